//! The surface area heuristic over bins (Wald 2007; Ize ch. 7.4, I7-04): planes between equal bins of the middles along
//! each axis are weighed by what lies left and right of them, and the cheapest is taken unless a leaf is cheaper still.
//!
//! Departs from the thesis in that all three axes are weighed, not the longest alone, and that a node of few items has
//! fewer bins: more could not tell them apart, and most nodes are small.

use super::bins::{Bins, Grating, best, fill};
use super::few::{FEW, weigh_few};
use super::grow::{Cut, Extent, Rule};
use super::lanes::{Box8, Item, Unit};
use super::yard::Yard;
use super::{BuildError, Input, Settings};
use crate::structure::bvh::BinaryBvh;

pub(super) const SUMMARY: &str = "surface area heuristic over bins (Wald 2007)";

/// Builds so, and keeps its buffers.
pub(super) struct BinnedSah {
    rule: SahRule,
    yard: Yard,
}

impl BinnedSah {
    pub(super) fn new(settings: &Settings) -> Self {
        Self { rule: SahRule::new(settings), yard: Yard::default() }
    }

    pub(super) fn build(&mut self, input: &Input<'_>, bvh: &mut BinaryBvh) -> Result<(), BuildError> {
        self.yard.build(&self.rule, input.boxes, bvh)?;
        Ok(())
    }
}

/// The heuristic as a rule.
#[derive(Clone, Copy, Debug)]
pub(super) struct SahRule {
    bins: usize,
    most_in_leaf: usize,
    step_cost: f32,
    item_cost: f32,
    pub(super) unit: Unit,
}

impl SahRule {
    pub(super) fn new(settings: &Settings) -> Self {
        let Settings { bins, most_in_leaf, step_cost, item_cost, .. } = *settings;
        Self { bins, most_in_leaf, step_cost, item_cost, unit: Unit::best() }
    }

    /// The bins a node of so many items gets.
    pub(super) fn grating(&self, middles: &Box8, items: usize) -> Grating {
        Grating::new(middles, self.bins(items))
    }

    /// What becomes of a node whose bins are full.
    pub(super) fn weigh(&self, bins: &Bins, grating: &Grating, items: usize, bounds: &Box8) -> Cut {
        let Some(split) = best(self.unit, bins, grating) else { return Cut::Halves };
        if self.is_leaf(items, bounds, split.cost) { Cut::Leaf } else { Cut::Plane(split) }
    }

    /// Whether a leaf is allowed, and no dearer than two sides of a cost.
    pub(super) fn is_leaf(&self, items: usize, bounds: &Box8, sides: f32) -> bool {
        let area = bounds.half_area();
        let pays = self.step_cost * area + self.item_cost * sides < self.item_cost * area * items as f32;
        items <= self.most_in_leaf && !pays
    }
}

impl Rule for SahRule {
    fn unit(&self) -> Unit {
        self.unit
    }

    fn most_in_leaf(&self) -> usize {
        self.most_in_leaf
    }

    fn bins(&self, items: usize) -> usize {
        if items > FEW { self.bins.min(2 + items) } else { 0 }
    }

    fn cut(&self, items: &[Item], extent: &Extent, bins: &mut Bins) -> Cut {
        if items.len() <= FEW {
            let parting = weigh_few(self.unit, items);
            return match self.is_leaf(items.len(), &extent.bounds, parting.cost) {
                true => Cut::Leaf,
                false => Cut::Few(parting),
            };
        }
        let grating = self.grating(&extent.middles, items.len());
        if grating.is_point() {
            return Cut::Halves;
        }
        bins.clear(&grating);
        fill(self.unit, items, &grating, bins);
        self.weigh(bins, &grating, items.len(), &extent.bounds)
    }
}
