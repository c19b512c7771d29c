//! What building and refitting cost on a simulated machine: the measured times of this very code, scaled.

use crate::machine::simulated::Model;
use crate::structure::bvh::build::Effort;
use crate::structure::bvh::refit::Refitted;

/// PLACEHOLDER
const BUILDING_NS: [f64; 9] = [4.0, 10.0, 2.5, 20.0, 5.0, 10.0, 6.0, 4.0, 4.0];
const NODE_NS: f64 = 4.0;
const ITEM_NS: f64 = 6.0;
const RENEWED_NS: f64 = 4.0;

/// Cycles that building and refitting are charged on a simulated machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Costs {
    cycles_per_measured_ns: f64,
}

impl Costs {
    /// The measured times in cycles of `model`: its `cycles_per_measured_ns` is the one number that stands for all that
    /// is between the two machines, clock and instructions a cycle.
    pub fn measured_on(model: &Model) -> Self {
        Self { cycles_per_measured_ns: model.cycles_per_measured_ns }
    }

    /// Cycles of what building did.
    pub fn of_building(&self, effort: &Effort) -> u64 {
        let Effort { loaded, binned, bins, few, moved, nodes, gridded, located, cells } = *effort;
        let counts = [loaded, binned, bins, few, moved, nodes, gridded, located, cells];
        self.cycles(counts.iter().zip(BUILDING_NS).map(|(count, time)| *count as f64 * time).sum())
    }

    /// Cycles of what refitting did.
    pub(super) fn of_refitting(&self, refitted: &Refitted) -> u64 {
        self.cycles(refitted.nodes as f64 * NODE_NS + refitted.items as f64 * ITEM_NS)
    }

    /// Cycles of renewing the data of so many items.
    pub(super) fn of_renewing(&self, items: usize) -> u64 {
        self.cycles(items as f64 * RENEWED_NS)
    }

    fn cycles(&self, nanoseconds: f64) -> u64 {
        (nanoseconds * self.cycles_per_measured_ns).round() as u64
    }
}
