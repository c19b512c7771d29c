//! What BART asks to be told of an animation (Lext, Assarsson and Möller 2000, Measurement report proposal; P3-10):
//! model, frames, primitives, complexity level, resolution, mode; average and worst frame, deviation, continuity, total,
//! preprocessing; machine; memory of the scene and of the structure over it. A line a configuration, medians over the
//! repeats.

use super::choices::differing;
use super::figure::{bare, number, unit};
use super::listing::{Column, Listing};
use crate::record::statistics::median;
use crate::record::{Row, settings_pairs};
use std::collections::BTreeMap;

/// The job whose rows these are.
pub(crate) const JOB: &str = "animate";

/// Told in columns of their own.
const TOLD: [&str; 2] = ["job.size", "job.mode"];

/// One scheme with its settings on a machine with so many processors, of one scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Configuration<'a> {
    pub(crate) scene: &'a str,
    pub(crate) scheme: &'a str,
    pub(crate) settings: &'a str,
    pub(crate) machine: &'a str,
    pub(crate) processors: u32,
}

impl<'a> Configuration<'a> {
    pub(crate) fn of(row: &'a Row) -> Self {
        Self {
            scene: &row.scene,
            scheme: &row.scheme,
            settings: &row.settings,
            machine: &row.machine,
            processors: row.processors,
        }
    }

    /// A setting, by its key.
    pub(crate) fn setting(&self, key: &str) -> Option<&'a str> {
        settings_pairs(self.settings).find(|(other, _)| *other == key).map(|(_, value)| value)
    }
}

/// The rows of animations.
pub(crate) fn of_animations(rows: &[Row]) -> impl Iterator<Item = &Row> {
    rows.iter().filter(|row| row.job == JOB && row.value.is_finite())
}

/// What tells configurations apart in words: their scheme, and those of their settings that differ. What is the only
/// thing to differ goes without its key.
pub(crate) fn names(rows: &[Row]) -> impl Fn(&Configuration<'_>) -> String {
    let keys: Vec<String> =
        differing(rows).into_iter().filter(|key| !TOLD.contains(key)).map(str::to_owned).collect();
    let one_scheme = rows.iter().all(|row| row.scheme == rows[0].scheme);
    move |configuration| {
        let own = settings_pairs(configuration.settings).filter(|(key, _)| keys.iter().any(|k| k == key));
        let own = own.map(|(key, value)| match keys.len() {
            1 if one_scheme => value.to_owned(),
            _ => format!("{}={value}", bare(key)),
        });
        let scheme = (!one_scheme || keys.is_empty()).then(|| configuration.scheme.to_owned());
        let words = scheme.into_iter().chain(own).collect::<Vec<_>>().join(" ");
        if words.is_empty() { configuration.scheme.to_owned() } else { words }
    }
}

pub(crate) fn listings(rows: &[Row]) -> Vec<Listing> {
    let mut configurations: Vec<Configuration<'_>> = Vec::new();
    let mut values: BTreeMap<(Configuration<'_>, &str), Vec<f64>> = BTreeMap::new();
    for row in of_animations(rows).filter(|row| row.frame.is_none()) {
        let configuration = Configuration::of(row);
        if !configurations.contains(&configuration) {
            configurations.push(configuration);
        }
        values.entry((configuration, &row.metric)).or_default().push(row.value);
    }
    if configurations.is_empty() {
        return Vec::new();
    }
    let value =
        |configuration: &Configuration<'_>, metric: &str| median(values.get(&(*configuration, metric))?);
    let name = names(rows);
    let words = |heading: &str, cell: &dyn Fn(&Configuration<'_>) -> String| Column {
        heading: heading.to_owned(),
        cells: configurations.iter().map(cell).collect(),
        is_words: true,
    };
    let numbers = |heading: &str, metric: &str| {
        let all: Vec<Option<f64>> = configurations.iter().map(|one| value(one, metric)).collect();
        column(heading, metric, &all)
    };
    let count = |number: Option<f64>| {
        number.filter(|number| number.is_finite()).map_or("-".to_owned(), |number| format!("{number:.0}"))
    };
    // Their mean is the total over how many there are.
    let frames = |one: &Configuration<'_>| Some(value(one, "total_time")? / value(one, "frame_time_mean")?);
    let columns = vec![
        words("model", &|one| one.scene.to_owned()),
        words("frames", &|one| count(frames(one))),
        words("primitives", &|one| count(value(one, "primitives"))),
        words("complexity level", &|one| level(one.scene).unwrap_or("-").to_owned()),
        words("resolution", &|one| one.setting("job.size").unwrap_or("-").to_owned()),
        words("mode", &|one| one.setting("job.mode").unwrap_or("interactive").to_owned()),
        words("configuration", &|one| name(one)),
        words("machine", &|one| one.machine.to_owned()),
        words("P", &|one| one.processors.to_string()),
        numbers("average", "frame_time_mean"),
        numbers("worst", "frame_time_max"),
        numbers("deviation", "deviation"),
        numbers("continuity", "continuity"),
        numbers("total", "total_time"),
        numbers("preprocessing", "preprocessing_time"),
        numbers("scene", "scene_bytes"),
        numbers("structure", "structure_bytes"),
    ];
    let mut notes = vec!["times, deviation and continuity: medians over the repeats".to_owned()];
    let slow = configurations.iter().any(|one| value(one, "frame_time_mean").is_some_and(|time| time > 1e9));
    if slow {
        // P3-F11.
        notes.push("below a frame a second continuity says little".to_owned());
    }
    vec![Listing { title: "BART's report".to_owned(), columns, asked: 6, notes }]
}

/// Numbers of a metric, in a unit that suits the largest.
fn column(heading: &str, metric: &str, all: &[Option<f64>]) -> Column {
    let most = all.iter().flatten().copied().fold(0.0, f64::max);
    let (scale, unit) = match crate::record::metric(metric).map_or("", |metric| metric.unit) {
        "ns" => unit(most),
        "B" => (1e6, "MB"),
        _ => (1.0, ""),
    };
    let cell = |value: &Option<f64>| value.map_or("-".to_owned(), |value| number(value / scale));
    Column {
        heading: if unit.is_empty() { heading.to_owned() } else { format!("{heading}, {unit}") },
        cells: all.iter().map(cell).collect(),
        is_words: false,
    }
}

/// The complexity level of the one scene that has some: museum 5, as a stand-in or from a file of BART's.
fn level(scene: &str) -> Option<&str> {
    let name = scene.rsplit(['/', '\\']).next()?.split('.').next()?;
    let level = name.strip_prefix("bart-").unwrap_or(name).strip_prefix("museum")?;
    let level = level.strip_prefix('-').unwrap_or(level);
    (!level.is_empty() && level.bytes().all(|byte| byte.is_ascii_digit())).then_some(level)
}

#[cfg(test)]
mod tests {
    use super::level;

    #[test]
    fn only_the_museum_has_levels() {
        let levels = [
            ("bart-museum-5", Some("5")),
            ("museum8", Some("8")),
            ("a/b/museum3.aff", Some("3")),
            ("museum", None),
            ("bart-kitchen-10", None),
            ("museum-of-5", None),
        ];
        for (scene, expected) in levels {
            assert_eq!(level(scene), expected, "{scene}");
        }
    }
}
