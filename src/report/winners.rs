//! Which scheme wins where: one line a choice of common settings, one column a count of processors.

use super::group::Group;
use super::text::blocks;
use crate::record::settings_pairs;
use std::collections::BTreeSet;

/// The most columns: of more counts of processors, so many are shown, spread over all.
const COLUMNS: usize = 5;

/// The plane of winners; none where there is but one choice of settings, or nothing to choose between.
///
/// A cell names the fastest scheme and by how much it beats the next, one processor being a candidate
/// everywhere: its speedup is 1.
pub(crate) fn winners(groups: &[Group]) -> Option<String> {
    let schemes: BTreeSet<&str> = groups
        .iter()
        .flat_map(|group| group.curves.iter().map(|curve| curve.scheme.as_str()))
        .filter(|scheme| *scheme != "serial")
        .collect();
    let choices: BTreeSet<&str> = groups.iter().map(|group| group.settings.as_str()).collect();
    if choices.len() < 2 || schemes.len() < 2 {
        return None;
    }
    let counts: BTreeSet<u32> = groups.iter().flat_map(Group::parallel_counts).collect();
    let counts = spread(&counts.into_iter().collect::<Vec<_>>());
    let mut columns = vec![vec!["winner, by how much".to_owned()]];
    columns[0].extend(groups.iter().map(|group| place(group, groups)));
    for &count in &counts {
        let winners = groups.iter().map(|group| {
            let win = win(group, count);
            win.map_or("-".to_owned(), |win| format!("{} +{:.0} %", win.scheme, 100.0 * win.margin()))
        });
        columns.push(std::iter::once(format!("P = {count}")).chain(winners).collect());
    }
    Some(blocks(&columns).join("\n"))
}

/// At most [`COLUMNS`] of the counts, first and last among them.
fn spread(counts: &[u32]) -> Vec<u32> {
    if counts.len() <= COLUMNS {
        return counts.to_vec();
    }
    (0..COLUMNS).map(|i| counts[i * (counts.len() - 1) / (COLUMNS - 1)]).collect()
}

/// What tells a group from the others: machine and scene where they differ, and the settings that do.
fn place(group: &Group, groups: &[Group]) -> String {
    let mut words = Vec::new();
    if groups.iter().any(|other| other.machine != group.machine) {
        words.push(group.machine.clone());
    }
    if groups.iter().any(|other| other.scene != group.scene) {
        words.push(group.scene.clone());
    }
    let differs = |pair: &(&str, &str)| {
        groups.iter().any(|other| settings_pairs(&other.settings).all(|theirs| theirs != *pair))
    };
    let settings = settings_pairs(&group.settings).filter(differs);
    words.extend(settings.map(|(key, value)| {
        let bare = key.split_once('.').map_or(key, |(_, bare)| bare);
        format!("{bare}={value}")
    }));
    words.join(" ")
}

/// Who is fastest at a count of processors, and by how much.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Win {
    pub(crate) scheme: String,
    pub(crate) speedup: f64,
    /// The next best, and its speedup.
    pub(crate) next: (String, f64),
}

impl Win {
    /// By how much it beats the next: 0.1 is a tenth faster.
    pub(crate) fn margin(&self) -> f64 {
        self.speedup / self.next.1 - 1.0
    }
}

/// The winner of a group at a count of processors; none where nobody ran on so many.
pub(crate) fn win(group: &Group, count: u32) -> Option<Win> {
    let mut ranked = vec![("serial".to_owned(), 1.0)];
    for best in group.best().iter().filter(|best| best.scheme != "serial") {
        if let Some((curve, point)) = best.at(group, count) {
            ranked.push((curve.scheme.clone(), point.median));
        }
    }
    ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
    let [(scheme, speedup), next, ..] = &ranked[..] else { return None };
    Some(Win { scheme: scheme.clone(), speedup: *speedup, next: next.clone() })
}

#[cfg(test)]
mod tests {
    use super::super::group::groups;
    use super::winners;
    use crate::record::Row;

    fn row(scheme: &str, work: &str, processors: u32, speedup: f64) -> Row {
        Row {
            run: "r".into(),
            experiment: "e".into(),
            job: "tree".into(),
            scene: "s".into(),
            structure: "skip_tree".into(),
            scheme: scheme.into(),
            settings: format!("job.nodes=9;job.work_ns={work}"),
            machine: "e4000".into(),
            processors,
            repeat: 0,
            frame: None,
            metric: "speedup".into(),
            unit: "x".into(),
            value: speedup,
        }
    }

    #[test]
    fn the_fastest_wins_by_its_margin_and_one_processor_may() {
        let rows = [
            row("hybrid", "1-2", 2, 0.5),
            row("lock_free", "1-2", 2, 0.8),
            row("hybrid", "3-4", 2, 1.2),
            row("lock_free", "3-4", 2, 1.8),
        ];
        let text = winners(&groups(&rows, "speedup")).unwrap();
        assert!(text.contains("work_ns=1-2") && text.contains("serial +25 %"), "{text}");
        assert!(text.contains("lock_free +50 %") && !text.contains("nodes"), "{text}");
        assert!(winners(&groups(&rows[..2], "speedup")).is_none(), "one choice of settings is no plane");
    }
}
