//! Speed against accuracy, one kind of accuracy at a time, with the Pareto front.
//!
//! A panel holds cells that are alternatives: one machine, job, scene and question about it. What is given up in
//! *structure* is more work for the same answer, so that cells stand together only where their answer, the nodes found
//! visible, the pixels covered or the rays that hit, is the same; where rows do not tell the answer, only those that
//! share their common settings do. Where what is counted is by how much an answer is too large, all of them stand
//! together. Where no cell gives up more than another there is no choice to show, and nothing is drawn.
//!
//! Cells whose settings differ in a knob alone, as `pixel_reuse:4` and `pixel_reuse:8` do, are one method: a line joins
//! them in the order of the knob (Lext, Assarsson and Möller 2000, Approximating algorithms; P3-A04).

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
    // Of an animation the time a frame is what its paper asks for.
    let a_frame = medians(rows, "frame_time_mean");
    let of_frame = !a_frame.is_empty();
    let times = if of_frame { a_frame } else { medians(rows, "total_time") };
    let axis = if of_frame { "time a frame" } else { "time of all frames" };
    let mut answers = medians(rows, "nodes_visible");
    answers.extend(medians(rows, "pixels_covered"));
    answers.extend(medians(rows, "rays_hit"));
    let mut methods = Methods::default();
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
                panels.push(panel(&place, (metric, axis), &choices, &mut methods, panels.len(), name, alone));
            }
        }
    }
    let says = panels.iter().map(says).collect::<Vec<_>>().join(" ");
    let joined = methods.0.iter().any(|method| method.knobs.len() > 1);
    (!panels.is_empty()).then(|| Figure {
        kind: format!("accuracy-{}", kind.word()),
        title: format!("Speed against accuracy: {}", kind.word()),
        says,
        how: format!(
            "Every cell is a point; the {}line joins those of which no other is both quicker and gives up less.{}",
            if joined { "grey " } else { "" },
            if joined { " Others join the cells of a method, in the order of its knob." } else { "" }
        ),
        legend: methods.legend(),
        panels,
    })
}

/// What has a line in the legend: a scheme, or where nothing is shared out a method, with the values of its knob.
#[derive(Default)]
struct Methods(Vec<Method>);

struct Method {
    name: String,
    look: Look,
    /// As they are written.
    knobs: Vec<String>,
}

impl Methods {
    /// The number of a method, one more of whose knob's values is now known.
    fn number(&mut self, (name, knob): (&str, Option<&str>), look: impl Fn(usize) -> Look) -> usize {
        let number = self.0.iter().position(|method| method.name == name).unwrap_or_else(|| {
            let look = look(self.0.len());
            self.0.push(Method { name: name.to_owned(), look, knobs: Vec::new() });
            self.0.len() - 1
        });
        let knobs = &mut self.0[number].knobs;
        knobs.extend(knob.filter(|knob| !knobs.iter().any(|other| other == knob)).map(str::to_owned));
        number
    }

    fn legend(self) -> Vec<Entry> {
        let entry = |mut method: Method| {
            let value = |text: &String| text.parse().unwrap_or(f64::NAN);
            method.knobs.sort_by(|a, b| value(a).total_cmp(&value(b)));
            let label = match method.knobs.is_empty() {
                true => method.name,
                false => format!("{}: {}", method.name, method.knobs.join(", ")),
            };
            Entry { label, look: method.look }
        };
        self.0.into_iter().map(entry).collect()
    }
}

/// Points with the values of their method's knob.
type Knobbed = Vec<(Option<f64>, Point)>;

/// A method and its knob: `pixel_reuse:4` is `pixel_reuse` at 4.
fn method(label: &str) -> (&str, Option<&str>) {
    match label.rsplit_once(':') {
        Some((name, knob)) if knob.parse::<f64>().is_ok_and(f64::is_finite) => (name, Some(knob)),
        _ => (label, None),
    }
}

fn panel(
    (place, scene, view): &(&str, &str, String),
    (metric, time): (&Metric, &str),
    choices: &[Choice<'_>],
    methods: &mut Methods,
    pair: usize,
    name: Option<&dyn Fn(&str) -> String>,
    alone: bool,
) -> Panel {
    let (scale, unit) = unit(choices.iter().map(|choice| choice.time).fold(0.0, f64::max));
    let mut series: Vec<(Style, usize, Knobbed)> = Vec::new();
    for choice in choices {
        let label = name.map_or_else(|| choice.scheme.to_owned(), |name| name(choice.settings));
        let (own, knob) = if name.is_some() { method(&label) } else { (&*label, None) };
        let number = methods.number((own, knob), |number| match name {
            Some(_) => Look::nth(number),
            None => Look::of(choice.scheme, 0),
        });
        let differs = |pair: &(&str, &str)| {
            choices.iter().any(|other| settings_pairs(other.settings).all(|theirs| theirs != *pair))
        };
        let settings = settings_pairs(choice.settings).filter(differs);
        let settings = settings.map(|(key, value)| format!("{}={value}", bare(key)));
        let note = std::iter::once(format!("P = {}", choice.processors)).chain(settings);
        let note = note.collect::<Vec<_>>().join(" ");
        let point = Point { note, ..Point::bare(choice.given_up, choice.time / scale) };
        let knob = knob.and_then(|knob| knob.parse().ok());
        match series.iter_mut().find(|(_, entry, _)| *entry == number) {
            Some((.., points)) => points.push((knob, point)),
            None => series.push((
                knob.map_or(Style::Scatter, |_: f64| Style::Joined),
                number,
                vec![(knob, point)],
            )),
        }
    }
    let joined = |(style, entry, mut points): (Style, usize, Knobbed)| {
        if style == Style::Joined {
            points.sort_by(|a, b| a.0.unwrap_or_default().total_cmp(&b.0.unwrap_or_default()));
        }
        let points = points.into_iter().map(|(_, point)| point).collect();
        Series { style, entry: Some(entry), points }
    };
    let mut series: Vec<Series> = series.into_iter().map(joined).collect();
    let all: Vec<&Point> = series.iter().flat_map(|series| &series.points).collect();
    let name = metric.name.replace('_', " ");
    let x = axis(name, metric.unit, all.iter().filter_map(|point| point.x), metric.counts_surplus);
    let y = axis(time.to_owned(), unit, all.iter().map(|point| point.y), true);
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
    use super::{Better, Look, Methods, Point, front, method};

    #[test]
    fn cells_that_differ_in_a_knob_are_one_method() {
        assert_eq!(method("pixel_reuse:4"), ("pixel_reuse", Some("4")));
        assert_eq!(
            method("depth=3 approximation=lower_resolution:1.5"),
            ("depth=3 approximation=lower_resolution", Some("1.5"))
        );
        for whole in ["exact", "a:b", "file.obj:", "x:nan", "x:inf"] {
            assert_eq!(method(whole), (whole, None));
        }
        let mut methods = Methods::default();
        for label in ["exact", "reuse:12", "reuse:4", "exact", "reuse:4"] {
            methods.number(method(label), Look::nth);
        }
        let legend: Vec<String> = methods.legend().into_iter().map(|entry| entry.label).collect();
        assert_eq!(legend, ["exact", "reuse: 4, 12"]);
    }

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
