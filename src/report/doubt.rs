//! What a run on real threads cannot tell: schemes too near to each other, outliers, speedups that are not sure.

use super::group::{Curve, Group};
use super::text::label;
use crate::record::statistics::{OUTLIER, interval, outliers};
use crate::record::{Row, THREADS};
use std::collections::{BTreeMap, HashMap};

/// Fewer repeats give no 95 % interval of a median.
const FEWEST: usize = 6;
/// More than so many names are counted, not listed.
const MANY: usize = 3;
/// Seed of the bootstrap: fixed, so that a report drawn twice is the same report.
const SEED: u64 = 1;

/// Speedups by cell and repeat: scene, scheme, settings, processors.
type Speedups<'a> = HashMap<(&'a str, &'a str, &'a str, u32), BTreeMap<u32, f64>>;

/// For each group, what its table should be read with: none for a simulated machine, which has no noise.
pub(crate) fn doubts(rows: &[Row], groups: &[Group]) -> Vec<Vec<String>> {
    let mut speedups = Speedups::new();
    for row in rows.iter().filter(|row| row.metric == "speedup" && row.machine == THREADS) {
        let cell = (&*row.scene, &*row.scheme, &*row.settings, row.processors);
        speedups.entry(cell).or_default().insert(row.repeat, row.value);
    }
    let of_group = |group: &Group| {
        if group.machine != THREADS {
            return Vec::new();
        }
        let repeats = |curve: &Curve, processors| {
            speedups.get(&(&*group.scene, &*curve.scheme, &*group.all_settings(curve), processors)).cloned()
        };
        let mut notes: Vec<String> = Vec::new();
        let mut strays = Vec::new();
        let counts: std::collections::BTreeSet<u32> = group.parallel_counts().collect();
        for processors in counts {
            let cells: Vec<(String, BTreeMap<u32, f64>)> = group
                .curves
                .iter()
                .filter(|curve| curve.scheme != "serial")
                .filter_map(|curve| Some((label(curve, &group.curves), repeats(curve, processors)?)))
                .collect();
            // On one processor nothing is shared out.
            notes.extend(too_near(group, processors, &cells).filter(|_| processors > 1));
            strays.extend(cells.iter().filter_map(|(name, repeats)| {
                let values: Vec<f64> = repeats.values().copied().collect();
                let strays = outliers(&values);
                (strays > 0)
                    .then(|| (strays, format!("{name} at P={processors} {strays} of {}", values.len())))
            }));
        }
        notes.extend(outlying(strays));
        notes.extend(lost(rows, group));
        notes
    };
    groups.iter().map(of_group).collect()
}

/// How many repeats are outliers: cell by cell where they are few.
fn outlying(mut cells: Vec<(usize, String)>) -> Option<String> {
    cells.sort_by_key(|(strays, _)| std::cmp::Reverse(*strays));
    let all: usize = cells.iter().map(|(strays, _)| strays).sum();
    let list = match &cells[..] {
        [] => return None,
        [(_, first), rest @ ..] if rest.len() >= MANY => {
            format!("{all} in {} cells, most in {first}", cells.len())
        }
        few => few.iter().map(|(_, cell)| cell.as_str()).collect::<Vec<_>>().join(", "),
    };
    Some(format!("repeats beyond {OUTLIER} scaled MADs of the median (kept): {list}"))
}

/// Which schemes cannot be told from the best one, by the ratio of their speedups in the same repeat.
fn too_near(group: &Group, processors: u32, cells: &[(String, BTreeMap<u32, f64>)]) -> Option<String> {
    let median = |name: &str| {
        let curve = group.curves.iter().find(|curve| label(curve, &group.curves) == name)?;
        curve.points.get(&processors).map(|point| point.median)
    };
    // Reversed: of equals the last is taken, and it is to be the first of the table.
    let (best, its) =
        cells.iter().rev().max_by(|(a, _), (b, _)| median(a).partial_cmp(&median(b)).expect("finite"))?;
    if cells.len() < 2 {
        return None;
    }
    if its.len() < FEWEST {
        return Some(format!(
            "cannot tell schemes apart at P={processors}: it takes {FEWEST} repeats or more"
        ));
    }
    let holds_one = |theirs: &BTreeMap<u32, f64>| {
        let ratios: Vec<f64> =
            its.iter().filter_map(|(repeat, value)| Some(value / theirs.get(repeat)?)).collect();
        interval(&ratios, SEED).is_none_or(|ratio| ratio.low <= 1.0 && ratio.high >= 1.0)
    };
    let near: Vec<&str> = cells
        .iter()
        .filter(|(name, theirs)| name != best && holds_one(theirs))
        .map(|(name, _)| name.as_str())
        .collect();
    let others = if near.len() > MANY { format!("{} others", near.len()) } else { near.join(", ") };
    (!near.is_empty()).then(|| {
        format!(
            "cannot tell {best} from {others} at P={processors}: the interval of their paired ratio holds 1",
        )
    })
}

/// How much of a core other work took away while the group was measured.
fn lost(rows: &[Row], group: &Group) -> Option<String> {
    let of_group = |row: &&Row| {
        row.metric == "lost_time"
            && row.machine == THREADS
            && row.scene == group.scene
            && super::group::split(&row.settings, &row.machine).0 == group.settings
    };
    let lost: Vec<f64> = rows.iter().filter(of_group).map(|row| row.value).collect();
    // The mean, since it is moments that are lost: of most looks nothing is.
    let mean = lost.iter().sum::<f64>() / lost.len() as f64;
    let most = lost.iter().copied().fold(0.0, f64::max);
    (!lost.is_empty())
        .then(|| format!("other work took {mean:.1} % of a core, {most:.0} % at the worst moment"))
}

/// The measured cells whose speedup's 95 % interval reaches further than `percent` from its median, each with how far.
pub fn loose(rows: &[Row], percent: f64) -> Vec<String> {
    let mut loose = Vec::new();
    for group in super::group::groups(rows, "speedup").iter().filter(|group| group.machine == THREADS) {
        for curve in &group.curves {
            for (processors, point) in &curve.points {
                let spread = 100.0 * point.spread();
                if spread > percent {
                    let name = label(curve, &group.curves);
                    loose.push(format!(
                        "{}, {}: {name} at P={processors} ({spread:.1} %)",
                        group.scene, group.settings
                    ));
                }
            }
        }
    }
    loose
}
