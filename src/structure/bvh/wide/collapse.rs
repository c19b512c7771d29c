//! Which nodes of a binary hierarchy a wide one keeps: those for which its expected cost is least (Ylitie, Karras and
//! Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", sec. 3.1).
//!
//! `cost[n][j - 1]` is the least cost of what is below binary node `n` when a node above has `j` places for it:
//! either it becomes one child (a leaf, or a node of its own) or its places are dealt out to its two halves. Children
//! come after their parents, so costs are found from the last node to the first. A cost is the surface of a box times
//! what a visit there takes.

use super::layout::{Child, Node, WIDTH};
use crate::geometry::Aabb;
use crate::geometry::hit::Scale;
use crate::structure::bvh::{BinaryBvh, BinaryNode};

/// What a visit to a node takes, in visits to a leaf's items. Between 0.6 and 1 nothing changes that rays notice.
const NODE: f32 = 1.0;

/// What comes of a collapse.
pub(super) struct Collapsed {
    pub(super) root: Child,
    pub(super) nodes: Vec<Node>,
    pub(super) waiting: usize,
}

/// What leaves are made of.
pub(super) trait Leaves {
    /// Most items of a leaf; they are visited together.
    const MOST: usize;
    /// Whether a ray can ever meet an item.
    fn can_be_met(&self, item: u32) -> bool;
    /// A box around an item that can be met, in the scale's lengths.
    fn bounds(&self, item: u32) -> Aabb;
    /// Lays down a leaf of some items, from one to the most there may be.
    fn lay(&mut self, items: &[u32]) -> Child;
}

/// A binary node as the collapse sees it.
struct Plan {
    node: BinaryNode,
    /// Items below.
    items: usize,
    /// Least cost by places, 1 to 7.
    cost: [f32; WIDTH - 1],
    /// By places less 1, and last for all eight: how many the first child gets; 0 if it becomes one child or a place
    /// stays free.
    first_gets: [u8; WIDTH],
    /// Whether one child is best made a leaf.
    is_leaf: bool,
}

struct Making<'a, L> {
    plans: Vec<Plan>,
    order: Vec<u32>,
    leaves: &'a mut L,
    nodes: Vec<Node>,
}

pub(super) fn collapse<L: Leaves>(binary: &BinaryBvh, leaves: &mut L, scale: Scale) -> Collapsed {
    let (nodes, order) = small_leaves(binary, leaves, scale);
    let mut making = Making { plans: plan::<L>(nodes), order, leaves, nodes: Vec::new() };
    let (root, waiting) = making.make();
    Collapsed { root, nodes: making.nodes, waiting }
}

/// The surface of a box, in the scale's square lengths; 0 of an empty one.
fn surface(bounds: &Aabb) -> f32 {
    let size = bounds.size();
    2.0 * (size.x * size.y + size.y * size.z + size.z * size.x)
}

/// The nodes in the scale's lengths; leaves with more items than a leaf may have are halved until they have not, and
/// what can never be hit is left out.
fn small_leaves<L: Leaves>(binary: &BinaryBvh, leaves: &L, scale: Scale) -> (Vec<BinaryNode>, Vec<u32>) {
    let mut order = Vec::with_capacity(binary.order.len());
    let mut nodes: Vec<BinaryNode> = Vec::with_capacity(binary.nodes.len());
    for node in &binary.nodes {
        let bounds = Aabb { min: scale.point(node.bounds.min), max: scale.point(node.bounds.max) };
        let mut kept = BinaryNode { bounds, ..*node };
        if node.is_leaf() {
            let (first, items) = (node.first as usize, node.count as usize);
            kept.first = order.len() as u32;
            let items = binary.order[first..first + items].iter().copied();
            order.extend(items.filter(|item| leaves.can_be_met(*item)));
            kept.count = order.len() as u32 - kept.first;
        }
        nodes.push(kept);
    }
    // Behind all others, so that children still come after their parents.
    let mut next = 0;
    while let Some(node) = nodes.get(next).copied() {
        let was_leaf = next >= binary.nodes.len() || binary.nodes[next].is_leaf();
        if was_leaf && node.count as usize > L::MOST {
            let half = node.count / 2;
            let children = [(node.first, half), (node.first + half, node.count - half)];
            nodes[next] = BinaryNode { first: nodes.len() as u32, count: 0, ..node };
            nodes.extend(children.map(|(first, count)| {
                let items = &order[first as usize..(first + count) as usize];
                let around = items.iter().map(|item| leaves.bounds(*item)).fold(Aabb::EMPTY, Aabb::union);
                // With spatial splits a leaf's box may be smaller than its items'.
                let bounds =
                    Aabb { min: around.min.max(node.bounds.min), max: around.max.min(node.bounds.max) };
                BinaryNode { bounds, first, count }
            }));
        } else if was_leaf && node.count == 0 {
            // Nothing is left of it: a box that no ray meets.
            nodes[next] = BinaryNode { bounds: Aabb::EMPTY, first: NOTHING, count: 0 };
        }
        next += 1;
    }
    (nodes, order)
}

/// In place of a first child or item: a leaf without items.
const NOTHING: u32 = u32::MAX;

fn plan<L: Leaves>(nodes: Vec<BinaryNode>) -> Vec<Plan> {
    let mut plans: Vec<Plan> = nodes
        .into_iter()
        .map(|node| Plan {
            node,
            items: node.count as usize,
            cost: [0.0; WIDTH - 1],
            first_gets: [0; WIDTH],
            is_leaf: true,
        })
        .collect();
    for at in (0..plans.len()).rev() {
        let node = plans[at].node;
        let surface = surface(&node.bounds);
        if node.is_leaf() || node.first == NOTHING {
            plans[at].cost = [surface * plans[at].items.div_ceil(L::MOST) as f32; WIDTH - 1];
            continue;
        }
        let first = node.first as usize;
        assert!(first > at && first + 1 < plans.len(), "children come after their parent");
        let (a, b) = (&plans[first], &plans[first + 1]);
        let items = a.items + b.items;
        let deal = |places: usize| {
            let costs = (1..places).map(|gets| (a.cost[gets - 1] + b.cost[places - gets - 1], gets));
            costs.min_by(|x, y| x.0.total_cmp(&y.0)).unwrap_or((f32::INFINITY, 0))
        };
        let mut made = Plan { node, items, cost: [0.0; WIDTH - 1], first_gets: [0; WIDTH], is_leaf: false };
        let (below, gets) = deal(WIDTH);
        made.first_gets[WIDTH - 1] = gets as u8;
        let as_node = below + surface * NODE;
        let as_leaf = if items <= L::MOST { surface * items.div_ceil(L::MOST) as f32 } else { f32::INFINITY };
        made.is_leaf = as_leaf <= as_node;
        made.cost[0] = as_leaf.min(as_node);
        for places in 2..WIDTH {
            let (dealt, gets) = deal(places);
            let alone = made.cost[places - 2];
            made.cost[places - 1] = dealt.min(alone);
            made.first_gets[places - 1] = if dealt < alone { gets as u8 } else { 0 };
        }
        plans[at] = made;
    }
    plans
}

impl<L: Leaves> Making<'_, L> {
    /// Makes all nodes and blocks. Tells the root, and how many children may wait on a way down.
    fn make(&mut self) -> (Child, usize) {
        if self.plans.first().is_none_or(|root| root.items == 0) {
            return (Child::NONE, 0);
        }
        // Always a node, so that a ray is held against the root's box too.
        self.nodes.push(Node::EMPTY);
        let mut most = 0;
        // Wide node, the binary node it stands for, and how many wait when a ray comes there.
        let mut open = vec![(0, 0, 0)];
        while let Some((wide, binary, waiting)) = open.pop() {
            let children = self.children(binary);
            let below = waiting + children.len();
            most = most.max(below);
            let mut node = Node::EMPTY;
            let inner = children.iter().filter(|&&child| !self.plans[child].is_leaf).count();
            let mut next = self.nodes.len();
            self.nodes.resize_with(next + inner, || Node::EMPTY);
            let first = open.len();
            for (i, child) in children.into_iter().enumerate() {
                let bounds = self.plans[child].node.bounds;
                let made = if self.plans[child].is_leaf {
                    self.leaf(child)
                } else {
                    open.push((next, child, below));
                    next += 1;
                    Child::node(next - 1)
                };
                node.set(i, &bounds, made);
            }
            open[first..].reverse();
            self.nodes[wide] = node;
        }
        (Child::node(0), most)
    }

    /// The binary nodes that become the children of the wide node that stands for one.
    fn children(&self, binary: usize) -> Vec<usize> {
        if self.plans[binary].is_leaf {
            return vec![binary];
        }
        let mut found = Vec::with_capacity(WIDTH);
        let mut open = vec![(binary, WIDTH)];
        while let Some((at, places)) = open.pop() {
            let plan = &self.plans[at];
            // Places that are not worth filling stay free.
            let dealt = (2..=places).rev().find(|&places| places == WIDTH || plan.first_gets[places - 1] > 0);
            match dealt {
                Some(places) => {
                    let gets = usize::from(plan.first_gets[places - 1]);
                    let first = plan.node.first as usize;
                    open.extend([(first + 1, places - gets), (first, gets)]);
                }
                None if plan.items > 0 => found.push(at),
                None => {}
            }
        }
        found
    }

    fn leaf(&mut self, binary: usize) -> Child {
        let mut items = Vec::new();
        let mut open = vec![binary];
        while let Some(at) = open.pop() {
            let node = self.plans[at].node;
            if node.is_leaf() {
                items.extend_from_slice(&self.order[node.first as usize..(node.first + node.count) as usize]);
            } else if node.first != NOTHING {
                open.extend([node.first as usize + 1, node.first as usize]);
            }
        }
        self.leaves.lay(&items)
    }
}
