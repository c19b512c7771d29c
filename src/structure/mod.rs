//! What is built over a scene: trees of boxes, and what is to be said of their shape.

mod aabb_tree;
mod box_tree;
mod boxes;
pub mod bvh;
mod midpoint;
mod midpoint_tree;
mod moving_tree;
mod placed_leaves;
mod runs;
mod skip_tree;
mod split;
mod statistics;
pub mod volume_tree;
mod volumes;

pub use aabb_tree::{AabbTree, AabbTreeNode};
pub use box_tree::{BoxTree, BoxTreeView, Looked};
pub use boxes::{BitMask, Boxes, cull, cull_blocks, cull_into};
pub use midpoint_tree::{MidpointStatistics, Object, midpoint_tree};
pub use moving_tree::MovingTree;
pub use placed_leaves::{PlacedLeaf, PlacedLeaves};
pub use skip_tree::{SkipNode, SkipTree};
pub use split::{Leaf, Split, SplitError};
pub use statistics::TreeStatistics;
pub use volume_tree::{VolumeTree, VolumeTreeError};
pub use volumes::{VOLUME_KINDS, VolumeKind, Volumes};

use thiserror::Error;

/// What stands in for a scene node where a tree node was made for none: the root put over a scene that
/// has several.
pub const NO_SOURCE: u32 = u32::MAX;

/// A tree that does not hold what it must.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("tree node {node}: {fault}")]
pub struct TreeError {
    /// The node, by index.
    pub node: u32,
    /// What is wrong with it.
    pub fault: String,
}

impl TreeError {
    fn new(node: usize, fault: impl Into<String>) -> Self {
        Self { node: node as u32, fault: fault.into() }
    }
}

#[cfg(test)]
mod tests;
