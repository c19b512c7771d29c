//! New boxes for a hierarchy whose items have moved: the same nodes, from the leaves up (Ize ch. 7.6).

use super::{BinaryBvh, BinaryNode};
use crate::geometry::Aabb;

/// Gives every node the box around what is below it now.
///
/// # Panics
/// If the hierarchy holds an item that has no box.
pub fn refit(bvh: &mut BinaryBvh, boxes: &[Aabb]) {
    refit_with(bvh, |item| boxes[item as usize]);
}

/// The same with boxes that are made as they are asked for, once for each time an item is in the order.
pub fn refit_with(bvh: &mut BinaryBvh, bounds: impl Fn(u32) -> Aabb) {
    below(&mut bvh.nodes, 0, &bvh.order, &bounds);
}

/// Refits nodes of which the first is number `first`; all that is below any of them is among them.
pub fn below(nodes: &mut [BinaryNode], first: usize, order: &[u32], bounds: &impl Fn(u32) -> Aabb) {
    // Children come after their parent.
    for i in (0..nodes.len()).rev() {
        let node = nodes[i];
        nodes[i].bounds = if node.is_leaf() {
            let items = order[node.items()].iter();
            items.fold(Aabb::EMPTY, |around, item| around.union(bounds(*item)))
        } else {
            let [left, right] = node.children().map(|child| nodes[child - first].bounds);
            left.union(right)
        };
    }
}
