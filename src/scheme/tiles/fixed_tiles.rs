//! Fixed tiles from a counter: whoever is free takes the next so many pieces (Parker et al. 1999, sec. 2.1,
//! before their tiles decrease).
//!
//! Invariant: each draw from the counter gives another number, 0, 1, 2 and so on, and draw t is tile t.
//!
//! Steps of a processor: 1. draw; 2. if the tile begins beyond the last piece, end; 3. work on it.
//!
//! Settings: `tile` (pieces in a tile, 1): small ones balance, large ones spare the counter. `counter` (`fetch_add`,
//! or `locked` with a `lock`, as one does where there is no such operation). `layout`.

use super::work::Frames;
use super::{MOST_PIECES, Share, TileWork};
use crate::machine::{Machine, RunError};
use crate::scheme::{SettingError, Settings};
use crate::sync::{Counter, CounterKind};

pub(super) const SUMMARY: &str = "the next tile to whoever is free, by a counter";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct FixedTiles<M: Machine> {
    processors: usize,
    tile: usize,
    counter: Counter<M>,
}

impl<M: Machine> FixedTiles<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let tile = settings.number("tile", 1, 1..=MOST_PIECES)?;
        let locked = CounterKind::Locked(settings.lock()?);
        let kinds = [("fetch_add", CounterKind::FetchAdd), ("locked", locked)];
        let kind = settings.choice("counter", CounterKind::FetchAdd, &kinds)?;
        let counter = Counter::new(machine, kind, settings.layout()?, processors);
        Ok(FixedTiles { processors, tile, counter })
    }

    pub(super) fn run<W: TileWork>(
        &mut self,
        machine: &M,
        frames: &Frames<'_, M, W>,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        self.counter.reset();
        let (counter, pieces, tile) = (&self.counter, frames.pieces(), self.tile);
        frames.run(
            machine,
            self.processors,
            || counter.restart(),
            |cpu, _| {
                let start = tile.saturating_mul(counter.draw(cpu) as usize);
                (start < pieces).then(|| start..pieces.min(start + tile))
            },
        )
    }
}
