//! Cuts in the middle of space (Waechter and Keller 2006, "bounding interval hierarchy"; Ize ch. 7.4, I7-04): each node
//! is cut half way along the longest side, with no cost weighed.
//!
//! Departs from the paper in what is halved: the box around the middles of the node's items, not a part of the
//! scene's box, so no cut leaves one side empty.

use super::bins::{Bins, Grating, best, fill};
use super::grow::{Cut, Extent, Rule};
use super::lanes::{Item, Unit};
use super::yard::Yard;
use super::{BuildError, Input, Settings};
use crate::structure::bvh::BinaryBvh;

pub(super) const SUMMARY: &str = "cuts half way along the longest side (Waechter and Keller 2006)";

/// Builds so, and keeps its buffers.
pub(super) struct SpatialMedian {
    rule: MedianRule,
    yard: Yard,
}

impl SpatialMedian {
    pub(super) fn new(settings: &Settings) -> Self {
        Self { rule: MedianRule::new(settings), yard: Yard::default() }
    }

    pub(super) fn build(&mut self, input: &Input<'_>, bvh: &mut BinaryBvh) -> Result<(), BuildError> {
        self.yard.build(&self.rule, input.boxes, bvh)?;
        Ok(())
    }
}

/// The cut as a rule.
#[derive(Clone, Copy, Debug)]
pub(super) struct MedianRule {
    most_in_leaf: usize,
    unit: Unit,
}

impl MedianRule {
    pub(super) fn new(settings: &Settings) -> Self {
        Self { most_in_leaf: settings.median_leaf, unit: Unit::best() }
    }
}

impl Rule for MedianRule {
    fn unit(&self) -> Unit {
        self.unit
    }

    fn most_in_leaf(&self) -> usize {
        self.most_in_leaf
    }

    fn bins(&self, items: usize) -> usize {
        if items > self.most_in_leaf { 2 } else { 0 }
    }

    fn cut(&self, items: &[Item], extent: &Extent, bins: &mut Bins) -> Cut {
        if items.len() <= self.most_in_leaf {
            return Cut::Leaf;
        }
        let grating = Grating::new(&extent.middles, 2).longest_only();
        bins.clear(&grating);
        fill(self.unit, items, &grating, bins);
        best(self.unit, bins, &grating).map_or(Cut::Halves, Cut::Plane)
    }
}
