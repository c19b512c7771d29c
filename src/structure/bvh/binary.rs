//! A binary hierarchy, as builders make it.

use crate::geometry::Aabb;

/// A node: two children side by side, or a run of items.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BinaryNode {
    /// The box around all that is below.
    pub bounds: Aabb,
    /// Of an inner node: the first child; the second follows it. Of a leaf: where its items begin in the order.
    pub first: u32,
    /// How many items a leaf has; 0 for an inner node.
    pub count: u32,
}

/// A binary hierarchy over items known by their boxes. Node 0 is the root; children come after their parent; over no
/// items there are no nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BinaryBvh {
    /// The nodes.
    pub nodes: Vec<BinaryNode>,
    /// Item numbers, in the order of the leaves. With spatial splits an item may be there more than once.
    pub order: Vec<u32>,
}

impl BinaryNode {
    /// Whether it has items and no children.
    pub fn is_leaf(&self) -> bool {
        self.count > 0
    }
}
