//! Work stealing over ranges: each processor starts with a part of the pieces, as in `static_blocks`, and works it off
//! tile by tile from its front; whoever runs dry takes the rear half of what another has left. Task stealing is what
//! the ray tracer of the DASH machine does, which Parker et al. 1999 (sec. 5; PK-15) hold to be unnecessary.
//!
//! Invariant: a processor's range is one word, start and end, so that every change to it is one compare-exchange; a
//! unit of pieces is in one range, or in the hands of whoever took it out, until it is worked on. Only the owner
//! writes to a range that is empty.
//!
//! Steps of a processor: 1. take a tile from the front of its own range; 2. work on it; 3. if there was none, look at
//! the others in turn, take the rear half of the first that has anything, keep one tile of it in hand and make the rest
//! its own range; 4. if nobody had anything, end. What a thief has in its hands meanwhile nobody sees: it works that off
//! itself, so one who ends too early costs balance and never a piece.
//!
//! A range that comes back to a word as it was before is one that can be taken again, so no compare-exchange is misled.
//!
//! Settings: `tile` (pieces in a tile, 1), `layout` (of the ranges).

use super::work::Frames;
use super::{MOST_PIECES, Share, TileWork};
use crate::machine::{Machine, Processor, RunError, Shared, Word};
use crate::scheme::{SettingError, Settings};
use std::sync::atomic::Ordering;

pub(super) const SUMMARY: &str =
    "a part each, the idle take half of what another has left (DASH in Parker et al. sec. 5)";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

/// Bits of a range's word that hold its end; those above hold its start.
const HALF: u32 = 32;

pub(super) struct WorkStealing<M: Machine> {
    processors: usize,
    tile: usize,
    /// One range a processor, in units.
    ranges: Shared<M::Word>,
}

fn pack(start: u64, end: u64) -> u64 {
    start << HALF | end
}

fn unpack(range: u64) -> (u64, u64) {
    (range >> HALF, range & (u64::MAX >> HALF))
}

impl<M: Machine> WorkStealing<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let tile = settings.number("tile", 1, 1..=MOST_PIECES)?;
        let ranges = machine.alloc(processors, settings.layout()?, |_| Word::new(0));
        Ok(WorkStealing { processors, tile, ranges })
    }

    pub(super) fn run<W: TileWork>(
        &mut self,
        machine: &M,
        frames: &Frames<'_, M, W>,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        let pieces = frames.pieces();
        // A unit is a tile, or more where half a word could not number so many.
        let unit = self.tile.max(pieces.div_ceil(u32::MAX as usize));
        let units = pieces.div_ceil(unit) as u64;
        let scheme = &*self;
        scheme.deal(units);
        frames.run(
            machine,
            scheme.processors,
            || scheme.deal(units),
            |cpu, _| {
                let start = unit * scheme.pop(cpu.id()).or_else(|| scheme.steal(cpu))? as usize;
                Some(start..pieces.min(start + unit))
            },
        )
    }

    /// Gives each processor its part; nobody may be taking any.
    fn deal(&self, units: u64) {
        let (count, mut start) = (self.processors as u64, 0);
        for (p, range) in self.ranges.iter().enumerate() {
            let end = start + units / count + u64::from((p as u64) < units % count);
            // ORDERING: Relaxed: between runs, or the barrier between two frames orders it.
            range.store(pack(start, end), Ordering::Relaxed);
            start = end;
        }
    }

    /// Takes the first unit of one's own range.
    #[inline]
    fn pop(&self, me: usize) -> Option<u64> {
        self.change(&self.ranges[me], |start, end| pack(start + 1, end)).map(|(start, _)| start)
    }

    /// Takes the rear half of somebody's range, hands out its first unit, and makes the rest this processor's range.
    fn steal(&self, cpu: &M::Processor) -> Option<u64> {
        let (me, count) = (cpu.id(), self.processors);
        let half = |start: u64, end: u64| start + (end - start) / 2;
        let rear = |victim: usize| {
            let range = &self.ranges[victim];
            self.change(range, |start, end| pack(start, half(start, end)))
        };
        let (start, end) = (1..count).find_map(|i| rear((me + i) % count))?;
        let first = half(start, end);
        // ORDERING: Relaxed: the range itself is all that is handed on; what the pieces read lay there before the run.
        self.ranges[me].store(pack(first + 1, end), Ordering::Relaxed);
        Some(first)
    }

    /// Puts another range in place of one that is not empty; returns what it was.
    #[inline]
    fn change(&self, range: &M::Word, new: impl Fn(u64, u64) -> u64) -> Option<(u64, u64)> {
        // ORDERING: Relaxed, here and below: as in `steal`.
        let mut seen = range.load(Ordering::Relaxed);
        loop {
            let (start, end) = unpack(seen);
            if start >= end {
                return None;
            }
            match range.compare_exchange(seen, new(start, end), Ordering::Relaxed, Ordering::Relaxed) {
                Ok(_) => return Some((start, end)),
                Err(now) => seen = now,
            }
        }
    }
}
