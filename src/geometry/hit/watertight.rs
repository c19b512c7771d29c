//! The watertight test of Woop, Benthin and Wald (2013), "Watertight Ray/Triangle Intersection", JCGT 2(1), sec. 3.

use super::sealed::Edges;
use super::{Beam, Found, TriangleTest};
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
    unsafe fn within_edges<L: Lanes>(
        beam: &Beam<L>,
        corner: impl Fn(usize, usize) -> L + Copy,
    ) -> Option<Found<L>> {
        // SAFETY: the processor is the caller's.
        unsafe {
            let corners = [0, 1, 2].map(|of| {
                let [x, y, z] = beam.axes.map(|axis| corner(of, axis).sub(beam.origin[axis & 3]));
                [x.sub(beam.shear[0].mul(z)), y.sub(beam.shear[1].mul(z)), z]
            });
            let weight = |p: [L; 3], q: [L; 3]| p[0].mul(q[1]).sub(p[1].mul(q[0]));
            let [a, b, c] = corners;
            let mut weights = [weight(c, b), weight(a, c), weight(b, a)];
            let [u, v, w] = weights;
            let zero = L::splat(0.0);
            if zero.at_least(u.abs().min(v.abs()).min(w.abs())) != 0 {
                weights = exact(corners, weights);
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

/// The weights, those of lanes in which one is zero without rounding.
#[inline(always)]
unsafe fn exact<L: Lanes>(corners: [[L; 3]; 3], weights: [L; 3]) -> [L; 3] {
    // SAFETY: the processor is the caller's, and no vector has more than 16 lanes.
    let column = |lanes: L| unsafe {
        let mut column: Column = [0.0; 16];
        lanes.store(&mut column, 0);
        column
    };
    let places = corners.map(|[x, y, _]| [column(x), column(y)]);
    let mut columns = weights.map(column);
    exactly(&places, &mut columns, L::LEN);
    // SAFETY: as above.
    columns.each_ref().map(|column| unsafe { L::load(column, 0) })
}

#[cold]
#[inline(never)]
fn exactly(places: &[[Column; 2]; 3], weights: &mut [Column; 3], lanes: usize) {
    for lane in 0..lanes {
        if weights.iter().all(|weight| weight[lane] != 0.0) {
            continue;
        }
        let at = places.each_ref().map(|place| place.each_ref().map(|column| f64::from(column[lane])));
        let [a, b, c] = at;
        for (weight, (p, q)) in weights.iter_mut().zip([(c, b), (a, c), (b, a)]) {
            // Products of two f32 are f64 exactly; what is rounded is their difference, which keeps its sign.
            weight[lane] = (p[0] * q[1] - p[1] * q[0]) as f32;
        }
    }
}
