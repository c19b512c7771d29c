//! The memory of a simulated machine: real addresses, numbered by coherence line.
//!
//! Blocks are bumped out of chunks that start on a line boundary, so which values share a line
//! depends on the program's layout alone and the numbering is the same on every run, whatever the
//! operating system's address randomisation does.

use crate::machine::shared::{Arena, LINE};
use std::alloc::{Layout, alloc_zeroed, dealloc, handle_alloc_error};
use std::ptr::NonNull;
use std::sync::Mutex;

/// Bytes of a chunk; a larger block gets a chunk of its own.
const CHUNK: usize = 1 << 20;

/// Memory that is handed out once and freed with the machine.
pub(super) struct Memory {
    chunks: Mutex<Vec<Chunk>>,
}

struct Chunk {
    start: NonNull<u8>,
    layout: Layout,
    used: usize,
    /// Bytes in the chunks before this one.
    before: usize,
}

// SAFETY: a chunk owns plain memory; the pointer is not tied to a thread.
unsafe impl Send for Chunk {}

/// Where a chunk lies: `start .. end` maps to bytes `before ..` of the machine's memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) start: usize,
    pub(super) end: usize,
    pub(super) before: usize,
}

impl Memory {
    pub(super) fn new() -> Self {
        Memory { chunks: Mutex::new(Vec::new()) }
    }

    /// The chunks there are, newest first (most accesses go to the newest).
    pub(super) fn extents(&self) -> Vec<Extent> {
        let chunks = self.chunks.lock().unwrap_or_else(|e| e.into_inner());
        let extent = |c: &Chunk| {
            let start = c.start.addr().get();
            Extent { start, end: start + c.layout.size(), before: c.before }
        };
        chunks.iter().rev().map(extent).collect()
    }
}

impl Arena for Memory {
    fn take(&self, bytes: Layout) -> NonNull<u8> {
        let mut chunks = self.chunks.lock().unwrap_or_else(|e| e.into_inner());
        // Whole widest lines, so that two blocks never share a line of any machine.
        let size = bytes.size().next_multiple_of(LINE);
        let align = bytes.align();
        if let Some(chunk) = chunks.last_mut() {
            let at = chunk.used.next_multiple_of(align);
            if at + size <= chunk.layout.size() && chunk.layout.align() >= align {
                chunk.used = at + size;
                // SAFETY: `at + size` lies within the chunk.
                return unsafe { chunk.start.add(at) };
            }
        }
        let before = chunks.last().map_or(0, |c| c.before + c.layout.size());
        let layout = Layout::from_size_align(size.max(CHUNK), align.max(LINE)).expect("valid layout");
        // SAFETY: the layout's size is not zero.
        let start =
            NonNull::new(unsafe { alloc_zeroed(layout) }).unwrap_or_else(|| handle_alloc_error(layout));
        chunks.push(Chunk { start, layout, used: size, before });
        start
    }

    unsafe fn give_back(&self, _block: NonNull<u8>, _bytes: Layout) {
        // Freed with the machine: reusing addresses would hand cached lines to new data.
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        for chunk in self.chunks.get_mut().unwrap_or_else(|e| e.into_inner()) {
            // SAFETY: each chunk was allocated with this layout; every `Shared` that lay in it kept
            // this memory alive through its `Arc` and is gone.
            unsafe { dealloc(chunk.start.as_ptr(), chunk.layout) };
        }
    }
}
