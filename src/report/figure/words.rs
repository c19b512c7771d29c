//! What panels and curves are called.

use super::super::group::{Best, Curve, Group};
use super::super::marker::Look;
use super::{Entry, Panel};
use crate::record::{THREADS, settings_pairs};
use std::collections::BTreeSet;

/// A number as people read it: three digits that count.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    match size {
        0.0 => "0".to_owned(),
        _ if !(1e-4..1e7).contains(&size) => format!("{value:.2e}"),
        _ if size >= 100.0 => format!("{value:.0}"),
        _ if size >= 10.0 => format!("{value:.1}"),
        _ if size >= 0.1 => format!("{value:.2}"),
        _ => format!("{value:.4}"),
    }
}

/// A count, which has no digits behind the point.
pub(crate) fn count(value: Option<f64>) -> String {
    format!("{:.0}", value.unwrap_or(1.0))
}

/// The key without its owner.
pub(crate) fn bare(key: &str) -> &str {
    key.split_once('.').map_or(key, |(_, bare)| bare)
}

/// A machine with what it is: `e4000, simulated`.
pub(crate) fn machine(name: &str) -> String {
    format!("{name}, {}", if name == THREADS { "measured" } else { "simulated" })
}

/// What tells a group from the others: its machine, and the scene and settings that differ.
pub(crate) fn heading(group: &Group, groups: &[Group]) -> String {
    let mut words = vec![machine(&group.machine)];
    if groups.iter().any(|other| other.scene != group.scene) {
        words.push(group.scene.clone());
    }
    let differs = |pair: &(&str, &str)| {
        groups.iter().any(|other| settings_pairs(&other.settings).all(|theirs| theirs != *pair))
    };
    // A setting of one machine alone differs from all others' and tells nothing.
    let own = |key: &str| key.split('.').next() == Some(group.machine.as_str());
    let settings = settings_pairs(&group.settings).filter(|pair| differs(pair) && !own(pair.0));
    words.extend(settings.map(|(key, value)| format!("{}={value}", bare(key))));
    words.join(", ")
}

/// A group in full, for where it stands alone.
pub(crate) fn full(group: &Group) -> String {
    let settings = settings_pairs(&group.settings).map(|(key, value)| format!(", {}={value}", bare(key)));
    format!("{} on {}{}", group.scene, machine(&group.machine), settings.collect::<String>())
}

/// Machine, scene and settings, with what is awkward in a file's name left out.
pub(crate) fn file(group: &Group) -> String {
    let mut name = format!("{}-{}", group.machine, group.scene);
    for (key, value) in settings_pairs(&group.settings) {
        name.push_str(&format!("-{key}-{value}"));
    }
    name.retain(|letter| letter.is_alphanumeric() || "-_.".contains(letter));
    name
}

/// The legend of all groups: a line for each scheme, or for each setting of the only one.
pub(crate) struct Legend {
    pub(crate) entries: Vec<Entry>,
    /// Scheme and settings of each entry.
    keys: Vec<(String, String)>,
}

impl Legend {
    pub(crate) fn new(groups: &[Group]) -> Self {
        let mut legend = Self { entries: Vec::new(), keys: Vec::new() };
        for best in groups.iter().flat_map(Group::best) {
            let key = (best.scheme.clone(), best.settings.clone());
            if legend.keys.contains(&key) {
                continue;
            }
            let variant = legend.keys.iter().filter(|(scheme, _)| *scheme == best.scheme).count();
            let label = label(&best, groups);
            legend.entries.push(Entry { label, look: Look::of(&best.scheme, variant) });
            legend.keys.push(key);
        }
        legend
    }

    /// The line of a curve.
    pub(crate) fn entry(&self, best: &Best) -> Option<usize> {
        self.keys.iter().position(|(scheme, settings)| *scheme == best.scheme && *settings == best.settings)
    }

    /// The first line of a scheme.
    pub(crate) fn scheme(&self, name: &str) -> Option<usize> {
        self.keys.iter().position(|(scheme, _)| scheme == name)
    }
}

/// The scheme, with the settings that tell its curves apart, or the names of those whose best is drawn.
fn label(best: &Best, groups: &[Group]) -> String {
    let keys = differing(&best.scheme, groups);
    if keys.is_empty() {
        return best.scheme.clone();
    }
    if best.settings.is_empty() {
        let bare: Vec<&str> = keys.iter().map(|key| bare(key)).collect();
        return format!("{}, best {}", best.scheme, bare.join(" and "));
    }
    let settings = settings_pairs(&best.settings).filter(|(key, _)| keys.contains(*key));
    let settings = settings.map(|(key, value)| format!(" {}={value}", bare(key)));
    std::iter::once(best.scheme.clone()).chain(settings).collect()
}

/// The settings in which curves of a scheme differ, in any group.
fn differing(scheme: &str, groups: &[Group]) -> BTreeSet<String> {
    let mut keys = BTreeSet::new();
    for group in groups {
        let curves: Vec<&Curve> = group.curves.iter().filter(|curve| curve.scheme == scheme).collect();
        for (curve, pair) in
            curves.iter().flat_map(|curve| settings_pairs(&curve.settings).map(move |pair| (curve, pair)))
        {
            let same = |other: &&Curve| settings_pairs(&other.settings).any(|theirs| theirs == pair);
            if !curves.iter().all(same) && !curve.settings.is_empty() {
                keys.insert(pair.0.to_owned());
            }
        }
    }
    keys
}

/// The setting of a chosen curve, where there was a choice.
pub(crate) fn chosen(curve: &Curve, group: &Group) -> String {
    let keys = differing(&curve.scheme, std::slice::from_ref(group));
    let pairs = settings_pairs(&curve.settings).filter(|(key, _)| keys.contains(*key));
    pairs.map(|(key, value)| format!("{}={value}", bare(key))).collect::<Vec<_>>().join(" ")
}

/// Which setting the best line of each scheme is, from count to count: `lock_free: receivers=1 at 2-3, =4 at 4`.
pub(crate) fn choices(group: &Group) -> String {
    let mut lines = Vec::new();
    for best in group.best().iter().filter(|best| best.settings.is_empty()) {
        let mut runs: Vec<(String, u32, u32)> = Vec::new();
        for &count in best.choice.keys() {
            let Some((curve, _)) = best.at(group, count) else { continue };
            let setting = chosen(curve, group);
            match runs.last_mut() {
                Some((last, _, to)) if *last == setting => *to = count,
                _ => runs.push((setting, count, count)),
            }
        }
        if runs.iter().all(|(setting, ..)| setting.is_empty()) {
            continue;
        }
        let runs = runs.iter().map(|(setting, from, to)| {
            if from == to { format!("{setting} at P = {from}") } else { format!("{setting} at {from}-{to}") }
        });
        lines.push(format!("{}: {}", best.scheme, runs.collect::<Vec<_>>().join(", ")));
    }
    lines.join("; ")
}

/// Words joined as a sentence has them: `a, b and c`.
pub(crate) fn and(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// The machines of panels, each once.
pub(crate) fn machines(panels: &[Panel]) -> Vec<&str> {
    let mut machines = Vec::new();
    for panel in panels {
        if !machines.contains(&panel.machine.as_str()) {
            machines.push(&panel.machine);
        }
    }
    machines
}
