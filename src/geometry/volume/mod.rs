//! Bounding volumes that plane tests can be made of.

mod aabb;
mod kdop;
mod movable;
mod obb;
mod sphere;

use glam::Vec3;

use super::frustum::KernelPlane;
pub use kdop::KDop;
pub use movable::Movable;
pub use obb::Obb;
pub use sphere::Sphere;

/// A convex body that stands for what it holds.
///
/// A plane test asks for two of its points: the n-vertex, deepest in the plane's inner half-space, and the
/// p-vertex, furthest out (Paper I sec. 3.1).
pub trait Volume: Copy + PartialEq + std::fmt::Debug + Send + Sync + 'static {
    /// What can be worked out for a plane once a frame, for all volumes (Paper I sec. 4).
    type Field: Copy + Send + Sync;

    /// What can be worked out for an eye once a frame, for all volumes.
    type Eye: Copy + Send + Sync;

    /// The volume relative to the eye, ready to be tested.
    type Placed<'a>: Placed<Field = Self::Field>
    where
        Self: 'a;

    /// Whether being inside the nearest plane of each pair means being inside the other: true of spheres,
    /// of boxes only up to a size, and not quite even then (Paper I sec. 3.3, finding P1-F04).
    const ROUND: bool;

    /// Works out the field of a plane with this outward normal.
    fn field(normal: Vec3) -> Self::Field;

    /// Works out what is needed of an eye, which is in metres.
    fn eye(eye: Vec3) -> Self::Eye;

    /// Whether it holds no point.
    fn is_empty(&self) -> bool;

    /// Whether a number in it is NaN, so that nobody knows where it is.
    fn is_nan(&self) -> bool;

    /// Moves it to where the eye is the origin.
    fn placed<'a>(&'a self, eye: &'a Self::Eye) -> Self::Placed<'a>;

    /// Its middle, in metres.
    fn centre(&self) -> Vec3;

    /// A bound on the distance of its points from the middle, in metres: the `d2` of the octant test
    /// (Paper I sec. 3.3).
    fn radius(&self) -> f32;

    /// Eight points whose hull holds it, in metres from `origin`, up to rounding at the distance they are from
    /// there: bit `i` of the index says which end of axis `i`.
    fn corners_from(&self, origin: Vec3) -> [Vec3; 8];

    /// The same in the world.
    fn corners(&self) -> [Vec3; 8] {
        self.corners_from(Vec3::ZERO)
    }
}

/// A volume relative to the eye. Products are of the plane's normal and a point, in metres; to each the
/// plane's distance term is to be added.
pub trait Placed {
    /// See [`Volume::Field`].
    type Field;

    /// The least product: that of the n-vertex.
    fn nearest(&self, normal: Vec3, field: &Self::Field) -> f32;

    /// The greatest product: that of the p-vertex.
    fn farthest(&self, normal: Vec3, field: &Self::Field) -> f32;

    /// Bound on the rounding of any of its products; infinite or NaN if a number in it is.
    fn slack(&self) -> f32;
}

impl KernelPlane {
    /// Below the distance of the n-vertex.
    #[inline]
    pub(super) fn nearest<P: Placed>(&self, placed: &P, field: &P::Field) -> f32 {
        placed.nearest(self.normal, field) + self.low
    }

    /// Above the distance of the p-vertex.
    #[inline]
    pub(super) fn farthest<P: Placed>(&self, placed: &P, field: &P::Field) -> f32 {
        placed.farthest(self.normal, field) + self.high
    }
}
