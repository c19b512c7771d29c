//! Speed against accuracy, one kind of accuracy at a time, with the Pareto front.
//!
//! A panel holds cells that are alternatives: one machine, job, scene and question about it. What is given up in
//! *structure* is more work for the same answer, so that cells stand together only where their answer, the nodes found
//! visible, the pixels covered or the rays that hit, is the same; where rows do not tell the answer, only those that
//! share their common settings do. Where what is counted is by how much an answer is too large, all of them stand
//! together. Where no cell gives up more than another there is no choice to show, and nothing is drawn.

use super::time::unit;
use super::words::{bare, machine, number};
use super::{Axis, Body, Entry, Figure, Material, Panel, Plot, Point, Scale, Series, Style};
use crate::record::statistics::median;
use crate::record::{AccuracyKind, Better, METRICS, Metric, Row, settings_pairs};
use crate::report::choices::{labels, views};
use crate::report::group::split;
use crate::report::marker::Look;
use std::collections::BTreeMap;

pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    AccuracyKind::ALL.iter().filter_map(|&kind| figure(material, kind)).collect()
}

/// What tells a cell from another, its repeats left out: machine, job, scene, scheme, settings, processors.
type Key<'a> = (&'a str, &'a str, &'a str, &'a str, &'a str, u32);

/// The medians of a metric.
fn medians<'a>(rows: &'a [Row], metric: &str) -> BTreeMap<Key<'a>, f64> {
    let mut values: BTreeMap<Key<'a>, Vec<f64>> = BTreeMap::new();
    let whole = |row: &&Row| row.metric == metric && row.frame.is_none() && row.value.is_finite();
    for row in rows.iter().filter(whole) {
        let key = (&*row.machine, &*row.job, &*row.scene, &*row.scheme, &*row.settings, row.processors);
        values.entry(key).or_default().push(row.value);
    }
    values.into_iter().filter_map(|(key, values)| Some((key, median(&values)?))).collect()
}

/// What a panel's cells have in common: machine, job, scene, and what is asked about it with the answer.
type Place<'a> = (&'a str, &'a str, &'a str, (String, String));

/// One alternative.
struct Choice<'a> {
    scheme: &'a str,
    settings: &'a str,
    processors: u32,
    given_up: f64,
    time: f64,
}

fn figure(material: &Material<'_>, kind: AccuracyKind) -> Option<Figure> {
    let rows = &material.run.rows;
    let times = medians(rows, "total_time");
    let mut answers = medians(rows, "nodes_visible");
    answers.extend(medians(rows, "pixels_covered"));
    answers.extend(medians(rows, "rays_hit"));
    let mut entries: Vec<(String, Entry)> = Vec::new();
    let mut panels = Vec::new();
    // Where nothing is shared out, settings have looks of their own instead of the one scheme.
    let (label, view) = (labels(rows), views(rows));
    let alone = rows.iter().all(|row| row.machine == rows[0].machine);
    let name: Option<&dyn Fn(&str) -> String> = if material.choices.is_empty() { None } else { Some(&label) };
    for metric in METRICS.iter().filter(|metric| metric.accuracy == Some(kind)) {
        let mut places: BTreeMap<Place<'_>, Vec<Choice<'_>>> = BTreeMap::new();
        for (key, &given_up) in &medians(rows, metric.name) {
            let Some(&time) = times.get(key) else { continue };
            let &(machine, job, scene, scheme, settings, processors) = key;
            let same = match (kind, answers.get(key)) {
                _ if metric.counts_surplus => String::new(),
                (AccuracyKind::Structure, Some(answer)) => number(*answer),
                (AccuracyKind::Structure, None) => split(settings, machine).0,
                _ => String::new(),
            };
            let same = (view(settings), same);
            let choice = Choice { scheme, settings, processors, given_up, time };
            places.entry((machine, job, scene, same)).or_default().push(choice);
        }
        for ((machine, _, scene, _), choices) in places {
            if choices.iter().any(|choice| choice.given_up != choices[0].given_up) {
                let place = (machine, scene, view(choices[0].settings));
                panels.push(panel(&place, metric, &choices, &mut entries, panels.len(), name, alone));
            }
        }
    }
    let says = panels.iter().map(says).collect::<Vec<_>>().join(" ");
    (!panels.is_empty()).then(|| Figure {
        kind: format!("accuracy-{}", kind.word()),
        title: format!("Speed against accuracy: {}", kind.word()),
        says,
        how:
            "Every cell is a point; the line joins those of which no other is both quicker and gives up less."
                .into(),
        legend: entries.into_iter().map(|(_, entry)| entry).collect(),
        panels,
    })
}

fn panel(
    (place, scene, view): &(&str, &str, String),
    metric: &Metric,
    choices: &[Choice<'_>],
    entries: &mut Vec<(String, Entry)>,
    pair: usize,
    name: Option<&dyn Fn(&str) -> String>,
    alone: bool,
) -> Panel {
    let (scale, unit) = unit(choices.iter().map(|choice| choice.time).fold(0.0, f64::max));
    let mut series: Vec<Series> = Vec::new();
    for choice in choices {
        let label = name.map_or_else(|| choice.scheme.to_owned(), |name| name(choice.settings));
        let number = entries.iter().position(|(known, _)| *known == label).unwrap_or_else(|| {
            let look = if name.is_some() { Look::nth(entries.len()) } else { Look::of(choice.scheme, 0) };
            entries.push((label.clone(), Entry { label, look }));
            entries.len() - 1
        });
        let differs = |pair: &(&str, &str)| {
            choices.iter().any(|other| settings_pairs(other.settings).all(|theirs| theirs != *pair))
        };
        let settings = settings_pairs(choice.settings).filter(differs);
        let settings = settings.map(|(key, value)| format!("{}={value}", bare(key)));
        let note = std::iter::once(format!("P = {}", choice.processors)).chain(settings);
        let note = note.collect::<Vec<_>>().join(" ");
        let point = Point { note, ..Point::bare(choice.given_up, choice.time / scale) };
        match series.iter_mut().find(|series| series.entry == Some(number)) {
            Some(series) => series.points.push(point),
            None => {
                series.push(Series { style: Style::Scatter, entry: Some(number), points: vec![point] });
            }
        }
    }
    let all: Vec<&Point> = series.iter().flat_map(|series| &series.points).collect();
    let name = metric.name.replace('_', " ");
    let x = axis(name, metric.unit, all.iter().filter_map(|point| point.x), metric.counts_surplus);
    let y = axis("time of all frames".to_owned(), unit, all.iter().map(|point| point.y), true);
    let front = front(&all, metric.better);
    // A camera path goes by its name, and a machine that is the only one without saying.
    let short = view.split(' ').map(|pair| pair.strip_prefix("scene.path=").unwrap_or(bare(pair)));
    let on = if alone { String::new() } else { machine(place) };
    let heading = [on, (*scene).to_owned(), short.collect::<Vec<_>>().join(" ")];
    let heading = heading.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(", ");
    series.insert(0, Series { style: Style::Front, entry: None, points: front });
    Panel {
        heading,
        place: String::new(),
        file: format!("{place}-{scene}-{}{}", metric.name, view.replace([' ', '='], "-")),
        machine: (*place).to_owned(),
        group: None,
        pair,
        note: String::new(),
        body: Body::Plot(Plot { x, y, series }),
    }
}

/// From this ratio of the greatest to the least number on, most points would lie in a corner of even axes.
const FAR_APART: f64 = 50.0;

/// An axis that holds these numbers, from zero if told to, or by powers where they are far apart.
fn axis(name: String, unit: &str, values: impl Iterator<Item = f64>, from_zero: bool) -> Axis {
    let (low, high) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    let (scale, low, high) = if low > 0.0 && high >= FAR_APART * low {
        let room = (high / low).powf(0.05);
        (Scale::Doubling, low / room, high * room)
    } else {
        // Enough for what stands at two ticks to differ, where the numbers hardly do.
        let room = if high > low { (0.08 * (high - low)).max(0.005 * high.abs()) } else { 1.0 };
        (Scale::Even, if from_zero { 0.0 } else { low - room }, high + room)
    };
    Axis { name, unit: unit.to_owned(), scale, low, high }
}

/// The points that no other beats in one and equals in the other, best accuracy first.
fn front(points: &[&Point], better: Better) -> Vec<Point> {
    let cost = |point: &Point| {
        let x = point.x.unwrap_or_default();
        if better == Better::Lower { x } else { -x }
    };
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| cost(a).total_cmp(&cost(b)).then(a.y.total_cmp(&b.y)));
    let mut front: Vec<Point> = Vec::new();
    for point in sorted {
        if front.last().is_none_or(|last| point.y < last.y) {
            front.push(point.clone());
        }
    }
    front
}

fn says(panel: &Panel) -> String {
    let Body::Plot(plot) = &panel.body else { return String::new() };
    let front = &plot.series[0].points;
    let all: usize = plot.series[1..].iter().map(|series| series.points.len()).sum();
    let (Some(first), Some(last)) = (front.first(), front.last()) else { return String::new() };
    let tell = |point: &Point| {
        let x = number(point.x.unwrap_or_default());
        format!("{x} {} in {} {}", plot.x.unit, number(point.y), plot.y.unit)
    };
    let range = if front.len() == 1 {
        format!("one beats all: {}", tell(first))
    } else {
        format!("{} are on the front, from {} to {}", front.len(), tell(first), tell(last))
    };
    format!("{}: of {all} cells {range}.", panel.heading)
}

#[cfg(test)]
mod tests {
    use super::{Better, Point, front};

    #[test]
    fn the_front_leaves_out_what_another_beats() {
        let points = [(3.0, 1.0), (1.0, 5.0), (2.0, 5.0), (2.0, 2.0), (3.0, 2.0), (1.0, 6.0)];
        let points = points.map(|(x, y)| Point::bare(x, y));
        let all: Vec<&Point> = points.iter().collect();
        let of = |better| -> Vec<(f64, f64)> {
            front(&all, better).iter().map(|point| (point.x.unwrap_or_default(), point.y)).collect()
        };
        assert_eq!(of(Better::Lower), [(1.0, 5.0), (2.0, 2.0), (3.0, 1.0)]);
        assert_eq!(of(Better::Higher), [(3.0, 1.0)]);
        assert!(front(&[], Better::Lower).is_empty());
    }
}
