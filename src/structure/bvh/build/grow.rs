//! Growing a hierarchy downwards: what all builders that cut a node's items in two have in common.
//!
//! Items are copied with their boxes and moved between two places, each side keeping its order, so a node's items lie
//! side by side and the next cut reads straight through them. It costs twice 32 bytes an item.

use super::bins::{Bins, Split, around, part};
use super::effort::Effort;
use super::few::Parting;
use super::lanes::{Box8, Item, Unit};
use crate::structure::bvh::BinaryNode;

/// Below this many nodes from the root, items are halved as they lie: boxes that grow by powers would otherwise make
/// a hierarchy as deep as there are powers of two.
pub(super) const DEEPEST_CUT: u32 = 64;

/// Where a node's items are: the box around them, and the box around their middles, twice its size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) bounds: Box8,
    pub(super) middles: Box8,
}

impl Extent {
    pub(super) const EMPTY: Self = Self { bounds: Box8::EMPTY, middles: Box8::EMPTY };

    #[inline(always)]
    pub(super) fn union(&self, other: &Self) -> Self {
        Self { bounds: self.bounds.union(&other.bounds), middles: self.middles.union(&other.middles) }
    }
}

/// Along each there are bins.
pub(super) const AXES: u64 = 3;

/// What becomes of a node.
pub(super) enum Cut {
    Leaf,
    /// Two halves of its items as they lie.
    Halves,
    Plane(Split),
    /// A few items parted whichever way is best.
    Few(Parting),
}

/// How nodes are cut.
pub(super) trait Rule: Sync {
    fn unit(&self) -> Unit;
    /// The most items in a leaf, where they can be told apart or not.
    fn most_in_leaf(&self) -> usize;
    /// Bins an axis that a node of so many items, at least two, is weighed by; none if it is not weighed.
    fn bins(&self, items: usize) -> usize;
    /// What becomes of a node of at least two items.
    fn cut(&self, items: &[Item], extent: &Extent, bins: &mut Bins) -> Cut;

    /// Whether a node at a depth may be cut as the rule has it.
    fn may_cut(&self, depth: u32) -> bool {
        depth < DEEPEST_CUT
    }

    /// The same, so that depth and leaves have their bounds.
    fn cut_within(&self, items: &[Item], extent: &Extent, depth: u32, bins: &mut Bins) -> Cut {
        let cut = match items.len() {
            1 => Cut::Leaf,
            _ if !self.may_cut(depth) => Cut::Halves,
            _ => self.cut(items, extent, bins),
        };
        match cut {
            Cut::Halves if items.len() <= self.most_in_leaf() => Cut::Leaf,
            Cut::Leaf if items.len() > self.most_in_leaf() => Cut::Halves,
            cut => cut,
        }
    }
}

/// The items of a part of the hierarchy: in the first of two places, the second as long; and their part of the order.
pub(super) struct Plot<'a> {
    pub(super) items: [&'a mut [Item]; 2],
    pub(super) order: &'a mut [u32],
    /// Where that part begins.
    pub(super) first: usize,
}

/// A node that is still to be cut.
struct Open {
    node: usize,
    range: std::ops::Range<usize>,
    depth: u32,
    /// Which of the two places its items are in.
    place: usize,
    extent: Extent,
}

/// What growing needs beside the items, kept from one time to the next.
pub(super) struct Shed {
    pub(super) bins: Box<Bins>,
    open: Vec<Open>,
}

impl Shed {
    pub(super) fn new() -> Self {
        Self { bins: Bins::new(), open: Vec::new() }
    }
}

/// A node whose children or items are not known yet.
pub(super) fn budding(bounds: &Box8) -> BinaryNode {
    BinaryNode { bounds: bounds.aabb(), first: 0, count: 0 }
}

/// Grows the hierarchy over at least one item, its root at a depth, into nodes that are cleared before; their numbers
/// are from 0. Returns what it did.
pub(super) fn grow<R: Rule>(
    rule: &R,
    plot: Plot<'_>,
    extent: Extent,
    depth: u32,
    nodes: &mut Vec<BinaryNode>,
    shed: &mut Shed,
) -> Effort {
    let mut effort = Effort::default();
    let Plot { mut items, order, first } = plot;
    nodes.clear();
    nodes.push(budding(&extent.bounds));
    shed.open.clear();
    shed.open.push(Open { node: 0, range: 0..order.len(), depth, place: 0, extent });
    while let Some(Open { node, range, depth, place, extent }) = shed.open.pop() {
        let [one, other] = &mut items;
        let (from, to) = if place == 0 { (&**one, &mut **other) } else { (&**other, &mut **one) };
        let from = &from[range.clone()];
        let cut = rule.cut_within(from, &extent, depth, &mut shed.bins);
        if from.len() > 1 && rule.may_cut(depth) {
            let bins = rule.bins(from.len()) as u64;
            effort.bins += AXES * bins;
            effort.binned += if bins > 0 { from.len() as u64 } else { 0 };
            effort.few += u64::from(bins == 0);
        }
        effort.moved += if matches!(cut, Cut::Leaf) { 0 } else { from.len() as u64 };
        let (left, place, extents) = match cut {
            Cut::Leaf => {
                nodes[node].first = (first + range.start) as u32;
                nodes[node].count = range.len() as u32;
                for (place, item) in order[range].iter_mut().zip(from) {
                    *place = item.number();
                }
                continue;
            }
            Cut::Halves => {
                let (left, right) = from.split_at(from.len() / 2);
                let extents = [left, right].map(|side| {
                    let [bounds, middles] = around(rule.unit(), side);
                    Extent { bounds, middles }
                });
                (left.len(), place, extents)
            }
            Cut::Few(parting) => {
                parting.part(from, &mut to[range.clone()]);
                // No middles: those are looked at where there are more than a few items.
                let extents = parting.bounds.map(|bounds| Extent { bounds, middles: Box8::EMPTY });
                (parting.count(), 1 - place, extents)
            }
            Cut::Plane(split) => {
                let (left, right) = to[range.clone()].split_at_mut(split.left);
                let middles = part(rule.unit(), from, &split.plane, [left, right]);
                let extents =
                    [0, 1].map(|side| Extent { bounds: split.bounds[side], middles: middles[side] });
                (split.left, 1 - place, extents)
            }
        };
        let (pair, middle) = (nodes.len(), range.start + left);
        nodes[node].first = pair as u32;
        nodes.extend(extents.each_ref().map(|extent| budding(&extent.bounds)));
        let [a, b] = extents;
        let depth = depth + 1;
        shed.open.push(Open { node: pair + 1, range: middle..range.end, depth, place, extent: b });
        shed.open.push(Open { node: pair, range: range.start..middle, depth, place, extent: a });
    }
    effort.nodes = nodes.len() as u64;
    effort
}
