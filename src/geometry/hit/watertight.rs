//! The watertight test of Woop, Benthin and Wald (2013), "Watertight Ray/Triangle Intersection", JCGT 2(1), sec. 3.

use super::sealed::Edges;
use super::{Beam, Corners, Found, TriangleTest};
use crate::geometry::lanes::Lanes;

/// The watertight test: no ray slips through an edge or a corner that triangles share. Corners are sheared so that the
/// ray goes along an axis, each alone, so that triangles that share one see it at the same place; what tells on which
/// side of an edge the ray passes is the same number but for its sign for both that share it, told exactly where it
/// rounds to zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Watertight;

impl TriangleTest for Watertight {
    const NAME: &'static str = "watertight";
}

/// As many lanes as the widest vector has.
type Column = [f32; 16];

impl Edges for Watertight {
    #[expect(private_interfaces, reason = "the trait cannot be named outside this crate")]
    #[expect(private_bounds, reason = "as above")]
    #[inline(always)]
    unsafe fn within_edges<L: Lanes>(beam: &Beam<L>, triangles: &impl Corners<L>) -> Option<Found<L>> {
        // SAFETY: the processor is the caller's.
        unsafe {
            let a = sheared(beam, triangles, 0);
            let b = sheared(beam, triangles, 1);
            let c = sheared(beam, triangles, 2);
            let mut weights = [weight(c, b), weight(a, c), weight(b, a)];
            let [u, v, w] = weights;
            let zero = L::splat(0.0);
            if zero.at_least(u.abs().min(v.abs()).min(w.abs())) != 0 {
                weights = exact([a, b, c], weights);
            }
            let [u, v, w] = weights;
            let determinant = u.add(v).add(w);
            let either = zero.greater(u.min(v).min(w)) & u.max(v).max(w).greater(zero);
            let lanes = !either & determinant.abs().greater(zero);
            if lanes == 0 {
                return None;
            }
            let along = u.mul(a[2]).add(v.mul(b[2])).add(w.mul(c[2]));
            let t = along.div(determinant).mul(beam.shear[2]);
            Some(Found { lanes, t, u: v.div(determinant), v: w.div(determinant) })
        }
    }
}

/// A corner as seen from the ray's origin, sheared so that the ray goes along z.
#[inline(always)]
unsafe fn sheared<L: Lanes>(beam: &Beam<L>, triangles: &impl Corners<L>, corner: usize) -> [L; 3] {
    // SAFETY: the processor is the caller's.
    unsafe {
        let [x, y, z] = beam.axes;
        let z = triangles.at(corner, z).sub(beam.from[2]);
        let x = triangles.at(corner, x).sub(beam.from[0]).sub(beam.shear[0].mul(z));
        let y = triangles.at(corner, y).sub(beam.from[1]).sub(beam.shear[1].mul(z));
        [x, y, z]
    }
}

/// On which side of an edge the ray passes, and how far, in shares of the edge.
#[inline(always)]
unsafe fn weight<L: Lanes>(p: [L; 3], q: [L; 3]) -> L {
    // SAFETY: the processor is the caller's.
    unsafe { p[0].mul(q[1]).sub(p[1].mul(q[0])) }
}

/// The weights, those of lanes in which one is zero without rounding.
#[inline(always)]
unsafe fn exact<L: Lanes>([a, b, c]: [[L; 3]; 3], [u, v, w]: [L; 3]) -> [L; 3] {
    // SAFETY: the processor is the caller's.
    unsafe {
        let places =
            [[column(a[0]), column(a[1])], [column(b[0]), column(b[1])], [column(c[0]), column(c[1])]];
        let mut weights = [column(u), column(v), column(w)];
        exactly(&places, &mut weights, L::LEN);
        [L::load(&weights[0], 0), L::load(&weights[1], 0), L::load(&weights[2], 0)]
    }
}

#[inline(always)]
unsafe fn column<L: Lanes>(lanes: L) -> Column {
    let mut column = [0.0; 16];
    // SAFETY: the processor is the caller's, and no vector has more than 16 lanes.
    unsafe { lanes.store(&mut column, 0) };
    column
}

#[cold]
#[inline(never)]
fn exactly(places: &[[Column; 2]; 3], weights: &mut [Column; 3], lanes: usize) {
    for lane in 0..lanes {
        if weights.iter().all(|weight| weight[lane] != 0.0) {
            continue;
        }
        let [a, b, c] = places.each_ref().map(|place| place.each_ref().map(|column| f64::from(column[lane])));
        for (weight, (p, q)) in weights.iter_mut().zip([(c, b), (a, c), (b, a)]) {
            // Products of two f32 are f64 exactly; what is rounded is their difference, which keeps its sign.
            weight[lane] = (p[0] * q[1] - p[1] * q[0]) as f32;
        }
    }
}
