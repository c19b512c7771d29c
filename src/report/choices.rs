//! Runs in which nothing is shared out: cells of the serial scheme beside one another, told apart by their settings.
//! Their speedups are all one; what there is to see are times, what a test gives up, and ratios to a baseline.

use super::figure::{number, unit};
use super::group::{Group, groups};
use super::text::{blocks, wrap};
use crate::record::statistics::{Interval, interval};
use crate::record::{METRICS, Metric, Row, settings_pairs};
use std::collections::{BTreeMap, BTreeSet};

/// What says nothing of one processor.
const HIDDEN: [&str; 10] = [
    "frame_time",
    "frame_time_p50",
    "frame_time_p90",
    "frame_time_p99",
    "speedup",
    "speedup_self",
    "load_imbalance",
    "processors_used",
    "lost_time",
    "cell_complete",
];

/// Seed of the bootstrap, as in [`super::group`].
const SEED: u64 = 1;

/// Settings of a job that say what is asked, as those of its scene do, and not how it is answered.
const ASKED: [&str; 9] = [
    "job.ask",
    "job.frames",
    "job.gap",
    "job.offset",
    "job.place",
    "job.query",
    "job.rays",
    "job.reach",
    "job.scale",
];

/// Whether cells that differ in this setting answer different questions, so that neither can take the other's place.
fn is_asked(key: &str) -> bool {
    key.starts_with("scene.") || ASKED.contains(&key)
}

/// Whether all that ran was the serial scheme on one processor.
pub(crate) fn nothing_is_shared(groups: &[Group]) -> bool {
    let alone = |group: &Group| {
        group
            .curves
            .iter()
            .all(|curve| curve.scheme == "serial" && curve.points.keys().all(|count| *count == 1))
    };
    !groups.is_empty() && groups.iter().all(alone)
}

/// The groups of a run in which something is shared out; none otherwise.
pub(crate) fn compared(rows: &[Row]) -> Vec<Group> {
    let groups = groups(rows, "speedup");
    if nothing_is_shared(&groups) { Vec::new() } else { groups }
}

/// The cells of a machine, a scene and a question about it, such as a camera path.
#[derive(Clone, Debug)]
pub(crate) struct Choices {
    pub(crate) machine: String,
    pub(crate) scene: String,
    /// What is asked about the scene where that differs, `key=value key=value`.
    pub(crate) view: String,
    /// The metrics that are there.
    pub(crate) columns: Vec<&'static Metric>,
    /// A line a cell.
    pub(crate) lines: Vec<Choice>,
}

/// A cell.
#[derive(Clone, Debug)]
pub(crate) struct Choice {
    pub(crate) label: String,
    pub(crate) settings: String,
    /// A number a column, the median over the repeats; none where it was not taken.
    pub(crate) values: Vec<Option<Interval>>,
}

/// The settings whose values differ from row to row.
pub(crate) fn differing(rows: &[Row]) -> BTreeSet<&str> {
    let all: BTreeSet<&str> = rows.iter().map(|row| row.settings.as_str()).collect();
    let pairs: BTreeSet<(&str, &str)> = all.iter().flat_map(|settings| settings_pairs(settings)).collect();
    let everywhere =
        |pair: &(&str, &str)| all.iter().all(|other| settings_pairs(other).any(|own| own == *pair));
    pairs.into_iter().filter(|pair| !everywhere(pair)).map(|(key, _)| key).collect()
}

/// What a cell of these rows is called: the values of the settings that differ, but for those that are asked. Where it
/// is one setting, its key goes without saying.
pub(crate) fn labels(rows: &[Row]) -> impl Fn(&str) -> String {
    let keys: BTreeSet<String> =
        differing(rows).into_iter().filter(|key| !is_asked(key)).map(str::to_owned).collect();
    move |settings| {
        let own = settings_pairs(settings).filter(|(key, _)| keys.contains(*key));
        let words = own.map(|(key, value)| match keys.len() {
            1 => value.to_owned(),
            _ => format!("{}={value}", key.split_once('.').map_or(key, |(_, bare)| bare)),
        });
        let words = words.collect::<Vec<_>>().join(" ");
        if words.is_empty() { "serial".to_owned() } else { words }
    }
}

/// What is asked of a cell, of that which differs.
pub(crate) fn views(rows: &[Row]) -> impl Fn(&str) -> String {
    let keys: BTreeSet<String> =
        differing(rows).into_iter().filter(|key| is_asked(key)).map(str::to_owned).collect();
    move |settings| {
        let own = settings_pairs(settings).filter(|(key, _)| keys.contains(*key));
        own.map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(" ")
    }
}

/// The choices of a run in which nothing is shared out, in the order of its rows; none otherwise.
pub(crate) fn choices(rows: &[Row]) -> Vec<Choices> {
    if !nothing_is_shared(&groups(rows, "speedup")) {
        return Vec::new();
    }
    let (label, view) = (labels(rows), views(rows));
    let told = |row: &&Row| row.frame.is_none() && row.value.is_finite() && !HIDDEN.contains(&&*row.metric);
    let mut values: BTreeMap<(usize, usize, &str), Vec<f64>> = BTreeMap::new();
    let mut all: Vec<Choices> = Vec::new();
    for row in rows.iter().filter(told) {
        let view = view(&row.settings);
        let same = |other: &Choices| {
            (&other.machine, &other.scene, &other.view) == (&row.machine, &row.scene, &view)
        };
        let place = all.iter().position(same).unwrap_or_else(|| {
            let (machine, scene) = (row.machine.clone(), row.scene.clone());
            all.push(Choices { machine, scene, view, columns: Vec::new(), lines: Vec::new() });
            all.len() - 1
        });
        let lines = &mut all[place].lines;
        let line = lines.iter().position(|line| line.settings == row.settings).unwrap_or_else(|| {
            let (label, settings) = (label(&row.settings), row.settings.clone());
            lines.push(Choice { label, settings, values: Vec::new() });
            lines.len() - 1
        });
        values.entry((place, line, &row.metric)).or_default().push(row.value);
    }
    for (place, choices) in all.iter_mut().enumerate() {
        let there = |metric: &&Metric| {
            (0..choices.lines.len()).any(|line| values.contains_key(&(place, line, metric.name)))
        };
        choices.columns = METRICS.iter().filter(there).collect();
        for (number, line) in choices.lines.iter_mut().enumerate() {
            let of = |metric: &&Metric| interval(values.get(&(place, number, metric.name))?, SEED);
            line.values = choices.columns.iter().map(of).collect();
        }
    }
    all
}

impl Choices {
    /// A column's heading, and its numbers as they are read: medians, times in a unit that suits them.
    pub(crate) fn column(&self, column: usize) -> (String, Vec<String>) {
        let metric = self.columns[column];
        let medians = || self.lines.iter().map(|line| line.values[column].map(|value| value.median));
        let (scale, unit) = match metric.unit {
            "ns" => unit(medians().flatten().fold(0.0, f64::max)),
            unit => (1.0, unit),
        };
        let name = metric.name.replace('_', " ");
        let heading = if unit == "x" { name } else { format!("{name}, {unit}") };
        let cells = medians().map(|median| median.map_or("-".to_owned(), |median| number(median / scale)));
        (heading, cells.collect())
    }

    /// As a table for reading.
    pub(crate) fn text(&self) -> String {
        let view = if self.view.is_empty() { String::new() } else { format!(", {}", self.view) };
        let title = wrap(&format!("one processor of {}, {}{view}: medians", self.machine, self.scene), 2);
        let names = std::iter::once(String::new()).chain(self.lines.iter().map(|line| line.label.clone()));
        let mut columns = vec![names.collect::<Vec<_>>()];
        for column in 0..self.columns.len() {
            let (heading, cells) = self.column(column);
            columns.push(std::iter::once(heading).chain(cells).collect());
        }
        title + &blocks(&columns).join("\n")
    }
}
