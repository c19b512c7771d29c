//! Axis-aligned boxes taken for oriented ones: the boxes of the one, the test of the other (P2-17).

use super::{Columns, Eight, Overlap, Way, obb};
use crate::geometry::lanes::Unit;
use crate::geometry::{Aabb, Obb};
use glam::Vec3;

/// An oriented box whose axes are those of its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignedObb(Obb);

impl Overlap for AlignedObb {
    type Moved = obb::MovedObb;
    type Eight = Columns<{ obb::NUMBERS }>;

    fn around(points: &[Vec3]) -> Self {
        Self(Obb::from(Aabb::around(points)))
    }

    fn surface(&self) -> f32 {
        self.0.surface()
    }

    #[inline]
    fn moved(&self, way: &Way) -> obb::MovedObb {
        self.0.moved(way)
    }

    #[inline]
    fn apart(&self, moved: &obb::MovedObb) -> bool {
        self.0.apart(moved)
    }
}

impl Eight<AlignedObb> for Columns<{ obb::NUMBERS }> {
    const UNUSED: Self = Self::UNUSED;

    fn set(&mut self, lane: usize, volume: &AlignedObb) {
        Eight::<Obb>::set(self, lane, &volume.0);
    }

    #[inline]
    fn apart(&self, unit: Unit, moved: &obb::MovedObb) -> u8 {
        Eight::<Obb>::apart(self, unit, moved)
    }
}
