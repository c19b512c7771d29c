//! The fast test of Moeller and Trumbore (1997), "Fast, Minimum Storage Ray/Triangle Intersection", sec. 2, without
//! its absolute bound on the determinant, which loses whatever is small.

use super::sealed::Edges;
use super::{Beam, Corners, Found, TriangleTest};
use crate::geometry::lanes::Lanes;

/// The fast test. A ray aimed at an edge that two triangles share may slip between them; [`super::Watertight`] lets
/// none through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fast;

impl TriangleTest for Fast {
    const NAME: &'static str = "fast";
}

#[inline(always)]
unsafe fn place<L: Lanes>(triangles: &impl Corners<L>, corner: usize) -> [L; 3] {
    // SAFETY: the processor is the caller's.
    unsafe { [triangles.at(corner, 0), triangles.at(corner, 1), triangles.at(corner, 2)] }
}

#[inline(always)]
unsafe fn minus<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    // SAFETY: the processor is the caller's.
    unsafe { [a[0].sub(b[0]), a[1].sub(b[1]), a[2].sub(b[2])] }
}

#[inline(always)]
unsafe fn cross<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    // SAFETY: the processor is the caller's.
    unsafe {
        [
            a[1].mul(b[2]).sub(a[2].mul(b[1])),
            a[2].mul(b[0]).sub(a[0].mul(b[2])),
            a[0].mul(b[1]).sub(a[1].mul(b[0])),
        ]
    }
}

#[inline(always)]
unsafe fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    // SAFETY: the processor is the caller's.
    unsafe { a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2])) }
}

impl Edges for Fast {
    #[expect(private_interfaces, reason = "the trait cannot be named outside this crate")]
    #[expect(private_bounds, reason = "as above")]
    #[inline(always)]
    unsafe fn within_edges<L: Lanes>(beam: &Beam<L>, triangles: &impl Corners<L>) -> Option<Found<L>> {
        // SAFETY: the processor is the caller's.
        unsafe {
            let (a, b, c) = (place(triangles, 0), place(triangles, 1), place(triangles, 2));
            let (ab, ac) = (minus(b, a), minus(c, a));
            let p = cross(beam.direction, ac);
            let from_a = minus(beam.origin, a);
            let q = cross(from_a, ab);
            let determinant = dot(ab, p);
            let u = dot(from_a, p).turned_by(determinant);
            let v = dot(beam.direction, q).turned_by(determinant);
            let size = determinant.abs();
            // The last one is NaN if any is, and a NaN stays as the second argument does.
            let inside = u.min(v.min(size.sub(u.add(v))));
            let lanes = inside.at_least(L::splat(0.0)) & size.greater(L::splat(0.0));
            if lanes == 0 {
                return None;
            }
            let t = dot(ac, q).div(determinant);
            Some(Found { lanes, t, u: u.div(size), v: v.div(size) })
        }
    }
}
