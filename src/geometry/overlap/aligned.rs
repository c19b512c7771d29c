//! Axis-aligned boxes taken for oriented ones: the boxes of the one, the test of the other (P2-17).

use super::{Columns, Kernel, Overlap, Way, obb};
use crate::geometry::lanes::Lanes;
use crate::geometry::{Aabb, Obb};
use glam::Vec3;

/// An oriented box whose axes are those of its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignedObb(Obb);

impl Overlap for AlignedObb {
    type Moved = obb::MovedObb;
    type Eight = Columns<5, 3>;

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
}

impl Kernel<5, 3> for AlignedObb {
    fn numbers(&self) -> [[f32; 3]; 5] {
        self.0.numbers()
    }

    #[inline(always)]
    unsafe fn separated<L: Lanes>(moved: &obb::MovedObb, numbers: &[[L; 3]; 5]) -> u64 {
        // SAFETY: the processor is the caller's.
        unsafe { Obb::separated(moved, numbers) }
    }
}
