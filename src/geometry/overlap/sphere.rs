//! Spheres: one comparison, and no rotation matters.

use super::{Columns, Eight, Overlap, ROUNDING, Way, load};
use crate::geometry::Sphere;
use crate::geometry::lanes::{Lanes, Unit, on_unit};
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

/// The numbers of a sphere: its centre and its radius.
const NUMBERS: usize = 4;

impl Overlap for Sphere {
    type Moved = MovedSphere;
    type Eight = Columns<NUMBERS>;

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

    #[inline]
    fn apart(&self, moved: &MovedSphere) -> bool {
        let [x, y, z] = self.centre.to_array();
        let numbers = [x, y, z, self.radius];
        // SAFETY: one lane needs no vector unit.
        unsafe { separated::<f32>(moved, &numbers) != 0 }
    }
}

impl Eight<Sphere> for Columns<NUMBERS> {
    const UNUSED: Self = Self::UNUSED;

    fn set(&mut self, lane: usize, volume: &Sphere) {
        let [x, y, z] = volume.centre.to_array();
        self.set(lane, [x, y, z, volume.radius]);
    }

    #[inline]
    fn apart(&self, unit: Unit, moved: &MovedSphere) -> u8 {
        eight(unit, moved, &self.0)
    }
}

on_unit! {
    fn eight(moved: &MovedSphere, columns: &[[f32; 8]; NUMBERS]) -> u8 = eight_by
}

/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn eight_by<L: Lanes>(moved: &MovedSphere, columns: &[[f32; 8]; NUMBERS]) -> u8 {
    let mut apart = 0;
    for from in (0..8).step_by(L::LEN) {
        // SAFETY: `from` steps by the lanes' number below 8; the processor is the caller's.
        apart |= unsafe { separated::<L>(moved, &load(columns, from)) << from };
    }
    apart as u8
}

/// Which spheres are apart from the moved one.
///
/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn separated<L: Lanes>(moved: &MovedSphere, numbers: &[L; NUMBERS]) -> u64 {
    // SAFETY: the processor is the caller's.
    unsafe {
        let [x, y, z] = [
            numbers[0].sub(L::splat(moved.centre[0])),
            numbers[1].sub(L::splat(moved.centre[1])),
            numbers[2].sub(L::splat(moved.centre[2])),
        ];
        let squared = x.mul(x).add(y.mul(y)).add(z.mul(z));
        let size = x.abs().add(y.abs()).add(z.abs());
        let radius = numbers[3];
        let slack = size.add(radius).mul(L::splat(ROUNDING));
        let reach = radius.add(L::splat(moved.radius)).add(slack);
        // A square that overflowed says nothing.
        squared.greater(reach.mul(reach)) & L::splat(f32::INFINITY).greater(squared)
    }
}
