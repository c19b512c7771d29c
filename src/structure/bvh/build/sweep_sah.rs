//! The surface area heuristic, exactly (Goldsmith and Salmon 1987; MacDonald and Booth 1990; Ize ch. 7.4, I7-04): along
//! each axis every cut between two items, in the order of their middles, is weighed.
//!
//! Items are sorted once along each axis. A cut marks each item with its side, and the three lists are parted by
//! the marks, which keeps them sorted. Items whose middles agree come by their number.

use super::binned_sah::SahRule;
use super::grow::{DEEPEST_CUT, Rule, budding};
use super::lanes::{Box8, Item, Lanes, on_unit};
use super::yard::{load_all, make_room};
use super::{BuildError, Input, Settings};
use crate::structure::bvh::BinaryBvh;
use std::ops::Range;

pub(super) const SUMMARY: &str = "surface area heuristic, every cut weighed (Goldsmith and Salmon 1987)";

/// Builds so, and keeps its buffers.
pub(super) struct SweepSah {
    rule: SahRule,
    items: Vec<Item>,
    /// Item numbers along each axis.
    along: [Vec<u32>; 3],
    is_right: Vec<bool>,
    numbers: Vec<u32>,
    costs: Vec<f32>,
    keys: Vec<u64>,
}

impl SweepSah {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            rule: SahRule::new(settings),
            items: Vec::new(),
            along: Default::default(),
            is_right: Vec::new(),
            numbers: Vec::new(),
            costs: Vec::new(),
            keys: Vec::new(),
        }
    }

    pub(super) fn build(&mut self, input: &Input<'_>, bvh: &mut BinaryBvh) -> Result<(), BuildError> {
        let count = input.boxes.len();
        bvh.nodes.clear();
        bvh.order.clear();
        if count == 0 {
            return Ok(());
        }
        make_room(&mut self.items, count, Item::new(&Box8::EMPTY, 0, 0));
        make_room(&mut self.is_right, count, false);
        make_room(&mut self.numbers, count, 0);
        make_room(&mut self.costs, count, 0.0);
        let (extent, view) = load_all(input.boxes, &mut self.items)?;
        for (axis, list) in self.along.iter_mut().enumerate() {
            self.keys.clear();
            let key = |item: &Item| u64::from(sortable(item.middle(axis))) << 32 | u64::from(item.number());
            self.keys.extend(self.items.iter().map(key));
            self.keys.sort_unstable();
            list.clear();
            list.extend(self.keys.iter().map(|key| *key as u32));
        }
        bvh.nodes.push(budding(&extent.bounds));
        let mut open = vec![(0, 0..count, 0)];
        while let Some((node, range, depth)) = open.pop() {
            let Some((left, bounds)) = self.cut(range.clone(), depth) else {
                bvh.nodes[node].first = range.start as u32;
                bvh.nodes[node].count = range.len() as u32;
                bvh.order.extend_from_slice(&self.along[0][range]);
                continue;
            };
            let (pair, middle) = (bvh.nodes.len(), range.start + left);
            bvh.nodes[node].first = pair as u32;
            bvh.nodes.extend(bounds.each_ref().map(budding));
            open.push((pair + 1, middle..range.end, depth + 1));
            open.push((pair, range.start..middle, depth + 1));
        }
        view.restore(bvh, input.boxes);
        Ok(())
    }

    /// Parts the items of a node; returns how many are left and the boxes of the sides, or nothing for a leaf.
    fn cut(&mut self, range: Range<usize>, depth: u32) -> Option<(usize, [Box8; 2])> {
        let Self { rule, items, along, is_right, numbers, costs, .. } = self;
        let count = range.len();
        if count == 1 {
            return None;
        }
        let fits = count <= rule.most_in_leaf();
        let (mut best, mut axis, mut left) = (f32::INFINITY, 0, count / 2);
        if depth < DEEPEST_CUT {
            for (along, list) in along.iter().enumerate() {
                let (cost, at) = sweep(rule.unit, &list[range.clone()], items, &mut costs[..count]);
                if cost < best {
                    (best, axis, left) = (cost, along, at);
                }
            }
        } else if fits {
            return None;
        }
        if fits {
            let whole = along[0][range.clone()].iter().map(|item| items[*item as usize].bounds());
            let whole = whole.fold(Box8::EMPTY, |all, one| all.union(&one));
            if rule.is_leaf(count, &whole, best) {
                return None;
            }
        }
        for (at, item) in along[axis][range.clone()].iter().enumerate() {
            is_right[*item as usize] = at >= left;
        }
        for (_, list) in along.iter_mut().enumerate().filter(|(other, _)| *other != axis) {
            let list = &mut list[range.clone()];
            let (lefts, rights) = numbers[..count].split_at_mut(left);
            let (sides, mut at) = ([lefts, rights], [0, 0]);
            for item in &*list {
                let side = usize::from(is_right[*item as usize]);
                sides[side][at[side]] = *item;
                at[side] += 1;
            }
            list.copy_from_slice(&numbers[..count]);
        }
        let side = |range: &[u32]| {
            let boxes = range.iter().map(|item| items[*item as usize].bounds());
            boxes.fold(Box8::EMPTY, |all, one| all.union(&one))
        };
        let (lefts, rights) = along[axis][range].split_at(left);
        Some((left, [side(lefts), side(rights)]))
    }
}

/// Bits that are in the order of the numbers; none of them is NaN.
fn sortable(number: f32) -> u32 {
    // Adding zero turns -0 to 0.
    let bits = (number + 0.0).to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

on_unit! {
    /// Where cutting a list of at least two items costs least: half the areas of both sides, each times its items; and
    /// how many are left of it. Of cuts that cost the same the first. There is room for a number an item.
    fn sweep(list: &[u32], items: &[Item], room: &mut [f32]) -> (f32, usize) = sweep_with
}

/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn sweep_with<L: Lanes>(list: &[u32], items: &[Item], room: &mut [f32]) -> (f32, usize) {
    let mut best = (f32::INFINITY, list.len() / 2);
    // SAFETY: the unit is there.
    unsafe {
        let mut around = L::load(&Box8::EMPTY);
        for at in (1..list.len()).rev() {
            around = around.union(L::load_item(&items[list[at] as usize]));
            room[at] = around.half_area() * (list.len() - at) as f32;
        }
        around = L::load(&Box8::EMPTY);
        for at in 1..list.len() {
            around = around.union(L::load_item(&items[list[at - 1] as usize]));
            let cost = around.half_area() * at as f32 + room[at];
            if cost < best.0 {
                best = (cost, at);
            }
        }
    }
    best
}
