//! Tables: the paper's figures beside ours, and the numbers behind a figure.

use crate::report::Table;
use crate::report::escape::attribute;
use crate::report::figure::{
    ACTIVITIES, Axis, Bars, Body, Field, Figure, Plot, Point, Scale, Style, number, shares,
};
use std::fmt::Write;

/// Paper, simulated, measured and the errors, of the figures the paper printed; nothing where it printed none.
pub(super) fn paper(table: &Table) -> String {
    let figures: Vec<_> = table.lines.iter().filter(|line| line.figure.is_some()).collect();
    if figures.is_empty() {
        return String::new();
    }
    let mut html = String::from(
        "<h3>Paper, simulated, measured</h3>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Paper, \
         simulated and measured\"><table class=\"paper\"><thead><tr>",
    );
    let head = ["Figure", "Scheme", "Settings", "Scene", "Machine", "P", "Metric"];
    let numbers = ["Paper", "Simulated", "Error", "Measured", "Error"];
    head.iter().for_each(|word| html.push_str(&format!("<th scope=\"col\">{word}")));
    numbers.iter().for_each(|word| html.push_str(&format!("<th scope=\"col\" class=\"n\">{word}")));
    html.push_str("<tbody>\n");
    let finite = |value: Option<f64>| value.filter(|value| value.is_finite());
    for line in figures {
        let processors = line.processors.map_or("peak".to_owned(), |count| count.to_string());
        let metric =
            if line.unit == "x" { line.metric.clone() } else { format!("{}, {}", line.metric, line.unit) };
        let figure = line.figure.as_deref().unwrap_or_default();
        let _ = write!(html, "<tr><th scope=\"row\">{}", attribute(figure));
        for word in
            [&line.scheme, &line.settings.replace(';', " "), &line.scene, &line.machine, &processors, &metric]
        {
            let _ = write!(html, "<td>{}", attribute(word));
        }
        let plain = |value| finite(value).map_or("-".to_owned(), number);
        let error =
            |value| finite(value).map_or("-".to_owned(), |error: f64| format!("{:+.0} %", 100.0 * error));
        for word in [
            plain(line.paper),
            plain(line.simulated),
            error(line.error_simulated),
            plain(line.measured),
            error(line.error_measured),
        ] {
            let _ = write!(html, "<td class=\"n\">{word}");
        }
        html.push('\n');
    }
    html + "</table></div>\n"
}

/// The cells of a run in which nothing is shared out, a table for each scene and camera path.
pub(super) fn choices(table: &Table) -> String {
    let mut html = String::new();
    for choices in &table.choices {
        let place = format!("{} on {} {}", choices.scene, choices.machine, choices.view);
        let place = attribute(place.trim());
        let _ = write!(
            html,
            "<details><summary>Cells of {place}: medians</summary><div class=\"wide\" tabindex=\"0\" role=\"region\" \
             aria-label=\"Cells of {place}\"><table><thead><tr><th scope=\"col\">Test"
        );
        let columns: Vec<_> = (0..choices.columns.len()).map(|column| choices.column(column)).collect();
        columns.iter().for_each(|(heading, _)| {
            let _ = write!(html, "<th scope=\"col\" class=\"n\">{}", attribute(heading));
        });
        html.push_str("<tbody>\n");
        for (number, line) in choices.lines.iter().enumerate() {
            let _ = write!(html, "<tr><th scope=\"row\">{}", attribute(&line.label));
            columns.iter().for_each(|(_, cells)| {
                let _ = write!(html, "<td class=\"n\">{}", attribute(&cells[number]));
            });
            html.push('\n');
        }
        html.push_str("</table></div></details>\n");
    }
    html
}

/// What the job tells of its cells beside all that.
pub(super) fn listings(table: &Table) -> String {
    let mut html = String::new();
    for listing in &table.listings {
        let title = attribute(&listing.title);
        let _ = write!(
            html,
            "<details class=\"listing\"><summary>{title}</summary><div class=\"wide\" tabindex=\"0\" role=\"region\" \
             aria-label=\"{title}\"><table><thead><tr>"
        );
        for column in &listing.columns {
            let class = if column.is_words { "" } else { " class=\"n\"" };
            let _ = write!(html, "<th scope=\"col\"{class}>{}", attribute(&column.heading));
        }
        html.push_str("<tbody>\n");
        for line in 0..listing.len() {
            html.push_str("<tr>");
            for (number, column) in listing.columns.iter().enumerate() {
                let start = match (number, column.is_words) {
                    (0, _) => "<th scope=\"row\">",
                    (_, true) => "<td>",
                    (_, false) => "<td class=\"n\">",
                };
                let _ = write!(html, "{start}{}", attribute(&column.cells[line]));
            }
            html.push('\n');
        }
        let _ = writeln!(html, "</table></div><p>{}.</p></details>", attribute(&listing.notes.join(". ")));
    }
    html
}

/// What the measured numbers cannot tell apart, what was far out, and how much of a core was lost to others;
/// nothing where nothing was measured.
pub(super) fn doubts(table: &Table) -> String {
    let all = table.groups.iter().zip(&table.doubts).filter(|(_, doubts)| !doubts.is_empty());
    let items = all.map(|(group, doubts)| {
        let place = format!("{}, {} {}", group.machine, group.scene, group.settings.replace(';', " "));
        format!("<li><strong>{}</strong>: {}\n", attribute(place.trim()), attribute(&doubts.join("; ")))
    });
    let items = items.collect::<String>();
    if items.is_empty() {
        return items;
    }
    format!("<details><summary>How sure the measured speedups are</summary><ul>\n{items}</ul></details>\n")
}

/// The numbers behind a figure.
pub(super) fn numbers(figure: &Figure) -> String {
    let mut html = format!(
        "<details><summary>Table: {}</summary><div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\">\
         <table>\n",
        attribute(&figure.title)
    );
    for panel in &figure.panels {
        let _ =
            write!(html, "<tbody><tr><th scope=\"rowgroup\" colspan=\"99\">{}", attribute(&panel.heading));
        match &panel.body {
            Body::Plot(plot) if plot.series.iter().any(|series| series.style == Style::Front) => {
                scatter(&mut html, plot, figure);
            }
            Body::Plot(plot) => curves(&mut html, plot, figure),
            Body::Field(field) => cells(&mut html, field, figure),
            Body::Bars(bars) => activities(&mut html, bars),
        }
        html.push('\n');
    }
    html + "</table></div></details>\n"
}

fn name(axis: &Axis, at: f64) -> String {
    match &axis.scale {
        Scale::Names(names) => names.get(at.round() as usize).cloned().unwrap_or_default(),
        _ => number(at),
    }
}

fn title(axis: &Axis) -> String {
    let unit = if axis.unit.is_empty() { String::new() } else { format!(", {}", axis.unit) };
    attribute(&format!("{}{unit}", axis.name))
}

/// A line a curve, a column a place on the horizontal axis; papers' points stand in lines of their own.
fn curves(html: &mut String, plot: &Plot, figure: &Figure) {
    // Points that belong to a name may stand beside it.
    let place = |point: &Point| match &plot.x.scale {
        Scale::Names(_) => point.x.map(f64::round),
        _ => point.x,
    };
    let shown = plot.series.iter().filter(|series| series.entry.is_some());
    let mut places: Vec<f64> = shown.flat_map(|series| &series.points).filter_map(place).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    let _ = write!(html, "<tr><th scope=\"col\">{} by {}", title(&plot.y), attribute(&plot.x.name));
    for &at in &places {
        let _ = write!(html, "<th scope=\"col\" class=\"n\">{}", attribute(&name(&plot.x, at)));
    }
    for series in &plot.series {
        let Some(entry) = series.entry else { continue };
        let label = &figure.legend[entry].label;
        let words = match (&series.style, series.points.first()) {
            (Style::Paper, Some(point)) if point.x.is_none() => {
                format!("{label}, paper ({}): peak {}", point.note, number(point.y))
            }
            (Style::Paper, Some(point)) => format!("{label}, paper ({})", point.note),
            _ => label.clone(),
        };
        let _ = write!(html, "<tr><th scope=\"row\">{}", attribute(&words));
        for at in &places {
            let point = series.points.iter().find(|point| place(point) == Some(*at));
            let _ = match point {
                None => write!(html, "<td>"),
                Some(point) if point.high > point.low => write!(
                    html,
                    "<td class=\"n\">{} <small>[{}, {}]</small>",
                    number(point.y),
                    number(point.low),
                    number(point.high)
                ),
                Some(point) => write!(html, "<td class=\"n\">{}", number(point.y)),
            };
        }
    }
}

/// A line a point; those on the front are marked.
fn scatter(html: &mut String, plot: &Plot, figure: &Figure) {
    let _ = write!(
        html,
        "<tr><th scope=\"col\">scheme<th scope=\"col\">settings<th scope=\"col\" class=\"n\">{}<th scope=\"col\" \
         class=\"n\">{}<th scope=\"col\">on the front",
        title(&plot.x),
        title(&plot.y)
    );
    let front =
        plot.series.iter().filter(|series| series.style == Style::Front).flat_map(|series| &series.points);
    let front: Vec<_> = front.collect();
    for series in &plot.series {
        let Some(entry) = series.entry else { continue };
        for point in &series.points {
            let best =
                front.iter().any(|other| (other.x, other.y, &other.note) == (point.x, point.y, &point.note));
            let _ = write!(
                html,
                "<tr><th scope=\"row\">{}<td>{}<td class=\"n\">{}<td class=\"n\">{}<td>{}",
                attribute(&figure.legend[entry].label),
                attribute(&point.note),
                number(point.x.unwrap_or_default()),
                number(point.y),
                if best { "yes" } else { "" }
            );
        }
    }
}

fn cells(html: &mut String, field: &Field, figure: &Figure) {
    let _ = write!(
        html,
        "<tr><th scope=\"col\">{} by {}",
        attribute(&field.lines.0),
        attribute(&field.columns.0)
    );
    for column in &field.columns.1 {
        let _ = write!(html, "<th scope=\"col\">{}", attribute(column));
    }
    for (line, value) in field.lines.1.iter().enumerate() {
        let _ = write!(html, "<tr><th scope=\"row\">{}", attribute(value));
        for column in 0..field.columns.1.len() {
            let cell = field.cells.iter().find(|cell| (cell.line, cell.column) == (line, column));
            let words = cell.map_or(String::new(), |cell| {
                let note = attribute(&cell.note);
                format!(
                    "{} {}<br><small>{note}</small>",
                    attribute(&figure.legend[cell.entry].label),
                    cell.text
                )
            });
            let _ = write!(html, "<td>{words}");
        }
    }
}

fn activities(html: &mut String, bars: &Bars) {
    html.push_str(
        "<tr><th scope=\"col\">activity<th scope=\"col\" class=\"n\">share of the processors' time, %",
    );
    for ((name, _), share) in ACTIVITIES.iter().zip(shares(bars)) {
        let _ = write!(html, "<tr><th scope=\"row\">{name}<td class=\"n\">{}", number(100.0 * share));
    }
}
