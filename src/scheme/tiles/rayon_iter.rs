//! A parallel iterator over the tiles, on rayon's own threads: what most Rust programs do today. Rayon halves the range
//! of tiles as long as its workers ask for more.
//!
//! Frame after frame is an iterator of its own: rayon has no barrier within one. A timeline shows the tiles, and all
//! that rayon does between them, looking for work and sleeping too, as sending.
//!
//! Settings: `tile` (pieces in a tile, 1).

use super::work::Frames;
use super::{MOST_PIECES, Share, TileWork};
use crate::machine::threads::{Thread, pin};
use crate::machine::{Machine, RunError, panic_message};
use crate::scheme::{SettingError, Settings};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;

pub(super) const SUMMARY: &str = "crate rayon, a parallel iterator over the tiles (rival; threads only)";
pub(super) const NATIVE_ONLY: bool = true;
pub(super) const LEARNS: bool = false;

pub(super) struct RayonIter<M> {
    /// Made on the first run, so that a system that refuses threads is an error of the run.
    pool: Option<ThreadPool>,
    processors: usize,
    tile: usize,
    machine: PhantomData<fn(M)>,
}

/// One share and one handle a worker. Its lock is free whenever it is taken: a worker works on one tile at a time.
type Shares<F> = Vec<Mutex<(Share<F>, Thread)>>;

impl<M: Machine> RayonIter<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        settings.native_only(machine)?;
        let tile = settings.number("tile", 1, 1..=MOST_PIECES)?;
        Ok(RayonIter { pool: None, processors, tile, machine: PhantomData })
    }

    pub(super) fn run<W: TileWork>(
        &mut self,
        machine: &M,
        frames: &Frames<'_, M, W>,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        let (count, tile, pieces) = (self.processors, self.tile, frames.pieces());
        let pool = match &mut self.pool {
            Some(pool) => pool,
            none => {
                let builder = ThreadPoolBuilder::new().num_threads(count).start_handler(pin);
                let refused = |e| RunError::System { what: "a rayon pool", source: std::io::Error::other(e) };
                none.insert(builder.build().map_err(refused)?)
            }
        };
        let whole = || {
            let shares: Shares<W::Found> =
                (0..count).map(|p| Mutex::new((frames.share(), machine.outside(p, count)))).collect();
            for work in frames.works() {
                let one = |number: usize| {
                    let me = rayon::current_thread_index().unwrap_or(0);
                    let mut share = shares[me].lock().unwrap_or_else(|e| e.into_inner());
                    let (share, cpu) = &mut *share;
                    let tile = number * tile..pieces.min((number + 1) * tile);
                    share.visited += tile.len() as u64;
                    work.work_on(tile, &mut share.found, cpu);
                };
                pool.install(|| (0..pieces.div_ceil(tile)).into_par_iter().for_each(one));
            }
            shares
        };
        let shares = catch_unwind(AssertUnwindSafe(whole))
            .map_err(|payload| RunError::Panicked { processor: 0, message: panic_message(&*payload) })?;
        Ok(shares.into_iter().map(|share| share.into_inner().expect("no tile panicked").0).collect())
    }
}
