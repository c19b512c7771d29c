//! Speedup of tests over a baseline's: where every test is serial, this is what they are compared by.

use super::words::{bare, machine, number};
use super::{Axis, Body, Entry, Figure, Material, Panel, Plot, Point, Scale, Series, Style};
use crate::record::{PaperFigure, settings_pairs};
use crate::report::choices::Choices;
use crate::report::marker::Look;

const METRIC: &str = "speedup_over_baseline";

pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let has = |choices: &&Choices| choices.columns.iter().any(|metric| metric.name == METRIC);
    let all: Vec<&Choices> = material.choices.iter().filter(has).collect();
    let mut labels: Vec<&str> = Vec::new();
    let mut places: Vec<(&str, &str)> = Vec::new();
    for choices in &all {
        labels.extend(choices.lines.iter().map(|line| line.label.as_str()));
        places.push((&choices.machine, &choices.scene));
    }
    let labels = once_each(labels);
    let panels = once_each(places).into_iter().enumerate().map(|(pair, place)| {
        let here: Vec<&Choices> =
            all.iter().copied().filter(|choices| (&*choices.machine, &*choices.scene) == place).collect();
        panel(place, &here, &labels, &material.run.question.paper, pair)
    });
    let panels: Vec<Panel> = panels.collect();
    let paper = panels.iter().any(|panel| matches!(&panel.body, Body::Plot(plot) if plot.series.iter().any(|series| series.style == Style::Paper)));
    let entry =
        |(number, label): (usize, &&str)| Entry { label: (*label).to_owned(), look: Look::nth(number) };
    vec![Figure {
        kind: "baseline".into(),
        title: "Speedup of each test over the baseline's".into(),
        says: panels.iter().filter_map(|panel| says(panel, &labels)).collect::<Vec<_>>().join(" "),
        how: format!(
            "Time of the baseline's test over the test's own, frames taken in turn; one stands at 1.{}",
            if paper { " Hollow marks are the paper's." } else { "" }
        ),
        legend: labels.iter().enumerate().map(entry).collect(),
        panels,
    }]
}

fn once_each<T: PartialEq>(all: Vec<T>) -> Vec<T> {
    let mut once = Vec::new();
    for one in all {
        if !once.contains(&one) {
            once.push(one);
        }
    }
    once
}

fn panel(
    (place, scene): (&str, &str),
    views: &[&Choices],
    labels: &[&str],
    figures: &[PaperFigure],
    pair: usize,
) -> Panel {
    let mut series: Vec<Series> = Vec::new();
    // Side by side about their place, for many are as fast as one another.
    let beside = |entry: usize| 0.7 * ((entry as f64 + 0.5) / labels.len() as f64 - 0.5);
    for (entry, label) in labels.iter().enumerate() {
        let (mut ours, mut papers) = (Vec::new(), Vec::new());
        for (place, choices) in views.iter().enumerate() {
            let x = place as f64 + beside(entry);
            let Some(column) = choices.columns.iter().position(|metric| metric.name == METRIC) else {
                continue;
            };
            for line in choices.lines.iter().filter(|line| line.label == *label) {
                if let Some(value) = line.values[column] {
                    let note = choices.view.clone();
                    let (y, low, high) = (value.median, value.low, value.high);
                    ours.push(Point { x: Some(x), y, low, high, note });
                }
                let fits = |figure: &&PaperFigure| {
                    figure.metric == METRIC
                        && figure.value.is_finite()
                        && figure.scene.as_ref().is_none_or(|other| other == scene)
                        && settings_pairs(&figure.settings)
                            .all(|pair| settings_pairs(&line.settings).any(|own| own == pair))
                };
                papers.extend(figures.iter().filter(fits).map(|figure| Point {
                    note: format!("{}, {}", figure.figure, figure.source),
                    ..Point::bare(x, figure.value)
                }));
            }
        }
        for (style, points) in [(Style::Scatter, ours), (Style::Paper, papers)] {
            if !points.is_empty() {
                series.push(Series { style, entry: Some(entry), points });
            }
        }
    }
    let most = series.iter().flat_map(|series| &series.points).map(|point| point.high).fold(1.0, f64::max);
    // One setting of the scene is named by the axis, several each by themselves.
    let pairs: Vec<_> = views.iter().map(|choices| choices.view.split_once('=')).collect();
    let one = pairs.iter().all(|pair| pair.is_some_and(|(_, value)| !value.contains('=')));
    let (axis, names) = match pairs.first().copied().flatten().filter(|_| one) {
        Some((key, _)) => {
            (setting(key), pairs.iter().flatten().map(|(_, value)| (*value).to_owned()).collect())
        }
        None => ("scene".to_owned(), views.iter().map(|choices| choices.view.clone()).collect()),
    };
    let names = Scale::Names(names);
    let last = views.len() as f64 - 0.5;
    let x = Axis { name: axis, unit: String::new(), scale: names, low: -0.5, high: last };
    let name = "speedup over baseline".to_owned();
    let y = Axis { name, unit: "x".into(), scale: Scale::Even, low: 0.0, high: most * 1.05 };
    Panel {
        heading: format!("{}, {scene}", machine(place)),
        place: format!("{scene} on {place}"),
        file: format!("{place}-{scene}"),
        machine: place.to_owned(),
        group: None,
        pair,
        note: String::new(),
        body: Body::Plot(Plot { x, y, series }),
    }
}

/// A setting of the scene in words.
fn setting(key: &str) -> String {
    match bare(key) {
        "path" => "camera path".to_owned(),
        key => key.replace('_', " "),
    }
}

/// Who is fastest, place by place.
fn says(panel: &Panel, labels: &[&str]) -> Option<String> {
    let Body::Plot(plot) = &panel.body else { return None };
    let Scale::Names(views) = &plot.x.scale else { return None };
    let ours = || plot.series.iter().filter(|series| series.style == Style::Scatter);
    let best = views.iter().enumerate().filter_map(|(x, view)| {
        let here = ours().flat_map(|series| series.points.iter().map(move |point| (series.entry, point)));
        let here = here.filter(|(_, point)| point.x.is_some_and(|at| at.round() == x as f64));
        let (entry, point) = here.max_by(|a, b| a.1.y.total_cmp(&b.1.y))?;
        let on = if view.is_empty() { String::new() } else { format!(" on {view}") };
        Some(format!("{} {}{on}", labels[entry?], number(point.y)))
    });
    Some(format!("{}: fastest are {}.", panel.heading, best.collect::<Vec<_>>().join(", ")))
}
