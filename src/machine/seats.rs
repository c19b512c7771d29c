//! One place a processor for what only that processor uses.

use crate::machine::{Layout, Machine, Processor, Shared};
use std::cell::UnsafeCell;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicBool, Ordering};

/// A value for each processor, claimed by that processor for the length of a run.
///
/// It lets a scheme keep ring endpoints and local queues from frame to frame without a lock: who
/// holds a seat is checked once a run, never on the hot path.
pub struct Seats<S> {
    seats: Shared<Seat<S>>,
}

struct Seat<S> {
    taken: AtomicBool,
    value: UnsafeCell<S>,
}

// SAFETY: the value is reached only through `claim`, which gives it to one holder at a time; the
// holder may sit on another thread, hence `S: Send`.
unsafe impl<S: Send> Sync for Seat<S> {}

impl<S: Send> Seats<S> {
    /// One seat a processor, each on lines of its own.
    pub fn new<M: Machine>(machine: &M, processors: usize, mut make: impl FnMut(usize) -> S) -> Self {
        let seat = |p| Seat { taken: AtomicBool::new(false), value: UnsafeCell::new(make(p)) };
        Seats { seats: machine.alloc(processors, Layout::Padded, seat) }
    }

    /// Takes this processor's seat until the claim is dropped.
    ///
    /// # Panics
    /// If the seat is taken already, or there is none for this processor.
    pub fn claim(&self, processor: &impl Processor) -> Claim<'_, S> {
        let seat = &self.seats[processor.id()];
        // ORDERING: Acquire pairs with the Release in `Claim::drop`: what the last holder did to the
        // value happened before this holder sees it.
        let taken = seat.taken.swap(true, Ordering::Acquire);
        assert!(!taken, "processor {} claims its seat twice", processor.id());
        Claim { seat }
    }

    /// How many seats there are.
    pub fn len(&self) -> usize {
        self.seats.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.seats.is_empty()
    }
}

/// A claimed seat; derefs to its value.
pub struct Claim<'a, S> {
    seat: &'a Seat<S>,
}

impl<S> Deref for Claim<'_, S> {
    type Target = S;
    fn deref(&self) -> &S {
        // SAFETY: this claim is the only holder (see `Seats::claim`).
        unsafe { &*self.seat.value.get() }
    }
}

impl<S> DerefMut for Claim<'_, S> {
    fn deref_mut(&mut self) -> &mut S {
        // SAFETY: this claim is the only holder (see `Seats::claim`), and it is borrowed mutably.
        unsafe { &mut *self.seat.value.get() }
    }
}

impl<S> Drop for Claim<'_, S> {
    fn drop(&mut self) {
        // ORDERING: Release pairs with the Acquire in `Seats::claim`.
        self.seat.taken.store(false, Ordering::Release);
    }
}

// SAFETY: a claim is an exclusive reference to an `S`.
unsafe impl<S: Send> Send for Claim<'_, S> {}
