//! What rays through a wide hierarchy are expected to cost.

use super::layout::{Child, Node};
use super::{BoxBvh, WIDTH, WideBvh};
use crate::geometry::Aabb;
use crate::geometry::hit::TriangleTest;

impl<T: TriangleTest> WideBvh<T> {
    /// How many nodes and blocks a ray is expected to go through that meets the box around all, if rays come from
    /// everywhere alike: each one's surface as a share of that box's (MacDonald and Booth 1990). 0 where there is nothing.
    pub fn expected_cost(&self) -> f64 {
        expected(&self.nodes, |leaf| leaf.blocks() as f64)
    }
}

impl BoxBvh {
    /// The same, where what is in a place takes so much.
    pub(in crate::structure::bvh) fn expected_cost(&self, item: impl Fn(usize) -> f64) -> f64 {
        expected(&self.nodes, |leaf| item(leaf.index()))
    }
}

fn expected(nodes: &[Node], leaf: impl Fn(Child) -> f64) -> f64 {
    let surface = |bounds: &Aabb| {
        let size = bounds.size().as_dvec3();
        size.x * size.y + size.y * size.z + size.z * size.x
    };
    let Some(root) = nodes.first() else { return 0.0 };
    let whole = surface(&root.boxes().fold(Aabb::EMPTY, Aabb::union));
    let mut visits = 1.0;
    for (node, i) in nodes.iter().flat_map(|node| (0..WIDTH).map(move |i| (node, i))) {
        let (child, around) = (node.children[i], node.bounds(i));
        if child == Child::NONE || around.is_empty() {
            continue;
        }
        let below = if child.blocks() == 0 { 1.0 } else { leaf(child) };
        // All in one point: every ray that comes there goes through all of it.
        visits += below * if whole > 0.0 { surface(&around) / whole } else { 1.0 };
    }
    visits
}
