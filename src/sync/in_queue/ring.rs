//! The memory of an in-queue, and an end's hold on it.

use super::RingSettings;
use crate::machine::{Machine, Shared};
use std::ptr::NonNull;
use std::sync::Arc;

/// Where `head` lies among a ring's indices.
pub(super) const HEAD: usize = 0;
/// Where `tail` does.
pub(super) const TAIL: usize = 1;

pub(super) struct Ring<M: Machine> {
    /// [`HEAD`], written by the receiver, and [`TAIL`], written by the sender.
    pub(super) indices: Shared<M::Word>,
    /// A power of two, at least the capacity.
    pub(super) slots: Shared<M::Slot<u64>>,
    pub(super) settings: RingSettings,
}

/// One end's hold on the ring: what each task needs of it lies in the end itself, one step away.
pub(super) struct Hold<M: Machine> {
    /// The first of `ring.slots`.
    slots: NonNull<M::Slot<u64>>,
    /// Number of slots minus one.
    mask: u64,
    /// The one of `ring.indices` that this end writes.
    own: NonNull<M::Word>,
    /// The one that the other end writes.
    other: NonNull<M::Word>,
    /// How many tasks this end may move without looking again.
    pub(super) memory: u64,
    /// Keeps what the pointers point to alive and in its place.
    pub(super) ring: Arc<Ring<M>>,
}

// SAFETY: a hold is an `Arc` of the ring and, in effect, references to words and slots of that ring;
// both are Sync (`Word`, `Slot`).
unsafe impl<M: Machine> Send for Hold<M> {}
// SAFETY: as for Send.
unsafe impl<M: Machine> Sync for Hold<M> {}

impl<M: Machine> Hold<M> {
    pub(super) fn new(ring: Arc<Ring<M>>, own: usize, other: usize) -> Self {
        let slots = NonNull::from(ring.slots.as_slice()).cast();
        let mask = ring.slots.len() as u64 - 1;
        let [own, other] = [own, other].map(|index| NonNull::from(&ring.indices[index]));
        let memory = if ring.settings.remember_index { u64::MAX } else { 1 };
        Hold { slots, mask, own, other, memory, ring }
    }

    #[inline]
    pub(super) fn own(&self) -> &M::Word {
        // SAFETY: it points into `ring`, which lives as long as this hold.
        unsafe { self.own.as_ref() }
    }

    #[inline]
    pub(super) fn other(&self) -> &M::Word {
        // SAFETY: as in `own`.
        unsafe { self.other.as_ref() }
    }

    #[inline]
    pub(super) fn slot(&self, index: u64) -> &M::Slot<u64> {
        // SAFETY: masked, the index is below the number of slots; `ring` keeps them alive.
        unsafe { self.slots.add((index & self.mask) as usize).as_ref() }
    }

    /// The `n` slots from `index` on, in the two stretches that the ring's end cuts them into.
    #[inline]
    pub(super) fn stretches(&self, index: u64, n: usize) -> [&[M::Slot<u64>]; 2] {
        let slots = self.ring.slots.as_slice();
        let start = (index & self.mask) as usize;
        let first = n.min(slots.len() - start);
        [&slots[start..start + first], &slots[..n - first]]
    }
}
