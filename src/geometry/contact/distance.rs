//! How near triangles come to each other, in f64.

use super::{Triangle, are_finite, edges, further, meet};
use glam::DVec3;

/// Whether two triangles come nearer than `distance`, in metres, or as near; what is within the rounding of f64 of
/// it may be told either way, for 0 and below the answer is that of [`meet`]. If the distance or a coordinate is not a
/// number nobody knows, and the answer is yes.
pub fn closer(a: &Triangle, b: &Triangle, distance: f64) -> bool {
    if distance <= 0.0 {
        return meet(a, b);
    }
    if distance.is_nan() || !are_finite(a, b) {
        return true;
    }
    if further(a, b, distance) {
        return false;
    }
    let limit = distance * distance;
    // The nearest points lie on two edges, or a corner and a face; or the triangles meet.
    edges(a).any(|s| edges(b).any(|t| between_segments(s, t) <= limit))
        || b.iter().any(|corner| from_triangle(*corner, a) <= limit)
        || a.iter().any(|corner| from_triangle(*corner, b) <= limit)
        || distance == f64::INFINITY
        || meet(a, b)
}

/// The square of the distance between two segments.
fn between_segments([p, p1]: [DVec3; 2], [q, q1]: [DVec3; 2]) -> f64 {
    let (u, v, w) = (p1 - p, q1 - q, p - q);
    let (uu, uv, vv, uw, vw) = (u.dot(u), u.dot(v), v.dot(v), u.dot(w), v.dot(w));
    // Across both; not by `uu * vv - uv * uv`, of which little is left where they are all but parallel.
    let across = u.cross(v);
    let share = |over: f64, under: f64| if under > 0.0 { (over / under).clamp(0.0, 1.0) } else { 0.0 };
    // Nearest on the first to the line of the second, then on the second to that, then back again.
    let s = share(across.cross(v).dot(w), across.length_squared());
    let t = share(vw + s * uv, vv);
    let s = share(t * uv - uw, uu);
    let t = share(vw + s * uv, vv);
    (w + u * s - v * t).length_squared()
}

/// The square of a point's distance from a triangle's inside; infinite if it is nearest to an edge.
fn from_triangle(point: DVec3, triangle: &Triangle) -> f64 {
    let [a, b, c] = *triangle;
    let normal = (b - a).cross(c - a);
    let inside = |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(normal) >= 0.0;
    if normal == DVec3::ZERO || !(inside(a, b) && inside(b, c) && inside(c, a)) {
        return f64::INFINITY;
    }
    let height = (point - a).dot(normal);
    height * height / normal.length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The distance by brute force: many points of each.
    fn sampled(a: &Triangle, b: &Triangle) -> f64 {
        let points = |t: &Triangle| {
            let t = *t;
            (0..=40).flat_map(move |i| {
                (0..=40 - i).map(move |j| {
                    let (u, v) = (f64::from(i) / 40.0, f64::from(j) / 40.0);
                    t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v
                })
            })
        };
        let to: Vec<DVec3> = points(b).collect();
        points(a).flat_map(|p| to.iter().map(move |q| p.distance(*q))).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn agrees_with_many_points_of_each() {
        let mut random = crate::geometry::contact::tests::Random(7);
        for round in 0..60 {
            let (a, b) = (random.triangle(), random.triangle());
            let b = b.map(|corner| corner + DVec3::X * f64::from(round % 4));
            let near = sampled(&a, &b);
            assert!(closer(&a, &b, near + 1e-9), "{a:?} {b:?} {near}");
            // No two points sampled lie further from the nearest ones than half a step each.
            assert!(
                !closer(&a, &b, (near - 0.2).max(0.0)) || meet(&a, &b) || near < 0.2,
                "{a:?} {b:?} {near}"
            );
        }
    }

    /// Two edges that cross at a height, all but parallel: no products of four lengths tell where.
    #[test]
    fn needles_that_are_all_but_parallel() {
        for slope in [1e-3, 1e-6, 1e-8, 1e-9] {
            let height = slope * 0.01;
            let turn = glam::DQuat::from_axis_angle(DVec3::new(0.3, -0.8, 0.5).normalize(), 0.7);
            let put = |x: f64, y: f64, z: f64| turn * DVec3::new(x, y, z);
            let across = |x: f64| put(x, slope * (x - 0.3), height);
            let (a, b) =
                ([put(-1.0, 0.0, 0.0), put(0.1, 0.0, 0.0), put(1.7, 0.0, 0.0)], [-1.2, 0.9, 0.2].map(across));
            // What is lost in writing the corners down.
            let slop = 1e-15;
            assert!(closer(&a, &b, height + slop), "{slope}");
            assert!(!closer(&a, &b, height - slop), "{slope}");
        }
    }

    #[test]
    fn flat_ones_and_parallel_ones() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let above = flat.map(|corner| corner + DVec3::Z * 0.5);
        assert!(closer(&flat, &above, 0.5) && !closer(&flat, &above, 0.499));
        let point = [DVec3::new(0.2, 0.2, 0.3); 3];
        assert!(
            closer(&flat, &point, 0.300_001) && !closer(&flat, &point, 0.299) && closer(&point, &point, 1e-9)
        );
        let beside = [DVec3::X * 3.0, DVec3::X * 4.0, DVec3::X * 3.5];
        assert!(closer(&flat, &beside, 2.0) && !closer(&flat, &beside, 1.99));
    }
}
