//! Speedup against processors, with the paper's points and the ideal line.

use super::curves::{against_processors, curves, fit};
use super::words::{Legend, and, count, machines, number};
use super::{Axis, Body, Entry, Figure, Material, Panel, Point, Scale, Series, Style};
use crate::record::{PaperFigure, settings_pairs};
use crate::report::group::{Best, Group};
use std::collections::BTreeMap;

/// Up to so many panels of a machine each gets a sentence, beyond they are counted.
const SENTENCES: usize = 3;

pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let legend = Legend::new(&material.groups);
    let y = Axis { name: "speedup".into(), unit: "x".into(), scale: Scale::Even, low: 0.0, high: 1.0 };
    let mut panels = against_processors(material, &legend, "speedup", 1.0, &y);
    for panel in &mut panels {
        let Some(group) = panel.group.map(|place| &material.groups[place]) else { continue };
        let paper = paper(group, &material.run.question.paper, &legend);
        let Body::Plot(plot) = &mut panel.body else { continue };
        plot.series.extend(paper.into_iter().map(|(entry, figure)| Series {
            style: Style::Paper,
            entry: Some(entry),
            points: vec![point(figure, figure.value)],
        }));
    }
    fit(&mut panels, true);
    for panel in &mut panels {
        let Body::Plot(plot) = &mut panel.body else { continue };
        let points = steps(&plot.x, plot.y.high).map(|count| Point::bare(count, count)).collect();
        plot.series.insert(0, Series { style: Style::Ideal, entry: None, points });
    }
    vec![Figure {
        kind: "speedup".into(),
        title: "Speedup against processors".into(),
        says: says(&panels, &legend.entries),
        how: how(&panels),
        legend: legend.entries,
        panels,
    }]
}

/// How lines are to be read, of what is there.
fn how(panels: &[Panel]) -> String {
    let has = |style| {
        panels.iter().any(|panel| match &panel.body {
            Body::Plot(plot) => plot.series.iter().any(|series| series.style == style),
            _ => false,
        })
    };
    let paper = if has(Style::Paper) { " Hollow marks are the paper's." } else { "" };
    format!("Against the serial scheme on one processor; the dashed line is the ideal.{paper}")
}

/// Counts of processors for a line that is straight on no axis but an even one.
pub(crate) fn steps(x: &Axis, most: f64) -> impl Iterator<Item = f64> + use<> {
    let last = x.high.min(most).max(1.0);
    let ratio = last.ln() / 24.0;
    (0..=24).map(move |step| (ratio * f64::from(step)).exp())
}

/// A paper's figure as a point; its peak stands at no count.
pub(crate) fn point(figure: &PaperFigure, y: f64) -> Point {
    let note = format!("{}, {}", figure.figure, figure.source);
    Point { x: figure.processors.map(f64::from), y, low: y, high: y, note }
}

/// The paper's speedups that belong in a group's panel, each with its line of the legend.
pub(crate) fn paper<'a>(
    group: &Group,
    figures: &'a [PaperFigure],
    legend: &Legend,
) -> Vec<(usize, &'a PaperFigure)> {
    let best = group.best();
    let here = figures.iter().filter(|figure| {
        figure.metric == "speedup"
            && figure.value.is_finite()
            && figure.machine == group.machine
            && figure.scene.as_ref().is_none_or(|scene| *scene == group.scene)
    });
    let with_entry = here.filter_map(|figure| {
        let fits = |best: &&Best| {
            let settings = format!("{};{}", group.settings, best.settings);
            best.scheme == figure.scheme
                && settings_pairs(&figure.settings).all(|pair| {
                    pair.0.starts_with(&figure.scheme) || settings_pairs(&settings).any(|own| own == pair)
                })
        };
        Some((legend.entry(best.iter().find(fits)?)?, figure))
    });
    with_entry.collect()
}

/// Who is fastest where.
fn says(panels: &[Panel], legend: &[Entry]) -> String {
    let mut sentences = Vec::new();
    for machine in machines(panels) {
        let own: Vec<&Panel> = panels.iter().filter(|panel| panel.machine == machine).collect();
        if own.len() <= SENTENCES {
            sentences.extend(own.iter().filter_map(|panel| sentence(panel, legend)));
            continue;
        }
        let mut wins: BTreeMap<&str, usize> = BTreeMap::new();
        for panel in &own {
            let best = peaks(panel, legend).into_iter().max_by(|a, b| a.1.y.total_cmp(&b.1.y));
            let winner = best.filter(|(_, peak)| peak.y > 1.0).map_or("one processor", |(label, _)| label);
            *wins.entry(winner).or_default() += 1;
        }
        let mut wins: Vec<_> = wins.into_iter().collect();
        wins.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
        let wins: Vec<String> = wins.iter().map(|(name, count)| format!("{name} in {count}")).collect();
        sentences.push(format!("Fastest in the {} panels of {machine}: {}.", own.len(), and(&wins)));
    }
    sentences.join(" ")
}

/// Each parallel curve's highest point.
fn peaks<'a>(panel: &'a Panel, legend: &'a [Entry]) -> Vec<(&'a str, &'a Point)> {
    let named = curves(panel).map(|(entry, points)| (legend[entry].label.as_str(), points));
    let parallel = named.filter(|(label, _)| *label != "serial");
    parallel
        .filter_map(|(label, points)| {
            // Of equal ones the fewest processors.
            let peak = points.iter().rev().max_by(|a, b| a.y.total_cmp(&b.y))?;
            Some((label, peak))
        })
        .collect()
}

fn sentence(panel: &Panel, legend: &[Entry]) -> Option<String> {
    let peaks = peaks(panel, legend);
    let (best, peak) = peaks.iter().max_by(|a, b| a.1.y.total_cmp(&b.1.y))?;
    let (least, low) = peaks.iter().min_by(|a, b| a.1.y.total_cmp(&b.1.y))?;
    let at = |point: &Point| format!("{} at P = {}", number(point.y), count(point.x));
    let mut text = if peak.y > 1.0 {
        format!("{}: {best} is fastest, {}", panel.heading, at(peak))
    } else {
        format!("{}: nothing beats one processor; {best} comes nearest, {}", panel.heading, at(peak))
    };
    if least != best {
        text.push_str(&format!("; {least} gains least, {}", at(low)));
    }
    Some(text + ".")
}
