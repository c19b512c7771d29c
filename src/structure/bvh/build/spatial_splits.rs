//! Spatial splits (Stich, Friedrich and Dietrich 2009): where the two sides of the heuristic's cut would overlap, space
//! itself is cut, and an item on both sides becomes two references, each with the box of its part.
//!
//! Steps of a node: 1. the best cut by middles, as `binned_sah` has it; 2. if its sides overlap by more than `overlap`
//! of the root's area and there may be more references, the best of the planes between equal bins of space; 3. the
//! cheaper of the two, unless a leaf is; 4. an item on both sides of a plane goes to one of them after all if that is
//! cheaper ("reference unsplitting").
//!
//! Departs from the paper in that the references are bounded, by `duplicates` times the items, and shared out
//! among the sides of a cut by their items. Boxes out of the range builders compute in are not split. Refitting goes by whole items: it takes away
//! what splitting gained.

use super::binned_sah::SahRule;
use super::bins::{MOST_BINS, around, part};
use super::clip::clip;
use super::grow::{Cut, Extent, Rule, Shed, budding};
use super::lanes::{Box8, Item};
use super::yard::{View, load_all};
use super::{BuildError, Input, Settings};
use crate::structure::bvh::BinaryBvh;
use glam::Vec3;

pub(super) const SUMMARY: &str = "heuristic that also cuts items in two (Stich et al. 2009)";

/// Builds so.
pub(super) struct SpatialSplits {
    rule: SahRule,
    bins: usize,
    overlap: f32,
    duplicates: f32,
    shed: Shed,
}

/// A plane across space.
#[derive(Clone, Copy, Debug)]
struct Plane {
    axis: usize,
    at: f32,
    /// Half the areas of the sides, each times its references.
    cost: f32,
    counts: [u32; 2],
    bounds: [Box8; 2],
}

/// A node that is still to be cut.
struct Open {
    node: usize,
    items: Vec<Item>,
    depth: u32,
    /// How many references may be made below it.
    spare: usize,
}

impl SpatialSplits {
    pub(super) fn new(settings: &Settings) -> Self {
        let Settings { bins, overlap, duplicates, .. } = *settings;
        Self { rule: SahRule::new(settings), bins, overlap, duplicates, shed: Shed::new() }
    }

    pub(super) fn build(&mut self, input: &Input<'_>, bvh: &mut BinaryBvh) -> Result<(), BuildError> {
        bvh.nodes.clear();
        bvh.order.clear();
        if input.boxes.is_empty() {
            return Ok(());
        }
        let mut items = vec![Item::new(&Box8::EMPTY, 0, 0); input.boxes.len()];
        let (extent, view) = load_all(input.boxes, &mut items)?;
        let least = self.overlap * extent.bounds.half_area();
        let spare =
            if view == View::PLAIN { input.boxes.len() as f64 * f64::from(self.duplicates) } else { 0.0 };
        let spare = spare as usize;
        bvh.nodes.push(budding(&extent.bounds));
        let mut open = vec![Open { node: 0, items, depth: 0, spare }];
        while let Some(Open { node, items, depth, spare }) = open.pop() {
            let Some(sides) = self.sides(&items, input.triangles, depth, least, spare) else {
                bvh.nodes[node].bounds = around(self.rule.unit, &items)[0].aabb();
                bvh.nodes[node].first = bvh.order.len() as u32;
                bvh.nodes[node].count = items.len() as u32;
                bvh.order.extend(items.iter().map(Item::number));
                continue;
            };
            let pair = bvh.nodes.len();
            bvh.nodes[node].first = pair as u32;
            // What is left is for both sides, by what comes to them.
            let references = sides[0].len() + sides[1].len();
            let spare = (spare + items.len() - references) as f64 / references as f64;
            for (side, items) in sides.into_iter().enumerate().rev() {
                bvh.nodes.push(budding(&Box8::EMPTY));
                let spare = (spare * items.len() as f64) as usize;
                open.push(Open { node: pair + side, items, depth: depth + 1, spare });
            }
        }
        // Parts are smaller than what they are of: boxes are known from the leaves up.
        for i in (0..bvh.nodes.len()).rev().filter(|i| !bvh.nodes[*i].is_leaf()).collect::<Vec<_>>() {
            let [left, right] = bvh.nodes[i].children().map(|child| bvh.nodes[child].bounds);
            bvh.nodes[i].bounds = left.union(right);
        }
        view.restore(bvh, input.boxes);
        Ok(())
    }

    /// What comes to lie on either side; nothing for a leaf.
    fn sides(
        &mut self,
        items: &[Item],
        triangles: Option<&[[Vec3; 3]]>,
        depth: u32,
        least: f32,
        spare: usize,
    ) -> Option<[Vec<Item>; 2]> {
        let [bounds, middles] = around(self.rule.unit, items);
        let extent = Extent { bounds, middles };
        let cut = self.rule.cut_within(items, &extent, depth, &mut self.shed.bins);
        let (cost, overlap) = match &cut {
            Cut::Plane(split) => (split.cost, overlap(&split.bounds)),
            Cut::Few(parting) => (parting.cost, overlap(&parting.bounds)),
            _ => (f32::INFINITY, f32::INFINITY),
        };
        if items.len() > 1 && spare > 0 && overlap > least && self.rule.may_cut(depth) {
            let plane = self.best_plane(items, triangles, &bounds).filter(|plane| plane.cost < cost);
            let pays = |plane: &Plane| !self.rule.is_leaf(items.len(), &bounds, plane.cost);
            if let Some(sides) = plane.filter(pays).and_then(|plane| divide(items, triangles, plane, spare)) {
                return Some(sides);
            }
        }
        match cut {
            Cut::Leaf => None,
            Cut::Halves => {
                let (left, right) = items.split_at(items.len() / 2);
                Some([left.to_vec(), right.to_vec()])
            }
            Cut::Few(parting) => {
                let mut parted = items.to_vec();
                parting.part(items, &mut parted);
                let right = parted.split_off(parting.count());
                Some([parted, right])
            }
            Cut::Plane(split) => {
                let nothing = Item::new(&Box8::EMPTY, 0, 0);
                let mut sides = [split.left, items.len() - split.left].map(|count| vec![nothing; count]);
                let [left, right] = &mut sides;
                part(self.rule.unit, items, &split.plane, [left, right]);
                Some(sides)
            }
        }
    }

    /// The plane of the least cost, of those between equal bins of the node's box.
    fn best_plane(&self, items: &[Item], triangles: Option<&[[Vec3; 3]]>, bounds: &Box8) -> Option<Plane> {
        let mut best: Option<Plane> = None;
        for axis in 0..3 {
            let (low, size) = (-bounds.0[axis], bounds.size(axis));
            let last = self.bins - 1;
            let mut planes = [0.0; MOST_BINS + 1];
            for (bin, plane) in planes[..=self.bins].iter_mut().enumerate() {
                *plane = low + size * (bin as f32 / self.bins as f32);
            }
            let planes = &planes[1..self.bins];
            if !planes.is_sorted_by(|a, b| a < b)
                || planes[0] <= low
                || planes[last - 1] >= bounds.0[axis + 4]
            {
                continue;
            }
            let mut boxes = [Box8::EMPTY; MOST_BINS];
            let (mut begin, mut end) = ([0_u32; MOST_BINS], [0_u32; MOST_BINS]);
            for item in items {
                let own = item.bounds();
                // What only touches a plane is on one side of it.
                let first = planes.partition_point(|plane| *plane <= -own.0[axis]);
                let after = planes.partition_point(|plane| *plane < own.0[axis + 4]).max(first);
                begin[first] += 1;
                end[after] += 1;
                if first == after {
                    boxes[first] = boxes[first].union(&own);
                    continue;
                }
                let triangle = triangles.map(|all| &all[item.number() as usize]);
                for bin in first..=after {
                    let from = if bin == 0 { f32::NEG_INFINITY } else { planes[bin - 1] };
                    let to = if bin == last { f32::INFINITY } else { planes[bin] };
                    boxes[bin] = boxes[bin].union(&clip(item, triangle, axis, from, to));
                }
            }
            let (mut right, mut rest, mut count) = ([Box8::EMPTY; MOST_BINS], Box8::EMPTY, 0);
            for bin in (1..self.bins).rev() {
                rest = rest.union(&boxes[bin]);
                right[bin] = rest;
            }
            let (mut left, mut rights) = (Box8::EMPTY, end[..self.bins].iter().sum::<u32>());
            for bin in 1..self.bins {
                left = left.union(&boxes[bin - 1]);
                count += begin[bin - 1];
                rights -= end[bin - 1];
                let cost = left.half_area() * count as f32 + right[bin].half_area() * rights as f32;
                if count > 0 && rights > 0 && best.is_none_or(|best| cost < best.cost) {
                    let (counts, bounds) = ([count, rights], [left, right[bin]]);
                    best = Some(Plane { axis, at: planes[bin - 1], cost, counts, bounds });
                }
            }
        }
        best
    }
}

/// Half the area that both boxes have in common.
fn overlap(bounds: &[Box8; 2]) -> f32 {
    let [a, b] = bounds;
    let common = Box8(std::array::from_fn(|lane| a.0[lane].min(b.0[lane])));
    if (0..3).any(|axis| common.size(axis) < 0.0) { 0.0 } else { common.half_area() }
}

/// Parts items by a plane across space; nothing if that takes more references than there may be.
fn divide(
    items: &[Item],
    triangles: Option<&[[Vec3; 3]]>,
    plane: Plane,
    mut spare: usize,
) -> Option<[Vec<Item>; 2]> {
    let Plane { axis, at, mut bounds, mut counts, .. } = plane;
    let mut sides = [Vec::new(), Vec::new()];
    for item in items {
        let own = item.bounds();
        if own.0[axis + 4] <= at {
            sides[0].push(*item);
            continue;
        }
        if -own.0[axis] >= at {
            sides[1].push(*item);
            continue;
        }
        let triangle = triangles.map(|all| &all[item.number() as usize]);
        let parts = [(f32::NEG_INFINITY, at), (at, f32::INFINITY)]
            .map(|(low, high)| clip(item, triangle, axis, low, high));
        // What the sides cost with it on both, and on one alone; only the difference tells.
        let [a, b] = bounds.map(|side| side.half_area());
        let [m, n] = counts.map(|count| count as f32);
        let both = a * m + b * n;
        let one = [
            bounds[0].union(&own).half_area() * m + b * (n - 1.0),
            a * (m - 1.0) + bounds[1].union(&own).half_area() * n,
        ];
        let cheaper = usize::from(one[1] < one[0]);
        let empty = parts.iter().position(|part| *part == Box8::EMPTY);
        let alone = empty.map(|none| 1 - none).or((one[cheaper] < both).then_some(cheaper));
        if let Some(side) = alone {
            sides[side].push(*item);
            bounds[side] = bounds[side].union(&own);
            counts[1 - side] -= 1;
            continue;
        }
        spare = spare.checked_sub(1)?;
        for (side, part) in sides.iter_mut().zip(&parts) {
            side.push(Item::new(part, item.number(), 1));
        }
    }
    (!sides.iter().any(Vec::is_empty)).then_some(sides)
}
