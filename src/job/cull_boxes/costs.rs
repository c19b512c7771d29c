//! What a block of boxes costs on a simulated machine: the measured time of this very code, scaled.

use crate::machine::simulated::Model;
use crate::structure::Looked;

/// Times of a block of 64 boxes in nanoseconds, by kernel, 4,096 boxes in cache, on one core of an AMD EPYC (Zen 3,
/// 2.45 GHz nominal): the least of 41 rounds of `benches/rivals`. The machine was busy with other work, so they are
/// divided by how much longer bevy's test took in that run than in a quiet one (17.3 ns a box against 6.6).
const BLOCK_NS: &[(&str, f64)] = &[("avx2", 33.0), ("sse2", 67.0), ("scalar", 316.0), ("plain", 708.0)];
/// Time of the test of one group: a sixty-fourth of a plain block, and as much again for the call.
const GROUP_NS: f64 = 22.0;

/// Cycles that looking at boxes is charged on a simulated machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Costs {
    block: f64,
    group: f64,
}

impl Costs {
    /// The kernels whose time has been measured.
    pub fn kernels() -> impl Iterator<Item = &'static str> {
        BLOCK_NS.iter().map(|(name, _)| *name)
    }

    /// The measured times in cycles of `model`, as in [`cull::Costs`](crate::job::cull::Costs); `None` for a kernel
    /// that has not been measured.
    pub fn measured_on(model: &Model, kernel: &str) -> Option<Self> {
        let (_, block) = BLOCK_NS.iter().find(|(name, _)| *name == kernel)?;
        let scale = model.cycles_per_measured_ns;
        Some(Costs { block: block * scale, group: GROUP_NS * scale })
    }

    /// Cycles of a block.
    pub(super) fn block(&self) -> u64 {
        self.block.round() as u64
    }

    /// Cycles of what a descent looked at. A block of bounds is a block of boxes, asked for both sides: all
    /// that is done for one is done twice, but for the loads.
    pub(super) fn of(&self, looked: Looked) -> u64 {
        match looked {
            Looked::Group(_) => self.group.round() as u64,
            Looked::Bounds(_) => 2 * self.block(),
            Looked::Block(_) => self.block(),
        }
    }
}
