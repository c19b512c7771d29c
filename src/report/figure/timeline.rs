//! What each processor did, from a run's `timeline.json` (Trace Event format).

use super::words::{and, number};
use super::{Bars, Body, Entry, Figure, Material, Panel, Span};
use crate::report::marker::Look;
use serde::Deserialize;
use std::collections::BTreeMap;

/// What a processor can be doing, in the order of the legend, each with the number of its colour.
pub(crate) const ACTIVITIES: [(&str, usize); 5] =
    [("working", 4), ("sending", 1), ("waiting", 3), ("idle", 5), ("barrier", 7)];
/// Of more cells than this the first are drawn: a small timeline, not a viewer.
const PANELS: usize = 6;

#[derive(Deserialize)]
struct Trace {
    #[serde(rename = "traceEvents")]
    events: Vec<Event>,
}

#[derive(Deserialize)]
struct Event {
    ph: String,
    name: String,
    #[serde(default)]
    pid: i64,
    #[serde(default)]
    tid: i64,
    #[serde(default)]
    ts: f64,
    #[serde(default)]
    dur: f64,
    args: Option<Arguments>,
}

#[derive(Deserialize)]
struct Arguments {
    name: Option<String>,
}

pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let Some(text) = &material.run.timeline else { return Vec::new() };
    // Reading the run has tried this already; a file that is off is refused there.
    let Ok(trace) = serde_json::from_str::<Trace>(text) else { return Vec::new() };
    let mut names: BTreeMap<i64, String> = BTreeMap::new();
    let mut cells: BTreeMap<i64, Vec<&Event>> = BTreeMap::new();
    for event in &trace.events {
        match (event.ph.as_str(), &event.args) {
            ("M", Some(Arguments { name: Some(name) })) if event.name == "process_name" => {
                names.insert(event.pid, name.clone());
            }
            ("X", _) if event.ts.is_finite() && event.dur.is_finite() => {
                cells.entry(event.pid).or_default().push(event);
            }
            _ => {}
        }
    }
    let of = cells.len();
    let panels: Vec<Panel> = cells
        .iter()
        .take(PANELS)
        .enumerate()
        .map(|(number, (pid, events))| {
            let heading = names.get(pid).cloned().unwrap_or_else(|| format!("cell {pid}"));
            panel(number, heading, events)
        })
        .collect();
    let legend = ACTIVITIES
        .iter()
        .map(|(name, colour)| Entry { label: (*name).to_owned(), look: Look::plain(*colour) });
    let shown = if of > PANELS { format!(" The first {PANELS} of {of} cells.") } else { String::new() };
    vec![Figure {
        kind: "timeline".into(),
        title: "What each processor did".into(),
        says: panels.iter().map(says).collect::<Vec<_>>().join(" "),
        how: format!("A line for each processor, time to the right.{shown}"),
        legend: legend.collect(),
        panels,
    }]
}

/// Why a timeline cannot be drawn; none where it can.
pub(crate) fn wrong(text: &str) -> Option<String> {
    serde_json::from_str::<Trace>(text).err().map(|error| error.to_string())
}

fn panel(number: usize, heading: String, events: &[&Event]) -> Panel {
    let first = events.iter().map(|event| event.ts).fold(f64::INFINITY, f64::min);
    let mut lanes: Vec<i64> = events.iter().map(|event| event.tid).collect();
    lanes.sort_unstable();
    lanes.dedup();
    let spans = events.iter().filter_map(|event| {
        Some(Span {
            lane: lanes.binary_search(&event.tid).ok()?,
            activity: ACTIVITIES.iter().position(|(name, _)| *name == event.name)?,
            from: event.ts - first,
            to: event.ts - first + event.dur.max(0.0),
        })
    });
    let spans: Vec<Span> = spans.collect();
    let end = spans.iter().map(|span| span.to).fold(f64::MIN_POSITIVE, f64::max);
    let lanes = lanes.iter().map(|lane| format!("P{lane}")).collect();
    Panel {
        file: format!("cell-{number}"),
        heading,
        place: String::new(),
        machine: String::new(),
        group: None,
        pair: number,
        note: String::new(),
        body: Body::Bars(Bars { lanes, end, spans }),
    }
}

/// The share of each activity in the time of all processors.
pub(crate) fn shares(bars: &Bars) -> [f64; ACTIVITIES.len()] {
    let whole = bars.end * bars.lanes.len() as f64;
    let mut shares = [0.0; ACTIVITIES.len()];
    for span in &bars.spans {
        shares[span.activity] += (span.to - span.from) / whole;
    }
    shares
}

fn says(panel: &Panel) -> String {
    let Body::Bars(bars) = &panel.body else { return String::new() };
    let shares = shares(bars);
    let mut parts: Vec<_> = ACTIVITIES.iter().zip(shares).filter(|(_, share)| *share > 0.0).collect();
    parts.sort_by(|a, b| b.1.total_cmp(&a.1));
    let parts: Vec<String> =
        parts.iter().map(|((name, _), share)| format!("{} % {name}", number(100.0 * share))).collect();
    format!(
        "{}: {} of {} µs on {} processors.",
        panel.heading,
        and(&parts),
        number(bars.end),
        bars.lanes.len()
    )
}
