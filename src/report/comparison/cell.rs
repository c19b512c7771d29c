//! The numbers of a cell in one run, and how two runs' numbers are brought onto one scale.

use super::{BLOCKS, CompareError};
use crate::record::statistics::{blocks, median, quantile};
use crate::record::{CellKey, Metric, Row};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Of the frames of a block this share is faster than the number that stands for it.
const QUARTILE: f64 = 0.25;

/// A cell's numbers: for each repeat, in order, by frame; a number of the whole cell has no frame.
pub(super) struct Taken {
    pub(super) key: CellKey,
    values: BTreeMap<u32, BTreeMap<Option<u32>, f64>>,
}

impl Taken {
    pub(super) fn repeats(&self) -> usize {
        self.values.len()
    }

    /// Whether the two have a frame in common, without which there is nothing to compare.
    pub(super) fn shares_frames(&self, other: &Taken) -> bool {
        let (ours, theirs) = (self.by_frame(), other.by_frame());
        ours.keys().any(|frame| theirs.contains_key(frame))
    }

    /// The median of all numbers.
    pub(super) fn median(&self) -> f64 {
        median(&self.all()).expect("a cell is made of its numbers")
    }

    /// The mean of all numbers: right where nothing disturbs.
    pub(super) fn mean(&self) -> f64 {
        let all = self.all();
        all.iter().sum::<f64>() / all.len() as f64
    }

    fn all(&self) -> Vec<f64> {
        self.values.values().flat_map(|frames| frames.values().copied()).collect()
    }

    /// The logarithms of each frame's numbers, over the repeats.
    fn by_frame(&self) -> HashMap<Option<u32>, Vec<f64>> {
        let mut by_frame: HashMap<_, Vec<f64>> = HashMap::new();
        for (&frame, &value) in self.values.values().flatten() {
            by_frame.entry(frame).or_default().push(value.ln());
        }
        by_frame
    }
}

/// The finished cells of a run that have this metric, in the order of the rows.
pub(super) fn gather(
    rows: &[Row],
    by: &'static Metric,
    run: &'static str,
) -> Result<Vec<Taken>, CompareError> {
    let finished: HashSet<CellKey> =
        rows.iter().filter(|row| row.metric == "cell_complete").map(Row::key).collect();
    let mut places: HashMap<CellKey, usize> = HashMap::new();
    let mut cells: Vec<Taken> = Vec::new();
    for row in rows.iter().filter(|row| row.metric == by.name) {
        let mut key = row.key();
        if !finished.contains(&key) {
            continue;
        }
        if !(row.value.is_finite() && row.value > 0.0) {
            let cell = format!("{} {} on {} x {}", row.scene, row.scheme, row.machine, row.processors);
            return Err(CompareError::NotPositive { run, metric: by.name, cell, value: row.value });
        }
        (key.experiment, key.repeat) = (String::new(), 0);
        let place = *places.entry(key).or_insert_with_key(|key| {
            cells.push(Taken { key: key.clone(), values: BTreeMap::new() });
            cells.len() - 1
        });
        cells[place].values.entry(row.repeat).or_default().insert(row.frame, row.value);
    }
    Ok(cells)
}

/// The levels of the blocks of the first `repeats` of each run: logarithms, relative to what is usual in both runs.
pub(super) fn levels(a: &Taken, b: &Taken, repeats: [usize; 2]) -> [Vec<f64>; 2] {
    let (of_a, of_b) = (a.by_frame(), b.by_frame());
    // Half from each run, so that exchanging the two turns the sign of the result and changes nothing else.
    let usual: HashMap<_, f64> = of_a
        .iter()
        .filter_map(|(frame, a)| Some((*frame, f64::midpoint(median(a)?, median(of_b.get(frame)?)?))))
        .collect();
    let level = |block: &[&BTreeMap<Option<u32>, f64>]| {
        let relative = |(frame, value): (&Option<u32>, &f64)| Some(value.ln() - usual.get(frame)?);
        let relative: Vec<f64> = block.iter().copied().flatten().filter_map(relative).collect();
        let of_frames = usual.keys().any(Option::is_some);
        quantile(&relative, if of_frames { QUARTILE } else { 0.5 })
    };
    let levels = |cell: &Taken, repeats| {
        let used: Vec<_> = cell.values.values().take(repeats).collect();
        blocks(&used, BLOCKS).filter_map(level).collect()
    };
    [levels(a, repeats[0]), levels(b, repeats[1])]
}
