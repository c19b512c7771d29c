//! The table as text: the paper's figures, then speedups by processors.

use super::group::{Curve, Group};
use super::table::{Line, Table};
use super::winners::winners;
use crate::record::statistics::Interval;
use crate::record::{THREADS, settings_pairs};
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
    parts.extend(winners(&table.groups));
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
        cells.push(std::iter::once(label(curve, &group.curves)).chain(counts.iter().map(cell)).collect());
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

/// The scheme, with those of its own settings that tell it from other curves of the same scheme.
pub(crate) fn label<'a>(curve: &Curve, all: impl IntoIterator<Item = &'a Curve>) -> String {
    let others: Vec<&Curve> = all.into_iter().filter(|other| other.scheme == curve.scheme).collect();
    let tells = |pair: &(&str, &str)| {
        others.iter().any(|other| settings_pairs(&other.settings).all(|theirs| theirs != *pair))
    };
    let settings = settings_pairs(&curve.settings).filter(tells);
    let bare = settings.map(|(key, value)| {
        let key = key.split_once('.').map_or(key, |(_, bare)| bare);
        format!(" {key}={value}")
    });
    std::iter::once(curve.scheme.clone()).chain(bare).collect()
}

/// Columns as wide as their widest cell; the first `left` of them aligned left, the others right.
pub(crate) fn align(cells: &[Vec<String>], left: usize) -> String {
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

#[cfg(test)]
mod tests {
    use super::{Curve, label};

    #[test]
    fn a_label_tells_what_differs_and_no_more() {
        let curve = |scheme: &str, settings: &str| Curve {
            scheme: scheme.to_owned(),
            settings: settings.to_owned(),
            points: Default::default(),
        };
        let all = [
            curve("lock_free", "lock_free.layout=1999;lock_free.receivers=1"),
            curve("lock_free", "lock_free.layout=1999;lock_free.receivers=4"),
            curve("hybrid", "hybrid.threshold=6"),
        ];
        let labels = all.each_ref().map(|curve| label(curve, &all));
        assert_eq!(labels, ["lock_free receivers=1", "lock_free receivers=4", "hybrid"]);
    }
}
