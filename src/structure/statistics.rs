//! What is to be said of a tree's shape, since that decides how well it can be shared out.

use serde::Serialize;

use super::{SkipNode, SkipTree};

/// The shape of a tree.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TreeStatistics {
    /// Nodes.
    pub nodes: usize,
    /// Nodes without children.
    pub leaves: usize,
    /// Depth of the deepest node; the root is at depth 1, an empty tree has depth 0.
    pub depth: usize,
    /// How many leaves there are at each depth; entry `i` is for depth `i + 1`.
    pub leaf_depths: Vec<usize>,
    /// The most children any node has.
    pub widest_fan_out: usize,
    /// Triangles, shared meshes counted each time they are placed.
    pub triangles: u64,
    /// Over all nodes with two children or more, the mean share of the nodes below that are under the
    /// heaviest child. The nearer to 1, the less there is to share out. 0 if there is no such node.
    pub mean_heaviest_share: f64,
    /// The greatest such share.
    pub max_heaviest_share: f64,
    /// Bytes the tree takes as a depth-first array.
    pub bytes: usize,
}

impl TreeStatistics {
    /// The shape of a tree laid out depth-first.
    pub fn of(tree: &SkipTree) -> Self {
        let mut statistics = Self {
            nodes: tree.nodes.len(),
            bytes: tree.nodes.len() * size_of::<SkipNode>(),
            ..Self::default()
        };
        let mut shares = (0usize, 0.0f64);
        // The ends of the subtrees that hold the node at hand: as many as it is deep.
        let mut open: Vec<u32> = Vec::new();
        for (index, node) in tree.nodes.iter().enumerate() {
            while open.last().is_some_and(|end| *end as usize <= index) {
                open.pop();
            }
            open.push(node.end);
            statistics.depth = statistics.depth.max(open.len());
            statistics.triangles += u64::from(node.triangles);
            let (mut fan_out, mut heaviest) = (0, 0);
            for child in tree.children(index as u32) {
                fan_out += 1;
                heaviest = heaviest.max(tree.nodes[child as usize].end - child);
            }
            statistics.widest_fan_out = statistics.widest_fan_out.max(fan_out);
            if fan_out == 0 {
                statistics.leaves += 1;
                statistics.leaf_depths.resize(statistics.depth, 0);
                statistics.leaf_depths[open.len() - 1] += 1;
            } else if fan_out > 1 {
                let share = f64::from(heaviest) / (f64::from(node.end) - index as f64 - 1.0);
                shares = (shares.0 + 1, shares.1 + share);
                statistics.max_heaviest_share = statistics.max_heaviest_share.max(share);
            }
        }
        if shares.0 > 0 {
            statistics.mean_heaviest_share = shares.1 / shares.0 as f64;
        }
        statistics
    }
}
