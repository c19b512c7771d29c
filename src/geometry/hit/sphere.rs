//! Where a ray meets a sphere.

use super::first_within;
use crate::geometry::{FineRay, Sphere};

/// The least `t` at which a ray meets a sphere's surface, from outside or from inside.
///
/// In f64, and with the discriminant taken from the distance of the middle from the line (Haines, Günther and
/// Akenine-Möller, "Precision improvements for ray/sphere intersection", Ray Tracing Gems 2019, ch. 7), so that a small
/// sphere far away is not lost. A sphere of radius 0 or less, and a ray that holds a NaN, meet nothing.
pub fn sphere(ray: impl Into<FineRay>, sphere: &Sphere) -> Option<f32> {
    let ray = ray.into();
    if sphere.radius <= 0.0 {
        return None;
    }
    let direction = ray.direction;
    let from = ray.origin - sphere.centre.as_dvec3();
    let radius = f64::from(sphere.radius);
    let square = direction.length_squared();
    let middle = -from.dot(direction) / square;
    let off = from + direction * middle;
    let left = radius * radius - off.length_squared();
    // Also false for a direction of length 0 and for what is not a number.
    if left >= 0.0 && square > 0.0 {
        let half = (left / square).sqrt();
        return first_within(&ray, [middle - half, middle + half]);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use glam::Vec3;

    const UNIT: Sphere = Sphere { centre: Vec3::ZERO, radius: 1.0 };

    #[test]
    fn from_outside_from_inside_and_beside() {
        let along = |z: f32| Ray::new(Vec3::new(0.0, 0.0, z), Vec3::Z);
        assert_eq!(sphere(&along(-3.0), &UNIT), Some(2.0));
        assert_eq!(sphere(&along(0.0), &UNIT), Some(1.0));
        assert_eq!(sphere(&along(3.0), &UNIT), None, "it lies behind");
        assert_eq!(sphere(&Ray::new(Vec3::new(1.001, 0.0, -3.0), Vec3::Z), &UNIT), None);
        assert_eq!(sphere(&Ray { near: 2.5, ..along(-3.0) }, &UNIT), Some(4.0), "the far side is told");
        assert_eq!(sphere(&Ray { far: 1.9, ..along(-3.0) }, &UNIT), None);
        assert_eq!(sphere(&Ray::new(Vec3::new(0.0, 0.0, -3.0), Vec3::Z * 4.0), &UNIT), Some(0.5));
    }

    #[test]
    fn what_is_told_lies_on_the_surface_at_any_scale_and_distance() {
        for scale in [1e-12_f32, 1e-3, 1.0, 1e6, 1e12] {
            for distance in [2.0_f32, 1e2, 1e5] {
                let ball = Sphere { centre: Vec3::new(0.3, -0.2, 0.1) * scale, radius: 0.5 * scale };
                for step in 0..200 {
                    let aim = ball.centre + Vec3::new(0.0, 0.49 - 0.0049 * step as f32, 0.0) * scale;
                    let origin = Vec3::new(distance, 0.7, 0.4) * scale;
                    let ray = Ray::new(origin, aim - origin);
                    let t = sphere(&ray, &ball).expect("it is aimed at");
                    let at = ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t);
                    let off = at.distance(ball.centre.as_dvec3()) / f64::from(ball.radius) - 1.0;
                    assert!(
                        off.abs() < 1e-6 * f64::from(distance.max(1.0)),
                        "{off} at {scale} from {distance}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_is_degenerate_meets_nothing() {
        let ray = Ray::new(Vec3::new(0.0, 0.0, -3.0), Vec3::Z);
        for radius in [0.0, -1.0, f32::NAN] {
            assert_eq!(sphere(&ray, &Sphere { radius, ..UNIT }), None);
        }
        assert_eq!(sphere(&Ray { direction: Vec3::ZERO, ..ray }, &UNIT), None);
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(sphere(&Ray { origin: Vec3::new(bad, 0.0, 0.0), ..ray }, &UNIT), None);
            assert_eq!(sphere(&Ray { direction: Vec3::new(0.0, bad, 1.0), ..ray }, &UNIT), None);
        }
        assert_eq!(sphere(&Ray { near: f32::NAN, ..ray }, &UNIT), None);
        assert_eq!(sphere(&Ray { far: f32::NAN, ..ray }, &UNIT), None);
    }
}
