//! A binary hierarchy, as builders make it.

use crate::geometry::Aabb;
use crate::structure::TreeError;

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
///
/// Nodes are numbered depth first, two at a time: all that is below a first child comes before all that is below the
/// second. So what is below a node lies side by side, and the leaves take up the order from its start to its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BinaryBvh {
    /// The nodes.
    pub nodes: Vec<BinaryNode>,
    /// Item numbers, in the order of the leaves. With spatial splits an item may be there more than once.
    pub order: Vec<u32>,
}

/// What there is to say of a hierarchy's shape.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BvhStatistics {
    /// Nodes, leaves among them.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Nodes on the longest way from the root to a leaf; 0 if there are none.
    pub depth: usize,
    /// How many leaves have so many items, by their number; there are no leaves without.
    pub leaves_by_items: Vec<usize>,
    /// Items in all leaves, one that is in several counted as often.
    pub references: usize,
    /// Bytes of nodes and order.
    pub bytes: usize,
}

impl BinaryNode {
    /// Whether it has items and no children.
    pub fn is_leaf(&self) -> bool {
        self.count > 0
    }

    /// The children of an inner node.
    pub fn children(&self) -> [usize; 2] {
        [self.first as usize, self.first as usize + 1]
    }

    /// Where the items of a leaf are in the order.
    pub fn items(&self) -> std::ops::Range<usize> {
        self.first as usize..self.first as usize + self.count as usize
    }
}

impl BinaryBvh {
    /// What a ray is expected to cost by the surface area heuristic (MacDonald and Booth 1990), in the unit of the
    /// two costs: `step` for an inner node it enters, `item` for an item it is tested against, both weighed by the
    /// area of the node over the root's. 0 without nodes, and where the root has no area the cost of going everywhere.
    pub fn cost(&self, step: f64, item: f64) -> f64 {
        let Some(root) = self.nodes.first() else { return 0.0 };
        let whole = half_area(&root.bounds);
        let weigh = |node: &BinaryNode| {
            let share = if whole > 0.0 { half_area(&node.bounds) / whole } else { 1.0 };
            share * if node.is_leaf() { item * f64::from(node.count) } else { step }
        };
        self.nodes.iter().map(weigh).sum()
    }

    /// Which nodes are below one.
    ///
    /// # Panics
    /// If there is no such node.
    pub fn below(&self, node: usize) -> std::ops::Range<usize> {
        let start = self.nodes[node].first as usize;
        let (mut at, mut end) = (node, start);
        // What is numbered last is below the second child, or below the first if that is a leaf.
        while !self.nodes[at].is_leaf() {
            let [left, right] = self.nodes[at].children();
            end = right + 1;
            at = if self.nodes[right].is_leaf() { left } else { right };
        }
        if at == node { 0..0 } else { start..end }
    }

    /// Counts what there is. The hierarchy is valid.
    pub fn statistics(&self) -> BvhStatistics {
        let mut told = BvhStatistics {
            nodes: self.nodes.len(),
            bytes: size_of_val(&*self.nodes) + size_of_val(&*self.order),
            ..Default::default()
        };
        let mut depths = vec![1; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate() {
            told.depth = told.depth.max(depths[i]);
            if node.is_leaf() {
                let count = node.count as usize;
                told.leaves += 1;
                told.references += count;
                if told.leaves_by_items.len() <= count {
                    told.leaves_by_items.resize(count + 1, 0);
                }
                told.leaves_by_items[count] += 1;
            } else {
                let below = depths[i] + 1;
                node.children().into_iter().for_each(|child| depths[child] = below);
            }
        }
        told
    }

    /// Checks the hierarchy over items with these boxes: nodes numbered as promised; leaves that take up the whole
    /// order; every item in it; the box of an inner node exactly around its children's; each item within the leaves
    /// that hold it, taken together.
    ///
    /// # Errors
    /// [`TreeError`]: the first node that breaks it, or 0 where the fault is in no single one.
    pub fn validate(&self, boxes: &[Aabb]) -> Result<(), TreeError> {
        if self.nodes.is_empty() {
            let empty = self.order.is_empty() && boxes.is_empty();
            return if empty { Ok(()) } else { Err(TreeError::new(0, "there are items and no nodes")) };
        }
        let mut held = vec![Aabb::EMPTY; boxes.len()];
        // The walk is in the order of numbering: the pair of an inner node is the next there is.
        let (mut next_node, mut next_item) = (1, 0);
        let mut open = vec![0];
        while let Some(at) = open.pop() {
            let node = &self.nodes[at];
            let fault = |fault: String| Err(TreeError::new(at, fault));
            if node.bounds.is_nan() || node.bounds.is_empty() {
                return fault(format!("its box holds no point: {:?}", node.bounds));
            }
            if node.is_leaf() {
                if node.first as usize != next_item {
                    return fault(format!("its items begin at {}, not at {next_item}", node.first));
                }
                let Some(items) = self.order.get(node.items()) else {
                    return fault(format!("{} items do not end in the order", node.count));
                };
                next_item += items.len();
                for item in items {
                    let Some(held) = held.get_mut(*item as usize) else {
                        return fault(format!("there is no item {item}"));
                    };
                    *held = held.union(node.bounds);
                }
                continue;
            }
            if node.first as usize != next_node || next_node + 2 > self.nodes.len() {
                return fault(format!("its children are at {}, not at {next_node}", node.first));
            }
            next_node += 2;
            let [left, right] = node.children().map(|child| self.nodes[child].bounds);
            if node.bounds != left.union(right) {
                return fault(format!("{:?} is not around {left:?} and {right:?} alone", node.bounds));
            }
            open.extend(node.children().iter().rev());
        }
        if next_node != self.nodes.len() {
            return Err(TreeError::new(next_node, "no node leads here"));
        }
        if next_item != self.order.len() {
            return Err(TreeError::new(0, format!("the leaves end at {next_item} of the order")));
        }
        match held.iter().zip(boxes).position(|(held, item)| item.is_empty() || !held.contains(item)) {
            Some(item) => {
                Err(TreeError::new(0, format!("item {item} is not within the leaves that hold it")))
            }
            None => Ok(()),
        }
    }
}

/// Half the surface, in square metres.
fn half_area(bounds: &Aabb) -> f64 {
    let size = bounds.max.as_dvec3() - bounds.min.as_dvec3();
    size.x * size.y + size.y * size.z + size.z * size.x
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn at(x: f32) -> Aabb {
        Aabb { min: Vec3::splat(x), max: Vec3::splat(x + 1.0) }
    }

    /// Three items: the first two in a leaf, the third alone.
    fn sound() -> (BinaryBvh, Vec<Aabb>) {
        let boxes = vec![at(0.0), at(1.0), at(5.0)];
        let nodes = vec![
            BinaryNode { bounds: at(0.0).union(at(5.0)), first: 1, count: 0 },
            BinaryNode { bounds: at(0.0).union(at(1.0)), first: 0, count: 2 },
            BinaryNode { bounds: at(5.0), first: 2, count: 1 },
        ];
        (BinaryBvh { nodes, order: vec![1, 0, 2] }, boxes)
    }

    #[test]
    fn whatever_is_broken_is_found() {
        let (bvh, boxes) = sound();
        bvh.validate(&boxes).expect("it is sound");
        BinaryBvh::default().validate(&[]).expect("nothing is");
        BinaryBvh::default().validate(&boxes).expect_err("items without nodes");
        type Breaking = fn(&mut BinaryBvh);
        let broken: [(&str, Breaking); 16] = [
            ("a child elsewhere", |bvh| bvh.nodes[0].first = 2),
            ("a child before its parent", |bvh| bvh.nodes[0].first = 0),
            ("a child that is not there", |bvh| bvh.nodes.truncate(2)),
            ("a node nobody leads to", |bvh| bvh.nodes.push(bvh.nodes[2])),
            ("a leaf that begins late", |bvh| bvh.nodes[1].first = 1),
            ("a leaf that ends late", |bvh| bvh.nodes[2].count = 2),
            ("a leaf that ends early", |bvh| bvh.nodes[1].count = 1),
            ("a leaf that never ends", |bvh| bvh.nodes[2].count = u32::MAX),
            ("an order that goes on", |bvh| bvh.order.push(0)),
            ("an item that is not there", |bvh| bvh.order[1] = 3),
            ("an item in the wrong leaf", |bvh| bvh.order.swap(1, 2)),
            ("an item left out", |bvh| bvh.order[0] = 0),
            ("a root too small", |bvh| bvh.nodes[0].bounds.max.x -= 0.5),
            ("a root too large", |bvh| bvh.nodes[0].bounds.max.y += 0.5),
            ("a leaf too small", |bvh| bvh.nodes[2].bounds.min.z += 0.5),
            ("a box that is no number", |bvh| bvh.nodes[2].bounds.min.z = f32::NAN),
        ];
        for (what, breaking) in broken {
            let mut bvh = bvh.clone();
            breaking(&mut bvh);
            assert!(bvh.validate(&boxes).is_err(), "{what} goes unnoticed");
        }
        let more = [&boxes[..], &[at(0.5)]].concat();
        bvh.validate(&more).expect_err("an item is nowhere");
        bvh.validate(&[at(0.0), at(1.0), Aabb::EMPTY]).expect_err("an item has no box");
    }

    #[test]
    fn what_is_told_is_so() {
        let (bvh, _) = sound();
        let told = bvh.statistics();
        let expected = BvhStatistics {
            nodes: 3,
            leaves: 2,
            depth: 2,
            leaves_by_items: vec![0, 1, 1],
            references: 3,
            bytes: 3 * 32 + 3 * 4,
        };
        assert_eq!(told, expected);
        // Cubes of sides 6, 2 and 1: a step at the root, two items in a ninth of its surface, one in a 36th.
        assert!((bvh.cost(1.0, 3.0) - (1.0 + 6.0 / 9.0 + 3.0 / 36.0)).abs() < 1e-12);
        assert_eq!((bvh.below(0), bvh.below(1), bvh.below(2)), (1..3, 0..0, 0..0));
        assert_eq!(BinaryBvh::default().cost(1.0, 1.0), 0.0);
        assert_eq!(BinaryBvh::default().statistics(), BvhStatistics::default());
    }
}
