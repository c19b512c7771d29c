//! Points over two axes.

use super::pen::{AXIS, GRID, Pen};
use super::ticked::Ticked;
use super::{Drawn, LETTER, message, text};
use crate::report::escape::attribute;
use crate::report::figure::{Axis, Entry, Plot, Point, Scale, Series, Style};
use plotters::prelude::*;
use std::fmt::Write;

/// Room beside the box where papers' peaks stand, units.
const PEAKS: i32 = 76;
/// The most that points at the same count are moved apart to either side, units.
const DODGE: f64 = 84.0;
/// Up to so many counts points are moved apart also where they have no intervals.
const FEW: usize = 2;

/// From so many doublings on, an axis by powers has its ticks at those of ten.
const DECADES: f64 = 6.6;

/// About the width of a digit, units.
const WIDTH: usize = 14;

/// Where numbers stand on an axis.
fn along(axis: &Axis, value: f64) -> f64 {
    if axis.scale == Scale::Doubling { value.max(f64::MIN_POSITIVE).log2() } else { value }
}

/// Axes, then points.
pub(super) fn draw(plot: &Plot, legend: &[Entry], size: (u32, u32)) -> Result<Drawn, String> {
    let mut inside = String::from("<g class=\"ax\">");
    let peaks = plot.series.iter().flat_map(|series| &series.points).any(|point| point.x.is_none());
    let place = axes(plot, size, peaks, &mut inside)?;
    inside.push_str("</g><g class=\"d\">");
    let (left, right, top, bottom) = place.box_;
    let offsets = dodge(&plot.series, right - left);
    for (series, offset) in plot.series.iter().zip(offsets) {
        write_series(series, offset, legend, &place, &mut inside);
    }
    inside.push_str("</g>");
    if peaks {
        inside.push_str(&text(right + PEAKS / 2, bottom + LETTER + 6, "m", "peak"));
    }
    let word = |scale: &Scale| match scale {
        Scale::Even => "even",
        Scale::Doubling => "log",
        Scale::Names(_) => "names",
    };
    let data = format!(
        " data-box=\"{left} {right} {top} {bottom}\" data-x=\"{} {} {}\" data-y=\"{} {} {}\" data-xn=\"{}\" data-yn=\"{}\" data-yu=\"{}\"",
        word(&plot.x.scale),
        short(plot.x.low),
        short(plot.x.high),
        word(&plot.y.scale),
        short(plot.y.low),
        short(plot.y.high),
        attribute(&plot.x.name),
        attribute(&plot.y.name),
        attribute(&plot.y.unit),
    );
    Ok(Drawn { size, data, inside })
}

/// From numbers to units.
struct Place {
    /// Left, right, top, bottom.
    box_: (i32, i32, i32, i32),
    at: Box<dyn Fn(f64, f64) -> (i32, i32)>,
}

fn axes(plot: &Plot, size: (u32, u32), peaks: bool, out: &mut String) -> Result<Place, String> {
    let (x, y) = (&plot.x, &plot.y);
    let area = Pen::new(out, size).into_drawing_area();
    let mut chart = ChartBuilder::on(&area)
        .margin_left(2)
        .margin_top(16)
        .margin_right(if peaks { PEAKS } else { 16 })
        .x_label_area_size(76)
        .y_label_area_size(100)
        .build_cartesian_2d(across(x, size.0 as usize - 120), ticked(y, size.1 as usize / 62))
        .map_err(message)?;
    let unit = if y.unit.is_empty() { String::new() } else { format!(", {}", y.unit) };
    let unit_x = if x.unit.is_empty() { String::new() } else { format!(", {}", x.unit) };
    let letters = ("sans-serif", LETTER);
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(AXIS)
        .x_label_formatter(&|at| label(x, *at))
        .y_label_formatter(&|at| label(y, *at))
        .x_desc(format!("{}{unit_x}", x.name))
        .y_desc(format!("{}{unit}", y.name))
        .axis_desc_style(letters)
        .label_style(letters)
        .set_all_tick_mark_size(6)
        .draw()
        .map_err(message)?;
    let (across, down) = chart.plotting_area().get_pixel_range();
    let coordinates = chart.as_coord_spec().clone();
    area.present().map_err(message)?;
    let (x, y) = (x.clone(), y.clone());
    let at = move |px: f64, py: f64| coordinates.translate(&(along(&x, px), along(&y, py)));
    Ok(Place { box_: (across.start, across.end, down.start, down.end), at: Box::new(at) })
}

/// What stands at a tick.
fn label(axis: &Axis, at: f64) -> String {
    match &axis.scale {
        Scale::Names(names) => names.get(at.round() as usize).cloned().unwrap_or_default(),
        Scale::Doubling => brief(at.exp2()),
        Scale::Even => brief(at),
    }
}

/// The horizontal axis, so many units long: as many ticks as leave room between what stands at them.
fn across(axis: &Axis, length: usize) -> Ticked {
    let fits = |most: usize| {
        let ticked = ticked(axis, most);
        let widest = ticked.ticks().iter().map(|at| label(axis, *at).len()).max().unwrap_or_default();
        let room = widest * WIDTH + LETTER as usize;
        (ticked.ticks().len() * room <= length).then_some(ticked)
    };
    (3..=length / 44).rev().find_map(fits).unwrap_or_else(|| ticked(axis, 2))
}

/// An axis with at most so many ticks.
fn ticked(axis: &Axis, most: usize) -> Ticked {
    let range = along(axis, axis.low)..along(axis, axis.high);
    let (first, last) = match &axis.scale {
        Scale::Names(names) => (0, names.len() as i32 - 1),
        // There is nothing between a frame and the next.
        Scale::Even if axis.name == "frame" && range.end - range.start < most as f64 => {
            (range.start.ceil() as i32, range.end.floor() as i32)
        }
        Scale::Even if axis.name != "processors" => return Ticked::round(range, most),
        // A number that is no count is read by its power of ten.
        Scale::Doubling if axis.name != "processors" && range.end - range.start > DECADES => {
            let power = 10f64.log2();
            let (first, last) = ((range.start / power).ceil() as i32, (range.end / power).floor() as i32);
            let step = ((last - first + 1).unsigned_abs() as usize).div_ceil(most.max(1)).max(1);
            return Ticked::new(
                range,
                (first..=last).step_by(step).map(|at| f64::from(at) * power).collect(),
            );
        }
        // Counts of processors, or their powers of two: whole ones only.
        _ => (range.start.ceil() as i32, range.end.floor() as i32),
    };
    let all = (last - first + 1).unsigned_abs() as usize;
    let step = if matches!(axis.scale, Scale::Names(_)) { 1 } else { all.div_ceil(most.max(1)) };
    Ticked::new(range, (first..=last).step_by(step.max(1)).map(f64::from).collect())
}

/// A number as an axis has room for it.
fn brief(value: f64) -> String {
    match value.abs() {
        size if size >= 1e6 => short(value / 1e6) + "M",
        size if size >= 1e4 => short(value / 1e3) + "k",
        _ => short(value),
    }
}

/// How far each series is moved aside, so that intervals at the same count do not hide one another.
fn dodge(series: &[Series], width: i32) -> Vec<i32> {
    let curves = || series.iter().filter(|series| series.style == Style::Curve);
    let points = || curves().flat_map(|series| &series.points);
    let mut counts: Vec<f64> = points().filter_map(|point| point.x).collect();
    counts.sort_by(f64::total_cmp);
    // A curve none of whose counts another has stays where it is.
    let alone = |series: &Series| {
        let shared = |point: &Point| counts.iter().filter(|count| Some(**count) == point.x).count() > 1;
        !series.points.iter().any(shared)
    };
    let moved: Vec<bool> =
        series.iter().map(|series| series.style == Style::Curve && !alone(series)).collect();
    let number = moved.iter().filter(|moved| **moved).count();
    let mut places = counts.clone();
    places.dedup();
    if number < 2 || !(places.len() <= FEW || points().any(|point| point.high > point.low)) {
        return vec![0; series.len()];
    }
    let reach = DODGE.min(f64::from(width) / places.len() as f64 / 4.0);
    let step = 2.0 * reach / (number - 1) as f64;
    let mut before = 0;
    let each = moved.iter().map(|moved| {
        before += usize::from(*moved);
        if *moved { (step * (before - 1) as f64 - reach).round() as i32 } else { 0 }
    });
    each.collect()
}

fn write_series(series: &Series, offset: i32, legend: &[Entry], place: &Place, out: &mut String) {
    let (_, right, ..) = place.box_;
    let at = |point: &Point, value: f64| match point.x {
        Some(x) => {
            let (x, y) = (place.at)(x, value);
            (x + offset, y)
        }
        None => (right + PEAKS / 2, (place.at)(0.0, value).1),
    };
    let look = series.entry.map(|entry| legend[entry].look);
    let word = match series.style {
        Style::Curve | Style::Joined => "c",
        Style::Scatter => "s",
        Style::Paper => "s h",
        Style::Ideal => "ideal",
        Style::Front => "front",
    };
    let class = look.map_or(word.to_owned(), |look| format!("{word} {}", look.class()));
    let mut places = String::new();
    let (mut data, mut notes) = (String::new(), String::new());
    for (number, point) in series.points.iter().enumerate() {
        let ((x, y), space) = (at(point, point.y), if number == 0 { "" } else { " " });
        let _ = write!(places, "{space}{x},{y}");
        let _ = write!(data, "{space}{},{}", point.x.map_or("p".to_owned(), short), short(point.y));
        if point.high > point.low {
            let _ = write!(data, ",{},{}", short(point.low), short(point.high));
        }
        let bar = if number == 0 { "" } else { "|" };
        let _ = write!(notes, "{bar}{}", attribute(&point.note.replace('|', "/")));
    }
    // A lone point is a line without length: its marks need two ends.
    if let [_] = series.points[..] {
        places = format!("{places} {places}");
    }
    let entry = series.entry.map_or(String::new(), |entry| format!(" data-c=\"{entry}\""));
    let moved = if offset == 0 { String::new() } else { format!(" data-o=\"{offset}\"") };
    let notes = if series.points.iter().all(|point| point.note.is_empty()) {
        String::new()
    } else {
        format!(" data-n=\"{notes}\"")
    };
    let _ = write!(
        out,
        "<polyline class=\"{class}\"{entry}{moved} data-d=\"{data}\"{notes} points=\"{places}\"/>"
    );
    let mut bars = String::new();
    for point in series.points.iter().filter(|point| point.high > point.low) {
        let ((x, low), (_, high)) = (at(point, point.low), at(point, point.high));
        let _ = write!(bars, "M{x} {low}V{high}");
    }
    if let (Some(look), false) = (look, bars.is_empty()) {
        let _ = write!(out, "<path class=\"i k{}\"{entry} d=\"{bars}\"/>", look.colour);
    }
}

/// A number in as few letters as tell it to four digits.
pub(super) fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let digits = (3 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_are_short_and_never_nan() {
        let numbers = [0.0, 1.0, 1.25, 1.0 / 3.0, 12_345.6, -0.000_000_000_1, 0.000_123_46, f64::NAN];
        assert_eq!(numbers.map(short), ["0", "1", "1.25", "0.3333", "12346", "0", "0.0001235", "0"]);
    }
}
