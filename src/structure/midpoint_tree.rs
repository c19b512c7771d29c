//! A binary tree of boxes over objects, built top-down by midpoint: Bubenicek 2020, sec. 2.

use glam::Vec3A;

use super::midpoint::{Items, Place, divide};
use super::{NO_SOURCE, SkipNode, SkipTree};
use crate::geometry::Aabb;

/// Something that is drawn or left out as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Object {
    /// The box around it, in the world, in metres. An empty box counts as the origin; NaN is not allowed.
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
/// # Panics
/// If there are more than 2^31 objects, whose nodes could not be counted.
pub fn midpoint_tree(objects: &[Object]) -> (SkipTree, MidpointStatistics) {
    assert!(objects.len() <= 1 << 31, "{} objects are more than a tree can hold", objects.len());
    let mut order: Vec<Boxed> = objects.iter().zip(0..).map(Boxed::new).collect();
    let parts = divide(&Boxes, &mut order, 1);
    let node = |(index, part): (u32, &super::midpoint::Part)| {
        let source = if part.end == index + 1 { order[part.start as usize].object } else { NO_SOURCE };
        let triangles = objects.get(source as usize).map_or(0, |object| object.triangles);
        SkipNode { bounds: part.bounds, end: part.end, triangles, source }
    };
    let nodes = (0..).zip(&parts.nodes).map(node).collect();
    (SkipTree { nodes }, MidpointStatistics { medians: parts.medians, depth: parts.depth })
}

#[derive(Clone, Copy)]
struct Boxed {
    low: Vec3A,
    high: Vec3A,
    object: u32,
}

impl Boxed {
    fn new((object, index): (&Object, u32)) -> Self {
        Self { low: object.bounds.min.into(), high: object.bounds.max.into(), object: index }
    }
}

struct Boxes;

impl Items for Boxes {
    type Item = Boxed;

    #[inline]
    fn place(&self, item: Boxed) -> Place {
        Place { low: item.low, high: item.high, middle: item.low * 0.5 + item.high * 0.5 }
    }
}
