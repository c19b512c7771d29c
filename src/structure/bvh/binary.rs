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
