//! The table as text: the paper's figures, then speedups by processors.

use super::group::{Curve, Group};
use super::table::{Line, Table};
use crate::record::THREADS;
use crate::record::statistics::Interval;
use std::collections::BTreeSet;

/// Beyond so many columns the intervals are left out: the line would not fit a screen.
const INTERVAL_COLUMNS: usize = 6;

pub(crate) fn text(table: &Table) -> String {
    let figures: Vec<&Line> = table.lines.iter().filter(|line| line.figure.is_some()).collect();
    let mut parts = Vec::new();
    if !figures.is_empty() {
        parts.push(figure_text(&figures));
    }
    parts.extend(table.groups.iter().map(group_text));
    if parts.is_empty() { "no rows to show".to_owned() } else { parts.join("\n") }
}

fn figure_text(lines: &[&Line]) -> String {
    let head = [
        "figure",
        "scheme",
        "scene",
        "machine",
        "P",
        "metric",
        "paper",
        "simulated",
        "error",
        "measured",
        "error",
    ];
    let mut cells = vec![head.map(str::to_owned).to_vec()];
    let number = |number: Option<f64>| number.map_or("-".to_owned(), |number| format!("{number:.2}"));
    let error = |error: Option<f64>| error.map_or("-".to_owned(), |error| format!("{:+.1} %", 100.0 * error));
    for line in lines {
        let metric =
            if line.unit == "x" { line.metric.clone() } else { format!("{}, {}", line.metric, line.unit) };
        cells.push(vec![
            line.figure.clone().unwrap_or_default(),
            line.scheme.clone(),
            line.scene.clone(),
            line.machine.clone(),
            line.processors.map_or("peak".to_owned(), |processors| processors.to_string()),
            metric,
            number(line.paper),
            number(line.simulated),
            error(line.error_simulated),
            number(line.measured),
            error(line.error_measured),
        ]);
    }
    let mut text = format!("paper | simulated | measured\n{}", align(&cells, 6));
    for (word, errors) in [
        ("simulated", lines.iter().filter_map(|line| line.error_simulated).collect::<Vec<f64>>()),
        ("measured", lines.iter().filter_map(|line| line.error_measured).collect()),
    ] {
        if !errors.is_empty() {
            let mean = 100.0 * errors.iter().map(|error| error.abs()).sum::<f64>() / errors.len() as f64;
            text.push_str(&format!("mean absolute error of {} figures, {word}: {mean:.1} %\n", errors.len()));
        }
    }
    text
}

fn group_text(group: &Group) -> String {
    let counts: BTreeSet<u32> = group.curves.iter().flat_map(|curve| curve.points.keys().copied()).collect();
    let intervals = group.machine == THREADS && counts.len() <= INTERVAL_COLUMNS;
    let mut cells = vec![vec!["processors".to_owned()]];
    cells[0].extend(counts.iter().map(u32::to_string));
    for curve in &group.curves {
        let cell = |count| curve.points.get(count).map_or(String::new(), |point| speedup(point, intervals));
        cells.push(std::iter::once(label(curve)).chain(counts.iter().map(cell)).collect());
    }
    let settings = if group.settings.is_empty() { String::new() } else { format!(", {}", group.settings) };
    let note = if intervals { ": median [95 % interval]" } else { "" };
    format!("speedup on {}, {}{settings}{note}\n{}", group.machine, group.scene, align(&cells, 1))
}

fn speedup(point: &Interval, interval: bool) -> String {
    if interval {
        format!("{:.2} [{:.2}, {:.2}]", point.median, point.low, point.high)
    } else {
        format!("{:.2}", point.median)
    }
}

/// The scheme, with its own settings where it has some.
pub(crate) fn label(curve: &Curve) -> String {
    if curve.settings.is_empty() {
        return curve.scheme.clone();
    }
    let settings = curve.settings.replace(&format!("{}.", curve.scheme), "").replace(';', ", ");
    format!("{} {settings}", curve.scheme)
}

/// Columns as wide as their widest cell; the first `left` of them aligned left, the others right.
fn align(cells: &[Vec<String>], left: usize) -> String {
    let width = |column: usize| cells.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for line in cells {
        let padded = line.iter().enumerate().map(|(column, cell)| {
            let width = width(column);
            if column < left { format!("{cell:width$}") } else { format!("{cell:>width$}") }
        });
        text.push_str(padded.collect::<Vec<_>>().join("  ").trim_end());
        text.push('\n');
    }
    text
}
