//! Rays of each frame by class: eye, shadow, reflection, refraction.

use super::{Told, panel, places, told};
use crate::report::animation::names;
use crate::report::choices::views;
use crate::report::figure::curves::fit;
use crate::report::figure::words::number;
use crate::report::figure::{Body, Entry, Figure, Material, Point, Series, Style};
use crate::report::marker::Look;
use std::collections::BTreeMap;

/// The classes: metric, name.
const CLASSES: [(&str, &str); 4] = [
    ("rays_eye", "eye"),
    ("rays_shadow", "shadow"),
    ("rays_reflection", "reflection"),
    ("rays_refraction", "refraction"),
];

/// A panel for each machine, scene and question: rays of its first configuration. Those of all that make the same
/// pictures are as many.
pub(crate) fn figures(material: &Material<'_>) -> Vec<Figure> {
    let rows = &material.run.rows;
    let (name, view) = (names(rows), views(rows));
    let all = CLASSES.map(|(metric, _)| told(rows, metric));
    let mut panels = Vec::new();
    let mut says = Vec::new();
    // Every picture has rays from the eye.
    for place in places(&all[0], &view) {
        let Some(first) = place.first() else { continue };
        let mut series = Vec::new();
        let mut words = Vec::new();
        for (class, told) in all.iter().enumerate() {
            let Some(own) = told.iter().find(|told| told.configuration == first.configuration) else {
                continue;
            };
            // A frame without a row of the class has no such rays.
            let rays: BTreeMap<u32, f64> = own.medians().collect();
            let of = |frame: &u32| rays.get(frame).copied().unwrap_or(0.0);
            let points: Vec<Point> =
                first.frames.keys().map(|frame| Point::bare(f64::from(*frame), of(frame))).collect();
            let mean = points.iter().map(|point| point.y).sum::<f64>() / points.len() as f64;
            words.push(format!("{} {}", number(mean), CLASSES[class].1));
            series.push(Series { style: Style::Curve, entry: Some(class), points });
        }
        let same = |other: &&&Told<'_>| {
            let of = |told: &Told<'_>| {
                let one = all.iter().map(|all| {
                    let own = all.iter().find(|other| other.configuration == told.configuration);
                    own.map(|own| own.medians().collect::<Vec<_>>())
                });
                one.collect::<Vec<_>>()
            };
            of(other) == of(first)
        };
        let as_many = place.iter().filter(same).count();
        let mut panel = panel(&first.configuration, &view, panels.len(), ("rays", ""), series);
        let of = name(&first.configuration);
        panel.note = match place.len() {
            1 => String::new(),
            all if as_many == all => format!("As many of all {all} configurations."),
            all => format!("Of {of}; {as_many} of {all} configurations trace as many."),
        };
        says.push(format!("{}: on average {} rays a frame.", panel.heading, words.join(", ")));
        panels.push(panel);
    }
    fit(&mut panels, false);
    let used = |class: usize| {
        panels.iter().any(|panel| matches!(&panel.body, Body::Plot(plot) if plot.series.iter().any(|s| s.entry == Some(class))))
    };
    // Entries keep their numbers: classes that never occur are the last ones of the list, if any is left out at all.
    let most = (0..CLASSES.len()).filter(|class| used(*class)).max().map_or(0, |last| last + 1);
    let entry = |(number, (_, name)): (usize, &(&str, &str))| Entry {
        label: (*name).to_owned(),
        look: Look::nth(number + 1),
    };
    vec![Figure {
        kind: "by-frame-rays".into(),
        title: "Rays of each frame".into(),
        says: says.join(" "),
        how: "By class; a class without a line has no rays in any frame.".into(),
        legend: CLASSES.iter().take(most).enumerate().map(entry).collect(),
        panels,
    }]
}
