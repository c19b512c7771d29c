//! Two runs held against each other: for each cell a ratio, how sure it is, and a verdict.
//!
//! Two runs made one after the other are not paired: the computer may have been busier during one of them, and a
//! process keeps the luck of its memory layout as long as it lives. So:
//! 1. A frame's time is held against that frame's usual time in both runs, so that light and heavy frames can be
//!    mixed. Its logarithm is what is compared: ratios then add up, and B against A is A against B turned round.
//! 2. The repeats are cut into at most [`BLOCKS`] blocks of neighbours, each summed up by the lower quartile of its
//!    frames: whatever disturbs a frame makes it slower, and what disturbs neighbours counts once.
//! 3. The ratio is the Hodges-Lehmann shift between the blocks of the two runs, its interval Wilcoxon's, widened
//!    (Bonferroni) so that those of all cells hold at once with 95 %.
//! 4. A verdict needs the whole interval beyond 1 by more than [`FLOOR`]: two runs of the same program differ by
//!    more than their own blocks show.
//!
//! A simulated machine says the same each time: its ratio is exact and needs no floor. What this does not see: a
//! change that only touches the slower three quarters of the frames; ask for `--metric frame_time_p90` then.

mod cell;
mod print;

use crate::record::statistics::{Interval, median, shift};
use crate::record::{Better, CellKey, Metric, Row, THREADS, metric};
use cell::{Taken, gather};
use serde::Serialize;

/// The repeats of a run are cut into no more blocks than this: enough for any confidence, long enough each to
/// hold quiet moments.
pub const BLOCKS: usize = 12;
/// Two runs of the same program differ by up to this much, as a share, for reasons that neither of them shows.
pub const FLOOR: f64 = 0.02;
/// The chance that any interval of a comparison misses.
const RISK: f64 = 0.05;
/// What is exact differs beyond rounding only.
const ROUNDING: f64 = 1e-9;

/// What a comparison says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Verdict {
    /// B is better than A.
    #[serde(rename = "better")]
    Better,
    /// B is worse than A.
    #[serde(rename = "worse")]
    Worse,
    /// The two may be alike.
    #[serde(rename = "cannot tell")]
    CannotTell,
    /// Some cells are better, some worse: of a whole comparison only.
    #[serde(rename = "mixed")]
    Mixed,
}

/// A cell that both runs hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// The cell; its experiment is empty, its repeat 0.
    pub key: CellKey,
    /// The median of A's numbers, in the metric's unit.
    pub a: f64,
    /// The median of B's numbers.
    pub b: f64,
    /// B over A, with an interval that holds for all pairs at once; infinite where there are too few repeats.
    pub ratio: Interval,
    /// What that means.
    pub verdict: Verdict,
}

/// Two runs held against each other by one metric.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// By what.
    pub metric: &'static Metric,
    /// The cells both hold, in the order of A's rows.
    pub pairs: Vec<Pair>,
    /// The geometric mean of the ratios: of the measured cells, or of the simulated ones where there are no others.
    pub ratio: Interval,
    /// What all pairs say together.
    pub verdict: Verdict,
    /// Cells only A holds.
    pub only_a: Vec<CellKey>,
    /// Cells only B holds.
    pub only_b: Vec<CellKey>,
    /// Share of a core other work took during A and during B, per cent; none where nothing was measured.
    pub lost: [Option<f64>; 2],
}

/// Why two runs cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// A ratio needs numbers above 0.
    #[error(
        "run {run}: {metric} of {cell} is {value}: a ratio needs finite numbers above 0; choose another --metric"
    )]
    NotPositive {
        /// "A" or "B".
        run: &'static str,
        /// The metric.
        metric: &'static str,
        /// The cell.
        cell: String,
        /// Its number.
        value: f64,
    },
    /// No cell with this metric is finished in both runs.
    #[error("no finished cell with metric {metric} is in both runs (A has {a}, B has {b})")]
    NothingShared {
        /// The metric.
        metric: &'static str,
        /// How many cells of A have it.
        a: usize,
        /// How many cells of B have it.
        b: usize,
    },
    /// No such metric.
    #[error("there is no metric `{0}`")]
    UnknownMetric(String),
}

/// Compares the finished cells of two runs by a metric, of which `frame_time` is known best.
///
/// # Errors
/// An unknown metric, a number that is not above 0, or no cell that both runs hold.
pub fn compare(a: &[Row], b: &[Row], by: &str) -> Result<Comparison, CompareError> {
    let by = metric(by).ok_or_else(|| CompareError::UnknownMetric(by.to_owned()))?;
    let taken = [gather(a, by, "A")?, gather(b, by, "B")?];
    let (mut shared, mut only_a) = (Vec::new(), Vec::new());
    for cell in &taken[0] {
        match taken[1].iter().find(|other| other.key == cell.key && other.shares_frames(cell)) {
            Some(other) => shared.push((cell, other)),
            None => only_a.push(cell.key.clone()),
        }
    }
    let is_shared = |cell: &Taken| shared.iter().any(|(_, other)| other.key == cell.key);
    let only_b = taken[1].iter().filter(|cell| !is_shared(cell)).map(|cell| cell.key.clone()).collect();
    if shared.is_empty() {
        let [a, b] = taken.each_ref().map(Vec::len);
        return Err(CompareError::NothingShared { metric: by.name, a, b });
    }
    let (ratio, together, pairs) = judge(&shared, by);
    let verdict = overall(&pairs, together);
    let lost = [a, b].map(lost);
    Ok(Comparison { metric: by, pairs, ratio, verdict, only_a, only_b, lost })
}

/// The ratio over all cells with the verdict it gives, and that of each cell.
fn judge(shared: &[(&Taken, &Taken)], by: &Metric) -> (Interval, Verdict, Vec<Pair>) {
    let measured = shared.iter().filter(|(a, _)| a.key.machine == THREADS).count();
    // One more for all of them together; a single cell is all of them.
    let at_once = if measured > 1 { measured + 1 } else { 1 };
    let risk = RISK / at_once as f64;
    // All cells by the same repeats, so that a mean over cells is one of things that happened together.
    let repeats = |run: fn(&(&Taken, &Taken)) -> usize| {
        shared.iter().filter(|pair| pair.0.key.machine == THREADS).map(run).min()
    };
    let repeats =
        [repeats(|pair| pair.0.repeats()).unwrap_or(1), repeats(|pair| pair.1.repeats()).unwrap_or(1)];
    let (mut sums, mut exact) = ([Vec::new(), Vec::new()], Vec::new());
    let mut pairs = Vec::new();
    for (a, b) in shared {
        let (log, verdict) = if a.key.machine == THREADS {
            let levels = cell::levels(a, b, repeats);
            for (sum, level) in sums.iter_mut().zip(&levels) {
                sum.resize(level.len(), 0.0);
                sum.iter_mut().zip(level).for_each(|(sum, level)| *sum += level / measured as f64);
            }
            let log = shift(&levels[0], &levels[1], risk).expect("finite logarithms of at least one repeat");
            (log, verdict(log, FLOOR.ln_1p(), by.better))
        } else {
            let log = b.mean().ln() - a.mean().ln();
            exact.push(log);
            let log = Interval { median: log, low: log, high: log };
            (log, verdict(log, ROUNDING, by.better))
        };
        pairs.push(Pair { key: a.key.clone(), a: a.median(), b: b.median(), ratio: exp(log), verdict });
    }
    let (log, floor) = if measured > 0 {
        (shift(&sums[0], &sums[1], risk).expect("sums of finite numbers"), FLOOR.ln_1p())
    } else {
        let mean = exact.iter().sum::<f64>() / exact.len() as f64;
        (Interval { median: mean, low: mean, high: mean }, ROUNDING)
    };
    (exp(log), verdict(log, floor, by.better), pairs)
}

fn exp(log: Interval) -> Interval {
    Interval { median: log.median.exp(), low: log.low.exp(), high: log.high.exp() }
}

/// What the logarithm of a ratio says, where less than `floor` counts as nothing.
fn verdict(log: Interval, floor: f64, better: Better) -> Verdict {
    match better {
        Better::Lower if log.low > floor => Verdict::Worse,
        Better::Lower if log.high < -floor => Verdict::Better,
        Better::Higher if log.low > floor => Verdict::Better,
        Better::Higher if log.high < -floor => Verdict::Worse,
        _ => Verdict::CannotTell,
    }
}

/// The cells speak first; where none of them can, all together may.
fn overall(pairs: &[Pair], together: Verdict) -> Verdict {
    let any = |verdict| pairs.iter().any(|pair| pair.verdict == verdict);
    match (any(Verdict::Better), any(Verdict::Worse)) {
        (true, true) => Verdict::Mixed,
        (true, false) => Verdict::Better,
        (false, true) => Verdict::Worse,
        (false, false) => together,
    }
}

fn lost(rows: &[Row]) -> Option<f64> {
    let lost: Vec<f64> = rows.iter().filter(|row| row.metric == "lost_time").map(|row| row.value).collect();
    // The mean, since it is moments that are lost: of most looks nothing is.
    median(&lost).map(|_| lost.iter().sum::<f64>() / lost.len() as f64)
}
