//! Paper, simulated and measured, side by side.

use super::choices::{Choices, choices, compared};
use super::doubt::doubts;
use super::group::{Curve, Group, groups};
use super::listing::{Listing, listings};
use super::text;
use crate::record::statistics::Interval;
use crate::record::{Better, Host, PaperFigure, Row, THREADS, metric, quoted, settings_pairs};
use serde::Serialize;
use std::collections::BTreeSet;

/// One number in up to three versions. Its columns are those of `apportion table --format csv`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    /// The paper's figure or table; none for a number of ours alone.
    pub figure: Option<String>,
    /// The scheme.
    pub scheme: String,
    /// The settings; for a paper's figure those of its best cell, simulated where there is one.
    pub settings: String,
    /// The scene.
    pub scene: String,
    /// The paper's or the simulated machine; `threads` where only threads ran so many processors.
    pub machine: String,
    /// Processors; none for the peak over all counts.
    pub processors: Option<u32>,
    /// The counts ours is the peak of, where they are not all of the experiment's: no error is given then.
    #[serde(skip)]
    pub peak_of: Option<String>,
    /// The metric.
    pub metric: String,
    /// Its unit.
    pub unit: String,
    /// What the paper printed.
    pub paper: Option<f64>,
    /// What the simulated machine gave.
    pub simulated: Option<f64>,
    /// What threads on this computer gave: the median over the repeats.
    pub measured: Option<f64>,
    /// The simulated number's error relative to the paper's: 0.1 is 10 % too high.
    pub error_simulated: Option<f64>,
    /// The measured number's error relative to the paper's.
    pub error_measured: Option<f64>,
}

/// A table: the paper's figures first, then all other speedups, or where nothing was shared out all other numbers.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Its lines.
    pub lines: Vec<Line>,
    /// Speedups by machine and scene, for the text.
    pub(crate) groups: Vec<Group>,
    /// For each group, what its numbers cannot tell.
    pub(crate) doubts: Vec<Vec<String>>,
    /// The cells of a run in which nothing is shared out.
    pub(crate) choices: Vec<Choices>,
    /// What its job tells beside all that.
    pub(crate) listings: Vec<Listing>,
}

/// Makes the table of a run.
pub fn table(rows: &[Row], figures: &[PaperFigure]) -> Table {
    let speedups = compared(rows);
    let mut lines: Vec<Line> = figures.iter().map(|figure| figure_line(rows, figure)).collect();
    for group in speedups.iter().filter(|group| group.machine != THREADS) {
        let twin = speedups.iter().find(|other| is_twin(other, group));
        for (curve, &processors) in
            group.curves.iter().flat_map(|curve| curve.points.keys().map(move |p| (curve, p)))
        {
            let measured = twin.and_then(|twin| point(twin, curve, processors));
            lines.push(speedup_line(group, curve, processors, point(group, curve, processors), measured));
        }
    }
    for group in speedups.iter().filter(|group| group.machine == THREADS) {
        let twins = || speedups.iter().filter(|other| other.machine != THREADS && is_twin(group, other));
        for (curve, &processors) in
            group.curves.iter().flat_map(|curve| curve.points.keys().map(move |p| (curve, p)))
        {
            if twins().all(|twin| point(twin, curve, processors).is_none()) {
                lines.push(speedup_line(group, curve, processors, None, point(group, curve, processors)));
            }
        }
    }
    let doubts = doubts(rows, &speedups);
    let choices = choices(rows);
    lines.extend(choices.iter().flat_map(choice_lines));
    Table { lines, groups: speedups, doubts, choices, listings: listings(rows) }
}

impl Table {
    /// Tells on which computer what is of `threads` was made.
    pub fn made_on(&mut self, host: &Host) {
        self.listings.iter_mut().for_each(|listing| listing.made_on(host));
    }

    /// Takes the error from peaks over fewer counts of processors than the experiment's, which `whole` gives for a
    /// machine: they are not what the paper printed.
    pub fn hold_peaks_to(&mut self, whole: impl Fn(&str) -> Vec<u32>) {
        for line in self.lines.iter_mut().filter(|line| line.figure.is_some() && line.processors.is_none()) {
            let of_machine = self.groups.iter().filter(|group| group.machine == line.machine);
            let counts: BTreeSet<u32> = of_machine.flat_map(Group::parallel_counts).collect();
            if !counts.is_empty() && whole(&line.machine).iter().any(|count| !counts.contains(count)) {
                line.peak_of = Some(ranges(&counts));
                (line.error_simulated, line.error_measured) = (None, None);
            }
        }
    }

    /// The table for reading.
    pub fn text(&self) -> String {
        text::text(self)
    }

    /// The lines as a JSON array.
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(&self.lines).expect("a line is strings and numbers, which JSON can hold")
    }

    /// The lines as comma-separated values; a number that is not there is an empty field.
    pub fn csv(&self) -> String {
        let mut csv = String::from(
            "figure,scheme,settings,scene,machine,processors,metric,unit,paper,simulated,measured,error_simulated,error_measured\n",
        );
        let number = |number: Option<f64>| number.map_or(String::new(), |number| number.to_string());
        for line in &self.lines {
            let fields = [
                quoted(line.figure.as_deref().unwrap_or_default()).into_owned(),
                quoted(&line.scheme).into_owned(),
                quoted(&line.settings).into_owned(),
                quoted(&line.scene).into_owned(),
                quoted(&line.machine).into_owned(),
                line.processors.map_or(String::new(), |processors| processors.to_string()),
                line.metric.clone(),
                line.unit.clone(),
                number(line.paper),
                number(line.simulated),
                number(line.measured),
                number(line.error_simulated),
                number(line.error_measured),
            ];
            csv.push_str(&fields.join(","));
            csv.push('\n');
        }
        csv
    }
}

/// Counts as a list with ranges: `1-4,8`.
fn ranges(counts: &BTreeSet<u32>) -> String {
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for &count in counts {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == count => *last = count,
            _ => ranges.push((count, count)),
        }
    }
    let text = |&(first, last): &(u32, u32)| {
        if first == last { first.to_string() } else { format!("{first}-{last}") }
    };
    ranges.iter().map(text).collect::<Vec<_>>().join(",")
}

/// Whether `threads` holds the measured numbers of what `simulated` simulates.
fn is_twin(threads: &Group, simulated: &Group) -> bool {
    threads.machine == THREADS
        && threads.scene == simulated.scene
        && threads.portable_settings() == simulated.portable_settings()
}

fn point(group: &Group, like: &Curve, processors: u32) -> Option<Interval> {
    let curve =
        group.curves.iter().find(|curve| curve.scheme == like.scheme && curve.settings == like.settings)?;
    curve.points.get(&processors).copied()
}

/// A line for each number of each cell.
fn choice_lines(choices: &Choices) -> impl Iterator<Item = Line> {
    let measured = choices.machine == THREADS;
    choices.lines.iter().flat_map(move |choice| {
        let numbers = choices.columns.iter().zip(&choice.values);
        numbers.filter_map(|(metric, value)| Some((metric, value.as_ref()?.median))).map(
            move |(metric, value)| Line {
                figure: None,
                scheme: "serial".to_owned(),
                settings: choice.settings.clone(),
                scene: choices.scene.clone(),
                machine: choices.machine.clone(),
                processors: Some(1),
                peak_of: None,
                metric: metric.name.to_owned(),
                unit: metric.unit.to_owned(),
                paper: None,
                simulated: (!measured).then_some(value),
                measured: measured.then_some(value),
                error_simulated: None,
                error_measured: None,
            },
        )
    })
}

fn speedup_line(
    group: &Group,
    curve: &Curve,
    processors: u32,
    simulated: Option<Interval>,
    measured: Option<Interval>,
) -> Line {
    Line {
        figure: None,
        scheme: curve.scheme.clone(),
        settings: group.all_settings(curve),
        scene: group.scene.clone(),
        machine: group.machine.clone(),
        processors: Some(processors),
        peak_of: None,
        metric: "speedup".to_owned(),
        unit: "x".to_owned(),
        paper: None,
        simulated: simulated.map(|point| point.median),
        measured: measured.map(|point| point.median),
        error_simulated: None,
        error_measured: None,
    }
}

fn figure_line(rows: &[Row], figure: &PaperFigure) -> Line {
    let groups = groups(rows, &figure.metric);
    let simulated = best(&groups, figure, &figure.machine).filter(|_| figure.machine != THREADS);
    let measured = best(&groups, figure, THREADS);
    let error = |ours: Option<f64>| ours.map(|ours| ours / figure.value - 1.0);
    let cell = simulated.as_ref().or(measured.as_ref());
    let (simulated, measured) =
        (simulated.as_ref().map(|best| best.value), measured.as_ref().map(|best| best.value));
    Line {
        figure: Some(figure.figure.clone()),
        scheme: figure.scheme.clone(),
        settings: cell.map_or_else(|| figure.settings.clone(), |best| best.settings.clone()),
        scene: cell.map_or_else(|| figure.scene.clone().unwrap_or_default(), |best| best.scene.clone()),
        machine: figure.machine.clone(),
        processors: figure.processors,
        peak_of: None,
        metric: figure.metric.clone(),
        unit: figure.unit.clone(),
        paper: Some(figure.value),
        simulated,
        measured,
        error_simulated: error(simulated),
        error_measured: error(measured),
    }
}

/// The best cell a figure can be held against.
struct Best {
    value: f64,
    settings: String,
    scene: String,
}

fn best(groups: &[Group], figure: &PaperFigure, machine: &str) -> Option<Best> {
    let higher = metric(&figure.metric).is_none_or(|metric| metric.better == Better::Higher);
    let mut best: Option<Best> = None;
    let fits = |group: &&Group| {
        group.machine == machine && figure.scene.as_ref().is_none_or(|scene| *scene == group.scene)
    };
    for group in groups.iter().filter(fits) {
        for curve in group.curves.iter().filter(|curve| curve.scheme == figure.scheme) {
            let settings = group.all_settings(curve);
            let has = |pair| settings_pairs(&settings).any(|own| own == pair);
            if !settings_pairs(&figure.settings).all(has) {
                continue;
            }
            let counts =
                curve.points.iter().filter(|(count, _)| figure.processors.is_none_or(|p| p == **count));
            for (_, point) in counts {
                let value = point.median;
                if best
                    .as_ref()
                    .is_none_or(|best| if higher { value > best.value } else { value < best.value })
                {
                    best = Some(Best { value, settings: settings.clone(), scene: group.scene.clone() });
                }
            }
        }
    }
    best
}
