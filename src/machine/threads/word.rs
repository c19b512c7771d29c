//! Words and slots of real threads: `std`'s atomics and cells, and nothing more.
#![expect(clippy::disallowed_types, reason = "this is the one door to the native 64-bit atomic")]

use crate::machine::{Slot, Word};
use std::cell::UnsafeCell;
use std::sync::atomic::{AtomicU64, Ordering};

/// A native atomic word.
#[derive(Debug)]
pub struct NativeWord(AtomicU64);

impl Word for NativeWord {
    #[inline]
    fn new(value: u64) -> Self {
        NativeWord(AtomicU64::new(value))
    }
    // ORDERING: each method takes its ordering from the caller, who names the partner.
    #[inline]
    fn load(&self, order: Ordering) -> u64 {
        self.0.load(order)
    }
    #[inline]
    fn store(&self, value: u64, order: Ordering) {
        self.0.store(value, order);
    }
    #[inline]
    fn swap(&self, value: u64, order: Ordering) -> u64 {
        self.0.swap(value, order)
    }
    #[inline]
    fn fetch_add(&self, value: u64, order: Ordering) -> u64 {
        self.0.fetch_add(value, order)
    }
    #[inline]
    fn compare_exchange(
        &self,
        current: u64,
        new: u64,
        success: Ordering,
        failure: Ordering,
    ) -> Result<u64, u64> {
        self.0.compare_exchange(current, new, success, failure)
    }
    #[inline]
    fn fence(order: Ordering) {
        std::sync::atomic::fence(order);
    }
}

/// A native cell.
#[derive(Debug)]
pub struct NativeSlot<T>(UnsafeCell<T>);

// SAFETY: `Slot`'s contract makes the users of `read` and `write` keep races off the cell.
unsafe impl<T: Send> Sync for NativeSlot<T> {}

impl<T: Copy + Send> Slot<T> for NativeSlot<T> {
    #[inline]
    fn new(value: T) -> Self {
        NativeSlot(UnsafeCell::new(value))
    }
    #[inline]
    unsafe fn read(&self) -> T {
        // SAFETY: the caller keeps writers away.
        unsafe { *self.0.get() }
    }
    #[inline]
    unsafe fn write(&self, value: T) {
        // SAFETY: the caller keeps everybody else away.
        unsafe { *self.0.get() = value }
    }
}
