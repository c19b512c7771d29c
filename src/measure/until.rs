//! When a run has been repeated often enough.

use crate::record::CellKey;
use crate::record::statistics::interval;
use std::collections::HashMap;
use std::time::{Duration, Instant};

/// Fewer repeats give no 95 % interval of a median: all of five lie on one side of it in 1 of 16 cases.
pub(super) const FEWEST: u32 = 6;
/// Seed of the bootstrap: fixed, so that the same rows are always tight or always not.
const SEED: u64 = 1;

/// How sure a run has to become, and how long it may take over that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Until {
    /// No end of a speedup's 95 % interval may be further from its median than this, per cent of the median.
    pub percent: f64,
    /// After so long no repeat beyond those asked for is begun or gone on with.
    pub at_most: Duration,
}

/// The speedups seen so far, against what was asked for.
pub(super) struct Tightness {
    until: Option<Until>,
    start: Instant,
    speedups: HashMap<CellKey, Vec<f64>>,
}

impl Tightness {
    #[expect(clippy::disallowed_methods, reason = "how long the user waits is told by the real clock")]
    pub(super) fn new(until: Option<Until>) -> Self {
        Self { until, start: Instant::now(), speedups: HashMap::new() }
    }

    /// Takes note of a measured cell's speedup in one more repeat.
    pub(super) fn add(&mut self, key: &CellKey, speedup: f64) {
        let key = CellKey { repeat: 0, ..key.clone() };
        self.speedups.entry(key).or_default().push(speedup);
    }

    /// Whether one more repeat was asked for and is still needed.
    pub(super) fn wants_more(&self) -> bool {
        let Some(until) = self.until else { return false };
        let is_loose = |speedups: &Vec<f64>| {
            interval(speedups, SEED).is_some_and(|interval| 100.0 * interval.spread() > until.percent)
        };
        !self.is_late() && self.speedups.values().any(is_loose)
    }

    /// Whether the time is up.
    pub(super) fn is_late(&self) -> bool {
        self.until.is_some_and(|until| self.start.elapsed() >= until.at_most)
    }
}
