//! New boxes for a hierarchy whose items have moved: the same nodes, from the leaves up (Ize ch. 7.6).

use super::{BinaryBvh, BinaryNode};
use crate::geometry::Aabb;
use std::ops::Range;

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

/// What was given new boxes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refitted {
    /// Nodes.
    pub nodes: usize,
    /// Items of theirs whose boxes were asked for.
    pub items: usize,
}

/// Refits nodes of which the first is number `first`; all that is below any of them is among them. Returns how many items
/// they have.
fn below(nodes: &mut [BinaryNode], first: usize, order: &[u32], bounds: &impl Fn(u32) -> Aabb) -> usize {
    let mut asked = 0;
    // Children come after their parent.
    for i in (0..nodes.len()).rev() {
        let node = nodes[i];
        nodes[i].bounds = if node.is_leaf() {
            asked += node.count as usize;
            let items = order[node.items()].iter();
            items.fold(Aabb::EMPTY, |around, item| around.union(bounds(*item)))
        } else {
            let [left, right] = node.children().map(|child| nodes[child - first].bounds);
            left.union(right)
        };
    }
    asked
}

/// A hierarchy's subtrees at a level, none of which is much larger than the others, and the nodes above them.
#[derive(Clone, Debug)]
pub struct Cut {
    nodes: usize,
    /// Their roots, and what is below each, the largest first.
    subtrees: Vec<(usize, Range<usize>)>,
    /// For each node of those above, in rising order, the subtree it is the root of.
    above: Vec<(usize, Option<usize>)>,
}

/// One subtree's nodes.
#[derive(Debug)]
pub struct Part<'a> {
    root: BinaryNode,
    nodes: &'a mut [BinaryNode],
    order: &'a [u32],
}

/// The nodes above the subtrees, and their roots.
#[derive(Debug)]
pub struct Above<'a> {
    nodes: Vec<(usize, Option<usize>, &'a mut BinaryNode)>,
}

impl Cut {
    /// Lists at least `wanted` subtrees, if there are as many nodes to be had, by parting the largest again and again.
    pub fn new(bvh: &BinaryBvh, wanted: usize) -> Self {
        let mut open = std::collections::BinaryHeap::new();
        let mut above = Vec::new();
        if !bvh.nodes.is_empty() {
            open.push((bvh.nodes.len() - 1, std::cmp::Reverse(0)));
        }
        while let Some((below, std::cmp::Reverse(node))) = open.peek().copied() {
            if open.len() >= wanted || below == 0 {
                break;
            }
            open.pop();
            above.push((node, None));
            for child in bvh.nodes[node].children() {
                open.push((bvh.below(child).len(), std::cmp::Reverse(child)));
            }
        }
        let roots = open.into_sorted_vec().into_iter().rev().map(|(_, std::cmp::Reverse(node))| node);
        let subtrees: Vec<_> = roots.map(|root| (root, bvh.below(root))).collect();
        above.extend(subtrees.iter().enumerate().map(|(number, (root, _))| (*root, Some(number))));
        above.sort_unstable();
        Self { nodes: bvh.nodes.len(), subtrees, above }
    }

    /// Parts the hierarchy it was made of, or one of the same nodes.
    ///
    /// # Panics
    /// If it has not as many nodes.
    pub fn part<'a>(&self, bvh: &'a mut BinaryBvh) -> (Vec<Part<'a>>, Above<'a>) {
        assert_eq!(bvh.nodes.len(), self.nodes, "the subtrees are of a hierarchy of as many nodes");
        let roots: Vec<BinaryNode> = self.subtrees.iter().map(|(root, _)| bvh.nodes[*root]).collect();
        let mut ranges: Vec<(Range<usize>, usize)> =
            self.subtrees.iter().enumerate().map(|(number, (_, below))| (below.clone(), number)).collect();
        ranges.sort_unstable_by_key(|(below, _)| (below.start, below.end));
        let mut parts: Vec<&mut [BinaryNode]> = self.subtrees.iter().map(|_| &mut [][..]).collect();
        let (mut rest, mut at) = (&mut bvh.nodes[..], 0);
        let mut between = Vec::with_capacity(self.above.len());
        for (below, number) in ranges.into_iter().filter(|(below, _)| !below.is_empty()) {
            between.extend(cut_off(&mut rest, below.start - at).iter_mut());
            at = below.end;
            parts[number] = cut_off(&mut rest, below.len());
        }
        between.extend(rest);
        let nodes = self.above.iter().zip(between).map(|((node, subtree), place)| (*node, *subtree, place));
        let above = Above { nodes: nodes.collect() };
        let order = &bvh.order;
        let parts = roots.into_iter().zip(parts);
        let parts = parts.map(|(root, nodes)| Part { root, nodes, order });
        (parts.collect(), above)
    }
}

impl Part<'_> {
    /// Refits the nodes below the root; returns the root's box, and what was refitted.
    pub fn refit(self, bounds: &impl Fn(u32) -> Aabb) -> (Aabb, Refitted) {
        if self.root.is_leaf() {
            let mut alone = [self.root];
            let items = below(&mut alone, 0, self.order, bounds);
            return (alone[0].bounds, Refitted { nodes: 0, items });
        }
        let items = below(self.nodes, self.root.first as usize, self.order, bounds);
        let root = self.nodes[0].bounds.union(self.nodes[1].bounds);
        (root, Refitted { nodes: self.nodes.len(), items })
    }
}

impl Above<'_> {
    /// Refits the nodes above, given the box of each subtree's root; returns what was refitted.
    pub fn refit(mut self, roots: impl Fn(usize) -> Aabb) -> Refitted {
        for i in (0..self.nodes.len()).rev() {
            let bounds = match self.nodes[i].1 {
                Some(subtree) => roots(subtree),
                None => {
                    let [left, right] = self.nodes[i].2.children().map(|child| {
                        let at = self.nodes.binary_search_by_key(&child, |(node, ..)| *node);
                        self.nodes[at.expect("what is above has its children there")].2.bounds
                    });
                    left.union(right)
                }
            };
            self.nodes[i].2.bounds = bounds;
        }
        Refitted { nodes: self.nodes.len(), items: 0 }
    }
}

/// Cuts off the first of a slice.
fn cut_off<'a, T>(slice: &mut &'a mut [T], length: usize) -> &'a mut [T] {
    let (first, rest) = std::mem::take(slice).split_at_mut(length);
    *slice = rest;
    first
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::bvh::build::{Builder, Input, Settings};
    use glam::Vec3;

    #[test]
    fn subtrees_and_what_is_above_make_up_the_whole() {
        let boxes = |turn: f32| -> Vec<Aabb> {
            let at = |i: usize| Vec3::new((i * 7 % 31) as f32, (i * 11 % 17) as f32, turn * (i % 13) as f32);
            (0..500).map(at).map(|at| Aabb { min: at, max: at + 1.0 }).collect()
        };
        for count in [0, 1, 2, 3, 10, 500] {
            let (before, after) = (&boxes(1.0)[..count], &boxes(-3.0)[..count]);
            let mut bvh = BinaryBvh::default();
            Builder::new("binned_sah", &Settings::default())
                .unwrap()
                .build(&Input::of(before), &mut bvh)
                .unwrap();
            let mut serial = bvh.clone();
            refit(&mut serial, after);
            serial.validate(after).unwrap();
            for wanted in [1, 2, 7, 64, 5000] {
                let cut = Cut::new(&bvh, wanted);
                let mut parted = bvh.clone();
                let (parts, above) = cut.part(&mut parted);
                assert!(parts.len() >= wanted.min(serial.statistics().leaves));
                let roots: Vec<Aabb> =
                    parts.into_iter().map(|part| part.refit(&|item| after[item as usize]).0).collect();
                above.refit(|subtree| roots[subtree]);
                assert_eq!(parted, serial, "{count} items, {wanted} subtrees");
            }
        }
    }
}
