//! Axis-aligned boxes: six comparisons (Paper II sec. 5, P2-17). A box that was turned on the way is taken for the
//! aligned box around it, which is up to 1.7 times as wide.

use super::{Columns, Kernel, Overlap, ROUNDING, Way};
use crate::geometry::Aabb;
use crate::geometry::lanes::Lanes;
use glam::Vec3;

/// The box around one that was moved to where others are.
#[derive(Clone, Copy, Debug)]
pub struct MovedAabb {
    centre: [f32; 3],
    /// With a bound on all rounding that does not depend on the other box, and the reach.
    half: [f32; 3],
}

/// Half extents from the centre as it was rounded, and rounded up.
fn half(bounds: &Aabb) -> Vec3 {
    let centre = bounds.centre();
    (bounds.max - centre).max(centre - bounds.min) * (1.0 + ROUNDING)
}

impl Overlap for Aabb {
    type Moved = MovedAabb;
    type Eight = Columns<2, 3>;

    fn around(points: &[Vec3]) -> Self {
        // The least of a number and a NaN is the number: the box would leave out what nobody knows the place of.
        if points.iter().any(|point| point.is_nan()) {
            return Self { min: Vec3::NAN, max: Vec3::NAN };
        }
        Self::of_points(points.iter().copied())
    }

    fn surface(&self) -> f32 {
        let size = self.size();
        2.0 * (size.x * size.y + size.y * size.z + size.z * size.x)
    }

    #[inline]
    fn moved(&self, way: &Way) -> MovedAabb {
        let (centre, half) = (self.centre(), half(self));
        let slack = way.slack(centre, half.element_sum());
        let turned = if way.straight { half.into() } else { way.rotation.abs() * glam::Vec3A::from(half) };
        MovedAabb { centre: way.point(centre).to_array(), half: (turned + slack).to_array() }
    }
}

/// Its centre and its half extents; an axis separates.
impl Kernel<2, 3> for Aabb {
    fn numbers(&self) -> [[f32; 3]; 2] {
        [self.centre().to_array(), half(self).to_array()]
    }

    #[inline(always)]
    unsafe fn separated<L: Lanes>(moved: &MovedAabb, [centre, half]: &[[L; 3]; 2]) -> u64 {
        let mut apart = 0;
        for axis in 0..3 {
            // SAFETY: the processor is the caller's.
            unsafe {
                let between = centre[axis].sub(L::splat(moved.centre[axis])).abs();
                let half = half[axis];
                let slack = between.add(half).mul(L::splat(ROUNDING));
                apart |= between.greater(half.add(L::splat(moved.half[axis])).add(slack));
            }
        }
        apart
    }
}
