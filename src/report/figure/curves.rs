//! Numbers against processors: what speedup, time, balance and sharing have in common.

use super::words::{Legend, choices, chosen, file, full, heading};
use super::{Axis, Body, Material, Panel, Plot, Point, Scale, Series, Style, pair};
use crate::report::group::{Group, groups};

/// Up to so many processors the axis counts evenly, beyond in powers of two.
const EVEN: f64 = 32.0;

/// A panel for each group: a metric of the cells that the speedup curves are made of, so that all charts of a run
/// show the same cells. Values are divided by `scale`.
pub(crate) fn against_processors(
    material: &Material<'_>,
    legend: &Legend,
    metric: &str,
    scale: f64,
    y: &Axis,
) -> Vec<Panel> {
    let metrics =
        if metric == "speedup" { material.groups.clone() } else { groups(&material.run.rows, metric) };
    let mut panels = Vec::new();
    let mut pairs = Vec::new();
    for (place, group) in material.groups.iter().enumerate() {
        let same = |other: &&Group| {
            other.machine == group.machine && other.scene == group.scene && other.settings == group.settings
        };
        let Some(values) = metrics.iter().find(same) else { continue };
        let series = series(group, values, legend, scale);
        if series.is_empty() {
            continue;
        }
        let pair = pair(group);
        let number = pairs.iter().position(|other| *other == pair).unwrap_or_else(|| {
            pairs.push(pair);
            pairs.len() - 1
        });
        let plot = Plot { x: processors(&series), y: y.clone(), series };
        panels.push(Panel {
            heading: heading(group, &material.groups),
            place: full(group),
            file: file(group),
            machine: group.machine.clone(),
            group: Some(place),
            pair: number,
            note: choices(group),
            body: Body::Plot(plot),
        });
    }
    panels
}

fn series(group: &Group, values: &Group, legend: &Legend, scale: f64) -> Vec<Series> {
    let mut all = Vec::new();
    for best in group.best() {
        let mut points = Vec::new();
        for (&count, &number) in &best.choice {
            let curve = &group.curves[number];
            let value =
                values.curve(&curve.scheme, &curve.settings).and_then(|curve| curve.points.get(&count));
            if let Some(value) = value {
                points.push(Point {
                    x: Some(f64::from(count)),
                    y: value.median / scale,
                    low: value.low / scale,
                    high: value.high / scale,
                    note: if best.settings.is_empty() { chosen(curve, group) } else { String::new() },
                });
            }
        }
        if !points.is_empty() {
            all.push(Series { style: Style::Curve, entry: legend.entry(&best), points });
        }
    }
    all
}

fn processors(series: &[Series]) -> Axis {
    let counts = || series.iter().flat_map(|series| &series.points).filter_map(|point| point.x);
    let (low, high) = (counts().fold(f64::INFINITY, f64::min).min(1.0), counts().fold(1.0, f64::max));
    let scale = if high <= EVEN { Scale::Even } else { Scale::Doubling };
    let (low, high) = if scale == Scale::Even { (low - 0.5, high + 0.5) } else { (low / 1.3, high * 1.3) };
    Axis { name: "processors".to_owned(), unit: String::new(), scale, low, high }
}

/// Sets the vertical axes to hold their points, from zero: those of a machine alike where `shared`.
pub(crate) fn fit(panels: &mut [Panel], shared: bool) {
    let highest = |panel: &Panel| {
        let Body::Plot(plot) = &panel.body else { return 0.0 };
        // The ideal would dwarf the rest; it is cut off at the top.
        let series = plot.series.iter().filter(|series| series.style != Style::Ideal);
        series.flat_map(|series| &series.points).map(|point| point.high).fold(0.0, f64::max)
    };
    let each: Vec<(String, f64)> =
        panels.iter().map(|panel| (panel.machine.clone(), highest(panel))).collect();
    for (panel, (machine, own)) in panels.iter_mut().zip(&each) {
        let all = each.iter().filter(|(other, _)| other == machine).map(|(_, high)| *high);
        let high = if shared { all.fold(0.0, f64::max) } else { *own };
        if let Body::Plot(plot) = &mut panel.body {
            plot.y.low = 0.0;
            plot.y.high = if high > 0.0 { high * 1.08 } else { 1.0 };
        }
    }
}

/// The curves of a panel with their number in the legend, highest point first in each.
pub(crate) fn curves(panel: &Panel) -> impl Iterator<Item = (usize, &[Point])> {
    let series = match &panel.body {
        Body::Plot(plot) => &plot.series[..],
        _ => &[],
    };
    let curves =
        series.iter().filter(|series| matches!(series.style, Style::Curve | Style::Scatter | Style::Joined));
    curves.filter_map(|series| Some((series.entry?, &series.points[..])))
}
