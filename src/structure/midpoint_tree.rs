//! A binary tree of boxes over objects, built top-down by midpoint: Bubenicek 2020, sec. 2.
//!
//! Objects are moved about with their boxes, so that all that is looked at lies one after the other. A part
//! of n objects becomes 2n - 1 nodes, so every subtree's place in the tree is known before it is built and
//! threads share nothing.

use glam::{Vec3A, Vec4};

use super::midpoint::{Bounds, most_midpoints};
use super::{NO_SOURCE, SkipNode, SkipTree};
use crate::geometry::Aabb;

/// Parts below this many objects are one thread's: a join costs as much as some hundreds of them.
const GRAIN: usize = 4096;

/// Something that is drawn or left out as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Object {
    /// The box around it, in the world, in metres.
    pub bounds: Aabb,
    /// Triangles it is made of.
    pub triangles: u32,
}

/// How a [`midpoint_tree`] came to be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MidpointStatistics {
    /// How many cuts had to be made at the median, since the midpoint would have cut nothing off.
    pub medians: u32,
    /// Nodes on the longest way down.
    pub depth: u32,
}

/// Builds the tree: two children a node, one object a leaf, laid out depth-first, so that every scheme that
/// culls a [`SkipTree`] culls this one. The source of a leaf is the object's index; inner nodes stand for
/// none ([`NO_SOURCE`]).
///
/// Objects are divided across the longest axis of their common box, in its middle, each going where the
/// middle of its own box lies; where that cuts nothing off, at the median, as in [`super::Split::new`].
/// Works on the threads of the current rayon pool; the result is the same whatever their number.
///
/// An object whose box is empty, infinite or NaN goes wherever the others leave room, and is in the tree all
/// the same; boxes above a NaN reach to infinity on that side, so that culling says "intersecting" of them.
///
/// # Panics
/// If there are more than 2^31 objects, whose nodes could not be counted.
pub fn midpoint_tree(objects: &[Object]) -> (SkipTree, MidpointStatistics) {
    assert!(objects.len() <= 1 << 31, "{} objects are more than a tree can hold", objects.len());
    let mut boxes: Vec<Boxed> =
        objects.iter().zip(0..).map(|(object, index)| Boxed::new(object, index)).collect();
    let mut spare = boxes.clone();
    let nothing = SkipNode { bounds: Aabb::EMPTY, end: 0, triangles: 0, source: NO_SOURCE };
    let mut nodes = vec![nothing; (2 * objects.len()).saturating_sub(1)];
    let mut statistics = MidpointStatistics::default();
    if !objects.is_empty() {
        let part = Part { first: 0, midpoints: most_midpoints(objects.len(), 1), depth: 1 };
        statistics = Builder { objects }.part(&mut boxes, &mut spare, &mut nodes, part);
    }
    (SkipTree { nodes }, statistics)
}

/// An object as it is moved about.
#[derive(Clone, Copy, Debug)]
struct Boxed {
    /// Least corner of its box and, by bits, its index.
    low: Vec4,
    /// Greatest corner.
    high: Vec4,
}

impl Boxed {
    #[inline]
    fn new(object: &Object, index: u32) -> Self {
        // What is not a number may be anywhere.
        let or = |at: f32, anywhere: f32| if at.is_nan() { anywhere } else { at };
        let low = object.bounds.min.map(|at| or(at, f32::NEG_INFINITY));
        let high = object.bounds.max.map(|at| or(at, f32::INFINITY));
        Self { low: low.extend(f32::from_bits(index)), high: high.extend(0.0) }
    }

    fn index(&self) -> u32 {
        self.low.w.to_bits()
    }

    /// The point that decides on which side of a cut it goes, on one axis.
    #[inline]
    fn middle(&self, axis: usize) -> f32 {
        let (low, high): (&[f32; 4], &[f32; 4]) = (self.low.as_ref(), self.high.as_ref());
        low[axis] * 0.5 + high[axis] * 0.5
    }
}

/// A part before it is divided.
#[derive(Clone, Copy)]
struct Part {
    /// The index of its own node.
    first: u32,
    /// How many midpoint cuts may still be made on the way down.
    midpoints: u32,
    /// Nodes on the way to it, itself included.
    depth: u32,
}

struct Builder<'a> {
    objects: &'a [Object],
}

impl Builder<'_> {
    /// Divides some objects, at least one, into `nodes`, of which there are as many as it takes; `spare` is
    /// as long as `boxes`.
    fn part(
        &self,
        boxes: &mut [Boxed],
        spare: &mut [Boxed],
        nodes: &mut [SkipNode],
        part: Part,
    ) -> MidpointStatistics {
        if let [only] = boxes {
            nodes[0] = self.leaf(only, part.first);
            return MidpointStatistics { medians: 0, depth: part.depth };
        }
        let bounds = common(boxes);
        let (count, (axis, plane)) = (boxes.len(), bounds.cut());
        let mut first = if part.midpoints > 0 { cut(boxes, spare, axis, plane) } else { 0 };
        let is_parted = (1..count).contains(&first);
        if !is_parted {
            first = cut_at_median(boxes);
        }
        let end = part.first + nodes.len() as u32;
        nodes[0] = SkipNode { bounds: bounds.aabb(), end, triangles: 0, source: NO_SOURCE };
        let (boxes, other_boxes) = boxes.split_at_mut(first);
        let (spare, other_spare) = spare.split_at_mut(first);
        let (nodes, other_nodes) = nodes[1..].split_at_mut(2 * first - 1);
        let half = Part {
            first: part.first + 1,
            midpoints: part.midpoints.saturating_sub(1),
            depth: part.depth + 1,
        };
        let other_half = Part { first: half.first + nodes.len() as u32, ..half };
        let mut one = move || self.part(boxes, spare, nodes, half);
        let mut other = move || self.part(other_boxes, other_spare, other_nodes, other_half);
        let (one, other) = if count > GRAIN { rayon::join(one, other) } else { (one(), other()) };
        MidpointStatistics {
            medians: one.medians + other.medians + u32::from(!is_parted),
            depth: one.depth.max(other.depth),
        }
    }

    #[inline]
    fn leaf(&self, only: &Boxed, first: u32) -> SkipNode {
        let object = &self.objects[only.index() as usize];
        SkipNode { bounds: object.bounds, end: first + 1, triangles: object.triangles, source: only.index() }
    }
}

/// The box around all.
#[inline]
fn common(boxes: &[Boxed]) -> Bounds {
    let ends = [Vec4::INFINITY, Vec4::NEG_INFINITY];
    let [low, high] = boxes.iter().fold(ends, |[low, high], one| [low.min(one.low), high.max(one.high)]);
    Bounds { low: Vec3A::from_vec4(low), high: Vec3A::from_vec4(high) }
}

/// Brings the boxes whose middle lies below a plane before the others, both in the order they had; how many
/// these are.
#[inline]
fn cut(boxes: &mut [Boxed], spare: &mut [Boxed], axis: usize, plane: f32) -> usize {
    // Each is written to both sides and counted on one: the side may be as good as random, and a branch that
    // is guessed wrong costs more than all this.
    let (mut first, mut second) = (0, 0);
    for at in 0..boxes.len() {
        let one = boxes[at];
        let is_first = one.middle(axis) < plane;
        boxes[first] = one;
        spare[second] = one;
        first += usize::from(is_first);
        second += usize::from(!is_first);
    }
    boxes[first..].copy_from_slice(&spare[..second]);
    first
}

/// Sorts two boxes or more by their middles, for a cut between two halves; how many the first has.
fn cut_at_median(boxes: &mut [Boxed]) -> usize {
    // The longest axis may be one all middles agree on: what counts now is where they differ.
    let middles = boxes.iter().map(|one| Vec3A::from([0, 1, 2].map(|axis| one.middle(axis))));
    let axis = middles.fold(Bounds::EMPTY, Bounds::with).longest();
    boxes.sort_by(|one, other| one.middle(axis).total_cmp(&other.middle(axis)));
    boxes.len() / 2
}

#[cfg(test)]
#[path = "midpoint_tree_tests.rs"]
mod tests;
