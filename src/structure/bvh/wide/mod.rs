//! The hierarchy that rays go through: eight boxes a node, four triangles a block.
//!
//! Made of a binary hierarchy by leaving nodes out ([`collapse`]). A node's boxes lie coordinate by coordinate, so that
//! one vector test takes all eight; which plane of a box a ray comes to first depends on the ray alone and is picked by
//! address. Leaves are blocks of triangles, coordinate by coordinate too. All lengths are counted in the scene's own
//! ([`Scale`]).
//!
//! What is no triangle is known by its box ([`BoxBvh`]): the same nodes, over leaves of places in an order.

mod boxes;
mod collapse;
mod expected;
mod layout;
mod refit;

pub use boxes::BoxBvh;
pub(super) use layout::{Alone, Block, Child, Node, TRIANGLES, Together, WIDTH};

use super::BinaryBvh;
use crate::geometry::hit::{Scale, TriangleTest, Watertight};
use crate::geometry::{Aabb, Unit};
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
        let mut laid = Blocks { triangles, scale, blocks: Vec::new() };
        let made = collapse::collapse(binary, &mut laid, scale);
        Self {
            scale,
            root: made.root,
            nodes: made.nodes,
            blocks: laid.blocks,
            waiting: made.waiting,
            unit: Unit::best(),
            test: PhantomData,
        }
    }

    /// How many nodes it has.
    pub fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Boxes that hold all its triangles between them, in metres: those of the root's children.
    pub(super) fn outline(&self) -> impl Iterator<Item = Aabb> {
        let root = self.nodes.first();
        let metres = self.scale.inverse();
        let boxes = root.into_iter().flat_map(|root| root.boxes());
        boxes.map(move |bounds| Aabb { min: bounds.min * metres, max: bounds.max * metres })
    }

    /// How many bytes its nodes and triangles take.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..])
    }
}

/// Blocks of triangles as they are laid down.
struct Blocks<'a> {
    triangles: &'a [[Vec3; 3]],
    scale: Scale,
    blocks: Vec<Block>,
}

impl collapse::Leaves for Blocks<'_> {
    const MOST: usize = TRIANGLES;

    fn can_be_met(&self, item: u32) -> bool {
        self.triangles[item as usize].iter().all(|corner| corner.is_finite())
    }

    fn bounds(&self, item: u32) -> Aabb {
        Aabb::of_points(self.triangles[item as usize].map(|corner| self.scale.point(corner)))
    }

    fn lay(&mut self, items: &[u32]) -> Child {
        let mut block = Block::EMPTY;
        for (i, &item) in items.iter().enumerate() {
            block.set(i, self.triangles[item as usize].map(|corner| self.scale.point(corner)), item);
        }
        self.blocks.push(block);
        Child::leaf(self.blocks.len() - 1, 1)
    }
}
