//! Sharing out independent pieces: blocks of boxes, tiles of a picture, ranges of an array.
//!
//! Pieces are numbered from 0 and cost nobody knows what. Each is worked on exactly once, by whichever
//! processor gets it. Pieces are handed out in ranges, that is, tiles. All that the processors share in most schemes is
//! one counter, drawn from with a fetch-and-add, so that these can run wherever there is one.
//!
//! Many frames can be gone through in one run, with a barrier between each two of them and not an end of the run
//! (Parker et al. 1999, sec. 2.1): [`Scheme::run_frames`]. Setting of every scheme: `barrier` (`fetch_op`, `tree`,
//! `system`; see [`BarrierKind`]).
//!
//! ```
//! use apportion::machine::Threads;
//! use apportion::scheme::tiles::{share, work};
//!
//! // Your own pieces: sum up a hundred numbers, ten to a piece.
//! let job = work(10, || 0, |pieces, sum: &mut usize| *sum += (10 * pieces.start..10 * pieces.end).sum::<usize>());
//! let shares = share("fixed_tiles", &Threads::new(2)?, 2, &job)?;
//! assert_eq!(shares.iter().map(|share| share.found).sum::<usize>(), 4950);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod decreasing_tiles;
mod fixed_tiles;
mod interleaved;
mod per_pixel_queue;
mod rayon_iter;
mod serial;
mod static_blocks;
mod work;
mod work_stealing;

pub use super::{About, Share, ShareError};
use super::{SettingError, Settings};
use crate::machine::{Layout, Machine, RunError};
use crate::sync::{Barrier, BarrierKind};
use std::collections::BTreeMap;
use work::Frames;
pub use work::{TileWork, work};

/// The most pieces a tile may be asked to have.
const MOST_PIECES: usize = 1 << 30;

/// Declares the schemes: the list is the table of contents. Each file holds a type of one name, with
/// `SUMMARY`, `NATIVE_ONLY`, `LEARNS`, `new` and `run`; the file's name is the scheme's word everywhere.
macro_rules! tile_schemes {
    ($($file:ident => $Scheme:ident),* $(,)?) => {
        enum AnyScheme<M: Machine> { $($Scheme($file::$Scheme<M>)),* }

        /// The schemes, by name.
        pub const SCHEMES: &[About] =
            &[$(About {
                name: stringify!($file),
                summary: $file::SUMMARY,
                native_only: $file::NATIVE_ONLY,
                learns: $file::LEARNS,
            }),*];

        impl<M: Machine> AnyScheme<M> {
            fn new(name: &str, machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
                match name {
                    $(stringify!($file) => {
                        Ok(AnyScheme::$Scheme($file::$Scheme::new(machine, processors, settings)?))
                    })*
                    _ => {
                        let known = SCHEMES.iter().map(|scheme| scheme.name).collect::<Vec<_>>().join(", ");
                        Err(SettingError::NoScheme { shape: "tiles", name: name.to_owned(), known })
                    }
                }
            }

            fn run<W: TileWork>(
                &mut self,
                machine: &M,
                frames: &Frames<'_, M, W>,
            ) -> Result<Vec<Share<W::Found>>, RunError> {
                match self { $(AnyScheme::$Scheme(scheme) => scheme.run(machine, frames)),* }
            }
        }
    };
}

tile_schemes! {
    serial => Serial,
    static_blocks => StaticBlocks,
    interleaved => Interleaved,
    fixed_tiles => FixedTiles,
    decreasing_tiles => DecreasingTiles,
    per_pixel_queue => PerPixelQueue,
    work_stealing => WorkStealing,
    rayon_iter => RayonIter,
}

/// A scheme set up for a machine and a number of processors. It keeps its counter and list from run to run.
pub struct Scheme<M: Machine> {
    scheme: AnyScheme<M>,
    about: &'static About,
    processors: usize,
    barrier_kind: BarrierKind,
    /// Made when it is first needed.
    barrier: Option<Barrier<M>>,
}

impl<M: Machine> Scheme<M> {
    /// Sets up the scheme called `name`.
    ///
    /// # Errors
    /// [`SettingError`]: an unknown scheme or setting, a senseless value, a machine it cannot run on.
    pub fn new(
        name: &str,
        machine: &M,
        processors: usize,
        settings: BTreeMap<String, String>,
    ) -> Result<Self, SettingError> {
        let settings = Settings::new(name, settings);
        let scheme = AnyScheme::new(name, machine, processors.max(1), &settings)?;
        let barrier_kind = settings.barrier(machine)?;
        settings.finish()?;
        let about = SCHEMES.iter().find(|known| known.name == name).expect("it was just made");
        Ok(Scheme { scheme, about, processors, barrier_kind, barrier: None })
    }

    /// Shares out `work` over the processors; returns what each of them found and how many pieces it worked
    /// on, in the order of their numbers.
    ///
    /// # Errors
    /// [`RunError`]. After a failed run the scheme can be used again.
    pub fn run<W: TileWork>(&mut self, machine: &M, work: &W) -> Result<Vec<Share<W::Found>>, RunError> {
        machine.check_processors(self.processors)?;
        self.scheme.run(machine, &Frames { works: std::slice::from_ref(work), barrier: None })
    }

    /// Shares out frame after frame over the processors in one run, with a barrier between each two; returns what
    /// each processor found in all of them, and how many of their pieces it worked on, in the order of their
    /// numbers. No piece of a frame is begun before the last of the frame before is done.
    ///
    /// # Errors
    /// As [`Scheme::run`].
    ///
    /// # Panics
    /// If the frames do not have the same number of pieces.
    pub fn run_frames<W: TileWork>(
        &mut self,
        machine: &M,
        works: &[W],
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        machine.check_processors(self.processors)?;
        let Some(first) = works.first() else { return Ok(Vec::new()) };
        assert!(
            works.iter().all(|work| work.pieces() == first.pieces()),
            "frames of different size in one run"
        );
        let (kind, processors) = (self.barrier_kind, self.processors);
        let make =
            || Barrier::new(machine, kind, Layout::Padded, processors).expect("the settings were checked");
        let barrier = self.barrier.get_or_insert_with(make);
        barrier.reset();
        self.scheme.run(machine, &Frames { works, barrier: Some(barrier) })
    }

    /// The scheme's line in the list of schemes.
    pub fn about(&self) -> &'static About {
        self.about
    }
}

/// Shares out `work` once, under the scheme called `name` with its default settings. To do it every
/// frame, keep a [`Scheme`].
///
/// # Errors
/// [`ShareError`].
pub fn share<M: Machine, W: TileWork>(
    name: &str,
    machine: &M,
    processors: usize,
    work: &W,
) -> Result<Vec<Share<W::Found>>, ShareError> {
    Ok(Scheme::new(name, machine, processors, BTreeMap::new())?.run(machine, work)?)
}
