//! How frame times are spread: from the rows of single frames where they were kept, else from the percentiles.

use super::curves::{curves, fit};
use super::time::unit;
use super::words::{Legend, file, heading, number};
use super::{Axis, Body, Entry, Figure, Material, Panel, Plot, Point, Scale, Series, Style, pair};
use crate::report::group::{Curve, Group, groups, split};
use std::collections::HashMap;

/// What the rows of a cell tell where those of its frames were not kept: metric, and its name on the axis.
const KEPT: [(&str, &str); 4] =
    [("frame_time_p50", "50"), ("frame_time_p90", "90"), ("frame_time_p99", "99"), ("frame_time_max", "max")];
/// What is drawn of the rows of frames: the share of frames, and its name on the axis.
const SHARES: [(f64, &str); 8] = [
    (0.0, "min"),
    (0.1, "10"),
    (0.25, "25"),
    (0.5, "50"),
    (0.75, "75"),
    (0.9, "90"),
    (0.99, "99"),
    (1.0, "max"),
];

pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let legend = Legend::new(&material.groups);
    let spread = Spread::of(material);
    let mut panels: Vec<Panel> = material
        .groups
        .iter()
        .enumerate()
        .filter_map(|(place, group)| panel(material, place, group, &legend, &spread))
        .collect();
    let tops = panels.iter().map(|panel| {
        let points = curves(panel).flat_map(|(_, points)| points);
        points.map(|point| point.y).fold(0.0, f64::max)
    });
    let (scale, unit) = unit(tops.fold(f64::INFINITY, f64::min));
    for panel in &mut panels {
        let Body::Plot(plot) = &mut panel.body else { continue };
        plot.y.unit = unit.to_owned();
        for point in plot.series.iter_mut().flat_map(|series| &mut series.points) {
            (point.y, point.low, point.high) = (point.y / scale, point.low / scale, point.high / scale);
        }
    }
    fit(&mut panels, false);
    let from = match spread {
        Spread::Frames(_) => "every frame of all repeats",
        Spread::Percentiles(_) => "the percentiles of each cell, the median over its repeats",
    };
    vec![Figure {
        kind: "frames".into(),
        title: "Frame times".into(),
        says: says(&panels, &legend.entries, unit),
        how: format!(
            "The time within which so many of the frames were done, at the most processors of each; from {from}."
        ),
        legend: legend.entries,
        panels,
    }]
}

/// Where the numbers come from.
enum Spread {
    /// Cell to its frame times, sorted.
    Frames(HashMap<Key, Vec<f64>>),
    /// The metrics of [`KEPT`].
    Percentiles(Vec<Vec<Group>>),
}

/// Machine, scene, common settings, scheme, own settings, processors.
type Key = (String, String, String, String, String, u32);

impl Spread {
    fn of(material: &Material<'_>) -> Self {
        let mut frames: HashMap<Key, Vec<f64>> = HashMap::new();
        let rows = &material.run.rows;
        for row in rows.iter().filter(|row| row.metric == "frame_time" && row.frame.is_some()) {
            if !row.value.is_finite() {
                continue;
            }
            let (common, own) = split(&row.settings, &row.machine);
            let (machine, scene, scheme) = (row.machine.clone(), row.scene.clone(), row.scheme.clone());
            frames.entry((machine, scene, common, scheme, own, row.processors)).or_default().push(row.value);
        }
        if frames.is_empty() {
            return Self::Percentiles(KEPT.iter().map(|(metric, _)| groups(rows, metric)).collect());
        }
        frames.values_mut().for_each(|times| times.sort_by(f64::total_cmp));
        Self::Frames(frames)
    }

    fn names(&self) -> Vec<String> {
        match self {
            Self::Frames(_) => SHARES.iter().map(|(_, name)| (*name).to_owned()).collect(),
            Self::Percentiles(_) => KEPT.iter().map(|(_, name)| (*name).to_owned()).collect(),
        }
    }

    /// The times of a cell, one for each name; none where its rows are not there.
    fn times(&self, group: &Group, curve: &Curve, processors: u32) -> Option<Vec<f64>> {
        match self {
            Self::Frames(frames) => {
                let (common, own) = (group.settings.clone(), curve.settings.clone());
                let key = (
                    group.machine.clone(),
                    group.scene.clone(),
                    common,
                    curve.scheme.clone(),
                    own,
                    processors,
                );
                let times = frames.get(&key)?;
                let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
                Some(SHARES.iter().map(|(share, _)| at(*share)).collect())
            }
            Self::Percentiles(metrics) => metrics
                .iter()
                .map(|groups| {
                    let same = |other: &&Group| {
                        (&other.machine, &other.scene, &other.settings)
                            == (&group.machine, &group.scene, &group.settings)
                    };
                    let own = groups.iter().find(same)?.curve(&curve.scheme, &curve.settings)?;
                    own.points.get(&processors).map(|point| point.median)
                })
                .collect(),
        }
    }
}

fn panel(
    material: &Material<'_>,
    place: usize,
    group: &Group,
    legend: &Legend,
    spread: &Spread,
) -> Option<Panel> {
    let names = spread.names();
    let mut series = Vec::new();
    for best in group.best() {
        let Some((&count, _)) = best.choice.last_key_value() else { continue };
        let Some((curve, _)) = best.at(group, count) else { continue };
        let Some(times) = spread.times(group, curve, count) else { continue };
        let note = format!("P = {count}");
        let point = |(at, time)| Point { note: note.clone(), ..Point::bare(at as f64, time) };
        let points = times.into_iter().enumerate().map(point).collect();
        series.push(Series { style: Style::Curve, entry: legend.entry(&best), points });
    }
    let most = group.parallel_counts().max().unwrap_or(1);
    let high = names.len() as f64 - 0.6;
    let (name, scale) = ("share of the frames".into(), Scale::Names(names));
    let x = Axis { name, unit: "%".into(), scale, low: -0.4, high };
    let y = Axis { name: "frame time".into(), unit: String::new(), scale: Scale::Even, low: 0.0, high: 1.0 };
    let pairs: Vec<_> = material.groups.iter().map(pair).collect();
    (!series.is_empty()).then(|| Panel {
        heading: format!("{}, P = {most}", heading(group, &material.groups)),
        place: super::words::full(group),
        file: file(group),
        machine: group.machine.clone(),
        group: Some(place),
        pair: pairs.iter().position(|other| *other == pairs[place]).unwrap_or(place),
        note: String::new(),
        body: Body::Plot(Plot { x, y, series }),
    })
}

/// The steadiest and the least steady, by how far the slow frames stand from the middle.
fn says(panels: &[Panel], legend: &[Entry], unit: &str) -> String {
    let ratios = panels.iter().flat_map(|panel| {
        curves(panel).filter_map(move |(entry, points)| {
            let Body::Plot(Plot { x: Axis { scale: Scale::Names(names), .. }, .. }) = &panel.body else {
                return None;
            };
            let at = |name: &str| names.iter().position(|other| other == name).and_then(|at| points.get(at));
            let (middle, slow) = (at("50")?, at("99")?);
            let ratio = slow.y / middle.y;
            ratio.is_finite().then_some((panel, entry, middle.y, slow.y, ratio))
        })
    });
    let ratios: Vec<_> = ratios.collect();
    let most = ratios.iter().max_by(|a, b| a.4.total_cmp(&b.4));
    let least = ratios.iter().min_by(|a, b| a.4.total_cmp(&b.4));
    let (Some(most), Some(least)) = (most, least) else { return String::new() };
    let place =
        |panel: &Panel| if panels.len() == 1 { String::new() } else { format!(" ({})", panel.heading) };
    format!(
        "99 in 100 frames are done within {} {unit} where the middle one takes {} with {}{}: the widest spread. The \
         narrowest: {} times the middle one, with {}{}.",
        number(most.3),
        number(most.2),
        legend[most.1].label,
        place(most.0),
        number(least.4),
        legend[least.1].label,
        place(least.0),
    )
}
