//! Building and refitting hierarchies by the processors of a machine (Ize ch. 7.5, 7.6.1; I7-03, I7-05).
//!
//! ```
//! use apportion::geometry::Aabb;
//! use apportion::job::build::build;
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
//! build(&mut builder, &Input::of(&boxes), &mut bvh, &machine, &mut scheme, 2)?;
//! bvh.validate(&boxes)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod refit;

use crate::machine::{Machine, RunError};
use crate::scheme::tiles::{Scheme, work};
use crate::structure::bvh::BinaryBvh;
use crate::structure::bvh::build::phased::{Phased, Team};
use crate::structure::bvh::build::{BuildError, Input};
pub use refit::Refit;

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

/// Builds in phases, the pieces of each shared out by a scheme set up for so many processors of the machine.
///
/// # Errors
/// [`JobError`]; what `bvh` holds then is of no use.
pub fn build<M: Machine>(
    builder: &mut Phased,
    input: &Input<'_>,
    bvh: &mut BinaryBvh,
    machine: &M,
    scheme: &mut Scheme<M>,
    processors: usize,
) -> Result<(), JobError> {
    builder.build(input, bvh, &mut Shared { machine, scheme, processors })
}

/// The processors of a machine, and how pieces are shared out among them.
struct Shared<'a, M: Machine> {
    machine: &'a M,
    scheme: &'a mut Scheme<M>,
    processors: usize,
}

impl<M: Machine> Team for Shared<'_, M> {
    type Error = JobError;

    fn processors(&self) -> usize {
        self.processors
    }

    fn each(&mut self, pieces: usize, each: impl Fn(usize) + Sync) -> Result<(), JobError> {
        // A run is a hand-over and a barrier: not for one piece.
        if pieces < 2 {
            (0..pieces).for_each(each);
            return Ok(());
        }
        let job = work(pieces, || (), |range, ()| range.for_each(&each));
        self.scheme.run(self.machine, &job)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests;
