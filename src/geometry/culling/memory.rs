//! What a volume keeps from frame to frame.

use std::cell::Cell;

use crate::geometry::PLANE_COUNT;

/// The short part of what is kept; packs into 64 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Head {
    /// The plane to be tested first.
    pub plane: u8,
    /// The planes whose distances are kept, as bits: those that were really tested since `epoch` began.
    /// A test ends at the first plane that rejects, so the others have none (finding P1-F07).
    pub valid: u8,
    /// One more than the frame that last saw the volume outside `plane`; 0 if it was not outside.
    pub rejected: u32,
    /// The epoch the distances belong to, see [`super::Motion`].
    pub epoch: u32,
}

impl Head {
    /// There are numbers for so many frames, 26 days at 30 a second; later ones carry nothing over.
    pub(super) const FRAMES: u32 = 1 << 26;

    /// What is left when the volume has moved or changed: the plane, which only says what to test first. That it
    /// was outside, and its distances, held for where it was (Paper I sec. 3.5, P1-F06).
    #[must_use]
    pub fn forgotten(self) -> Self {
        Head { plane: self.plane, ..Head::default() }
    }

    /// As one word, the plane in the lowest byte.
    pub fn pack(self) -> u64 {
        u64::from(self.plane)
            | u64::from(self.valid) << 4
            | u64::from(self.rejected) << 10
            | u64::from(self.epoch) << 37
    }

    /// What `pack` gave.
    pub fn unpack(word: u64) -> Self {
        Head {
            plane: (word & 7) as u8,
            valid: (word >> 4 & 63) as u8,
            rejected: (word >> 10) as u32 & (2 * Self::FRAMES - 1),
            epoch: (word >> 37) as u32,
        }
    }
}

/// Where a volume's [`Head`] and distances are kept.
pub trait Memory {
    /// What was kept last; [`Head::default`] before that.
    fn head(&self) -> Head;

    /// Keeps this from now on.
    fn keep(&self, head: Head);

    /// To be called when the volume has moved or changed: nothing is carried over to the next test.
    fn forget(&self) {
        self.keep(self.head().forgotten());
    }

    /// The bounds kept for a plane: below the n-vertex' distance and above the p-vertex', in metres, seen
    /// from where the epoch began.
    fn distances(&self, plane: usize) -> (f32, f32);

    /// Keeps such bounds.
    fn keep_distances(&self, plane: usize, bounds: (f32, f32));
}

/// Keeps nothing: for tests that do not look back.
#[derive(Clone, Copy, Debug, Default)]
pub struct Forgetful;

impl Memory for Forgetful {
    fn head(&self) -> Head {
        Head::default()
    }

    fn keep(&self, _: Head) {}

    fn distances(&self, _: usize) -> (f32, f32) {
        (f32::NEG_INFINITY, f32::INFINITY)
    }

    fn keep_distances(&self, _: usize, _: (f32, f32)) {}
}

/// Keeps everything, for one thread.
#[derive(Clone, Debug, Default)]
pub struct Remembering {
    head: Cell<Head>,
    distances: [Cell<(f32, f32)>; PLANE_COUNT],
}

impl Memory for Remembering {
    fn head(&self) -> Head {
        self.head.get()
    }

    fn keep(&self, head: Head) {
        self.head.set(head);
    }

    fn distances(&self, plane: usize) -> (f32, f32) {
        self.distances[plane].get()
    }

    fn keep_distances(&self, plane: usize, bounds: (f32, f32)) {
        self.distances[plane].set(bounds);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_holds_it_all() {
        for head in [
            Head::default(),
            Head { plane: 5, valid: 63, rejected: Head::FRAMES, epoch: Head::FRAMES - 1 },
            Head { plane: 1, valid: 32, rejected: 1, epoch: 77 },
        ] {
            assert_eq!(Head::unpack(head.pack()), head);
        }
        assert_eq!(Head { plane: 3, ..Head::default() }.pack(), 3);
    }
}
