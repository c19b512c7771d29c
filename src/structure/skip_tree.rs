//! The tree as a depth-first array with skip indices (Paper II sec. 3.3): a task is a range of it.

use super::{AabbTree, TreeError};
use crate::geometry::Aabb;

/// A node of a [`SkipTree`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkipNode {
    /// The box around everything at and below the node, in the world, in metres.
    pub bounds: Aabb,
    /// Index after the last node of its subtree: where to go on when the subtree is skipped.
    pub end: u32,
    /// Triangles of the mesh placed at this very node; 0 if there is none. They count as soon as the
    /// node is not outside, whether or not it has children.
    pub triangles: u32,
    /// What this one stands for: the scene node, or the object of a tree over objects; [`super::NO_SOURCE`]
    /// for nothing.
    pub source: u32,
}

/// An AABB tree as one array in depth-first order (Paper II sec. 3.3).
///
/// Invariants: the subtree of node `i` is the range `i..nodes[i].end`; its first child is `i + 1`, the
/// next child of the same parent is where the subtree of the one before ends; the root is node 0 and
/// its subtree is everything; each box holds those below it.
#[derive(Clone, Debug, Default)]
pub struct SkipTree {
    /// All nodes, depth-first, the root first.
    pub nodes: Vec<SkipNode>,
}

impl SkipTree {
    /// Lays a pointer tree out depth-first. No recursion, so any depth will do.
    pub fn build(tree: &AabbTree) -> Self {
        let mut nodes: Vec<SkipNode> = Vec::with_capacity(tree.nodes.len());
        let mut place = vec![0usize; tree.nodes.len()];
        let mut stack = Vec::new();
        if !tree.nodes.is_empty() {
            stack.push(0);
        }
        while let Some(index) = stack.pop() {
            let node = &tree.nodes[index as usize];
            place[index as usize] = nodes.len();
            let end = nodes.len() as u32 + 1;
            nodes.push(SkipNode { bounds: node.bounds, end, triangles: node.triangles, source: node.source });
            stack.extend(node.children.iter().rev());
        }
        // Children come after their parent in the pointer tree, so from the last to the first each
        // subtree's end is known before its parent asks for it.
        for (index, node) in tree.nodes.iter().enumerate().rev() {
            if let Some(last) = node.children.last() {
                nodes[place[index]].end = nodes[place[*last as usize]].end;
            }
        }
        Self { nodes }
    }

    /// The children of a node, by index, first to last.
    ///
    /// # Panics
    /// If `node` is not in the tree.
    #[inline]
    pub fn children(&self, node: u32) -> impl Iterator<Item = u32> + Clone {
        let end = self.nodes[node as usize].end;
        let first = Some(node + 1).filter(|child| *child < end);
        std::iter::successors(first, move |child| {
            Some(self.nodes[*child as usize].end).filter(|next| *next < end)
        })
    }

    /// Checks the invariants.
    ///
    /// # Errors
    /// [`TreeError`] naming the first node that breaks one.
    pub fn validate(&self) -> Result<(), TreeError> {
        let count = self.nodes.len() as u32;
        if let Some(root) = self.nodes.first().filter(|root| root.end != count) {
            return Err(TreeError::new(0, format!("its subtree ends at {}, not at {count}", root.end)));
        }
        let mut open: Vec<usize> = Vec::new();
        for (index, node) in self.nodes.iter().enumerate() {
            while open.last().is_some_and(|above| self.nodes[*above].end as usize <= index) {
                open.pop();
            }
            if node.end as usize <= index {
                return Err(TreeError::new(index, format!("its subtree ends at {}, before it", node.end)));
            }
            if let Some(above) = open.last() {
                let parent = &self.nodes[*above];
                if node.end > parent.end {
                    return Err(TreeError::new(index, format!("its subtree leaves that of node {above}")));
                }
                if !parent.bounds.contains(&node.bounds) {
                    return Err(TreeError::new(index, format!("its box leaves that of node {above}")));
                }
            }
            open.push(index);
        }
        Ok(())
    }
}
