//! Where a ray meets the side of a cone.

use glam::{DVec3, Vec3};

use super::first_within;
use crate::geometry::{Aabb, FineRay};

/// The side of a cut-off cone, open at both ends; a cylinder if its radii are equal, a cone if one is 0 (the cone of
/// Haines' Neutral File Format). Metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Middle of one end.
    pub base: Vec3,
    /// Radius there.
    pub base_radius: f32,
    /// Middle of the other end.
    pub tip: Vec3,
    /// Radius there.
    pub tip_radius: f32,
}

impl Cone {
    /// A box around it.
    pub fn bounds(&self) -> Aabb {
        let [base, tip] = [(self.base, self.base_radius), (self.tip, self.tip_radius)]
            .map(|(at, radius)| Aabb { min: at - radius, max: at + radius });
        base.union(tip)
    }

    /// The normal at a point of its surface, outward and of unit length; none if it has no length.
    pub fn normal(&self, at: Vec3) -> Option<Vec3> {
        let (axis, length) = self.axis()?;
        let off = at.as_dvec3() - self.base.as_dvec3();
        let out = (off - axis * off.dot(axis)).try_normalize()?;
        // As much as the side leans.
        let lean = (f64::from(self.base_radius) - f64::from(self.tip_radius)) / length;
        Some((out + axis * lean).normalize().as_vec3())
    }

    /// From the base to the tip: a unit vector, and how far.
    fn axis(&self) -> Option<(DVec3, f64)> {
        let way = self.tip.as_dvec3() - self.base.as_dvec3();
        let length = way.length();
        (length > 0.0).then(|| (way / length, length))
    }
}

/// The least `t` at which a ray meets a cone's side, from outside or from inside. In f64. A cone without length, and a
/// ray that holds a NaN, meet nothing.
pub fn cone(ray: impl Into<FineRay>, cone: &Cone) -> Option<f32> {
    let ray = ray.into();
    let (axis, length) = cone.axis()?;
    let direction = ray.direction;
    let speed = direction.length();
    if !(speed > 0.0 && speed.is_finite()) {
        return None;
    }
    let direction = direction / speed;
    // From where the ray is nearest to the base, so that from afar nothing cancels.
    let from = ray.origin - cone.base.as_dvec3();
    let skipped = -from.dot(direction);
    let from = from + direction * skipped;
    let slope = (f64::from(cone.tip_radius) - f64::from(cone.base_radius)) / length;
    // Along the axis and across it: the surface is where the distance across is `radius + slope * along`.
    let (along, rise) = (from.dot(axis), direction.dot(axis));
    let (across, drift) = (from - axis * along, direction - axis * rise);
    let radius = f64::from(cone.base_radius) + slope * along;
    let a = drift.length_squared() - slope * slope * rise * rise;
    let b = across.dot(drift) - slope * rise * radius;
    let c = across.length_squared() - radius * radius;
    let roots = roots(a, b, c)?;
    let on_side = |t: f64| {
        let along = along + t * rise;
        // The other half of the double cone lies beyond the ends too.
        if (0.0..=length).contains(&along) { (t + skipped) / speed } else { f64::NAN }
    };
    first_within(&ray, roots.map(on_side))
}

/// Where `a t^2 + 2 b t + c` is 0, without cancellation.
fn roots(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let left = b * b - a * c;
    if left < 0.0 || left.is_nan() {
        return None;
    }
    let q = -(b + left.sqrt().copysign(b));
    // A line along the side of a cone has one root only; the other goes to infinity, which is on no cone.
    Some([q / a, c / q])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;

    const CYLINDER: Cone = Cone { base: Vec3::ZERO, base_radius: 1.0, tip: Vec3::Y, tip_radius: 1.0 };
    const POINTED: Cone = Cone { base: Vec3::ZERO, base_radius: 1.0, tip: Vec3::Y, tip_radius: 0.0 };

    fn across(y: f32) -> Ray {
        Ray::new(Vec3::new(-3.0, y, 0.0), Vec3::X)
    }

    #[test]
    fn sides_are_met_and_ends_are_open() {
        assert_eq!(cone(&across(0.5), &CYLINDER), Some(2.0));
        assert_eq!(cone(&across(0.5), &POINTED), Some(2.5));
        assert_eq!(cone(&Ray { near: 2.1, ..across(0.5) }, &CYLINDER), Some(4.0));
        for y in [-0.01, 1.01] {
            assert_eq!(cone(&across(y), &CYLINDER), None);
            assert_eq!(cone(&across(y), &POINTED), None, "the other half of the double cone at {y}");
        }
        let through = Ray::new(Vec3::new(0.2, -3.0, 0.1), Vec3::Y);
        assert_eq!(cone(&through, &CYLINDER), None, "it goes in and out at the open ends");
        let t = cone(&through, &POINTED).expect("the side leans over it");
        assert!((t - (4.0 - 0.05_f32.sqrt())).abs() < 1e-6, "{t}");
        assert_eq!(POINTED.normal(Vec3::new(0.5, 0.5, 0.0)).map(|n| n.y > 0.7 && n.x > 0.7), Some(true));
    }

    /// Rays aimed a little below the surface, as what is aimed at the outline may miss by rounding: where they meet it is
    /// on it.
    #[test]
    fn aimed_rays_meet_the_surface_at_any_scale_and_distance() {
        for (scale, distance) in [(1e-9_f32, 3.0_f32), (1.0, 3.0), (1.0, 1e4), (1e9, 50.0)] {
            let shape = Cone {
                base: Vec3::new(0.1, -0.2, 0.3) * scale,
                base_radius: 0.8 * scale,
                tip: Vec3::new(0.7, 1.1, -0.4) * scale,
                tip_radius: 0.3 * scale,
            };
            let (axis, length) = shape.axis().expect("it has a length");
            let side = axis.any_orthonormal_vector();
            for step in 15..285 {
                let (share, angle) = (f64::from(step) / 300.0, f64::from(step) * 0.37);
                let radius =
                    f64::from(shape.base_radius) * (1.0 - share) + f64::from(shape.tip_radius) * share;
                let radius = 0.99 * radius;
                let out = side * angle.cos() + axis.cross(side) * angle.sin();
                let aim = (shape.base.as_dvec3() + axis * (share * length) + out * radius).as_vec3();
                let origin = Vec3::new(0.3, 0.4, 1.0) * distance * scale;
                let ray = Ray::new(origin, aim - origin);
                let t = cone(&ray, &shape).unwrap_or_else(|| panic!("missed at {step}, {scale}, {distance}"));
                let at =
                    ray.origin.as_dvec3() + ray.direction.as_dvec3() * f64::from(t) - shape.base.as_dvec3();
                let along = at.dot(axis);
                let there = f64::from(shape.base_radius)
                    + (f64::from(shape.tip_radius) - f64::from(shape.base_radius)) * along / length;
                let off = ((at - axis * along).length() - there).abs() / f64::from(scale);
                assert!(off < 1e-6 * f64::from(distance), "{off} at {scale}, {distance}");
            }
        }
    }

    #[test]
    fn what_is_degenerate_meets_nothing() {
        assert_eq!(cone(&across(0.5), &Cone { tip: Vec3::ZERO, ..CYLINDER }), None);
        assert_eq!(cone(&Ray { direction: Vec3::ZERO, ..across(0.5) }, &CYLINDER), None);
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(cone(&Ray { direction: Vec3::new(1.0, bad, 0.0), ..across(0.5) }, &CYLINDER), None);
            assert_eq!(cone(&Ray { origin: Vec3::new(0.0, bad, 0.0), ..across(0.5) }, &CYLINDER), None);
        }
        assert_eq!(cone(&Ray::new(Vec3::new(1.0, -3.0, 0.0), Vec3::Y), &CYLINDER), None, "along its side");
    }
}
