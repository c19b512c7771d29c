//! Volumes against volumes: the overlap tests of collision detection (Paper II sec. 5, P2-17), one at a time or one
//! against eight.
//!
//! A test says *apart* only of what certainly is: each comparison is against a bound on its own rounding, on that of
//! the motion between the two bodies, and on what is not quite a right angle in an axis; what overflows is not apart.
//! So no contact is ever missed on the way down two hierarchies, however the boxes lie. In particular the cross
//! product of two parallel edges, which is zero and separates nothing (P2-F16), stays below the bound for that
//! reason and no other.
//!
//! One and eight are the same code, so they say the same of the same pair, on every vector unit.

mod aabb;
mod aligned;
mod eight;
mod kdop;
mod obb;
mod sphere;

use super::Rigid;
use super::lanes::Unit;
pub use aligned::AlignedObb;
pub use eight::Columns;
use eight::Kernel;
use glam::{Mat3A, Vec3, Vec3A};

/// Volumes that are tested against one another.
pub trait Overlap: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// A volume as eight of its kind see it: moved to where they are.
    type Moved: Copy + Send + Sync + 'static;

    /// Eight volumes, number beside number.
    type Eight: Eight<Self>;

    /// A small volume around some points; one that is apart from nothing if a number in them is NaN.
    fn around(points: &[Vec3]) -> Self;

    /// Its surface or what stands for it, in square metres: of a pair the larger is descended.
    fn surface(&self) -> f32;

    /// Moves it to where others are.
    fn moved(&self, way: &Way) -> Self::Moved;

    /// Whether this one and one that was moved here are certainly further apart than the way's reach.
    #[inline]
    fn apart(&self, moved: &Self::Moved) -> bool {
        Self::Eight::one_apart(self, moved)
    }
}

/// Eight volumes as a structure of arrays.
pub trait Eight<V: Overlap>: Copy + std::fmt::Debug + Send + Sync + 'static {
    /// Eight of what nothing should be tested against.
    const UNUSED: Self;

    /// Puts a volume in a lane, 0 to 7.
    fn set(&mut self, lane: usize, volume: &V);

    /// Bit `i` is set when volume `i` and the moved one are certainly apart.
    fn apart(&self, unit: Unit, moved: &V::Moved) -> u8;

    /// Whether one volume by itself and the moved one are: what its bit would be.
    fn one_apart(volume: &V, moved: &V::Moved) -> bool;
}

/// The way from one body's space to another's, with all that is to be added to a comparison for it.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    rotation: Mat3A,
    translation: Vec3A,
    /// Whether nothing is turned, so that boxes along the axes stay so.
    straight: bool,
    /// Bound on the rounding of a moved point, as a share of its coordinates' sum; and that of the way, with the reach,
    /// in metres.
    share: f32,
    reach: f32,
}

/// Bound on the rounding of a sum of a few products of numbers below 1 and metres, as a share of the metres: 32
/// times half a unit in the last place. Axes are unit vectors at right angles to 4 of them, turned ones to 8.
const ROUNDING: f32 = 32.0 * f32::EPSILON / 2.0;

impl Way {
    /// A motion for tests whether volumes come nearer than `reach`, in metres. A reach below 0 is one of 0; of one that
    /// is not a number, or a motion that has such, nobody knows, and nothing is apart.
    pub fn new(motion: &Rigid, reach: f64) -> Self {
        // Not by `max`, which would make 0 of what is not a number.
        let reach = if reach < 0.0 { 0.0 } else { reach };
        let rotation = motion.rotation();
        let translation = motion.translation().as_vec3a();
        let shift = translation.abs().element_sum();
        Self {
            rotation: rotation.as_mat3().into(),
            translation,
            straight: rotation == glam::DMat3::IDENTITY,
            share: ROUNDING,
            // Below it is what is lost by writing the numbers in f32, far below.
            reach: (reach as f32) * (1.0 + ROUNDING) + shift * ROUNDING + f32::MIN_POSITIVE,
        }
    }

    /// The same way, which may be off by so many metres.
    pub(crate) fn off_by(self, metres: f64) -> Self {
        Self { reach: self.reach + (metres as f32) * (1.0 + ROUNDING), ..self }
    }

    /// Where a point goes.
    #[inline]
    fn point(&self, point: Vec3) -> Vec3A {
        self.rotation * Vec3A::from(point) + self.translation
    }

    /// What is to be added to a comparison for a volume about this point whose extents add up to `extent`.
    #[inline]
    fn slack(&self, centre: Vec3, extent: f32) -> f32 {
        (centre.abs().element_sum() + extent) * self.share + self.reach
    }
}

#[cfg(test)]
mod tests;
