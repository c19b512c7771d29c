//! Bounding spheres (Paper I sec. 1 and 5).

use glam::{DVec3, Vec3};

use super::{Placed, Volume};
use crate::geometry::culling::ROUNDING;

/// A sphere, in metres; empty if its radius is negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its middle.
    pub centre: Vec3,
    /// Its radius.
    pub radius: f32,
}

impl Sphere {
    /// The sphere that holds nothing.
    pub const EMPTY: Self = Self { centre: Vec3::ZERO, radius: -1.0 };

    /// A small sphere around some points: Ritter's, from the widest of the axes' extreme pairs, grown point
    /// by point; or that about the middle of their box if it is smaller. At most some 5 to 20 % larger than
    /// the smallest there is. Empty if there are none.
    pub fn of_points(points: &[Vec3]) -> Self {
        let Some(first) = points.first() else { return Self::EMPTY };
        let mut ends = [(*first, *first); 3];
        for point in points {
            for (axis, (low, high)) in ends.iter_mut().enumerate() {
                if point[axis] < low[axis] {
                    *low = *point;
                }
                if point[axis] > high[axis] {
                    *high = *point;
                }
            }
        }
        let exact = |(a, b): (Vec3, Vec3)| (a.as_dvec3(), b.as_dvec3());
        let [x, y, z] = ends.map(exact);
        let widest = [y, z].into_iter().fold(x, |widest: (DVec3, DVec3), pair| {
            if pair.0.distance_squared(pair.1) > widest.0.distance_squared(widest.1) { pair } else { widest }
        });
        let mut centre = (widest.0 + widest.1) / 2.0;
        let mut radius = widest.0.distance(widest.1) / 2.0;
        for point in points {
            let way = point.as_dvec3() - centre;
            let distance = way.length();
            if distance > radius {
                // Just large enough for the point and for all that was held before.
                let grown = (radius + distance) / 2.0;
                centre += way * ((grown - radius) / distance);
                radius = grown;
            }
        }
        let middle = DVec3::new(x.0.x + x.1.x, y.0.y + y.1.y, z.0.z + z.1.z) / 2.0;
        let [grown, about] = [centre, middle].map(|centre| Self::about(centre.as_vec3(), points));
        if about.radius < grown.radius { about } else { grown }
    }

    /// The smallest sphere about a given middle around some points.
    fn about(centre: Vec3, points: &[Vec3]) -> Self {
        let farthest = points.iter().map(|point| point.as_dvec3().distance_squared(centre.as_dvec3()));
        // Never less than the distance, whatever the rounding; a NaN among the points stays one.
        let radius = farthest.fold(0.0, |most: f64, d| if d > most || d.is_nan() { d } else { most }).sqrt();
        Self { centre, radius: (radius as f32).next_up() }
    }
}

/// A sphere relative to the eye.
#[derive(Clone, Copy, Debug)]
pub struct PlacedSphere {
    centre: Vec3,
    radius: f32,
    slack: f32,
}

impl Volume for Sphere {
    type Field = ();
    type Eye = Vec3;
    type Placed<'a> = PlacedSphere;
    const ROUND: bool = true;

    #[inline]
    fn field(_: Vec3) {}

    #[inline]
    fn eye(eye: Vec3) -> Vec3 {
        eye
    }

    #[inline]
    fn is_empty(&self) -> bool {
        self.radius < 0.0
    }

    #[inline]
    fn is_nan(&self) -> bool {
        self.centre.is_nan() || self.radius.is_nan()
    }

    #[inline]
    fn placed(&self, eye: &Vec3) -> PlacedSphere {
        let centre = self.centre - *eye;
        // Also the length of the normal, which is 1 to within an ulp, is covered by this.
        let slack = (centre.abs().element_sum() + self.radius) * ROUNDING + f32::MIN_POSITIVE;
        PlacedSphere { centre, radius: self.radius, slack }
    }

    #[inline]
    fn centre(&self) -> Vec3 {
        self.centre
    }

    #[inline]
    fn radius(&self) -> f32 {
        self.radius
    }

    #[inline]
    fn corners_from(&self, origin: Vec3) -> [Vec3; 8] {
        let centre = self.centre - origin;
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { -self.radius } else { self.radius };
            centre + Vec3::new(pick(0), pick(1), pick(2))
        })
    }
}

impl Placed for PlacedSphere {
    type Field = ();

    #[inline]
    fn nearest(&self, normal: Vec3, (): &()) -> f32 {
        normal.dot(self.centre) - self.radius
    }

    #[inline]
    fn farthest(&self, normal: Vec3, (): &()) -> f32 {
        normal.dot(self.centre) + self.radius
    }

    #[inline]
    fn slack(&self) -> f32 {
        self.slack
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holds_its_points_and_is_not_much_too_large() {
        assert!(Sphere::of_points(&[]).is_empty());
        assert!(Sphere::of_points(&[Vec3::splat(1e6)]).radius < 1e-6);
        assert!(Sphere::of_points(&[Vec3::ZERO, Vec3::NAN]).is_nan());
        let cube = crate::geometry::Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) }.corners();
        assert!((Sphere::of_points(&cube).radius - 3f32.sqrt()).abs() < 1e-5);
        let mut random = 1u32;
        let mut next = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            random as f32 / u32::MAX as f32
        };
        for offset in [0.0, 1e6] {
            let points: Vec<Vec3> =
                (0..500).map(|_| Vec3::new(next(), next() * 3.0, next()) + Vec3::splat(offset)).collect();
            let sphere = Sphere::of_points(&points);
            for point in &points {
                assert!(point.as_dvec3().distance(sphere.centre.as_dvec3()) <= f64::from(sphere.radius));
            }
            assert!(sphere.radius < 1.2 * 11f32.sqrt() / 2.0, "{sphere:?}");
        }
    }
}
