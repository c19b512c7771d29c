//! Time against processors, with the paper's points and the ideal line.

use super::curves::{against_processors, curves, fit};
use super::speedup::{paper, point, steps};
use super::words::{Legend, count, machines, number};
use super::{Axis, Body, Figure, Material, Panel, Point, Scale, Series, Style};
use crate::report::group::groups;

/// The metric: the whole path's time, which has the rare slow frame in it too.
const METRIC: &str = "total_time";

pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let legend = Legend::new(&material.groups);
    let (scale, unit) = unit(slowest_of_quickest(material));
    let y = Axis {
        name: "time of all frames".into(),
        unit: unit.into(),
        scale: Scale::Even,
        low: 0.0,
        high: 1.0,
    };
    let mut panels = against_processors(material, &legend, METRIC, scale, &y);
    let mut paper_points = false;
    for panel in &mut panels {
        let serial = serial(panel, &legend);
        let group = panel.group.map(|place| &material.groups[place]);
        let (Some(serial), Some(group), Body::Plot(plot)) = (serial, group, &mut panel.body) else {
            continue;
        };
        for (entry, figure) in paper(group, &material.run.question.paper, &legend) {
            if figure.value > 0.0 {
                let points = vec![point(figure, serial / figure.value)];
                plot.series.push(Series { style: Style::Paper, entry: Some(entry), points });
                paper_points = true;
            }
        }
        let ideal = steps(&plot.x, plot.x.high).map(|count| Point::bare(count, serial / count)).collect();
        plot.series.insert(0, Series { style: Style::Ideal, entry: None, points: ideal });
    }
    fit(&mut panels, false);
    let hollow =
        "Hollow marks are our serial time over the paper's speedup: the paper printed no times we hold.";
    vec![Figure {
        kind: "time".into(),
        title: "Time against processors".into(),
        says: says(&panels, &legend, unit),
        how: format!(
            "The sum of the frame times, from zero; the dashed line is the serial time over P.{}",
            if paper_points { format!(" {hollow}") } else { String::new() }
        ),
        legend: legend.entries,
        panels,
    }]
}

/// The slowest time of the quickest panel, ns: its unit fits all.
fn slowest_of_quickest(material: &Material<'_>) -> f64 {
    let highest = |group: &crate::report::group::Group| {
        let points = group.curves.iter().flat_map(|curve| curve.points.values());
        points.map(|point| point.median).fold(0.0, f64::max)
    };
    groups(&material.run.rows, METRIC).iter().map(highest).fold(f64::INFINITY, f64::min)
}

/// Nanoseconds in the unit that suits a time, and its name.
pub(crate) fn unit(ns: f64) -> (f64, &'static str) {
    match ns {
        _ if ns >= 1e9 => (1e9, "s"),
        _ if ns >= 1e6 => (1e6, "ms"),
        _ if ns >= 1e3 => (1e3, "µs"),
        _ => (1.0, "ns"),
    }
}

fn serial(panel: &Panel, legend: &Legend) -> Option<f64> {
    let serial = legend.scheme("serial")?;
    let (_, points) = curves(panel).find(|(entry, _)| *entry == serial)?;
    points.iter().find(|point| point.x == Some(1.0)).map(|point| point.y)
}

/// The shortest of each machine: those of a machine of 1999 are not held against those of another.
fn says(panels: &[Panel], legend: &Legend, unit: &str) -> String {
    let of_machine = |machine: &str| {
        let own: Vec<&Panel> = panels.iter().filter(|panel| panel.machine == machine).collect();
        let all = own.iter().flat_map(|panel| {
            curves(panel)
                .flat_map(move |(entry, points)| points.iter().map(move |point| (*panel, entry, point)))
        });
        let (panel, entry, point) = all.min_by(|a, b| a.2.y.total_cmp(&b.2.y))?;
        let serial = serial(panel, legend).map(|serial| format!("; serial takes {}", number(serial)));
        let place = if own.len() == 1 { super::words::machine(machine) } else { panel.heading.clone() };
        let (label, count) = (&legend.entries[entry].label, count(point.x));
        let serial = serial.filter(|_| *label != "serial").unwrap_or_default();
        Some(format!("{place}: shortest is {} {unit}, {label} at P = {count}{serial}.", number(point.y)))
    };
    machines(panels).into_iter().filter_map(of_machine).collect::<Vec<_>>().join(" ")
}
