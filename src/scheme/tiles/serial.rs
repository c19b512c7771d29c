//! One processor, all pieces in one tile: what every speedup is measured against.

use super::work::Frames;
use super::{Share, TileWork};
use crate::machine::{Machine, RunError};
use crate::scheme::{SettingError, Settings};
use std::marker::PhantomData;

pub(super) const SUMMARY: &str = "one processor, no sharing";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct Serial<M>(PhantomData<fn(M)>);

impl<M: Machine> Serial<M> {
    pub(super) fn new(_: &M, _processors: usize, _: &Settings) -> Result<Self, SettingError> {
        Ok(Serial(PhantomData))
    }

    pub(super) fn run<W: TileWork>(
        &mut self,
        machine: &M,
        frames: &Frames<'_, M, W>,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        let share = machine.alone(|cpu| {
            let (mut share, pieces) = (frames.share(), frames.pieces());
            for work in frames.works().filter(|_| pieces > 0) {
                share.visited += pieces as u64;
                work.work_on(0..pieces, &mut share.found, cpu);
            }
            share
        })?;
        Ok(vec![share])
    }
}
