//! Animations frame by frame (Lext, Assarsson and Möller 2000, Measurement report proposal; P3-11): the time of each
//! frame, that over another configuration's, how far pictures are off, rays by class, and what the time goes into.
//!
//! Of each scheme and setting those at the most processors are drawn. Where rows of frames were not kept there is
//! nothing to draw.

mod parts;
mod rays;

pub(crate) use parts::figures as parts;
pub(crate) use rays::figures as rays;

use super::curves::fit;
use super::time::unit;
use super::words::{machine, number};
use super::{Axis, Body, Entry, Figure, Material, Panel, Plot, Point, Scale, Series, Style};
use crate::record::Row;
use crate::record::statistics::median;
use crate::report::animation::{Configuration, names, of_animations};
use crate::report::choices::views;
use crate::report::marker::Look;
use std::collections::BTreeMap;

/// The numbers of one configuration by frame and repeat.
struct Told<'a> {
    configuration: Configuration<'a>,
    frames: BTreeMap<u32, BTreeMap<u32, f64>>,
}

impl Told<'_> {
    /// By frame, the medians over the repeats.
    fn medians(&self) -> impl Iterator<Item = (u32, f64)> {
        let of = |repeats: &BTreeMap<u32, f64>| median(&repeats.values().copied().collect::<Vec<_>>());
        self.frames.iter().filter_map(move |(frame, repeats)| Some((*frame, of(repeats)?)))
    }
}

/// What is told of frames by a metric, a configuration after the other in the order of the rows, of which only those at
/// the most processors; none of fewer frames than make a line.
fn told<'a>(rows: &'a [Row], metric: &str) -> Vec<Told<'a>> {
    let mut all: Vec<Told<'a>> = Vec::new();
    for row in of_animations(rows).filter(|row| row.metric == metric) {
        let Some(frame) = row.frame else { continue };
        let configuration = Configuration::of(row);
        let place = all.iter().position(|told| told.configuration == configuration).unwrap_or_else(|| {
            all.push(Told { configuration, frames: BTreeMap::new() });
            all.len() - 1
        });
        all[place].frames.entry(frame).or_default().insert(row.repeat, row.value);
    }
    let most = |one: &Configuration<'_>| {
        let same = all.iter().map(|told| &told.configuration).filter(|other| {
            let key = |one: &Configuration<'a>| (one.scene, one.scheme, one.settings, one.machine);
            key(other) == (one.scene, one.scheme, one.settings, one.machine)
        });
        same.map(|other| other.processors).max()
    };
    let keep: Vec<bool> = all
        .iter()
        .map(|told| told.frames.len() > 1 && most(&told.configuration) == Some(told.configuration.processors))
        .collect();
    all.into_iter().zip(keep).filter_map(|(told, keep)| keep.then_some(told)).collect()
}

/// The figures of one line a configuration.
pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let rows = &material.run.rows;
    let (times, ratios) = (told(rows, "frame_time"), told(rows, "pnsr"));
    // Where every picture is without error there is nothing to see.
    let differs = ratios.iter().any(|told| {
        let mut values = told.medians().map(|(_, value)| value);
        let first = values.next();
        values.any(|value| Some(value) != first)
    });
    let slowest = times.iter().flat_map(Told::medians).map(|(_, time)| time).fold(0.0, f64::max);
    let (scale, unit) = unit(slowest);
    let mut figures = vec![time(rows, &times, scale, unit), against(rows, &times)];
    figures.extend(differs.then(|| error(rows, &ratios)));
    figures
}

fn time(rows: &[Row], times: &[Told<'_>], scale: f64, unit: &str) -> Figure {
    let panels = Panels::new(rows, times, ("frame time", unit), |told, _| {
        told.medians().map(|(frame, time)| (frame, time / scale)).collect()
    });
    let says = panels.ends(|panel, (quickest, least), (slowest, most)| {
        let (least, most) = (number(least), number(most));
        format!("{panel}: from {least} {unit} ({quickest}) to {most} {unit} ({slowest}).")
    });
    panels.figure(
        ("by-frame-time", "Time of each frame"),
        says,
        "The median over the repeats, at the most processors of each; update of the structure included.",
    )
}

/// Each frame's time over that of the first configuration, of the serial scheme where it ran: `t_new(k) / t_old(k)`.
fn against(rows: &[Row], times: &[Told<'_>]) -> Figure {
    let mut panels = Panels::new(rows, times, ("time over the first's", "x"), |told, first| {
        if told.configuration == first.configuration {
            return Vec::new();
        }
        let ratio = |(frame, repeats): (&u32, &BTreeMap<u32, f64>)| {
            let old = first.frames.get(frame)?;
            // Of the same repeat, as what disturbs one disturbs the other.
            let pairs =
                repeats.iter().filter_map(|(repeat, new)| Some(new / old.get(repeat).filter(|o| **o > 0.0)?));
            Some((*frame, median(&pairs.collect::<Vec<_>>())?))
        };
        told.frames.iter().filter_map(ratio).collect()
    });
    for panel in &mut panels.panels {
        let Body::Plot(plot) = &mut panel.body else { continue };
        let line = [plot.x.low, plot.x.high].map(|x| Point::bare(x, 1.0)).to_vec();
        plot.series.insert(0, Series { style: Style::Ideal, entry: None, points: line });
        // The line at 1 is to be seen also where all are quicker.
        plot.y.high = plot.y.high.max(1.08);
    }
    let says = panels.ends(|panel, (quickest, least), (slowest, most)| {
        let (least, most) = (number(least), number(most));
        format!("{panel}: from {least} ({quickest}) to {most} ({slowest}).")
    });
    let firsts = panels.firsts.join(", ");
    let how = format!(
        "Of the same frame and repeat, the median over the repeats; below 1 is quicker than {firsts}."
    );
    panels.figure(("by-frame-ratio", "Time of each frame over the first's"), says, &how)
}

fn error(rows: &[Row], ratios: &[Told<'_>]) -> Figure {
    let panels = Panels::new(rows, ratios, ("PNSR", "dB"), |told, _| told.medians().collect());
    let says = panels.ends(|panel, (worst, least), _| {
        format!("{panel}: the worst frame has {} dB ({worst}).", number(least))
    });
    let how = "Peak noise to signal ratio of each frame's picture against the exact one; frames without any error stand \
               above the least error there can be.";
    panels.figure(("by-frame-pnsr", "How far each frame is off"), says, how)
}

/// Panels of a line a configuration, one for each machine, scene and question about it, and their legend.
struct Panels {
    panels: Vec<Panel>,
    legend: Vec<Entry>,
    /// What the first of each panel is called, each once.
    firsts: Vec<String>,
}

impl Panels {
    fn new<'a>(
        rows: &[Row],
        told: &[Told<'a>],
        (axis, unit): (&str, &str),
        points: impl Fn(&Told<'a>, &Told<'a>) -> Vec<(u32, f64)>,
    ) -> Self {
        let (name, view) = (names(rows), views(rows));
        // A configuration looks the same in all of these figures.
        let mut order: Vec<String> = Vec::new();
        for one in self::told(rows, "frame_time").iter().map(|told| name(&told.configuration)) {
            if !order.contains(&one) {
                order.push(one);
            }
        }
        let mut made = Self { panels: Vec::new(), legend: Vec::new(), firsts: Vec::new() };
        for places in places(told, &view) {
            let serial = places.iter().find(|told| told.configuration.scheme == "serial");
            let Some(first) = serial.or(places.first()) else { continue };
            let name_of = |told: &Told<'_>| label(&name, told, &places);
            let of_first = name_of(first);
            if !made.firsts.contains(&of_first) {
                made.firsts.push(of_first);
            }
            let mut series = Vec::new();
            for told in &places {
                let points = points(told, first);
                if points.is_empty() {
                    continue;
                }
                let look = order.iter().position(|other| *other == name(&told.configuration)).unwrap_or(0);
                let entry = made.entry(name_of(told), Look::nth(look));
                let points = points.into_iter().map(|(frame, y)| Point::bare(f64::from(frame), y)).collect();
                series.push(Series { style: Style::Curve, entry: Some(entry), points });
            }
            if !series.is_empty() {
                made.panels.push(panel(&first.configuration, &view, made.panels.len(), (axis, unit), series));
            }
        }
        fit(&mut made.panels, false);
        made
    }

    fn entry(&mut self, label: String, look: Look) -> usize {
        self.legend.iter().position(|entry| entry.label == label).unwrap_or_else(|| {
            self.legend.push(Entry { label, look });
            self.legend.len() - 1
        })
    }

    /// What is to be said of each panel's lowest and highest point, whose configurations are told.
    fn ends(&self, say: impl Fn(&str, (&str, f64), (&str, f64)) -> String) -> String {
        let of = |panel: &Panel| {
            let points = super::curves::curves(panel);
            let points = points.flat_map(|(entry, points)| points.iter().map(move |point| (entry, point.y)));
            let points: Vec<(usize, f64)> = points.collect();
            let least = points.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
            let most = points.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
            let end = |end: &(usize, f64)| (self.legend[end.0].label.clone(), end.1);
            let (least, most) = (end(least), end(most));
            Some(say(&panel.heading, (&least.0, least.1), (&most.0, most.1)))
        };
        self.panels.iter().filter_map(of).collect::<Vec<_>>().join(" ")
    }

    fn figure(self, (kind, title): (&str, &str), says: String, how: &str) -> Figure {
        let Self { panels, legend, .. } = self;
        Figure { kind: kind.into(), title: title.into(), says, how: how.into(), legend, panels }
    }
}

/// What a configuration is called among those of its panel.
fn label(name: &dyn Fn(&Configuration<'_>) -> String, told: &Told<'_>, places: &[&Told<'_>]) -> String {
    let one = &told.configuration;
    let name = name(one);
    if places.iter().all(|other| other.configuration.processors == one.processors) {
        return name;
    }
    format!("{name}, P = {}", one.processors)
}

/// What is told, by machine, scene and question, in the order of the rows.
fn places<'a, 'b>(told: &'b [Told<'a>], view: &impl Fn(&str) -> String) -> Vec<Vec<&'b Told<'a>>> {
    let mut keys: Vec<(&str, &str, String)> = Vec::new();
    let mut places: Vec<Vec<&'b Told<'a>>> = Vec::new();
    for one in told {
        let Configuration { machine, scene, settings, .. } = one.configuration;
        let key = (machine, scene, view(settings));
        match keys.iter().position(|known| *known == key) {
            Some(place) => places[place].push(one),
            None => {
                keys.push(key);
                places.push(vec![one]);
            }
        }
    }
    places
}

/// A panel over the frames of a configuration's scene.
fn panel(
    configuration: &Configuration<'_>,
    view: &impl Fn(&str) -> String,
    pair: usize,
    (axis, unit): (&str, &str),
    series: Vec<Series>,
) -> Panel {
    let frames = || series.iter().flat_map(|series| &series.points).filter_map(|point| point.x);
    let (low, high) = (frames().fold(f64::INFINITY, f64::min), frames().fold(0.0, f64::max));
    let room = 0.02 * (high - low).max(1.0);
    let x = Axis {
        name: "frame".into(),
        unit: String::new(),
        scale: Scale::Even,
        low: low - room,
        high: high + room,
    };
    let y = Axis { name: axis.into(), unit: unit.into(), scale: Scale::Even, low: 0.0, high: 1.0 };
    let Configuration { machine: place, scene, settings, .. } = configuration;
    let view = view(settings);
    let words = [(*scene).to_owned(), view.clone(), machine(place)];
    let heading = words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(", ");
    Panel {
        heading,
        place: String::new(),
        file: format!("{place}-{scene}-{}", view.replace([' ', '='], "-")),
        machine: (*place).to_owned(),
        group: None,
        pair,
        note: String::new(),
        body: Body::Plot(Plot { x, y, series }),
    }
}
