//! Volumes of what moves: carried along with an object, and fitted anew around others.
//!
//! Both only ever err outward: what comes out holds every point of what went in, moved exactly.

use glam::{DAffine3, DVec3, Vec3};

use super::{KDop, Obb, Placed, Sphere, Volume};
use crate::geometry::Aabb;

/// A volume that can follow what it holds.
///
/// Where a number is NaN, or too large for f32, the outcome is [`Movable::NOWHERE`]: no test calls that
/// outside, so what is lost track of is drawn rather than dropped.
pub trait Movable: Volume {
    /// Holds what nobody knows the place of: all NaN.
    const NOWHERE: Self;

    /// A volume of the same kind around this one after a transform, lengths in metres. A sphere and an oriented
    /// box stay as tight as they are under a rigid motion; a box and a k-DOP only under a translation, since
    /// their directions do not turn with them. Empty stays empty.
    #[must_use]
    fn moved(&self, by: &DAffine3) -> Self;

    /// A volume around others, none of which is empty; of this one's axes, if it has any of its own.
    #[must_use]
    fn around(&self, parts: impl Iterator<Item = Self> + Clone) -> Self;
}

/// Bounds, in metres, on how far a volume reaches along a direction once it is moved.
fn span<V: Volume>(volume: &V, by: &DAffine3, direction: Vec3) -> (f64, f64) {
    let (centre, direction) = (volume.centre(), direction.as_dvec3());
    // The direction as the volume sees it. Its points are taken from its own middle, so that rounding goes with
    // its size and not with where it is.
    let normal = (by.matrix3.transpose() * direction).as_vec3();
    let (field, eye) = (V::field(normal), V::eye(centre));
    let placed = volume.placed(&eye);
    // The slack is one of a unit normal.
    let slack = f64::from(placed.slack()) * f64::from(normal.length()) * (1.0 + 1e-6);
    let at = direction.dot(by.transform_point3(centre.as_dvec3()));
    let end = |product: f32| at + f64::from(product);
    (end(placed.nearest(normal, &field)) - slack, end(placed.farthest(normal, &field)) + slack)
}

/// The next f32 below, which makes up for all rounding in f64 as well.
pub(super) fn below(x: f64) -> f32 {
    (x as f32).next_down()
}

/// The next f32 above.
pub(super) fn above(x: f64) -> f32 {
    (x as f32).next_up()
}

impl Movable for Aabb {
    const NOWHERE: Self = Self { min: Vec3::NAN, max: Vec3::NAN };

    fn moved(&self, by: &DAffine3) -> Self {
        if Aabb::is_empty(self) && !Aabb::is_nan(self) {
            return Self::EMPTY;
        }
        let [x, y, z] = Vec3::AXES.map(|axis| span(self, by, axis));
        let moved = Self {
            min: Vec3::new(below(x.0), below(y.0), below(z.0)),
            max: Vec3::new(above(x.1), above(y.1), above(z.1)),
        };
        if moved.min.is_finite() && moved.max.is_finite() { moved } else { Self::NOWHERE }
    }

    fn around(&self, parts: impl Iterator<Item = Self> + Clone) -> Self {
        // The least of a number and a NaN is the number: nobody may rely on a union to pass a NaN on.
        if parts.clone().any(|part| part.is_nan()) {
            return Self::NOWHERE;
        }
        parts.fold(Self::EMPTY, Self::union)
    }
}

impl<const D: usize> Movable for KDop<D> {
    const NOWHERE: Self = Self { ends: [[f32::NAN; D]; 2] };

    fn moved(&self, by: &DAffine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let mut moved = Self::EMPTY;
        for (number, (direction, _, _)) in self.slabs().enumerate() {
            let (low, high) = span(self, by, direction);
            (moved.ends[0][number], moved.ends[1][number]) = (below(low), above(high));
        }
        if moved.ends.as_flattened().iter().all(|end| end.is_finite()) { moved } else { Self::NOWHERE }
    }

    fn around(&self, parts: impl Iterator<Item = Self> + Clone) -> Self {
        let mut all = Self::EMPTY;
        for part in parts {
            if part.is_nan() {
                return Self::NOWHERE;
            }
            for number in 0..D {
                all.ends[0][number] = all.ends[0][number].min(part.ends[0][number]);
                all.ends[1][number] = all.ends[1][number].max(part.ends[1][number]);
            }
        }
        all
    }
}

impl Movable for Sphere {
    const NOWHERE: Self = Self { centre: Vec3::NAN, radius: f32::NAN };

    fn moved(&self, by: &DAffine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        // No vector grows by more than the root of the greatest eigenvalue of the squared matrix, which is at most
        // its greatest sum of a row: exactly 1 for a rigid motion.
        let squared = by.matrix3.transpose() * by.matrix3;
        let rows = [squared.x_axis, squared.y_axis, squared.z_axis];
        let growth = rows.map(|row| row.abs().element_sum()).into_iter().fold(0.0, f64::max).sqrt();
        let exact = by.transform_point3(self.centre.as_dvec3());
        let centre = exact.as_vec3();
        // The second term is what rounding moved the middle by.
        let radius = above(f64::from(self.radius) * growth + exact.distance(centre.as_dvec3()));
        if centre.is_finite() && radius.is_finite() { Self { centre, radius } } else { Self::NOWHERE }
    }

    fn around(&self, parts: impl Iterator<Item = Self> + Clone) -> Self {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for part in parts.clone() {
            if part.is_nan() {
                return Self::NOWHERE;
            }
            let (centre, radius) = (part.centre.as_dvec3(), f64::from(part.radius));
            (low, high) = (low.min(centre - radius), high.max(centre + radius));
        }
        let centre = ((low + high) / 2.0).as_vec3();
        let far = |part: Self| part.centre.as_dvec3().distance(centre.as_dvec3()) + f64::from(part.radius);
        let radius = above(parts.map(far).fold(0.0, f64::max));
        if radius.is_finite() { Self { centre, radius } } else { Self::NOWHERE }
    }
}

impl Movable for Obb {
    const NOWHERE: Self = Self { centre: Vec3::NAN, axes: Vec3::AXES, half: Vec3::ZERO };

    fn moved(&self, by: &DAffine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let axes = self.axes.map(|axis| (by.matrix3 * axis.as_dvec3()).as_vec3());
        let corners = self.fine_corners().map(|corner| by.transform_point3(corner));
        let boxed = || Self::spanned(Vec3::AXES, corners.into_iter());
        // Flattened along one of its axes, it has none to keep.
        let moved = Self::spanned(axes, corners.into_iter()).or_else(boxed);
        moved.filter(Self::is_finite).unwrap_or(Self::NOWHERE)
    }

    fn around(&self, parts: impl Iterator<Item = Self> + Clone) -> Self {
        let corners = parts.flat_map(|part| part.fine_corners());
        let around = Self::spanned(self.axes, corners).filter(Self::is_finite);
        // The axes stay, for when its parts are somewhere again.
        around.unwrap_or(Self { axes: self.axes, ..Self::NOWHERE })
    }
}

#[cfg(test)]
#[path = "movable_tests.rs"]
mod tests;
