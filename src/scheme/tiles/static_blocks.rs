//! Static blocks: processor p of P works on the p-th of P parts that follow one another, as even as whole
//! pieces allow.
//!
//! Invariant: the parts are disjoint and cover all pieces. Nothing is shared, so nothing is waited for but
//! the slowest; uneven pieces are its end. A processor has the same pieces in each run, and so they stay in
//! its cache.

use super::work::Frames;
use super::{Share, TileWork};
use crate::machine::{Machine, Processor, RunError};
use crate::scheme::{SettingError, Settings};
use std::marker::PhantomData;

pub(super) const SUMMARY: &str = "one part each, fixed beforehand";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct StaticBlocks<M> {
    processors: usize,
    machine: PhantomData<fn(M)>,
}

impl<M: Machine> StaticBlocks<M> {
    pub(super) fn new(_: &M, processors: usize, _: &Settings) -> Result<Self, SettingError> {
        Ok(StaticBlocks { processors, machine: PhantomData })
    }

    pub(super) fn run<W: TileWork>(
        &mut self,
        machine: &M,
        frames: &Frames<'_, M, W>,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        let (each, odd) = (frames.pieces() / self.processors, frames.pieces() % self.processors);
        // The first `odd` parts have one piece more.
        let start = |p: usize| each * p + p.min(odd);
        frames.run(
            machine,
            self.processors,
            || (),
            |cpu, turn| (turn == 0).then(|| start(cpu.id())..start(cpu.id() + 1)),
        )
    }
}
