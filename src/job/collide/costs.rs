//! What a visit costs on a simulated machine: the measured time of this very code, scaled.

use crate::machine::simulated::Model;

/// Cycles that a visit is charged on a simulated machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Costs {
    /// Measured times, in cycles.
    times: Times,
}

/// Measured times of a kind of volume, in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    /// A pair of boxes tested by itself, with its visit.
    pub pair: f64,
    /// A block of eight boxes tested, with its share of the visit.
    pub batch: f64,
    /// A pair of triangles.
    pub triangles: f64,
}

impl Costs {
    /// Measured times in cycles of `model`: its `cycles_per_measured_ns` is the one number that stands for all that
    /// is between the two machines, clock and instructions a cycle.
    pub fn measured_on(model: &Model, times: Times) -> Self {
        let scale = model.cycles_per_measured_ns;
        let Times { pair, batch, triangles } = times;
        Costs { times: Times { pair: pair * scale, batch: batch * scale, triangles: triangles * scale } }
    }

    pub(super) fn pair(&self) -> u64 {
        self.times.pair.round() as u64
    }

    pub(super) fn batch(&self) -> u64 {
        self.times.batch.round() as u64
    }

    pub(super) fn triangles(&self) -> u64 {
        self.times.triangles.round() as u64
    }
}
