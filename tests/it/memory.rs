//! Counts the memory each thread holds, so that a test can bound what a piece of code takes.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static HELD: Cell<isize> = const { Cell::new(0) };
    static MOST: Cell<isize> = const { Cell::new(0) };
}

/// Runs something and tells the most bytes that it held at once on this thread.
pub(crate) fn most_of<T>(run: impl FnOnce() -> T) -> (T, usize) {
    let before = HELD.get();
    MOST.set(before);
    let result = run();
    (result, usize::try_from(MOST.get() - before).unwrap_or(0))
}

fn add(bytes: isize) {
    // A thread that ends may free after its locals are gone: then nobody asks any more.
    let _ = HELD.try_with(|held| {
        held.set(held.get() + bytes);
        MOST.try_with(|most| most.set(most.get().max(held.get())))
    });
}

struct Counting;

#[global_allocator]
static COUNTING: Counting = Counting;

// SAFETY: each call goes to the system's allocator as it is; counting does not allocate, as the thread's locals
// are made at compile time and have no destructor.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        add(layout.size() as isize);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        add(layout.size() as isize);
        // SAFETY: the caller keeps the contract of `alloc_zeroed`.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        add(-(layout.size() as isize));
        // SAFETY: the caller keeps the contract of `dealloc`; `place` came from the system's allocator.
        unsafe { System.dealloc(place, layout) }
    }

    unsafe fn realloc(&self, place: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // Both may be there at once while bytes are moved.
        add(size as isize);
        add(-(layout.size() as isize));
        // SAFETY: the caller keeps the contract of `realloc`; `place` came from the system's allocator.
        unsafe { System.realloc(place, layout, size) }
    }
}

#[test]
fn the_most_is_counted_not_the_last() {
    let (kept, most) = most_of(|| {
        drop(vec![1u8; 1_000_000]);
        vec![1u8; 10]
    });
    assert!(kept.len() == 10 && (1_000_000..1_100_000).contains(&most), "{most}");
    let (_, most) = most_of(|| Vec::<u8>::with_capacity(5_000_000));
    assert!(most >= 5_000_000, "memory that is asked for counts, used or not");
}
