//! Words and slots of the simulated machine: every access is billed to whoever makes it.
#![expect(clippy::disallowed_types, reason = "simulated memory is made of native words, billed one by one")]

use super::engine::{self, Kind};
use crate::machine::{Slot, Word};
use std::cell::UnsafeCell;
use std::sync::atomic::{AtomicU64, Ordering};

/// A word in simulated memory. Outside a run (setting up, reading results) an access costs nothing.
///
/// All virtual processors of a machine share one host thread and the engine hands over between them
/// only in `engine::bill`, so a load followed by a store is indivisible there. The orderings a scheme
/// asks for are checked by loom; here every access is sequentially consistent.
#[derive(Debug)]
pub struct SimulatedWord(AtomicU64);

impl SimulatedWord {
    #[inline]
    fn bill(&self, kind: Kind) {
        engine::bill(std::ptr::from_ref(self).addr(), size_of::<u64>(), kind);
    }

    fn replace(&self, kind: Kind, new: impl FnOnce(u64) -> u64) -> u64 {
        self.bill(kind);
        // ORDERING: Relaxed: one host thread (see the type).
        let old = self.0.load(Ordering::Relaxed);
        self.0.store(new(old), Ordering::Relaxed);
        old
    }
}

impl Word for SimulatedWord {
    fn new(value: u64) -> Self {
        SimulatedWord(AtomicU64::new(value))
    }

    #[inline]
    fn load(&self, _order: Ordering) -> u64 {
        self.bill(Kind::Load);
        // ORDERING: Relaxed: one host thread (see the type).
        self.0.load(Ordering::Relaxed)
    }

    #[inline]
    fn store(&self, value: u64, _order: Ordering) {
        self.bill(Kind::Store);
        // ORDERING: Relaxed: one host thread (see the type).
        self.0.store(value, Ordering::Relaxed);
    }

    fn swap(&self, value: u64, _order: Ordering) -> u64 {
        self.replace(Kind::Atomic, |_| value)
    }

    fn fetch_add(&self, value: u64, _order: Ordering) -> u64 {
        self.replace(Kind::Atomic, |old| old.wrapping_add(value))
    }

    fn fetch_add_at_memory(&self, value: u64, _order: Ordering) -> u64 {
        self.replace(Kind::AtMemory, |old| old.wrapping_add(value))
    }

    fn compare_exchange(&self, current: u64, new: u64, _: Ordering, _: Ordering) -> Result<u64, u64> {
        let old = self.replace(Kind::Atomic, |old| if old == current { new } else { old });
        if old == current { Ok(old) } else { Err(old) }
    }

    fn fence(order: Ordering) {
        // On a total-store-order machine only the full fence costs anything.
        if order == Ordering::SeqCst {
            engine::fence();
        }
    }
}

/// Plain storage in simulated memory.
#[derive(Debug)]
pub struct SimulatedSlot<T>(UnsafeCell<T>);

// SAFETY: `Slot`'s contract makes the users of `read` and `write` keep races off the cell.
unsafe impl<T: Send> Sync for SimulatedSlot<T> {}

impl<T: Copy + Send> Slot<T> for SimulatedSlot<T> {
    fn new(value: T) -> Self {
        SimulatedSlot(UnsafeCell::new(value))
    }

    #[inline]
    unsafe fn read(&self) -> T {
        engine::bill(self.0.get().addr(), size_of::<T>(), Kind::Load);
        // SAFETY: the caller keeps writers away.
        unsafe { *self.0.get() }
    }

    #[inline]
    unsafe fn write(&self, value: T) {
        engine::bill(self.0.get().addr(), size_of::<T>(), Kind::Store);
        // SAFETY: the caller keeps everybody else away.
        unsafe { *self.0.get() = value }
    }
}
