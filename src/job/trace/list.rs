//! The slow answer for rays: every item, one by one.

use glam::Vec3;

use crate::geometry::{FineRay, Hit, Ray, hit};
use crate::scene::Shape;
use crate::structure::bvh::Intersector;

use super::Items;
use super::flocks::way_in;

/// All items, gone through one by one, triangles in f64: what every hierarchy's pictures are held against.
pub struct List<'a>(pub &'a Items);

impl Intersector for List<'_> {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        // A later item must be nearer: of hits equally near the lowest number stays.
        self.hits(ray).fold(None, |nearest: Option<Hit>, hit| match nearest {
            Some(nearest) if nearest.t <= hit.t => Some(nearest),
            _ => Some(hit),
        })
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.hits(ray).next().is_some()
    }
}

impl List<'_> {
    /// A hit of each item that is met, by number.
    fn hits(&self, ray: &Ray) -> impl Iterator<Item = Hit> {
        let own = FineRay::from(ray);
        let triangles = self.0.triangles.iter().map(|corners| triangle(ray, corners));
        let primitives = self.0.primitives.iter().map(move |primitive| shape(own, &primitive.shape));
        let placed = self.0.places.iter().flat_map(move |(flock, transform)| {
            let own = way_in(transform).map(|(place, _)| place.take_in(ray));
            self.0.flocks[*flock as usize].iter().map(move |primitive| shape(own?, &primitive.shape))
        });
        let without_weights = |t: Option<f32>| t.map(|t| [t, 0.0, 0.0]);
        let hits = triangles.chain(primitives.chain(placed).map(without_weights)).zip(0..);
        hits.filter_map(|(found, item)| found.map(|[t, u, v]| Hit { t, u, v, item }))
    }
}

/// Where a ray meets a sphere or cone.
#[inline]
pub(super) fn shape(ray: FineRay, shape: &Shape) -> Option<f32> {
    match shape {
        Shape::Sphere(sphere) => hit::sphere(ray, sphere),
        Shape::Cone(cone) => hit::cone(ray, cone),
    }
}

/// `t`, `u` and `v` where a ray meets a triangle, from either side, its edges taken as part of it (Möller and Trumbore
/// 1997, in f64).
fn triangle(ray: &Ray, corners: &[Vec3; 3]) -> Option<[f32; 3]> {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    let (direction, from) = (ray.direction.as_dvec3(), ray.origin.as_dvec3() - a);
    let (e, f) = (b - a, c - a);
    let p = direction.cross(f);
    let q = from.cross(e);
    let determinant = e.dot(p);
    let (u, v, t) = (from.dot(p) / determinant, direction.dot(q) / determinant, f.dot(q) / determinant);
    // A determinant of 0 gives infinities or NaN, which are on no triangle.
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    let t = t as f32;
    (inside && t >= ray.near && t <= ray.far).then_some([t, u as f32, v as f32])
}
