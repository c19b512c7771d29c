//! Triangles cut by slabs: the box of what is left, never too small.

use super::lanes::{Box8, Item};
use glam::{DVec3, Vec3};

/// Around the part of an item between two planes of an axis, in metres, within its box; empty if there is no such
/// part. An item without a triangle fills its box.
///
/// Corners made by cutting are reckoned in f64 and rounded away from the middle, past the error of the cutting.
pub(super) fn clip(item: &Item, triangle: Option<&[Vec3; 3]>, axis: usize, low: f32, high: f32) -> Box8 {
    let bounds = item.bounds();
    let mut part = bounds;
    part.0[axis] = part.0[axis].min(-low);
    part.0[axis + 4] = part.0[axis + 4].min(high);
    let Some(triangle) = triangle else { return if is_empty(&part) { Box8::EMPTY } else { part } };
    let corners = triangle.map(Vec3::as_dvec3);
    let mut around = Box8::EMPTY;
    for (from, to) in [(0, 1), (1, 2), (2, 0)] {
        let (from, to) = (corners[from], corners[to]);
        if (f64::from(low)..=f64::from(high)).contains(&from[axis]) {
            around = around.union(&Box8::of_point(from.as_vec3().to_array()));
        }
        for plane in [low, high].map(f64::from) {
            let (a, b) = (from[axis] - plane, to[axis] - plane);
            if a * b < 0.0 {
                around = around.union(&crossing(from, to, a / (a - b)));
            }
        }
    }
    for lane in [0, 1, 2, 4, 5, 6] {
        part.0[lane] = part.0[lane].min(around.0[lane]);
    }
    if is_empty(&part) { Box8::EMPTY } else { part }
}

fn is_empty(bounds: &Box8) -> bool {
    (0..3).any(|axis| -bounds.0[axis] > bounds.0[axis + 4])
}

/// The box of a point between two others, a little larger than it can be off.
fn crossing(from: DVec3, to: DVec3, at: f64) -> Box8 {
    let point = from + (to - from) * at;
    let error = from.abs().max(to.abs()) * (8.0 * f64::EPSILON);
    let (low, high) = ((point - error).to_array(), (point + error).to_array());
    let mut lanes = Box8::EMPTY;
    for axis in 0..3 {
        lanes.0[axis] = -(low[axis] as f32).next_down();
        lanes.0[axis + 4] = (high[axis] as f32).next_up();
    }
    lanes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use crate::structure::bvh::build::tests::noise;

    #[test]
    fn every_point_of_a_triangle_is_in_one_of_its_parts() {
        let mut next = noise(31);
        for round in 0..300 {
            let size = if round % 3 == 0 { 1e-3 } else { 50.0 };
            let at = Vec3::splat(if round % 2 == 0 { 0.0 } else { 1e5 });
            let triangle: [Vec3; 3] = std::array::from_fn(|_| at + Vec3::new(next(), next(), next()) * size);
            let bounds = Aabb::of_points(triangle);
            let item = Item::new(&Box8::new(&bounds), 0, 1);
            for axis in 0..3 {
                let plane = bounds.min[axis] + (bounds.max[axis] - bounds.min[axis]) * next();
                let left = clip(&item, Some(&triangle), axis, f32::NEG_INFINITY, plane).aabb();
                let right = clip(&item, Some(&triangle), axis, plane, f32::INFINITY).aabb();
                assert!(bounds.contains(&left) && bounds.contains(&right));
                assert_eq!(left.union(right), bounds, "all corners are there");
                for _ in 0..50 {
                    let (u, v) = (next(), next());
                    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                    let [a, b, c] = triangle.map(Vec3::as_dvec3);
                    let point = a + (b - a) * f64::from(u) + (c - a) * f64::from(v);
                    let part = if point[axis] < f64::from(plane) { left } else { right };
                    let within =
                        part.min.as_dvec3().cmple(point).all() && part.max.as_dvec3().cmpge(point).all();
                    assert!(within, "{point} is not in {part:?}");
                }
            }
        }
    }
}
