//! Where a ray meets triangles, in f64: the oracle of the ray tests. Slow and plain on purpose.

use super::super::{FineRay, Ray};
use glam::{DVec3, Vec3};

/// Where a ray meets a triangle's plane, in f64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// How far along the ray, in lengths of its direction.
    pub t: f64,
    /// The weights of the corners; they add up to 1, and one is negative if the ray passes outside.
    pub weights: [f64; 3],
    /// The cosine of the angle between the ray and the triangle's normal, without its sign.
    pub steepness: f64,
}

impl Crossing {
    /// Where a ray's line meets a triangle's plane, corners in metres; `None` if they are parallel, or the triangle has
    /// no area, or something is not finite.
    pub fn of(ray: &Ray, triangle: &[Vec3; 3]) -> Option<Self> {
        Self::of_fine(&FineRay::from(ray), &triangle.map(|corner| corner.as_dvec3()))
    }

    /// The same of what is known in f64.
    pub fn of_fine(ray: &FineRay, triangle: &[DVec3; 3]) -> Option<Self> {
        let direction = ray.direction;
        let [a, b, c] = triangle.map(|corner| corner - ray.origin);
        let normal = (b - a).cross(c - a);
        let slope = normal.dot(direction);
        let steepness = slope.abs() / (normal.length() * direction.length());
        // Twice the volumes of the ray with each edge.
        let volume = |p: DVec3, q: DVec3| direction.dot(q.cross(p));
        let volumes = [volume(c, b), volume(a, c), volume(b, a)];
        let sum: f64 = volumes.iter().sum();
        let crossing =
            Self { t: normal.dot(a) / slope, weights: volumes.map(|volume| volume / sum), steepness };
        let finite = crossing.t.is_finite() && crossing.weights.iter().all(|weight| weight.is_finite());
        (finite && steepness > 0.0).then_some(crossing)
    }

    /// The least weight: above 0 within the triangle.
    pub fn inside_by(&self) -> f64 {
        self.weights.into_iter().fold(f64::INFINITY, f64::min)
    }
}

/// The nearest crossing of a ray with triangles, corners in metres, that lies within one by `margin`, a weight, and
/// within the ray's reach; and the triangle's number.
pub fn nearest_crossing(ray: &Ray, triangles: &[[Vec3; 3]], margin: f64) -> Option<(usize, Crossing)> {
    let reach = f64::from(ray.near)..=f64::from(ray.far);
    triangles
        .iter()
        .enumerate()
        .filter_map(|(item, triangle)| Some((item, Crossing::of(ray, triangle)?)))
        .filter(|(_, crossing)| crossing.inside_by() >= margin && reach.contains(&crossing.t))
        .min_by(|(_, a), (_, b)| a.t.total_cmp(&b.t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_crossings() {
        let triangle = [Vec3::new(0.0, 0.0, 2.0), Vec3::new(4.0, 0.0, 2.0), Vec3::new(0.0, 4.0, 2.0)];
        let ray = Ray::new(Vec3::new(1.0, 2.0, -2.0), Vec3::new(0.0, 0.0, 2.0));
        let crossing = Crossing::of(&ray, &triangle).unwrap();
        assert_eq!((crossing.t, crossing.weights), (2.0, [0.25, 0.25, 0.5]));
        assert_eq!(crossing.steepness, 1.0);
        let behind = triangle.map(|corner| corner - Vec3::Z * 8.0);
        assert_eq!(nearest_crossing(&ray, &[behind, triangle, triangle], 0.0).unwrap().0, 1);
        assert!(nearest_crossing(&ray, &[triangle], 0.3).is_none());
        assert!(Crossing::of(&Ray::new(Vec3::ZERO, Vec3::X), &triangle).is_none());
        assert!(Crossing::of(&ray, &[triangle[0]; 3]).is_none());
    }
}
