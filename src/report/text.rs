//! The table as text: the paper's figures, then speedups by processors.

use super::choices::Choices;
use super::group::{Curve, Group};
use super::listing::Listing;
use super::table::{Line, Table};
use super::winners::winners;
use crate::record::statistics::Interval;
use crate::record::{THREADS, settings_pairs};
use std::collections::BTreeSet;

/// Lines are no wider than this, in letters: tables go on in another block, notes on another line.
const WIDTH: usize = 80;

pub(crate) fn text(table: &Table) -> String {
    let figures: Vec<&Line> = table.lines.iter().filter(|line| line.figure.is_some()).collect();
    let mut parts = Vec::new();
    if !figures.is_empty() {
        parts.push(figure_text(&figures));
    }
    let no_doubt = Vec::new();
    for (index, group) in table.groups.iter().enumerate() {
        let doubts = table.doubts.get(index).unwrap_or(&no_doubt);
        let notes: String = doubts.iter().map(|doubt| wrap(doubt, 2)).collect();
        parts.push(group_text(group) + &notes);
    }
    parts.extend(winners(&table.groups));
    parts.extend(table.choices.iter().map(Choices::text));
    parts.extend(table.listings.iter().map(Listing::text));
    if parts.is_empty() { "no rows to show".to_owned() } else { parts.join("\n") }
}

fn figure_text(lines: &[&Line]) -> String {
    let number = |number: Option<f64>| number.map_or("-".to_owned(), |number| format!("{number:.2}"));
    let error = |error: Option<f64>| error.map_or("-".to_owned(), |error| format!("{:+.0} %", 100.0 * error));
    let metric = |line: &Line| match line.unit.as_str() {
        "x" => line.metric.clone(),
        unit => format!("{}, {unit}", line.metric),
    };
    let processors = |line: &Line| match (line.processors, &line.peak_of) {
        (Some(processors), _) => processors.to_string(),
        (None, None) => "peak".to_owned(),
        (None, Some(counts)) => format!("peak of {counts}"),
    };
    type Word<'a> = &'a dyn Fn(&Line) -> String;
    let keys: [(&str, Word<'_>); 6] = [
        ("figure", &|line| line.figure.clone().unwrap_or_default()),
        ("scheme", &|line| line.scheme.clone()),
        ("scene", &|line| line.scene.clone()),
        ("machine", &|line| line.machine.clone()),
        ("metric", &metric),
        ("P", &processors),
    ];
    // Where all lines are of one of these, it is said once, above them.
    let is_common = |(name, word): &(&str, Word<'_>)| {
        ["scene", "machine", "metric"].contains(name) && lines.iter().all(|line| word(line) == word(lines[0]))
    };
    let (common, told): (Vec<_>, Vec<_>) = keys.into_iter().partition(is_common);
    let mut head: Vec<String> = told.iter().map(|(name, _)| (*name).to_owned()).collect();
    let left = head.len() - 1;
    head.extend(["paper", "simulated", "error", "measured", "error"].map(str::to_owned));
    let mut cells = vec![head];
    for line in lines {
        let mut cell: Vec<String> = told.iter().map(|(_, word)| word(line)).collect();
        cell.extend([number(line.paper), number(line.simulated), error(line.error_simulated)]);
        cell.extend([number(line.measured), error(line.error_measured)]);
        cells.push(cell);
    }
    let common: String = common.iter().map(|(name, word)| format!(", {name} {}", word(lines[0]))).collect();
    let mut text = wrap(&format!("paper | simulated | measured{common}"), 2) + &align(&cells, left);
    // None of what was measured: the papers' machines were of another kind.
    let errors: Vec<f64> = lines.iter().filter_map(|line| line.error_simulated).map(f64::abs).collect();
    if !errors.is_empty() {
        let mean = 100.0 * errors.iter().sum::<f64>() / errors.len() as f64;
        text.push_str(&format!("mean absolute error of {} figures, simulated: {mean:.1} %\n", errors.len()));
    }
    if lines.iter().any(|line| line.peak_of.is_some()) {
        text.push_str("a peak over fewer processors than the experiment's is not held against the paper's\n");
    }
    text
}

fn group_text(group: &Group) -> String {
    let counts: BTreeSet<u32> = group.curves.iter().flat_map(|curve| curve.points.keys().copied()).collect();
    let intervals = group.machine == THREADS;
    let mut columns = vec![vec!["processors".to_owned()]];
    columns[0].extend(group.curves.iter().map(|curve| label(curve, &group.curves)));
    for count in &counts {
        let cell =
            |curve: &Curve| curve.points.get(count).map_or(String::new(), |point| speedup(point, intervals));
        columns.push(std::iter::once(count.to_string()).chain(group.curves.iter().map(cell)).collect());
    }
    let settings = if group.settings.is_empty() { String::new() } else { format!(", {}", group.settings) };
    let note = if intervals { ": median [95 % interval]" } else { "" };
    let title = wrap(&format!("speedup on {}, {}{settings}{note}", group.machine, group.scene), 2);
    title + &blocks(&columns).join("\n")
}

/// Columns as tables no wider than a screen; the first column begins each.
pub(crate) fn blocks(columns: &[Vec<String>]) -> Vec<String> {
    let width = |column: &Vec<String>| column.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
    let (first, others) = columns.split_first().expect("there is a column of names");
    let mut blocks: Vec<Vec<&Vec<String>>> = Vec::new();
    let mut used = WIDTH + 1;
    for column in others {
        used += 2 + width(column);
        if used > WIDTH {
            blocks.push(vec![first]);
            used = width(first) + 2 + width(column);
        }
        blocks.last_mut().expect("one was begun").push(column);
    }
    let lines = |block: &Vec<&Vec<String>>| -> Vec<Vec<String>> {
        (0..first.len()).map(|line| block.iter().map(|column| column[line].clone()).collect()).collect()
    };
    blocks.iter().map(|block| align(&lines(block), 1)).collect()
}

/// The text in lines of at most 80 letters, broken at blanks and behind semicolons; all lines but the first begin
/// with so many blanks.
pub fn wrap(text: &str, indent: usize) -> String {
    let mut wrapped = String::new();
    let mut used = 0;
    for word in text.split_inclusive([' ', ';']) {
        let length = word.trim_end().chars().count();
        if used > 0 && used + length > WIDTH {
            wrapped.truncate(wrapped.trim_end().len());
            wrapped.push('\n');
            wrapped.push_str(&" ".repeat(indent));
            used = indent;
        }
        wrapped.push_str(word);
        used += word.chars().count();
    }
    wrapped.push('\n');
    wrapped
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
