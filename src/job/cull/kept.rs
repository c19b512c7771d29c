//! What a node keeps from frame to frame, in machine words.
//!
//! ORDERING: Relaxed throughout. Within a frame a node's words are the business of the one processor that
//! visits it; from frame to frame the machine's start and end of a run order them, as they do what is forgotten
//! between frames.

use super::Distances;
use crate::geometry::culling::{Head, Memory, Side};
use crate::geometry::{Aabb, Plane};
use crate::machine::Word;
use std::cell::Cell;
use std::sync::atomic::Ordering;

/// A node's words.
pub(super) struct Kept<'t, W> {
    head: &'t W,
    distances: Option<&'t Distances<W>>,
    /// The test keeps nothing itself: [`Kept::keep_all`] will.
    reads_only: bool,
    /// The plane that was read: reading it again would be billed again.
    plane: Cell<u8>,
}

impl<'t, W> Kept<'t, W> {
    pub(super) fn new(head: &'t W, distances: Option<&'t Distances<W>>, reads_only: bool) -> Self {
        Kept { head, distances, reads_only, plane: Cell::new(0) }
    }
}

impl<W: Word> Memory for Kept<'_, W> {
    #[inline]
    fn head(&self) -> Head {
        // ORDERING: Relaxed, see the head of this file.
        let head = Head::unpack(self.head.load(Ordering::Relaxed));
        self.plane.set(head.plane);
        head
    }

    #[inline]
    fn keep(&self, head: Head) {
        if !self.reads_only {
            // ORDERING: Relaxed, see the head of this file.
            self.head.store(head.pack(), Ordering::Relaxed);
        }
    }

    #[inline]
    fn distances(&self, plane: usize) -> (f32, f32) {
        let Some(words) = self.distances else { return (f32::NEG_INFINITY, f32::INFINITY) };
        // ORDERING: Relaxed, see the head of this file.
        let word = words[plane].load(Ordering::Relaxed);
        (f32::from_bits((word >> 32) as u32), f32::from_bits(word as u32))
    }

    #[inline]
    fn keep_distances(&self, plane: usize, bounds: (f32, f32)) {
        if let Some(words) = self.distances {
            // ORDERING: Relaxed, see the head of this file.
            words[plane].store(pair(bounds), Ordering::Relaxed);
        }
    }
}

impl<W: Word> Kept<'_, W> {
    /// Writes all there is to keep, whether or not it changed: the traffic of Paper II's code.
    #[inline]
    pub(super) fn keep_all(&self, bounds: &Aabb, planes: &[Plane], side: Side) {
        let plane = match side {
            Side::Outside(plane) => plane,
            _ => self.plane.get(),
        };
        // ORDERING: Relaxed, see the head of this file.
        self.head.store(Head { plane, ..Head::default() }.pack(), Ordering::Relaxed);
        for (word, plane) in self.distances.into_iter().flatten().zip(planes) {
            // ORDERING: Relaxed, see the head of this file.
            word.store(pair(plane.extremes(bounds)), Ordering::Relaxed);
        }
    }
}

/// Two `f32` in a word, the first on top.
fn pair((high, low): (f32, f32)) -> u64 {
    u64::from(high.to_bits()) << 32 | u64::from(low.to_bits())
}
