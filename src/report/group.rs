//! Rows gathered into curves: speed against processors.

use crate::record::statistics::{Interval, interval};
use crate::record::{Row, settings_pairs};
use std::collections::BTreeMap;

/// Seed of the bootstrap: fixed, so that a report drawn twice is the same report.
const SEED: u64 = 1;
/// Owners of settings that concern all schemes, so that cells which differ in one stand in different groups.
const COMMON: [&str; 5] = ["job", "scene", "structure", "machine", "scheme"];

/// All curves that may be compared: one machine, one scene, one choice of common settings.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub(crate) machine: String,
    pub(crate) scene: String,
    /// The common settings, `key=value;key=value`.
    pub(crate) settings: String,
    pub(crate) curves: Vec<Curve>,
    /// The most repeats of a cell.
    pub(crate) repeats: usize,
}

/// One scheme with its own settings.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    pub(crate) scheme: String,
    /// The scheme's own settings, `key=value;key=value`.
    pub(crate) settings: String,
    /// Processors to the median over the repeats.
    pub(crate) points: BTreeMap<u32, Interval>,
}

/// Gathers the rows of a metric of whole cells; groups and curves come in the order of the rows.
pub(crate) fn groups(rows: &[Row], metric: &str) -> Vec<Group> {
    let mut values: BTreeMap<(usize, usize, u32), Vec<f64>> = BTreeMap::new();
    let mut groups: Vec<Group> = Vec::new();
    // No log holds a number that is not finite; rows made by hand may.
    let fits = |row: &&Row| row.metric == metric && row.frame.is_none() && row.value.is_finite();
    for row in rows.iter().filter(fits) {
        let (settings, own) = split(&row.settings, &row.machine);
        let is_group = |group: &Group| {
            group.machine == row.machine && group.scene == row.scene && group.settings == settings
        };
        let group = groups.iter().position(is_group).unwrap_or_else(|| {
            let (machine, scene) = (row.machine.clone(), row.scene.clone());
            groups.push(Group { machine, scene, settings, curves: Vec::new(), repeats: 0 });
            groups.len() - 1
        });
        let curves = &mut groups[group].curves;
        let is_curve = |curve: &Curve| curve.scheme == row.scheme && curve.settings == own;
        let curve = curves.iter().position(is_curve).unwrap_or_else(|| {
            curves.push(Curve { scheme: row.scheme.clone(), settings: own, points: BTreeMap::new() });
            curves.len() - 1
        });
        values.entry((group, curve, row.processors)).or_default().push(row.value);
    }
    for ((group, curve, processors), values) in values {
        // Draws from equal numbers give that number: most cells of a simulated machine ran once.
        let point = if values.iter().all(|value| *value == values[0]) {
            Interval { median: values[0], low: values[0], high: values[0] }
        } else {
            interval(&values, SEED).expect("an entry has a value")
        };
        groups[group].repeats = groups[group].repeats.max(values.len());
        groups[group].curves[curve].points.insert(processors, point);
    }
    groups
}

/// The settings that concern all schemes of the machine, and those of the scheme alone.
pub(crate) fn split(settings: &str, machine: &str) -> (String, String) {
    let (common, own): (Vec<_>, Vec<_>) = settings_pairs(settings).partition(|(key, _)| {
        let owner = key.split('.').next().unwrap_or_default();
        owner == machine || COMMON.contains(&owner)
    });
    (join(&common), join(&own))
}

fn join(pairs: &[(&str, &str)]) -> String {
    let pairs: Vec<String> = pairs.iter().map(|(key, value)| format!("{key}={value}")).collect();
    pairs.join(";")
}

impl Group {
    /// Common and own settings together, sorted as rows have them.
    pub(crate) fn all_settings(&self, curve: &Curve) -> String {
        let mut pairs: Vec<_> =
            settings_pairs(&self.settings).chain(settings_pairs(&curve.settings)).collect();
        pairs.sort_unstable();
        join(&pairs)
    }

    /// The common settings without the machine's own, by which cells of two machines are matched.
    pub(crate) fn portable_settings(&self) -> String {
        let portable = |(key, _): &(&str, &str)| {
            let owner = key.split('.').next().unwrap_or_default();
            owner != self.machine && owner != "machine"
        };
        join(&settings_pairs(&self.settings).filter(portable).collect::<Vec<_>>())
    }

    /// The counts of processors that schemes other than the serial one ran on.
    pub(crate) fn parallel_counts(&self) -> impl Iterator<Item = u32> {
        let parallel = self.curves.iter().filter(|curve| curve.scheme != "serial");
        parallel.flat_map(|curve| curve.points.keys().copied())
    }

    /// The curve of a scheme with those settings.
    pub(crate) fn curve(&self, scheme: &str, settings: &str) -> Option<&Curve> {
        self.curves.iter().find(|curve| curve.scheme == scheme && curve.settings == settings)
    }

    /// A curve a scheme, of its best point at each count of processors ("best topology per point", Paper II sec. 4.2).
    /// Where there is but one parallel scheme its settings are the question, so that each keeps its curve.
    pub(crate) fn best(&self) -> Vec<Best> {
        let parallel = || self.curves.iter().filter(|curve| curve.scheme != "serial");
        let one_scheme =
            parallel().all(|curve| Some(&curve.scheme) == parallel().next().map(|first| &first.scheme));
        let mut best: Vec<Best> = Vec::new();
        for (number, curve) in self.curves.iter().enumerate() {
            let place = best.iter().position(|best| best.scheme == curve.scheme && !one_scheme);
            let place = place.unwrap_or_else(|| {
                let settings = if one_scheme { curve.settings.clone() } else { String::new() };
                let (scheme, choice) = (curve.scheme.clone(), BTreeMap::new());
                best.push(Best { scheme, settings, choice });
                best.len() - 1
            });
            for (&processors, point) in &curve.points {
                let chosen = best[place].choice.entry(processors).or_insert(number);
                if point.median > self.curves[*chosen].points[&processors].median {
                    *chosen = number;
                }
            }
        }
        best
    }
}

/// A curve as charts show it: at each count of processors the setting that is fastest there.
#[derive(Clone, Debug)]
pub(crate) struct Best {
    pub(crate) scheme: String,
    /// The scheme's own settings where each keeps its curve; empty where the best is taken.
    pub(crate) settings: String,
    /// Processors to the number of the curve chosen.
    pub(crate) choice: BTreeMap<u32, usize>,
}

impl Best {
    /// At that many processors: the curve chosen and its point.
    pub(crate) fn at<'a>(&self, group: &'a Group, processors: u32) -> Option<(&'a Curve, Interval)> {
        let curve = &group.curves[*self.choice.get(&processors)?];
        Some((curve, *curve.points.get(&processors)?))
    }
}
