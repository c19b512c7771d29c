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
    for row in rows.iter().filter(|row| row.metric == metric && row.frame.is_none()) {
        let (settings, own) = split(&row.settings, &row.machine);
        let is_group = |group: &Group| {
            group.machine == row.machine && group.scene == row.scene && group.settings == settings
        };
        let group = groups.iter().position(is_group).unwrap_or_else(|| {
            let (machine, scene) = (row.machine.clone(), row.scene.clone());
            groups.push(Group { machine, scene, settings, curves: Vec::new() });
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
        let point = interval(&values, SEED).expect("an entry has a value");
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

    /// A curve a scheme, of its best point at each count of processors ("best topology per point", Paper II sec. 4.2).
    /// Where there is but one parallel scheme its settings are the question, so that each keeps its curve.
    pub(crate) fn best_curves(&self) -> Vec<Curve> {
        let parallel = || self.curves.iter().filter(|curve| curve.scheme != "serial");
        if parallel().all(|curve| Some(&curve.scheme) == parallel().next().map(|first| &first.scheme)) {
            return self.curves.clone();
        }
        let mut best: Vec<Curve> = Vec::new();
        for curve in &self.curves {
            let Some(other) = best.iter_mut().find(|other| other.scheme == curve.scheme) else {
                best.push(Curve { settings: String::new(), ..curve.clone() });
                continue;
            };
            for (&processors, &point) in &curve.points {
                let place = other.points.entry(processors).or_insert(point);
                if point.median > place.median {
                    *place = point;
                }
            }
        }
        best
    }
}
