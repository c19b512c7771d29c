//! Axis-aligned boxes as volumes.

use glam::Vec3;

use super::{Placed, Volume};
use crate::geometry::{Aabb, culling::ROUNDING};

/// Which of the six coordinates (three least, three greatest) make the corner with the least product
/// with a normal of that sign field: the corner table of Paper I sec. 3.1. The complemented field gives
/// the corner with the greatest.
const CORNERS: [[u8; 3]; 8] =
    [[0, 1, 2], [3, 1, 2], [0, 4, 2], [3, 4, 2], [0, 1, 5], [3, 1, 5], [0, 4, 5], [3, 4, 5]];

/// A box relative to the eye.
#[derive(Clone, Copy, Debug)]
pub struct PlacedAabb {
    /// Least and greatest corner.
    coordinates: [f32; 6],
    slack: f32,
}

impl Volume for Aabb {
    /// The sign field: bit `i` is set when the normal is negative on axis `i`.
    type Field = u8;
    type Eye = Vec3;
    type Placed<'a> = PlacedAabb;
    const ROUND: bool = false;

    #[inline]
    fn field(normal: Vec3) -> u8 {
        let bit = |axis: usize| u8::from(normal[axis].is_sign_negative()) << axis;
        bit(0) | bit(1) | bit(2)
    }

    #[inline]
    fn eye(eye: Vec3) -> Vec3 {
        eye
    }

    #[inline]
    fn is_empty(&self) -> bool {
        Aabb::is_empty(self)
    }

    #[inline]
    fn is_nan(&self) -> bool {
        Aabb::is_nan(self)
    }

    #[inline]
    fn placed(&self, eye: &Vec3) -> PlacedAabb {
        let (low, high) = (self.min - *eye, self.max - *eye);
        // A sum, not a maximum: a NaN or an infinity anywhere reaches the slack, and with such a slack
        // no comparison can claim "outside" or "inside". The last term covers underflow.
        let slack = (low.abs() + high.abs()).element_sum() * ROUNDING + f32::MIN_POSITIVE;
        PlacedAabb { coordinates: [low.x, low.y, low.z, high.x, high.y, high.z], slack }
    }

    #[inline]
    fn centre(&self) -> Vec3 {
        Aabb::centre(self)
    }

    #[inline]
    fn radius(&self) -> f32 {
        self.half_diagonal()
    }

    #[inline]
    fn corners_from(&self, origin: Vec3) -> [Vec3; 8] {
        let ends = [self.min - origin, self.max - origin];
        std::array::from_fn(|i| {
            let pick = |axis: usize| ends[i >> axis & 1][axis];
            Vec3::new(pick(0), pick(1), pick(2))
        })
    }
}

impl PlacedAabb {
    #[inline]
    fn corner(&self, field: u8) -> Vec3 {
        let [x, y, z] = CORNERS[usize::from(field & 7)];
        let at = |i: u8| self.coordinates[usize::from(i)];
        Vec3::new(at(x), at(y), at(z))
    }
}

impl Placed for PlacedAabb {
    type Field = u8;

    #[inline]
    fn nearest(&self, normal: Vec3, field: &u8) -> f32 {
        normal.dot(self.corner(*field))
    }

    #[inline]
    fn farthest(&self, normal: Vec3, field: &u8) -> f32 {
        normal.dot(self.corner(!field))
    }

    #[inline]
    fn slack(&self) -> f32 {
        self.slack
    }
}
