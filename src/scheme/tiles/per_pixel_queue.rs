//! A queue entry a piece (Parker et al. 1999, sec. 2; PK-02): the master puts every piece into one queue under a lock,
//! and whoever is free takes one out, as in the ray tracer they began with, whose pieces are pixels. What a piece is,
//! is the caller's business.
//!
//! Invariant: entries `taken .. put` wait; both numbers and the entries change only while the lock is held. `put` may be
//! *read* at any time, as a hint.
//!
//! Steps of the master, processor 0: for each piece, lock, append, unlock; then as a slave. Steps of a slave: 1. lock,
//! take the oldest entry, unlock; 2. work on it; 3. if there was none, end if all pieces have been put, or wait
//! until one more is.
//!
//! Settings: `lock`, `layout` (of the two numbers).

use super::work::Frames;
use super::{Share, TileWork};
use crate::machine::{Layout, Machine, Processor, RunError, Shared, Slot, Word};
use crate::scheme::{SettingError, Settings};
use crate::sync::Lock;
use std::sync::atomic::Ordering;

pub(super) const SUMMARY: &str = "one locked queue, an entry a piece (Parker et al. sec. 2)";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct PerPixelQueue<M: Machine> {
    processors: usize,
    lock: Lock<M>,
    /// How many entries have been put in, then how many have been taken out.
    ends: Shared<M::Word>,
    entries: Shared<M::Slot<u64>>,
}

impl<M: Machine> PerPixelQueue<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let (kind, layout) = (settings.lock()?, settings.layout()?);
        Ok(PerPixelQueue {
            processors,
            lock: Lock::new(machine, kind, layout, processors),
            ends: machine.alloc(2, layout, |_| Word::new(0)),
            entries: machine.alloc(0, Layout::Packed, |_| Slot::new(0)),
        })
    }

    pub(super) fn run<W: TileWork>(
        &mut self,
        machine: &M,
        frames: &Frames<'_, M, W>,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        let pieces = frames.pieces();
        if self.entries.len() < pieces {
            self.entries = machine.alloc(pieces, Layout::Packed, |_| Slot::new(0));
        }
        self.lock.reset();
        self.empty();
        let queue = &*self;
        frames.run(
            machine,
            self.processors,
            || queue.empty(),
            |cpu, turn| {
                if cpu.id() == 0 && turn == 0 {
                    (0..pieces).for_each(|piece| queue.put(piece, cpu));
                }
                queue.take(pieces, cpu).map(|piece| piece..piece + 1)
            },
        )
    }

    /// Takes everything out; nobody may be at the queue.
    fn empty(&self) {
        // ORDERING: Relaxed: between runs, or the barrier between two frames orders it.
        self.ends.iter().for_each(|end| end.store(0, Ordering::Relaxed));
    }

    fn put(&self, piece: usize, cpu: &M::Processor) {
        self.lock.with(cpu, || {
            // ORDERING: Relaxed: the lock orders it; readers outside take it as a hint.
            let put = self.ends[0].load(Ordering::Relaxed);
            // SAFETY: the lock is held, so nobody else touches the entries.
            unsafe { self.entries[put as usize].write(piece as u64) };
            self.ends[0].store(put + 1, Ordering::Relaxed);
        });
    }

    /// The oldest entry of the queue, waiting for one; none when all have been taken.
    fn take(&self, pieces: usize, cpu: &M::Processor) -> Option<usize> {
        loop {
            let (put, entry) = self.lock.with(cpu, || {
                // ORDERING: Relaxed, here and below: the lock orders both.
                let (put, taken) =
                    (self.ends[0].load(Ordering::Relaxed), self.ends[1].load(Ordering::Relaxed));
                if taken == put {
                    return (put, None);
                }
                self.ends[1].store(taken + 1, Ordering::Relaxed);
                // SAFETY: the lock is held, so nobody else touches the entries.
                (put, Some(unsafe { self.entries[taken as usize].read() } as usize))
            });
            if entry.is_some() || put == pieces as u64 {
                return entry;
            }
            // ORDERING: Relaxed: a hint; the lock decides.
            cpu.wait_until(&[&self.ends[0]], || self.ends[0].load(Ordering::Relaxed) > put);
        }
    }
}
