//! A hierarchy over items known by their boxes, whatever is in them.

use super::collapse::{Leaves, collapse};
use super::layout::{Child, Node};
use crate::geometry::hit::Scale;
use crate::geometry::{Aabb, Unit};
use crate::structure::bvh::BinaryBvh;

/// A hierarchy of eight boxes a node over items in boxes, one a leaf. Its leaves are places in an order, so that who has
/// the items can lay them side by side.
#[derive(Clone, Debug)]
pub struct BoxBvh {
    pub(in crate::structure::bvh) scale: Scale,
    pub(in crate::structure::bvh) root: Child,
    pub(in crate::structure::bvh) nodes: Vec<Node>,
    /// How many children may wait at most while a ray goes through.
    pub(in crate::structure::bvh) waiting: usize,
    /// The widest there is, so that no ray need ask for it.
    pub(in crate::structure::bvh) unit: Unit,
}

impl BoxBvh {
    /// The hierarchy that a binary one over items with these boxes, in metres, collapses to; and the items by their
    /// places in it.
    ///
    /// # Panics
    /// If the binary hierarchy names an item that has no box, or a node that it does not have, or has 2^28 items or more.
    pub fn new(binary: &BinaryBvh, boxes: &[Aabb]) -> (Self, Vec<u32>) {
        let scale = Scale::of(boxes.iter().flat_map(|bounds| [bounds.min, bounds.max]));
        let mut places = Places { boxes, scale, order: Vec::with_capacity(boxes.len()) };
        let made = collapse(binary, &mut places, scale);
        let (root, nodes, waiting) = (made.root, made.nodes, made.waiting);
        (Self { scale, root, nodes, waiting, unit: Unit::best() }, places.order)
    }

    /// How many bytes its nodes take.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
    }
}

/// Items as they are given places.
struct Places<'a> {
    boxes: &'a [Aabb],
    scale: Scale,
    order: Vec<u32>,
}

impl Leaves for Places<'_> {
    const MOST: usize = 1;

    fn can_be_met(&self, item: u32) -> bool {
        let Aabb { min, max } = self.boxes[item as usize];
        min.cmple(max).all()
    }

    fn bounds(&self, item: u32) -> Aabb {
        let Aabb { min, max } = self.boxes[item as usize];
        Aabb { min: self.scale.point(min), max: self.scale.point(max) }
    }

    fn lay(&mut self, items: &[u32]) -> Child {
        let first = self.order.len();
        self.order.extend_from_slice(items);
        Child::leaf(first, items.len())
    }
}

impl Default for BoxBvh {
    /// Over nothing.
    fn default() -> Self {
        Self::new(&BinaryBvh::default(), &[]).0
    }
}
