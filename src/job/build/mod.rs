//! Building and refitting hierarchies by the processors of a machine (Ize ch. 7.5, 7.6.1; I7-03, I7-05).
//!
//! ```
//! use apportion::geometry::Aabb;
//! use apportion::job::build::Crew;
//! use apportion::machine::Threads;
//! use apportion::scheme::tiles::Scheme;
//! use apportion::structure::bvh::BinaryBvh;
//! use apportion::structure::bvh::build::{Input, Settings, phased::{Phased, Way}};
//! use glam::Vec3;
//!
//! let boxes: Vec<Aabb> = (0..1000).map(|i| Vec3::splat(i as f32)).map(|at| Aabb { min: at, max: at + 1.0 }).collect();
//! let machine = Threads::new(2)?;
//! let mut scheme = Scheme::new("fixed_tiles", &machine, 2, Default::default())?;
//! let mut builder = Phased::new(Way::SahSah, &Settings::default())?;
//! let mut bvh = BinaryBvh::default();
//! builder.build(&Input::of(&boxes), &mut bvh, &mut Crew::new(&machine, &mut scheme, 2))?;
//! bvh.validate(&boxes)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod costs;
mod refit;

use crate::machine::{Machine, Processor, RunError};
use crate::scheme::tiles::{Scheme, TileWork};
use crate::structure::bvh::build::phased::Team;
use crate::structure::bvh::build::{BuildError, Effort};
pub use costs::Costs;
pub use refit::{Refit, SUBTREES};
use std::ops::Range;

/// Why there is no hierarchy.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// It cannot be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The machine failed.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// The processors of a machine as a team that builds: the pieces of each phase are shared out by a scheme. On simulated
/// machines each piece is charged what it did, and what is done between phases is charged to one processor.
pub struct Crew<'a, M: Machine> {
    machine: &'a M,
    scheme: &'a mut Scheme<M>,
    processors: usize,
    costs: Costs,
}

impl<'a, M: Machine> Crew<'a, M> {
    /// A team of the processors that a scheme was set up for; nothing is charged.
    pub fn new(machine: &'a M, scheme: &'a mut Scheme<M>, processors: usize) -> Self {
        Self { machine, scheme, processors, costs: Costs::default() }
    }

    /// The same, charged what building costs.
    pub fn charging(self, costs: Costs) -> Self {
        Self { costs, ..self }
    }
}

impl<M: Machine> Team for Crew<'_, M> {
    type Error = JobError;

    fn processors(&self) -> usize {
        self.processors
    }

    fn each(&mut self, pieces: usize, each: impl Fn(usize) -> Effort + Sync) -> Result<(), JobError> {
        // A run is a hand-over and a barrier: not for one piece.
        if pieces < 2 {
            let mut effort = Effort::default();
            (0..pieces).for_each(|piece| effort += each(piece));
            return self.alone(effort);
        }
        self.scheme.run(self.machine, &Phase { pieces, each, costs: self.costs })?;
        Ok(())
    }

    fn alone(&mut self, effort: Effort) -> Result<(), JobError> {
        // Where time goes by itself, it has gone by already.
        if !self.machine.is_native() {
            let cycles = self.costs.of_building(&effort);
            self.machine.alone(|cpu| cpu.charge(cycles))?;
        }
        Ok(())
    }
}

/// The pieces of a phase.
struct Phase<F> {
    pieces: usize,
    each: F,
    costs: Costs,
}

impl<F: Fn(usize) -> Effort + Sync> TileWork for Phase<F> {
    type Found = ();

    fn pieces(&self) -> usize {
        self.pieces
    }

    fn found(&self) {}

    fn work_on<P: Processor>(&self, pieces: Range<usize>, _found: &mut (), cpu: &P) {
        pieces.for_each(|piece| cpu.charge(self.costs.of_building(&(self.each)(piece))));
    }
}

#[cfg(test)]
mod tests;
