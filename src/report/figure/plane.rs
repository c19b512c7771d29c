//! Which scheme wins where: a plane over two of the settings, a panel for each choice of the others.

use super::words::{bare, machine, number};
use super::{Body, Cell, Entry, Field, Figure, Material, Panel};
use crate::record::settings_pairs;
use crate::report::group::Group;
use crate::report::marker::Look;
use crate::report::winners::{Win, win};
use std::collections::{BTreeMap, BTreeSet};

/// The name of the axis of processors, beside the names of settings.
const PROCESSORS: &str = "processors";

/// A group at a count of processors: a place among the settings, and who wins there.
struct Spot {
    machine: String,
    /// Values by the name of what varies; processors and scene are among them.
    at: BTreeMap<String, String>,
    win: Win,
}

pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let choices: BTreeSet<&str> = material.groups.iter().map(|group| group.settings.as_str()).collect();
    let schemes: BTreeSet<&str> =
        material.groups.iter().flat_map(|group| &group.curves).map(|curve| curve.scheme.as_str()).collect();
    // Between one parallel scheme and one processor, or for one choice, the curves say it all.
    if choices.len() < 2 || schemes.iter().filter(|scheme| **scheme != "serial").count() < 2 {
        return Vec::new();
    }
    let spots: Vec<Spot> = material.groups.iter().flat_map(spots).collect();
    let Some((line, column)) = axes(&spots) else { return Vec::new() };
    let mut entries: Vec<Entry> = Vec::new();
    let mut panels: Vec<((String, String), Vec<&Spot>)> = Vec::new();
    for spot in &spots {
        let rest = spot
            .at
            .iter()
            .filter(|(key, _)| **key != line && **key != column && values(&spots, key).len() > 1);
        let rest = rest.map(|(key, value)| format!("{}={value}", short(key))).collect::<Vec<_>>().join(", ");
        let key = (spot.machine.clone(), rest);
        match panels.iter_mut().find(|(other, _)| *other == key) {
            Some((_, spots)) => spots.push(spot),
            None => panels.push((key, vec![spot])),
        }
    }
    let panels = panels.iter().enumerate().map(|(number, ((place, rest), own))| {
        let heading = if rest.is_empty() { machine(place) } else { format!("{}, {rest}", machine(place)) };
        Panel {
            file: heading.replace([',', ' '], "").replace('=', "-"),
            heading,
            place: String::new(),
            machine: place.clone(),
            group: None,
            pair: number,
            note: String::new(),
            body: Body::Field(field(&spots, own, (&line, &column), &mut entries)),
        }
    });
    let panels = panels.collect();
    vec![Figure {
        kind: "plane".into(),
        title: "Which scheme wins where".into(),
        says: says(&spots),
        how: "Colour and mark name the fastest scheme, the number by how much it beats the next; one processor \
              competes everywhere."
            .into(),
        legend: entries,
        panels,
    }]
}

fn short(key: &str) -> &str {
    if key == PROCESSORS { "P" } else { bare(key) }
}

fn spots(group: &Group) -> Vec<Spot> {
    let counts: BTreeSet<u32> = group.parallel_counts().filter(|count| *count > 1).collect();
    let spot = |&count: &u32| {
        let settings = settings_pairs(&group.settings).map(|(key, value)| (key.to_owned(), value.to_owned()));
        let mut at: BTreeMap<String, String> = settings.collect();
        at.insert("scene".into(), group.scene.clone());
        at.insert(PROCESSORS.into(), count.to_string());
        Some(Spot { machine: group.machine.clone(), at, win: win(group, count)? })
    };
    counts.iter().filter_map(spot).collect()
}

/// The values a key takes, in the order of the rows; counts of processors by their size.
fn values(spots: &[Spot], key: &str) -> Vec<String> {
    let mut values: Vec<String> = Vec::new();
    for value in spots.iter().filter_map(|spot| spot.at.get(key)) {
        if !values.contains(value) {
            values.push(value.clone());
        }
    }
    // Numbers, and ranges of them by their start, are sorted; words keep the order in which they were asked.
    let size = |value: &String| value.split('-').next().and_then(|start| start.parse::<f64>().ok());
    if values.iter().all(|value| size(value).is_some()) {
        values.sort_by(|a, b| size(a).partial_cmp(&size(b)).unwrap_or(std::cmp::Ordering::Equal));
    }
    values
}

/// The two settings with the most values, or one and the processors; settings of the job are the lines.
fn axes(spots: &[Spot]) -> Option<(String, String)> {
    let keys: BTreeSet<&String> = spots.iter().flat_map(|spot| spot.at.keys()).collect();
    let mut varying: Vec<(bool, usize, &String)> = keys
        .into_iter()
        .map(|key| (key == PROCESSORS, values(spots, key).len(), key))
        .filter(|&(_, count, _)| count > 1)
        .collect();
    varying.sort_by_key(|&(processors, count, _)| (processors, std::cmp::Reverse(count)));
    let [(.., line), (.., column), ..] = varying[..] else { return None };
    // Processors run along, and so does what is the machine's.
    let swap = line.starts_with("machine") && column != PROCESSORS;
    let (line, column) = if swap { (column, line) } else { (line, column) };
    Some((line.clone(), column.clone()))
}

fn field(all: &[Spot], own: &[&Spot], (line, column): (&str, &str), entries: &mut Vec<Entry>) -> Field {
    let (lines, columns) = (values(all, line), values(all, column));
    let mut cells = Vec::new();
    for spot in own {
        let place = |values: &[String], key: &str| {
            spot.at.get(key).and_then(|value| values.iter().position(|other| other == value))
        };
        let (Some(line), Some(column)) = (place(&lines, line), place(&columns, column)) else { continue };
        let win = &spot.win;
        let entry = entries.iter().position(|entry| entry.label == win.scheme).unwrap_or_else(|| {
            entries.push(Entry { label: win.scheme.clone(), look: Look::of(&win.scheme, 0) });
            entries.len() - 1
        });
        let margin = 100.0 * win.margin();
        let text = if margin.is_finite() { format!("+{}", percent(margin)) } else { "alone".to_owned() };
        let (next, speedup) = (&win.next.0, number(win.next.1));
        let note = format!("{} {} x; next {next} {speedup} x", win.scheme, number(win.speedup));
        cells.push(Cell { column, line, entry, text, note });
    }
    Field { columns: (short(column).to_owned(), columns), lines: (short(line).to_owned(), lines), cells }
}

/// A margin; of a narrow one a digit more.
fn percent(margin: f64) -> String {
    if margin < 1.0 { format!("{margin:.1} %") } else { format!("{margin:.0} %") }
}

fn says(spots: &[Spot]) -> String {
    let mut wins: BTreeMap<&str, (usize, f64)> = BTreeMap::new();
    for spot in spots {
        let (count, margin) = wins.entry(&spot.win.scheme).or_default();
        *count += 1;
        *margin = f64::max(*margin, spot.win.margin());
    }
    let mut wins: Vec<_> = wins.into_iter().collect();
    wins.sort_by_key(|(_, (count, _))| std::cmp::Reverse(*count));
    let words = wins.iter().map(|(scheme, (count, margin))| {
        let by = if margin.is_finite() {
            format!(" (by up to {})", percent(100.0 * margin))
        } else {
            String::new()
        };
        format!("{scheme} in {count}{by}")
    });
    format!("Of {} places: {}.", spots.len(), super::words::and(&words.collect::<Vec<_>>()))
}
