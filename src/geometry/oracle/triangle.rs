//! Triangles, and the solid angle that a body of triangles takes up.

use glam::{DVec3, Vec3};

use super::Hexahedron;

impl Hexahedron {
    /// Whether a triangle has a point in common with the frustum: it is cut by one plane after the other, and
    /// something is left. One with a NaN counts as having one.
    pub fn meets_triangle(&self, triangle: [Vec3; 3]) -> bool {
        if triangle.iter().any(|corner| corner.is_nan()) {
            return true;
        }
        let mut polygon: Vec<DVec3> = triangle.iter().map(|corner| corner.as_dvec3() - self.eye).collect();
        for (normal, d) in &self.planes {
            let distance = |point: &DVec3| normal.dot(*point) + d;
            let mut left = Vec::with_capacity(polygon.len() + 1);
            for (i, from) in polygon.iter().enumerate() {
                let to = polygon[(i + 1) % polygon.len()];
                let (here, there) = (distance(from), distance(&to));
                if here <= 0.0 {
                    left.push(*from);
                }
                if (here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0) {
                    left.push(*from + (to - *from) * (here / (here - there)));
                }
            }
            if left.is_empty() {
                return false;
            }
            polygon = left;
        }
        true
    }

    /// The solid angle of the view, in steradians.
    pub fn solid_angle(&self) -> f64 {
        let [a, b, c, d] = [4, 5, 7, 6].map(|corner: usize| self.corners[corner]);
        triangle_angle(a, b, c).abs() + triangle_angle(a, c, d).abs()
    }

    /// The solid angle that a box with these corners (bit `i` of the index says which end of axis `i`) takes
    /// up as seen from the eye, in steradians; the whole sphere if the eye is in it.
    pub fn solid_angle_of(&self, corners: &[Vec3; 8]) -> f64 {
        let at = corners.map(|corner| corner.as_dvec3() - self.eye);
        // Each face anticlockwise seen from outside, if the axes are right-handed.
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let angles = faces
            .map(|[a, b, c, d]| triangle_angle(at[a], at[b], at[c]) + triangle_angle(at[a], at[c], at[d]));
        let (front, back) = angles
            .iter()
            .fold((0.0, 0.0), |(front, back), angle: &f64| (front + angle.max(0.0), back - angle.min(0.0)));
        // From outside, the faces that are seen from the front cover what those seen from behind cover.
        if (front - back).abs() < 2.0 * std::f64::consts::PI { front.max(back) } else { front + back }
    }
}

/// The solid angle of a triangle as seen from the origin, in steradians, signed by the way it turns (van
/// Oosterom and Strackee, 1983).
fn triangle_angle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let below = la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la;
    2.0 * a.dot(b.cross(c)).atan2(below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Camera, Lens, Volume};

    fn oracle() -> Hexahedron {
        let lens = Lens::Symmetric { fov_y: std::f32::consts::FRAC_PI_2, aspect: 1.0 };
        Hexahedron::new(&Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, lens, 1.0, 10.0).unwrap())
    }

    #[test]
    fn triangles() {
        let oracle = oracle();
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        // All corners outside, the middle inside.
        assert!(oracle.meets_triangle([at(-99.0, -99.0, -5.0), at(99.0, -99.0, -5.0), at(0.0, 99.0, -5.0)]));
        assert!(!oracle.meets_triangle([at(-99.0, -99.0, 5.0), at(99.0, -99.0, 5.0), at(0.0, 99.0, 5.0)]));
        // Across an edge of the frustum, on neither side of any one plane.
        assert!(!oracle.meets_triangle([at(12.0, 0.0, -9.0), at(9.0, 0.0, -12.0), at(13.0, 0.0, -13.0)]));
        assert!(oracle.meets_triangle([at(0.0, 0.0, -2.0); 3]));
        assert!(oracle.meets_triangle([Vec3::NAN; 3]));
    }

    #[test]
    fn angles() {
        let oracle = oracle();
        let sixth = 4.0 * std::f64::consts::PI / 6.0;
        assert!((oracle.solid_angle() - sixth).abs() < 1e-6, "a face of a cube seen from its middle");
        let cube = |middle: Vec3, half: f32| Aabb { min: middle - half, max: middle + half }.corners();
        assert!((oracle.solid_angle_of(&cube(Vec3::ZERO, 1.0)) - 6.0 * sixth).abs() < 1e-9, "the eye in it");
        let far = oracle.solid_angle_of(&cube(Vec3::new(0.0, 0.0, -1000.0), 0.5));
        assert!((far - 1e-6).abs() < 1e-8, "{far}");
        let near = oracle.solid_angle_of(&cube(Vec3::new(2.0, 0.0, 0.0), 1.0));
        assert!((near - sixth).abs() < 1e-9, "{near}");
    }
}
