//! Where something stands that has a space of its own, and the way of a ray into that space.

use crate::geometry::{Aabb, FineRay, Ray};
use glam::{Affine3A, DMat3, DVec3, Vec3};

/// The greatest stretch or squeeze of a place, either way: beyond, a ray's direction might leave the range of f32.
const MOST_STRETCH: f64 = (1u64 << 40) as f64;

/// A transform into the world that has a way back.
///
/// The way back is worked out in f64, so nothing is lost on it but by rounding to f32 at its end, and a ray counts the
/// same in both spaces: its direction is not brought to any length.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// From the world's directions to its own.
    back: DMat3,
    /// Where its origin is in the world.
    at: Vec3,
}

impl Place {
    /// The place of a transform, and its skew. `None` where there is no way back: it is flat, or a number of it or of
    /// its inverse is not finite or above 2^40.
    ///
    /// The skew is by how many times an error of a coordinate may grow on the way there and back, of all that is
    /// parallel to an axis: the greatest row sum of `|M| |M^-1|`. It is 1 where the axes stay axes, whatever their
    /// lengths, at most 3 where they stay at right angles, and grows with the squeeze of what was turned before.
    pub fn new(transform: &Affine3A) -> Option<(Self, f64)> {
        let there = transform.matrix3.as_dmat3();
        let back = there.inverse();
        let sizes = [there, back].map(|matrix| matrix.to_cols_array().map(f64::abs));
        // A NaN is below nothing.
        let tame = sizes.as_flattened().iter().all(|size| *size < MOST_STRETCH);
        let at: Vec3 = transform.translation.into();
        if !(tame && at.is_finite()) {
            return None;
        }
        let [there, away] = sizes.map(|sizes| DMat3::from_cols_array(&sizes));
        let rows = (there * away) * DVec3::ONE;
        Some((Self { back, at }, rows.max_element()))
    }

    /// A ray of the world in this space.
    #[inline]
    pub fn take_in(&self, ray: &Ray) -> FineRay {
        let FineRay { origin, direction, near, far } = FineRay::from(ray);
        let origin = self.back * (origin - self.at.as_dvec3());
        FineRay { origin, direction: self.back * direction, near, far }
    }
}

/// A box in the world around a box that is placed there, rounded outwards; an empty one stays empty.
pub fn placed_box(bounds: &Aabb, transform: &Affine3A) -> Aabb {
    if bounds.is_empty() {
        return Aabb::EMPTY;
    }
    let (matrix, at) = (transform.matrix3.as_dmat3(), Vec3::from(transform.translation).as_dvec3());
    let (mut min, mut max) = (at, at);
    let corners = [bounds.min.as_dvec3(), bounds.max.as_dvec3()];
    for axis in 0..3 {
        let [a, b] = corners.map(|corner| matrix.col(axis) * corner[axis]);
        min += a.min(b);
        max += a.max(b);
    }
    let outward = |at: DVec3, to: fn(f32) -> f32| at.as_vec3().to_array().map(to).into();
    Aabb { min: outward(min, f32::next_down), max: outward(max, f32::next_up) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Mat3A;

    fn skew(matrix: Mat3A) -> Option<f64> {
        Place::new(&Affine3A { matrix3: matrix, translation: glam::Vec3A::ONE }).map(|(_, skew)| skew)
    }

    #[test]
    fn the_skew_is_that_of_axes_that_are_no_longer_at_right_angles() {
        let turn = Mat3A::from_rotation_z(0.8) * Mat3A::from_rotation_x(0.3);
        let squeeze = Mat3A::from_diagonal(Vec3::new(1.0, 1e-3, 50.0));
        assert_eq!(skew(Mat3A::IDENTITY), Some(1.0));
        assert!((skew(squeeze).unwrap() - 1.0).abs() < 1e-9);
        assert!(skew(turn).unwrap() < 3.0 && skew(turn * squeeze).unwrap() < 3.0);
        let skewed = skew(squeeze * turn).unwrap();
        assert!(skewed > 1e3, "{skewed}");
        for flat in [
            Mat3A::ZERO,
            Mat3A::from_diagonal(Vec3::new(1.0, 0.0, 1.0)),
            Mat3A::from_diagonal(Vec3::new(1.0, 1.0, f32::NAN)),
            Mat3A::from_diagonal(Vec3::splat(1e-20)),
            Mat3A::from_cols(glam::Vec3A::ONE, glam::Vec3A::ONE, glam::Vec3A::X),
        ] {
            assert_eq!(skew(flat), None, "{flat}");
        }
    }

    #[test]
    fn a_ray_goes_there_and_back() {
        let transform = Affine3A::from_translation(Vec3::new(3e6, -2.0, 7.0))
            * Affine3A::from_axis_angle(Vec3::new(1.0, 2.0, -0.5).normalize(), 1.1)
            * Affine3A::from_scale(Vec3::new(-2.0, 1e-4, 30.0));
        let (place, _) = Place::new(&transform).unwrap();
        let ray =
            Ray { near: 0.5, far: 9.0, ..Ray::new(Vec3::new(3e6, 1.0, 2.0), Vec3::new(0.1, -2.0, 0.3)) };
        let own = place.take_in(&ray);
        let matrix = transform.matrix3.as_dmat3();
        for t in [0.5, 9.0] {
            let expected = ray.origin.as_dvec3() + ray.direction.as_dvec3() * t;
            let found =
                matrix * (own.origin + own.direction * t) + Vec3::from(transform.translation).as_dvec3();
            assert!(found.distance(expected) < 1e-9, "{found} and {expected}");
        }
        assert_eq!((own.near, own.far), (0.5, 9.0));
        let (still, _) = Place::new(&Affine3A::IDENTITY).unwrap();
        assert_eq!(still.take_in(&ray).rounded(), ray, "where nothing is changed nothing is rounded");
    }
}
