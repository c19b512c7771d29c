//! Rays, and where they end.

use glam::{DVec3, Vec3};

/// A ray: the points `origin + t * direction` with `near <= t <= far`.
///
/// The direction need not be of unit length: `t` counts in its lengths. A ray that holds a NaN, or whose direction is
/// zero, hits nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, in metres.
    pub origin: Vec3,
    /// Where it goes, in metres for each 1 of `t`.
    pub direction: Vec3,
    /// The least `t` it may end at.
    pub near: f32,
    /// The greatest `t` it may end at.
    pub far: f32,
}

impl Ray {
    /// A ray without end from a point in metres.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, near: 0.0, far: f32::INFINITY }
    }

    /// The point at `t`, in metres.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// Where a ray meets an item.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// How far along the ray, in lengths of its direction.
    pub t: f32,
    /// Of a triangle: weight of the second corner; the first has `1 - u - v`. Of other items: as they say.
    pub u: f32,
    /// Of a triangle: weight of the third corner.
    pub v: f32,
    /// Which item, by number in what was built over.
    pub item: u32,
}

/// A ray in f64: what one is in the space of something that was placed, before it is rounded. Its ends count as those of
/// the ray it was made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FineRay {
    /// Where it starts, in metres of its space.
    pub origin: DVec3,
    /// Where it goes, for each 1 of `t`.
    pub direction: DVec3,
    /// From where on.
    pub near: f32,
    /// To where.
    pub far: f32,
}

impl FineRay {
    /// The nearest there is in f32.
    pub fn rounded(&self) -> Ray {
        let (origin, direction) = (self.origin.as_vec3(), self.direction.as_vec3());
        Ray { origin, direction, near: self.near, far: self.far }
    }
}

impl From<&Ray> for FineRay {
    fn from(ray: &Ray) -> Self {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        Self { origin, direction, near: ray.near, far: ray.far }
    }
}
