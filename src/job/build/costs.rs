//! What building and refitting cost on a simulated machine: the measured times of this very code, scaled.

use crate::machine::simulated::Model;
use crate::structure::bvh::build::Effort;
use crate::structure::bvh::refit::Refitted;

// Times in nanoseconds on one core of an AMD EPYC (Zen 3, 2.45 GHz nominal), of meshes of 69,451 and 298,116 triangles:
// processor time a phase over what it did, medians of 3 to 21, while other work went on beside. What phases do of
// one kind only was read off as it is; bins and nodes make up what is left of whole builds, to 10 % of either mesh's.
const LOADED_NS: f64 = 6.8;
const BINNED_NS: f64 = 5.5;
const BIN_NS: f64 = 9.0;
const FEW_NS: f64 = 25.0;
const MOVED_NS: f64 = 4.5;
const NODE_NS: f64 = 7.0;
const GRIDDED_NS: f64 = 8.8;
const LOCATED_NS: f64 = 11.0;
const CELL_NS: f64 = 14.8;
// Of the same meshes with one triangle a leaf and with many, boxes made of three corners looked up: least processor time of
// 25 rounds, the mean of both meshes.
const REFITTED_NODE_NS: f64 = 7.0;
const REFITTED_ITEM_NS: f64 = 14.0;
const RENEWED_NS: f64 = 9.0;

/// Cycles that building and refitting are charged on a simulated machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Costs {
    cycles_per_measured_ns: f64,
}

impl Costs {
    /// The measured times in cycles of `model`: its `cycles_per_measured_ns` is the one number that stands for all that
    /// is between the two machines, clock and instructions a cycle. Memory is not billed: that many processors
    /// read and move items at once costs none of them more.
    pub fn measured_on(model: &Model) -> Self {
        Self { cycles_per_measured_ns: model.cycles_per_measured_ns }
    }

    /// Cycles of what building did.
    pub fn of_building(&self, effort: &Effort) -> u64 {
        let Effort { loaded, binned, bins, few, moved, nodes, gridded, located, cells } = *effort;
        let times = [
            (loaded, LOADED_NS),
            (binned, BINNED_NS),
            (bins, BIN_NS),
            (few, FEW_NS),
            (moved, MOVED_NS),
            (nodes, NODE_NS),
            (gridded, GRIDDED_NS),
            (located, LOCATED_NS),
            (cells, CELL_NS),
        ];
        self.cycles(times.into_iter().map(|(count, time)| count as f64 * time).sum())
    }

    /// Cycles of what refitting did.
    pub(super) fn of_refitting(&self, refitted: &Refitted) -> u64 {
        self.cycles(refitted.nodes as f64 * REFITTED_NODE_NS + refitted.items as f64 * REFITTED_ITEM_NS)
    }

    /// Cycles of renewing the data of so many items.
    pub(super) fn of_renewing(&self, items: usize) -> u64 {
        self.cycles(items as f64 * RENEWED_NS)
    }

    fn cycles(&self, nanoseconds: f64) -> u64 {
        (nanoseconds * self.cycles_per_measured_ns).round() as u64
    }
}
