//! Interleaved: processor p of P works on tiles p, p + P, p + 2P and so on, as one deals cards.
//!
//! Invariant: tile t belongs to processor t mod P. Nothing is shared; pieces that are dear in one place
//! are spread over all processors, but neighbours no longer share what they read.
//!
//! Settings: `tile` (pieces in a tile, 1).

use super::work::Frames;
use super::{MOST_PIECES, Share, TileWork};
use crate::machine::{Machine, Processor, RunError};
use crate::scheme::{SettingError, Settings};
use std::marker::PhantomData;

pub(super) const SUMMARY: &str = "every P-th tile, fixed beforehand";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct Interleaved<M> {
    processors: usize,
    tile: usize,
    machine: PhantomData<fn(M)>,
}

impl<M: Machine> Interleaved<M> {
    pub(super) fn new(_: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let tile = settings.number("tile", 1, 1..=MOST_PIECES)?;
        Ok(Interleaved { processors, tile, machine: PhantomData })
    }

    pub(super) fn run<W: TileWork>(
        &mut self,
        machine: &M,
        frames: &Frames<'_, M, W>,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        let (pieces, tile, processors) = (frames.pieces(), self.tile, self.processors);
        frames.run(
            machine,
            processors,
            || (),
            |cpu, turn| {
                let start = tile * (turn * processors + cpu.id());
                (start < pieces).then(|| start..pieces.min(start + tile))
            },
        )
    }
}
