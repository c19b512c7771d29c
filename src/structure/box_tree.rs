//! Boxes put in order of space, with a box around each 64 and around each 4,096 of them: what is far
//! outside, or wholly inside, is settled 64 or 4,096 boxes at a time.
//!
//! The mask is the one that [`cull`](super::cull) makes of the same boxes in the same order, bit for bit:
//! see [`geometry::box_test`](crate::geometry::box_test) for why a box within one that is outside is outside
//! too. Two shallow levels are enough: the upper one is a four-thousandth of the boxes, gone through as it lies.
//!
//! Built by halving, at the median of the centres along the axis on which they spread most, always at a whole
//! number of blocks (and of groups, while there are several); so a far outlier costs its own block only. Boxes
//! without a bound come after the others, empty ones last.

use super::{BitMask, Boxes};
use crate::geometry::{Aabb, BoxBlock, BoxTest, Frustum, around, culling};
use glam::Vec3;
use std::ops::Range;

/// Boxes in order of space, under two levels of boxes around them.
///
/// ```
/// use apportion::geometry::{Aabb, Camera, Frustum, Lens};
/// use apportion::structure::{BoxTree, cull};
/// use glam::Vec3;
/// let at = |i: u32| Vec3::new((i % 50) as f32, (i / 50 % 50) as f32, (i / 2500) as f32);
/// let all: Vec<_> = (0..125_000).map(|i| Aabb { min: at(i), max: at(i) + 0.5 }).collect();
/// let tree = BoxTree::build(&all);
/// let lens = Lens::Symmetric { fov_y: 0.9, aspect: 1.5 };
/// let camera = Camera::look_at(Vec3::splat(-9.0), Vec3::splat(25.0), Vec3::Y, lens, 0.1, 90.0)?;
/// let seen = tree.cull(&Frustum::new(&camera));
/// assert_eq!(seen, cull(tree.boxes(), &Frustum::new(&camera)));
/// let yours: Vec<u32> = seen.ones().map(|i| tree.order()[i]).collect();
/// # assert!(yours.iter().all(|&i| i < 125_000));
/// # Ok::<(), apportion::geometry::CameraError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct BoxTree {
    boxes: Boxes,
    order: Vec<u32>,
    /// How many boxes are not empty; they come first.
    filled: usize,
    /// Around each block of boxes.
    bounds: Boxes,
    /// Around each block of those.
    groups: Vec<Aabb>,
}

/// What a [`BoxTree`] is culled by, wherever it lies: parts of it may be kept in a machine's shared memory.
#[derive(Clone, Copy, Debug)]
pub struct BoxTreeView<'a> {
    /// The boxes, in the order of the tree.
    pub blocks: &'a [BoxBlock],
    /// A box around each block: a block of them to a group.
    pub bounds: &'a [BoxBlock],
    /// A box around each group of 64 blocks.
    pub groups: &'a [Aabb],
    /// How many boxes are not empty; they come first.
    pub filled: usize,
}

/// What a descent looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Looked {
    /// The box around a group, by number.
    Group(usize),
    /// The boxes around the blocks of a group, by number.
    Bounds(usize),
    /// A block of boxes, by number.
    Block(usize),
}

impl BoxTree {
    /// Boxes in a group.
    pub const GROUP: usize = BoxBlock::LEN * BoxBlock::LEN;

    /// Puts boxes in order and boxes around them. The time is that of a sort.
    ///
    /// # Panics
    /// If there are more boxes than a u32 can number.
    pub fn build(all: &[Aabb]) -> Self {
        let count = u32::try_from(all.len()).expect("no more boxes than a u32 can number");
        let rank = |&i: &u32| rank(&all[i as usize]);
        let mut order: Vec<u32> = (0..count).collect();
        order.sort_by_key(rank);
        let bounded = order.partition_point(|i| rank(i) == 0);
        let filled = order.partition_point(|i| rank(i) < 2);
        halve(&mut order[..bounded], all);
        let boxes: Boxes = order.iter().map(|&i| &all[i as usize]).collect();
        let around_blocks: Vec<Aabb> = boxes.blocks().iter().map(BoxBlock::bounds).collect();
        let around_all = |blocks: &[Aabb]| blocks.iter().copied().reduce(around).unwrap_or(Aabb::EMPTY);
        let groups = around_blocks.chunks(BoxBlock::LEN).map(around_all).collect();
        Self { boxes, order, filled, bounds: around_blocks.iter().collect(), groups }
    }

    /// The boxes, in the order of the tree.
    pub fn boxes(&self) -> &Boxes {
        &self.boxes
    }

    /// Which box of those given to [`BoxTree::build`] stands at each place of the tree, and so of its masks.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// What it is culled by.
    pub fn view(&self) -> BoxTreeView<'_> {
        BoxTreeView {
            blocks: self.boxes.blocks(),
            bounds: self.bounds.blocks(),
            groups: &self.groups,
            filled: self.filled,
        }
    }

    /// Which boxes may be seen: bit `i` for the box at place `i` of the tree, as [`cull`](super::cull) says it.
    pub fn cull(&self, frustum: &Frustum) -> BitMask {
        let mut mask = BitMask::default();
        self.cull_into(frustum, &mut mask);
        mask
    }

    /// As [`BoxTree::cull`], into a mask that is there.
    pub fn cull_into(&self, frustum: &Frustum, mask: &mut BitMask) {
        if mask.len() != self.boxes.len() {
            mask.reset(self.boxes.len());
        }
        self.view().cull_groups(
            frustum,
            &BoxTest::new(frustum),
            0..self.groups.len(),
            mask.words_mut(),
            |_| (),
        );
    }
}

impl BoxTreeView<'_> {
    /// As [`BoxTree::cull`], of some of the groups, into the words of their boxes: for threads that fill a mask
    /// together. A group has 64 words, the last perhaps fewer. `test` is that of `frustum`; `watch` is told what
    /// was looked at.
    ///
    /// # Panics
    /// If there are not such groups, or not as many words as they have blocks.
    pub fn cull_groups(
        &self,
        frustum: &Frustum,
        test: &BoxTest,
        groups: Range<usize>,
        words: &mut [u64],
        mut watch: impl FnMut(Looked),
    ) {
        let around = &self.groups[groups.clone()];
        let first = BoxBlock::LEN * groups.start;
        let blocks = &self.blocks[first..self.blocks.len().min(BoxBlock::LEN * groups.end)];
        assert_eq!(blocks.len(), words.len(), "a mask word for each block of the groups");
        for ((group, around), words) in groups.zip(around).zip(words.chunks_mut(BoxBlock::LEN)) {
            watch(Looked::Group(group));
            match culling::basic(around, frustum).side {
                culling::Side::Outside(_) => words.fill(0),
                culling::Side::Inside => self.fill(BoxBlock::LEN * group, words),
                culling::Side::Intersecting => self.cull_group(test, group, words, &mut watch),
            }
        }
    }

    /// Goes through the blocks of a group that crosses the frustum.
    fn cull_group(&self, test: &BoxTest, group: usize, words: &mut [u64], watch: &mut impl FnMut(Looked)) {
        watch(Looked::Bounds(group));
        let sides = test.sides(&self.bounds[group]);
        for (at, word) in words.iter_mut().enumerate() {
            let (block, word) = (BoxBlock::LEN * group + at, std::slice::from_mut(word));
            if sides.inside >> at & 1 == 1 {
                self.fill(block, word);
            } else if sides.visible >> at & 1 == 1 {
                watch(Looked::Block(block));
                test.visible(std::slice::from_ref(&self.blocks[block]), word);
            } else {
                word.fill(0);
            }
        }
    }

    /// Sets the bits of all boxes of the blocks from `block` on that are not empty.
    fn fill(&self, block: usize, words: &mut [u64]) {
        for (at, word) in (block..).zip(words) {
            let boxes = self.filled.saturating_sub(BoxBlock::LEN * at);
            *word = if boxes >= BoxBlock::LEN { u64::MAX } else { (1 << boxes) - 1 };
        }
    }
}

/// Boxes with a bound come first, empty ones last.
fn rank(bounds: &Aabb) -> u8 {
    if bounds.is_nan() {
        1
    } else if bounds.is_empty() {
        2
    } else {
        u8::from(!(bounds.min.is_finite() && bounds.max.is_finite()))
    }
}

/// Puts boxes in order of space, half by half. Both halves but the last piece are whole blocks.
fn halve(order: &mut [u32], all: &[Aabb]) {
    let blocks = order.len().div_ceil(BoxBlock::LEN);
    if blocks < 2 {
        return;
    }
    let unit = if blocks > BoxBlock::LEN { BoxBlock::LEN } else { 1 };
    let at = BoxBlock::LEN * (blocks / 2).next_multiple_of(unit);
    let centre = |i: u32| all[i as usize].centre();
    let spread = order.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &i| {
        (low.min(centre(i)), high.max(centre(i)))
    });
    // Halved, so that the whole range of numbers does not overflow.
    let axis = (spread.1 * 0.5 - spread.0 * 0.5).max_position();
    order.select_nth_unstable_by(at, |&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]));
    let (left, right) = order.split_at_mut(at);
    halve(left, all);
    halve(right, all);
}

#[cfg(test)]
#[path = "box_tree_tests.rs"]
mod tests;
