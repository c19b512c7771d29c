//! Sharing out independent pieces: blocks of boxes, tiles of a picture, ranges of an array.
//!
//! Pieces are numbered from 0 and cost nobody knows what. Each is worked on exactly once, by whichever
//! processor gets it. All that the processors ever share is one counter, drawn from with a fetch-and-add, so the
//! same schemes can run wherever there is one; pieces are handed out in ranges, that is, tiles.
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
mod serial;
mod static_blocks;
mod work;

pub use super::{About, Share, ShareError};
use super::{SettingError, Settings};
use crate::machine::{Machine, RunError};
use std::collections::BTreeMap;
use work::Billed;
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

            fn run<W: TileWork>(&mut self, machine: &M, work: &W) -> Result<Vec<Share<W::Found>>, RunError> {
                match self { $(AnyScheme::$Scheme(scheme) => scheme.run(machine, work)),* }
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
}

/// A scheme set up for a machine and a number of processors. It keeps its counter and list from run to run.
pub struct Scheme<M: Machine> {
    scheme: AnyScheme<M>,
    about: &'static About,
    processors: usize,
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
        settings.finish()?;
        let about = SCHEMES.iter().find(|known| known.name == name).expect("it was just made");
        Ok(Scheme { scheme, about, processors })
    }

    /// Shares out `work` over the processors; returns what each of them found and how many pieces it worked
    /// on, in the order of their numbers.
    ///
    /// # Errors
    /// [`RunError`]. After a failed run the scheme can be used again.
    pub fn run<W: TileWork>(&mut self, machine: &M, work: &W) -> Result<Vec<Share<W::Found>>, RunError> {
        machine.check_processors(self.processors)?;
        self.scheme.run(machine, &Billed(work))
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
