//! Axis-aligned boxes: six comparisons (Paper II sec. 5, P2-17). A box that was turned on the way is taken for the
//! aligned box around it, which is up to 1.7 times as wide.

use super::{Columns, Eight, Overlap, ROUNDING, Way, load};
use crate::geometry::Aabb;
use crate::geometry::lanes::{Lanes, Unit, on_unit};
use glam::Vec3;

/// The box around one that was moved to where others are.
#[derive(Clone, Copy, Debug)]
pub struct MovedAabb {
    centre: [f32; 3],
    /// With a bound on all rounding that does not depend on the other box, and the reach.
    half: [f32; 3],
}

/// The numbers of a box: its centre and its half extents.
const NUMBERS: usize = 6;

/// Half extents from the centre as it was rounded, and rounded up.
fn half(bounds: &Aabb) -> Vec3 {
    let centre = bounds.centre();
    (bounds.max - centre).max(centre - bounds.min) * (1.0 + ROUNDING)
}

fn numbers(bounds: &Aabb) -> [f32; NUMBERS] {
    let parts = [bounds.centre(), half(bounds)];
    std::array::from_fn(|i| parts[i / 3][i % 3])
}

impl Overlap for Aabb {
    type Moved = MovedAabb;
    type Eight = Columns<NUMBERS>;

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

    #[inline]
    fn apart(&self, moved: &MovedAabb) -> bool {
        let numbers = numbers(self);
        // SAFETY: one lane needs no vector unit.
        unsafe { separated::<f32>(moved, &numbers) != 0 }
    }
}

impl Eight<Aabb> for Columns<NUMBERS> {
    const UNUSED: Self = Self::UNUSED;

    fn set(&mut self, lane: usize, volume: &Aabb) {
        self.set(lane, numbers(volume));
    }

    #[inline]
    fn apart(&self, unit: Unit, moved: &MovedAabb) -> u8 {
        eight(unit, moved, &self.0)
    }
}

on_unit! {
    fn eight(moved: &MovedAabb, columns: &[[f32; 8]; NUMBERS]) -> u8 = eight_by
}

/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn eight_by<L: Lanes>(moved: &MovedAabb, columns: &[[f32; 8]; NUMBERS]) -> u8 {
    let mut apart = 0;
    for from in (0..8).step_by(L::LEN) {
        // SAFETY: `from` steps by the lanes' number below 8; the processor is the caller's.
        apart |= unsafe { separated::<L>(moved, &load(columns, from)) << from };
    }
    apart as u8
}

/// Which boxes an axis separates from the moved one.
///
/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn separated<L: Lanes>(moved: &MovedAabb, numbers: &[L; NUMBERS]) -> u64 {
    let mut apart = 0;
    for axis in 0..3 {
        // SAFETY: the processor is the caller's.
        unsafe {
            let between = numbers[axis].sub(L::splat(moved.centre[axis])).abs();
            let half = numbers[3 + axis];
            let slack = between.add(half).mul(L::splat(ROUNDING));
            apart |= between.greater(half.add(L::splat(moved.half[axis])).add(slack));
        }
    }
    apart
}
