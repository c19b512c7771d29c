//! Triangles against triangles: what decides, at the leaves, whether two meshes touch.
//!
//! A triangle is the closed set of its points: touching at a corner, lying in one plane, and being flat as an edge or
//! a point are all cases of meeting, decided exactly by predicates of adaptive precision (Shewchuk 1997, as the crate
//! `robust` has them). What is certainly apart is told first, by two planes in plain f64 with a bound on their
//! rounding.

mod distance;
mod segment;

use glam::DVec3;
use robust::{Coord3D, orient3d};
use segment::segment_meets;

/// A triangle by its corners, in metres.
pub type Triangle = [DVec3; 3];

/// Whether two triangles have a point in common: exactly, for coordinates that are between 1e-70 and 1e70 in size, or
/// zero. If one is larger the boxes around them decide; if one is not a number nobody knows, and the answer is yes.
///
/// ```
/// use apportion::geometry::contact::meet;
/// use glam::DVec3;
/// let flat = [DVec3::ZERO, DVec3::X, DVec3::Y];
/// let touching = [DVec3::new(0.25, 0.25, 0.0), DVec3::new(0.0, 0.0, 1.0), DVec3::Z * 2.0];
/// assert!(meet(&flat, &touching));
/// assert!(!meet(&flat, &touching.map(|corner| corner + DVec3::Z * 1e-60)));
/// ```
pub fn meet(a: &Triangle, b: &Triangle) -> bool {
    if beside(a, b) || beside(b, a) {
        return false;
    }
    if a.iter().chain(b).any(|corner| !corner.abs().cmple(DVec3::splat(LARGEST)).all()) {
        return !are_finite(a, b) || !further(a, b, 0.0);
    }
    // Two closed triangles meet exactly if an edge of one meets the other.
    edges(a).any(|edge| segment_meets(edge, b)) || edges(b).any(|edge| segment_meets(edge, a))
}

/// The largest coordinate whose products with two others, and what they are rounded by, f64 can hold.
const LARGEST: f64 = 1e70;

fn are_finite(a: &Triangle, b: &Triangle) -> bool {
    a.iter().chain(b).all(|corner| corner.is_finite())
}

/// Whether the boxes around two triangles, whose coordinates are finite, are further apart than a distance, in metres.
fn further(a: &Triangle, b: &Triangle, distance: f64) -> bool {
    let ends = |[p, q, r]: Triangle| (p.min(q).min(r), p.max(q).max(r));
    let ((a_low, a_high), (b_low, b_high)) = (ends(*a), ends(*b));
    (b_low - a_high).max(a_low - b_high).cmpgt(DVec3::splat(distance)).any()
}

pub use distance::closer;

fn edges(triangle: &Triangle) -> impl Iterator<Item = [DVec3; 2]> {
    let [a, b, c] = *triangle;
    [[a, b], [b, c], [c, a]].into_iter()
}

/// Bound on the rounding of a corner's height over a plane, as a share of the product of the lengths that go into it:
/// some twenty times half a unit in the last place, where the exact analysis finds eight.
const ROUNDING: f64 = 20.0 * f64::EPSILON / 2.0;

/// Whether a triangle lies certainly on one side of another's plane.
#[inline]
fn beside(a: &Triangle, b: &Triangle) -> bool {
    let (u, v) = (a[1] - a[0], a[2] - a[0]);
    let normal = u.cross(v);
    let around = u.abs().max(v.abs()).max_element();
    let offsets = b.map(|corner| corner - a[0]);
    let far = offsets.iter().fold(DVec3::ZERO, |far, offset| far.max(offset.abs())).max_element();
    // The three corners' coordinates are exact, their differences are rounded once.
    let slack = ROUNDING * 12.0 * around * around * far;
    let [x, y, z] = offsets.map(|offset| normal.dot(offset));
    // Underflow would make a bound of nothing.
    far * around > 1e-60
        && ((x > slack && y > slack && z > slack) || (x < -slack && y < -slack && z < -slack))
}

fn coord(point: DVec3) -> Coord3D<f64> {
    Coord3D { x: point.x, y: point.y, z: point.z }
}

/// On which side of a plane a point lies: the exact sign.
fn side(plane: &Triangle, point: DVec3) -> f64 {
    let [a, b, c] = plane.map(coord);
    orient3d(a, b, c, coord(point))
}

#[cfg(test)]
mod tests;
