//! What a visited node costs on a simulated machine: the measured time of this very code, scaled.

use crate::machine::simulated::Model;

/// Measured times of the culling code in nanoseconds: the least-squares fit of a serial skip-pointer
/// descent's time a frame to its nodes, planes tested and children, over the walk through
/// `factory-large`, `-medium` and `-small`, plane-coherency and octant test on, warm caches, on one core
/// of an AMD EPYC (Zen 3, 2.45 GHz nominal). `apportion machine calibrate` measures them anew.
const NODE_NS: f64 = 16.5;
const PLANE_NS: f64 = 7.8;

/// Cycles that a visit is charged on a simulated machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Costs {
    /// For a node, whatever its test.
    pub node: f64,
    /// For a plane tested (locating an octant counts as one).
    pub plane: f64,
}

impl Costs {
    /// The measured times in cycles of `model`: its `cycles_per_measured_ns` is the one number that
    /// stands for all that is between the two machines, clock and instructions a cycle.
    pub fn measured_on(model: &Model) -> Self {
        let scale = model.cycles_per_measured_ns;
        Costs { node: NODE_NS * scale, plane: PLANE_NS * scale }
    }

    /// Cycles of a visit with so many plane tests.
    pub(super) fn of(&self, tests: u32) -> u64 {
        (self.node + self.plane * f64::from(tests)).round() as u64
    }
}
