//! The hierarchy that rays go through: eight boxes a node, four triangles a block.
//!
//! Made of a binary hierarchy by leaving nodes out ([`collapse`]). A node's boxes lie coordinate by coordinate, so that
//! one vector test takes all eight; which plane of a box a ray comes to first depends on the ray alone and is picked by
//! address. Leaves are blocks of triangles, coordinate by coordinate too. All lengths are counted in the scene's own
//! ([`Scale`]).

mod collapse;
mod layout;

pub(super) use layout::{Alone, Block, Child, Node, TRIANGLES, Together, WIDTH};

use super::BinaryBvh;
use crate::geometry::Unit;
use crate::geometry::hit::{Scale, TriangleTest, Watertight};
use glam::Vec3;
use std::marker::PhantomData;

/// A hierarchy of eight boxes a node over triangles, by whose test `T` rays meet them.
///
/// Triangles with a corner that is not finite are never hit.
#[derive(Clone, Debug)]
pub struct WideBvh<T: TriangleTest = Watertight> {
    pub(super) scale: Scale,
    pub(super) root: Child,
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Vec<Block>,
    /// How many children may wait at most while a ray goes through.
    pub(super) waiting: usize,
    /// The widest there is, so that no ray need ask for it.
    pub(super) unit: Unit,
    test: PhantomData<T>,
}

impl<T: TriangleTest> WideBvh<T> {
    /// The hierarchy that a binary one over these triangles, corners in metres, collapses to.
    ///
    /// # Panics
    /// If the binary hierarchy names an item that is no triangle, or a node that it does not have.
    pub fn new(binary: &BinaryBvh, triangles: &[[Vec3; 3]]) -> Self {
        let scale = Scale::of(triangles.iter().flatten().copied());
        let made = collapse::collapse(binary, triangles, scale);
        Self {
            scale,
            root: made.root,
            nodes: made.nodes,
            blocks: made.blocks,
            waiting: made.waiting,
            unit: Unit::best(),
            test: PhantomData,
        }
    }

    /// How many nodes it has.
    pub fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// How many bytes its nodes and triangles take.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..])
    }
}
