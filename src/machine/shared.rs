//! Shared allocations: values at a fixed stride, from an arena whose addresses mean something.

use std::alloc::{Layout as Bytes, alloc, dealloc, handle_alloc_error};
use std::marker::PhantomData;
use std::ops::{Index, IndexMut};
use std::ptr::NonNull;
use std::sync::Arc;

/// The widest coherence line of any machine here (Origin 2000), in bytes. Allocations start on it, so
/// that which values share a line follows from the layout alone, never from the allocator's mood.
pub(crate) const LINE: usize = 128;

/// How neighbouring values lie in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Layout {
    /// Side by side, as one wrote it in 1999: a lock beside its data, both ring indices in one line.
    Packed,
    /// Each value on lines of its own.
    #[default]
    Padded,
}

impl Layout {
    /// The bytes from one value to the next.
    fn stride<T>(self) -> usize {
        match self {
            Layout::Packed => size_of::<T>(),
            Layout::Padded => size_of::<T>().next_multiple_of(LINE),
        }
    }
}

/// Where shared memory comes from. Natively it is the heap; a simulated machine hands out numbered
/// memory of its own.
pub trait Arena: Send + Sync {
    /// Takes a block whose alignment is at least 128 bytes, the widest line there is.
    fn take(&self, bytes: Bytes) -> NonNull<u8>;
    /// Gives a block back.
    ///
    /// # Safety
    /// The block came from `take` of this arena with the same layout, and nothing uses it any more.
    unsafe fn give_back(&self, block: NonNull<u8>, bytes: Bytes);
}

/// The heap.
#[derive(Debug)]
pub(crate) struct Heap;

impl Arena for Heap {
    fn take(&self, bytes: Bytes) -> NonNull<u8> {
        // SAFETY: `Shared::new` never asks for a block of size zero.
        NonNull::new(unsafe { alloc(bytes) }).unwrap_or_else(|| handle_alloc_error(bytes))
    }

    unsafe fn give_back(&self, block: NonNull<u8>, bytes: Bytes) {
        // SAFETY: the caller hands back what `take` gave, with its layout.
        unsafe { dealloc(block.as_ptr(), bytes) }
    }
}

/// `n` values in shared memory, at a stride that the [`Layout`] fixed.
pub struct Shared<T> {
    first: NonNull<u8>,
    len: usize,
    stride: usize,
    bytes: Bytes,
    arena: Arc<dyn Arena>,
    values: PhantomData<T>,
}

// SAFETY: a `Shared` owns its values, as a `Vec` does; the arena is Send and Sync itself.
unsafe impl<T: Send> Send for Shared<T> {}
// SAFETY: `&Shared` gives out `&T` only, `&mut Shared` one `&mut T`.
unsafe impl<T: Sync> Sync for Shared<T> {}

impl<T> Shared<T> {
    /// Fills a new allocation from `arena`.
    ///
    /// # Panics
    /// If the size overflows the address space.
    pub fn new(arena: Arc<dyn Arena>, len: usize, layout: Layout, mut make: impl FnMut(usize) -> T) -> Self {
        let stride = layout.stride::<T>();
        let size = stride.checked_mul(len).expect("shared allocation overflows the address space").max(1);
        let bytes = Bytes::from_size_align(size, LINE.max(align_of::<T>())).expect("valid layout");
        let first = arena.take(bytes);
        // `len` grows with what is made, so that a panic in `make` drops exactly that.
        let mut shared = Shared::<T> { first, len: 0, stride, bytes, arena, values: PhantomData };
        for i in 0..len {
            let value = make(i);
            // SAFETY: slot `i < len` lies inside the block and holds nothing yet.
            unsafe { shared.slot(i).write(value) };
            shared.len = i + 1;
        }
        shared
    }

    fn slot(&self, i: usize) -> *mut T {
        // SAFETY: callers keep `i` within the block of `len * stride` bytes.
        unsafe { self.first.as_ptr().add(i * self.stride).cast() }
    }

    /// The values, which lie side by side.
    ///
    /// # Panics
    /// If they do not: the layout padded them.
    pub fn as_slice(&self) -> &[T] {
        assert_eq!(self.stride, size_of::<T>(), "padded values are no slice");
        // SAFETY: the block holds `len` values, `stride` apart, which is the distance in a slice.
        unsafe { std::slice::from_raw_parts(self.first.as_ptr().cast(), self.len) }
    }

    /// How many values there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The values in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &T> + Clone {
        (0..self.len).map(|i| &self[i])
    }
}

impl<T> Index<usize> for Shared<T> {
    type Output = T;

    #[inline]
    fn index(&self, i: usize) -> &T {
        assert!(i < self.len, "index {i} of a shared allocation of {}", self.len);
        // SAFETY: `i < len`, so the slot lies in the block and holds a value.
        unsafe { &*self.slot(i) }
    }
}

impl<T> IndexMut<usize> for Shared<T> {
    #[inline]
    fn index_mut(&mut self, i: usize) -> &mut T {
        assert!(i < self.len, "index {i} of a shared allocation of {}", self.len);
        // SAFETY: `i < len`, so the slot lies in the block and holds a value; nobody else has a reference, since
        // this one to the whole allocation is exclusive.
        unsafe { &mut *self.slot(i) }
    }
}

impl<T> Drop for Shared<T> {
    fn drop(&mut self) {
        for i in 0..self.len {
            // SAFETY: each of the `len` slots holds a value, dropped exactly once here.
            unsafe { self.slot(i).drop_in_place() };
        }
        // SAFETY: the block came from this arena with these bytes, and its values are gone.
        unsafe { self.arena.give_back(self.first, self.bytes) };
    }
}

impl<T> std::fmt::Debug for Shared<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Shared({} x {} bytes)", self.len, self.stride)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::AssertUnwindSafe;

    #[test]
    fn layouts_set_the_stride() {
        let heap: Arc<dyn Arena> = Arc::new(Heap);
        let at = |s: &Shared<u64>, i: usize| std::ptr::from_ref(&s[i]).addr();
        let packed = Shared::new(heap.clone(), 3, Layout::Packed, |i| i as u64);
        let padded = Shared::new(heap, 3, Layout::Padded, |i| i as u64);
        assert_eq!(at(&packed, 1) - at(&packed, 0), 8);
        assert_eq!(at(&padded, 1) - at(&padded, 0), LINE);
        assert_eq!(at(&packed, 0) % LINE, 0);
        assert_eq!(padded.iter().copied().collect::<Vec<_>>(), [0, 1, 2]);
        let mut packed = packed;
        packed[1] = 7;
        assert_eq!(packed.as_slice(), [0, 7, 2]);
        packed[1] = 1;
        assert_eq!(packed.as_slice(), [0, 1, 2]);
        assert!(std::panic::catch_unwind(AssertUnwindSafe(|| padded.as_slice().len())).is_err());
    }

    #[test]
    fn a_panic_while_filling_drops_what_was_made() {
        let made = Arc::new(());
        let result = std::panic::catch_unwind(|| {
            Shared::new(Arc::new(Heap), 4, Layout::Padded, |i| {
                assert!(i < 2, "third value");
                made.clone()
            })
        });
        assert!(result.is_err());
        assert_eq!(Arc::strong_count(&made), 1);
    }

    #[test]
    fn nothing_at_all_is_fine() {
        let none: Shared<u64> = Shared::new(Arc::new(Heap), 0, Layout::Packed, |_| 0);
        assert!(none.is_empty());
    }
}
