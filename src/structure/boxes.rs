//! A flat array of boxes and the mask of those that may be seen: what a game engine culls each frame.

use crate::geometry::{Aabb, BoxBlock, BoxTest, Frustum};
use std::ops::Range;

/// Boxes as a structure of arrays, in blocks of 64; in metres, 24 bytes a box.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Boxes {
    blocks: Vec<BoxBlock>,
    len: usize,
}

impl Boxes {
    /// How many boxes there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Adds a box after the others.
    pub fn push(&mut self, bounds: &Aabb) {
        if self.len.is_multiple_of(BoxBlock::LEN) {
            self.blocks.push(BoxBlock::EMPTY);
        }
        self.len += 1;
        self.set(self.len - 1, bounds);
    }

    /// Puts another box in the place of box `i`.
    ///
    /// # Panics
    /// If there is no box `i`.
    pub fn set(&mut self, i: usize, bounds: &Aabb) {
        assert!(i < self.len, "box {i} of {}", self.len);
        self.blocks[i / BoxBlock::LEN].set(i % BoxBlock::LEN, bounds);
    }

    /// Box `i`; of the odd ones what [`BoxBlock`] keeps of them.
    ///
    /// # Panics
    /// If there is no box `i`.
    pub fn get(&self, i: usize) -> Aabb {
        assert!(i < self.len, "box {i} of {}", self.len);
        self.blocks[i / BoxBlock::LEN].get(i % BoxBlock::LEN)
    }

    /// The boxes, 64 by 64; the last block is filled up with empty ones.
    pub fn blocks(&self) -> &[BoxBlock] {
        &self.blocks
    }
}

impl<'a> FromIterator<&'a Aabb> for Boxes {
    fn from_iter<I: IntoIterator<Item = &'a Aabb>>(boxes: I) -> Self {
        let mut all = Self::default();
        boxes.into_iter().for_each(|bounds| all.push(bounds));
        all
    }
}

/// A bit for each box, 64 to a word, the least significant first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BitMask {
    words: Vec<u64>,
    len: usize,
}

impl BitMask {
    /// A mask of `len` cleared bits.
    pub fn new(len: usize) -> Self {
        Self { words: vec![0; len.div_ceil(64)], len }
    }

    /// How many bits there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Whether bit `i` is set.
    ///
    /// # Panics
    /// If there is no bit `i`.
    pub fn get(&self, i: usize) -> bool {
        assert!(i < self.len, "bit {i} of {}", self.len);
        self.words[i / 64] >> (i % 64) & 1 == 1
    }

    /// How many bits are set.
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// The bits that are set, by number, least first.
    pub fn ones(&self) -> impl Iterator<Item = usize> {
        self.words.iter().enumerate().flat_map(|(at, &word)| {
            let mut left = word;
            std::iter::from_fn(move || {
                let bit = left.trailing_zeros() as usize;
                left &= left.wrapping_sub(1);
                (bit < 64).then_some(64 * at + bit)
            })
        })
    }

    /// The words; bits behind the last are 0.
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// The words, to be filled in parts by [`cull_blocks`].
    pub fn words_mut(&mut self) -> &mut [u64] {
        &mut self.words
    }

    /// Clears the mask and makes it `len` bits long; memory is kept.
    pub(super) fn reset(&mut self, len: usize) {
        self.words.clear();
        self.words.resize(len.div_ceil(64), 0);
        self.len = len;
    }
}

/// Which boxes may be seen: bit `i` is set when box `i` is not certainly outside the frustum. Nothing visible
/// is ever cleared; beyond an edge of the frustum a box may be called visible that is not
/// (Paper I sec. 3.1, Fig. 2).
///
/// ```
/// use apportion::geometry::{Aabb, Camera, Frustum, Lens};
/// use apportion::structure::{Boxes, cull};
/// use glam::Vec3;
/// let cube = |x: f32| Aabb { min: Vec3::new(x, -1.0, -1.0), max: Vec3::new(x + 2.0, 1.0, 1.0) };
/// let boxes: Boxes = [cube(5.0), cube(-9.0), cube(20.0)].iter().collect();
/// let lens = Lens::Symmetric { fov_y: 1.0, aspect: 16.0 / 9.0 };
/// let camera = Camera::look_at(Vec3::ZERO, Vec3::X, Vec3::Y, lens, 0.1, 1000.0)?;
/// let seen = cull(&boxes, &Frustum::new(&camera));
/// assert!(seen.ones().eq([0, 2]), "the second lies behind the eye");
/// # Ok::<(), apportion::geometry::CameraError>(())
/// ```
pub fn cull(boxes: &Boxes, frustum: &Frustum) -> BitMask {
    let mut mask = BitMask::default();
    cull_into(boxes, frustum, &mut mask);
    mask
}

/// As [`cull`], into a mask that is there: no memory is asked for from the second frame on.
pub fn cull_into(boxes: &Boxes, frustum: &Frustum, mask: &mut BitMask) {
    if mask.len != boxes.len {
        mask.reset(boxes.len);
    }
    cull_blocks(boxes, &BoxTest::new(frustum), 0..boxes.blocks.len(), &mut mask.words);
}

/// As [`cull`], of some of the blocks of 64 boxes, one word each: for threads that fill a mask together.
///
/// ```
/// # use apportion::geometry::{Aabb, BoxTest, Camera, Frustum, Lens};
/// # use apportion::structure::{BitMask, Boxes, cull, cull_blocks};
/// # use glam::Vec3;
/// # let boxes: Boxes = vec![Aabb { min: Vec3::X, max: Vec3::ONE }; 1000].iter().collect();
/// # let lens = Lens::Symmetric { fov_y: 1.0, aspect: 16.0 / 9.0 };
/// # let frustum = Frustum::new(&Camera::look_at(Vec3::ZERO, Vec3::X, Vec3::Y, lens, 0.1, 1000.0)?);
/// let (test, mut mask) = (BoxTest::new(&frustum), BitMask::new(boxes.len()));
/// let half = boxes.blocks().len() / 2;
/// let (first, second) = mask.words_mut().split_at_mut(half);
/// std::thread::scope(|threads| {
///     threads.spawn(|| cull_blocks(&boxes, &test, 0..half, first));
///     cull_blocks(&boxes, &test, half..boxes.blocks().len(), second);
/// });
/// assert_eq!(mask, cull(&boxes, &frustum));
/// # Ok::<(), apportion::geometry::CameraError>(())
/// ```
///
/// # Panics
/// If there are not such blocks, or not as many words as blocks.
pub fn cull_blocks(boxes: &Boxes, test: &BoxTest, blocks: Range<usize>, words: &mut [u64]) {
    test.visible(&boxes.blocks[blocks], words);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Camera, Lens};
    use glam::Vec3;

    #[test]
    fn masks_count_what_they_hold() {
        let mut mask = BitMask::new(130);
        assert!(mask.words().len() == 3 && mask.ones().next().is_none());
        mask.words_mut()[0] = 1 | 1 << 63;
        mask.words_mut()[2] = 2;
        assert!(mask.ones().eq([0, 63, 129]));
        assert_eq!((mask.count(), mask.get(129), mask.get(128)), (3, true, false));
        assert!(BitMask::default().is_empty() && BitMask::new(0).ones().next().is_none());
    }

    #[test]
    fn all_sizes_and_a_mask_used_again() {
        let lens = Lens::Symmetric { fov_y: 1.0, aspect: 1.0 };
        let camera = Camera::look_at(Vec3::ZERO, Vec3::X, Vec3::Y, lens, 0.1, 100.0).unwrap();
        let (front, behind) = (Vec3::new(9.0, 0.0, 0.0), Vec3::new(-9.0, 0.0, 0.0));
        let mut mask = BitMask::default();
        for len in [0, 1, 63, 64, 65, 128, 130, 7] {
            let at = |i: usize| if i.is_multiple_of(3) { front } else { behind };
            let all: Vec<Aabb> = (0..len).map(|i| Aabb { min: at(i) - 1.0, max: at(i) + 1.0 }).collect();
            let mut boxes: Boxes = all.iter().collect();
            assert!((0..len).all(|i| boxes.get(i) == all[i]) && boxes.len() == len);
            cull_into(&boxes, &Frustum::new(&camera), &mut mask);
            assert!(mask.ones().eq((0..len).step_by(3)), "{len} boxes");
            assert_eq!(mask.len(), len);
            if len > 1 {
                boxes.set(1, &all[0]);
                assert!(cull(&boxes, &Frustum::new(&camera)).get(1));
            }
        }
    }
}
