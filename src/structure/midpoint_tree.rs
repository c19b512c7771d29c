//! A binary tree of boxes over objects, built top-down by midpoint: Bubenicek 2020, sec. 2.

use glam::Vec3A;

use super::midpoint::{Items, Part, Place, divide};
use super::{NO_SOURCE, SkipNode, SkipTree};
use crate::geometry::Aabb;

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
/// the same; boxes above a NaN are of no use to culling, which says "intersecting" of them.
///
/// # Panics
/// If there are more than 2^31 objects, whose nodes could not be counted.
pub fn midpoint_tree(objects: &[Object]) -> (SkipTree, MidpointStatistics) {
    assert!(objects.len() <= 1 << 31, "{} objects are more than a tree can hold", objects.len());
    let mut order: Vec<u32> = (0..objects.len() as u32).collect();
    let parts = divide(&Boxes(objects), &mut order, 1);
    let node = |(index, part): (usize, Part)| {
        let source = if part.end as usize == index + 1 { order[part.start as usize] } else { NO_SOURCE };
        let triangles = objects.get(source as usize).map_or(0, |object| object.triangles);
        SkipNode { bounds: part.bounds, end: part.end, triangles, source }
    };
    let nodes = parts.nodes.into_iter().enumerate().map(node).collect();
    (SkipTree { nodes }, MidpointStatistics { medians: parts.medians, depth: parts.depth })
}

/// Objects by index.
struct Boxes<'a>(&'a [Object]);

impl Items for Boxes<'_> {
    type Item = u32;

    #[inline]
    fn place(&self, object: u32) -> Place {
        let bounds = &self.0[object as usize].bounds;
        let (low, high) = (Vec3A::from(bounds.min), Vec3A::from(bounds.max));
        Place { low, high, middle: low * 0.5 + high * 0.5 }
    }
}

#[cfg(test)]
#[path = "midpoint_tree_tests.rs"]
mod tests;
