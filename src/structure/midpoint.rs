//! The rule of midpoint subdivision: Bubenicek 2020, sec. 2 and 3.
//!
//! A part is cut across its longest axis in the middle of its box, and what is in it goes where its own
//! middle lies, until at most so many are left. The thesis leaves axis, plane and side open; this is the
//! usual reading.
//!
//! Where that cuts nothing off, since all middles lie on one side (all equal, or one far outlier that
//! stretches the box), the part is halved at its median instead; so is one below a chain of midpoints
//! longer than a balanced tree would want. No side is ever empty and the depth is bounded.

use glam::Vec3A;

use crate::geometry::Aabb;

/// A box in registers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) low: Vec3A,
    pub(super) high: Vec3A,
}

impl Bounds {
    pub(super) const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    #[inline]
    pub(super) fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// With a point.
    #[inline]
    pub(super) fn with(self, point: Vec3A) -> Self {
        self.union(Self { low: point, high: point })
    }

    pub(super) fn aabb(self) -> Aabb {
        Aabb { min: self.low.into(), max: self.high.into() }
    }

    /// The axis the box is longest on; the first of equals.
    #[inline]
    pub(super) fn longest(self) -> usize {
        // Halved before they are subtracted, so that boxes near the end of the number range do not overflow.
        let size = self.high * 0.5 - self.low * 0.5;
        if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        }
    }

    /// Where to cut: the axis, and the place on it below which a middle goes to the first half.
    #[inline]
    pub(super) fn cut(self) -> (usize, f32) {
        let axis = self.longest();
        (axis, self.low[axis] * 0.5 + self.high[axis] * 0.5)
    }
}

/// How many midpoint cuts may lie one below the other: twice what a balanced tree has, and some for
/// small ones, so that only chains of outliers are cut short.
pub(super) fn most_midpoints(count: usize, most: usize) -> u32 {
    2 * count.div_ceil(most.max(1)).next_power_of_two().trailing_zeros() + 8
}
