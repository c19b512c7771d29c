//! What a frame's time goes into: bringing the structure up to date, finding what rays meet, shading.

use super::{Told, panel, told};
use crate::record::statistics::median;
use crate::report::animation::{Configuration, names, of_animations};
use crate::report::choices::views;
use crate::report::figure::curves::fit;
use crate::report::figure::time::unit;
use crate::report::figure::words::number;
use crate::report::figure::{Entry, Figure, Material, Panel, Point, Series, Style};
use crate::report::marker::Look;

/// The parts, each on top of those before: metric, and what the line up to it is called.
const PARTS: [(&str, &str); 3] = [
    ("rebuild_time", "rebuild"),
    ("visibility_time", "rebuild + visibility"),
    ("shading_time", "rebuild + visibility + shading: all of it"),
];

/// A panel a configuration, of which the parts were measured.
pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let rows = &material.run.rows;
    let (name, view) = (names(rows), views(rows));
    let all = PARTS.map(|(metric, _)| told(rows, metric));
    let tops = all.iter().flat_map(|told| told.iter().flat_map(Told::medians).map(|(_, time)| time));
    let (scale, unit) = unit(tops.fold(0.0, f64::max));
    let mut panels: Vec<Panel> = Vec::new();
    let mut says = Vec::new();
    for told in &all[0] {
        let one = &told.configuration;
        let Some(stack) = stacked(&all, one) else { continue };
        let of = |number: usize| stack.iter().map(|(_, parts)| parts[number]).sum::<f64>();
        let whole = of(0) + of(1) + of(2);
        let line = |part: usize| {
            let point = |(frame, parts): &(u32, [f64; 3])| {
                let y = parts[..=part].iter().sum::<f64>() / scale;
                let note = format!("of it {} {}", number(parts[part] / scale), unit);
                Point { note, ..Point::bare(f64::from(*frame), y) }
            };
            let points = stack.iter().map(point).collect();
            Series { style: Style::Curve, entry: Some(part), points }
        };
        let lines = (0..PARTS.len()).map(line).collect();
        let mut panel = panel(one, &view, panels.len(), ("time", unit), lines);
        panel.heading = format!("{}: {}", panel.heading, name(one));
        let share = |part: usize| number(100.0 * of(part) / whole);
        let clock = clock(material, one).map_or(String::new(), |clock| {
            format!("; reading the clock {} %", number(100.0 * clock * stack.len() as f64 / whole))
        });
        says.push(format!(
            "{}: {} % rebuild, {} % visibility, {} % shading{clock}.",
            panel.heading,
            share(0),
            share(1),
            share(2)
        ));
        panels.push(panel);
    }
    fit(&mut panels, false);
    let entry = |(number, (_, name)): (usize, &(&str, &str))| Entry {
        label: (*name).to_owned(),
        look: Look::nth(number + 1),
    };
    vec![Figure {
        kind: "by-frame-parts".into(),
        title: "What the time of each frame goes into".into(),
        says: says.join(" "),
        how: "Of a pass apart from the one whose frames are timed, on one processor; what reading the clock takes is in it, \
              nothing is subtracted."
            .into(),
        legend: PARTS.iter().enumerate().map(entry).collect(),
        panels,
    }]
}

/// The parts by frame, of frames that have all.
fn stacked(all: &[Vec<Told<'_>>; 3], one: &Configuration<'_>) -> Option<Vec<(u32, [f64; 3])>> {
    let own = |told: &Vec<Told<'_>>| {
        let own = told.iter().find(|told| told.configuration == *one)?;
        Some(own.medians().collect::<std::collections::BTreeMap<u32, f64>>())
    };
    let [rebuild, visibility, shading] = [own(&all[0])?, own(&all[1])?, own(&all[2])?];
    let of = |(frame, rebuild): (&u32, &f64)| {
        Some((*frame, [*rebuild, *visibility.get(frame)?, *shading.get(frame)?]))
    };
    let stack: Vec<_> = rebuild.iter().filter_map(of).collect();
    // Shares are told of it.
    let whole: f64 = stack.iter().flat_map(|(_, parts)| parts).sum();
    (whole > 0.0).then_some(stack)
}

/// What reading the clock takes a frame, ns.
fn clock(material: &Material<'_>, one: &Configuration<'_>) -> Option<f64> {
    let own = of_animations(&material.run.rows)
        .filter(|row| row.metric == "clock_time" && row.frame.is_none() && Configuration::of(row) == *one);
    median(&own.map(|row| row.value).collect::<Vec<_>>())
}
