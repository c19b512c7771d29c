//! What the tiles of a picture cost: measured once by tracing them, then charged on simulated machines, however many
//! processors they have, without tracing again.

use std::ops::Range;

use crate::machine::simulated::Model;
use crate::machine::{Machine, Processor, RunError};
use crate::scheme::tiles::TileWork;

use super::{Counts, Frame};

/// Nanoseconds that each tile of a picture took where it was measured, and cycles where it is charged.
#[derive(Clone, Debug, PartialEq)]
pub struct TileCosts {
    nanoseconds: Vec<f64>,
    cycles_per_nanosecond: f64,
}

impl TileCosts {
    /// Times in nanoseconds, one for each tile, to be charged on a machine of so many cycles for each of them.
    pub fn new(nanoseconds: Vec<f64>, cycles_per_nanosecond: f64) -> Self {
        Self { nanoseconds, cycles_per_nanosecond }
    }

    /// Traces each tile `rounds` times, at least once, on one processor of a machine whose clock is real, and keeps the
    /// least time: what disturbs a tile makes it slower. The rounds go through the whole picture, so that no disturbance
    /// takes all times of one tile. Also tells what rays the picture took.
    ///
    /// # Errors
    /// [`RunError`].
    pub fn measure<M: Machine>(
        machine: &M,
        frame: &Frame<'_, M>,
        rounds: u32,
    ) -> Result<(Self, Counts), RunError> {
        machine.alone(|_| {
            let mut least = vec![u64::MAX; frame.pieces()];
            let mut counts = Counts::default();
            for _ in 0..rounds.max(1) {
                counts = Counts::default();
                for (tile, least) in least.iter_mut().enumerate() {
                    let before = machine.now();
                    frame.trace(tile, &mut counts);
                    *least = (*least).min(machine.now() - before);
                }
            }
            let scale = 1.0 / machine.ticks_per_nanosecond();
            (Self::new(least.into_iter().map(|ticks| ticks as f64 * scale).collect(), 1.0), counts)
        })
    }

    /// The same, charged on a simulated machine: its `cycles_per_measured_ns` is the one number that stands for all that
    /// is between the two.
    pub fn on(self, model: &Model) -> Self {
        Self { cycles_per_nanosecond: model.cycles_per_measured_ns, ..self }
    }

    /// How many tiles there are.
    pub fn len(&self) -> usize {
        self.nanoseconds.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.nanoseconds.is_empty()
    }

    /// Nanoseconds of each tile.
    pub fn nanoseconds(&self) -> &[f64] {
        &self.nanoseconds
    }

    /// Cycles that a tile is charged.
    pub fn cycles(&self, tile: usize) -> u64 {
        (self.nanoseconds[tile] * self.cycles_per_nanosecond).round() as u64
    }
}

/// A picture traced before: each of its tiles is charged what it cost, and nothing is traced.
#[derive(Clone, Copy)]
pub struct Costed<'a>(pub &'a TileCosts);

impl TileWork for Costed<'_> {
    type Found = ();

    fn pieces(&self) -> usize {
        self.0.len()
    }

    fn found(&self) {}

    fn work_on<P: Processor>(&self, pieces: Range<usize>, _found: &mut (), cpu: &P) {
        pieces.for_each(|tile| cpu.charge(self.0.cycles(tile)));
    }
}
