//! Spheres: one comparison, and no rotation matters.

use super::{Columns, Kernel, Overlap, ROUNDING, Way};
use crate::geometry::Sphere;
use crate::geometry::lanes::Lanes;
use glam::Vec3;

/// A sphere moved to where others are.
#[derive(Clone, Copy, Debug)]
pub struct MovedSphere {
    centre: [f32; 3],
    /// With a bound on all rounding that does not depend on the other sphere, and the reach.
    radius: f32,
}

/// What is added to a reach, in metres, so that its square is no number whose last places f32 has lost: of smaller
/// spheres the rounding of the squares would decide.
const LEAST: f32 = 1e-16;

impl Overlap for Sphere {
    type Moved = MovedSphere;
    type Eight = Columns<1, 4>;

    fn around(points: &[Vec3]) -> Self {
        Self::of_points(points)
    }

    fn surface(&self) -> f32 {
        4.0 * std::f32::consts::PI * self.radius * self.radius
    }

    #[inline]
    fn moved(&self, way: &Way) -> MovedSphere {
        let radius = self.radius + way.slack(self.centre, self.radius) + LEAST;
        MovedSphere { centre: way.point(self.centre).to_array(), radius }
    }
}

/// Its centre and its radius.
impl Kernel<1, 4> for Sphere {
    fn numbers(&self) -> [[f32; 4]; 1] {
        let [x, y, z] = self.centre.to_array();
        [[x, y, z, self.radius]]
    }

    #[inline(always)]
    unsafe fn separated<L: Lanes>(moved: &MovedSphere, &[[x, y, z, radius]]: &[[L; 4]; 1]) -> u64 {
        // SAFETY: the processor is the caller's.
        unsafe {
            let x = x.sub(L::splat(moved.centre[0]));
            let y = y.sub(L::splat(moved.centre[1]));
            let z = z.sub(L::splat(moved.centre[2]));
            let squared = x.mul(x).add(y.mul(y)).add(z.mul(z));
            let size = x.abs().add(y.abs()).add(z.abs());
            let slack = size.add(radius).mul(L::splat(ROUNDING));
            let reach = radius.add(L::splat(moved.radius)).add(slack);
            // A square that overflowed says nothing.
            squared.greater(reach.mul(reach)) & L::splat(f32::INFINITY).greater(squared)
        }
    }
}
