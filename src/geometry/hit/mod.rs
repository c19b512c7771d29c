//! Where rays meet shapes: spheres, cones, triangles.
//!
//! Of triangles there is a fast test and a watertight one, of one ray with several or of several rays with one, by the
//! same code over lanes; scalar code and every vector unit answer the same bit for bit.
//!
//! A hit lies within its triangle's own box, as the box test of a hierarchy's nodes (`slab`) sees it: `t` is moved
//! there, and what has no point in common with that box is no hit. Each step of that test keeps the order of its
//! arguments when it is rounded, so a box around others is never passed over when one in it is met: a hierarchy tells
//! the same as a list gone through item by item, however ill-conditioned a triangle is.
//!
//! No bound is absolute: lengths are counted in the scene's own ([`Scale`]).

mod aim;
mod columns;
mod cone;
mod fast;
mod probe;
mod scale;
mod slab;
mod span;
mod sphere;
mod watertight;

pub use cone::{Cone, cone};
pub use fast::Fast;
pub use scale::Scale;
pub use sphere::sphere;
pub use watertight::Watertight;

pub(crate) use aim::{Aim, Beam};
pub(crate) use columns::Columns;
pub(crate) use probe::Probe;
pub(crate) use slab::slab;
pub(crate) use span::{Seek, Slab, Span, Spread, Way};

use super::lanes::Lanes;

/// What some lanes found: rays and triangles that meet.
#[derive(Clone, Copy)]
pub(crate) struct Found<L> {
    /// Bit `i` is set when lane `i`'s meet, at a `t` that may lie outside the ray's reach.
    pub(crate) lanes: u64,
    /// How far along the ray, in the aim's lengths.
    pub(crate) t: L,
    /// Weight of the second corner.
    pub(crate) u: L,
    /// Weight of the third corner.
    pub(crate) v: L,
}

/// A test of rays with triangles, from both sides.
pub trait TriangleTest: Copy + Default + Send + Sync + 'static + sealed::Edges {
    /// Its name: the command's word, and the rows' value.
    const NAME: &'static str;
}

pub(crate) mod sealed {
    use super::{Beam, Corners, Found, Lanes};

    /// The test itself, before a hit is held against its triangle's box.
    pub trait Edges {
        /// Whether the rays pass within the edges, and where; `None` if no lane does. A lane with a NaN meets nothing.
        ///
        /// # Safety
        /// The processor has the lanes' vector unit.
        #[expect(private_interfaces, reason = "the trait cannot be named outside this crate")]
        #[expect(private_bounds, reason = "as above")]
        unsafe fn within_edges<L: Lanes>(beam: &Beam<L>, triangles: &impl Corners<L>) -> Option<Found<L>>;
    }
}

/// Triangles, one a lane.
///
/// # Safety of the methods
/// The processor has the lanes' vector unit. They are called where no closure is: what is not inlined has not the
/// unit's target feature, and costs ten times as much.
pub(crate) trait Corners<L> {
    /// A coordinate, by corner and axis, both below 3.
    unsafe fn at(&self, corner: usize, axis: usize) -> L;
}

/// Which lanes' rays and triangles meet.
///
/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
pub(crate) unsafe fn meet<L: Lanes, T: TriangleTest>(
    beam: &Beam<L>,
    triangles: &impl Corners<L>,
) -> Option<Found<L>> {
    // SAFETY: the processor is the caller's.
    unsafe {
        let found = T::within_edges(beam, triangles)?;
        let (x, y, z) = (
            sides(beam.rises, triangles, 0),
            sides(beam.rises, triangles, 1),
            sides(beam.rises, triangles, 2),
        );
        let all = [L::splat(f32::NEG_INFINITY), L::splat(f32::INFINITY)];
        let [enters, leaves] = slab(beam, all, [x[0], y[0], z[0]], [x[1], y[1], z[1]]);
        // A NaN stays one, as the second argument does.
        let t = leaves.min(enters.max(found.t));
        Some(Found { lanes: found.lanes & leaves.at_least(enters), t, ..found })
    }
}

/// The planes of the triangles' boxes on an axis, that which the rays come to first and the other; by axis, whether the
/// rays rise.
///
/// # Safety
/// The processor has the lanes' vector unit, and `axis` is below 3.
#[inline(always)]
pub(crate) unsafe fn sides<L: Lanes>(rises: [bool; 3], triangles: &impl Corners<L>, axis: usize) -> [L; 2] {
    // SAFETY: the processor is the caller's.
    unsafe {
        let (a, b, c) = (triangles.at(0, axis), triangles.at(1, axis), triangles.at(2, axis));
        let (least, greatest) = (a.min(b).min(c), a.max(b).max(c));
        if rises[axis] { [least, greatest] } else { [greatest, least] }
    }
}

/// The lesser of two roots that lies on the ray, rounded to f32.
fn first_within(ray: &super::FineRay, roots: [f64; 2]) -> Option<f32> {
    let [a, b] = roots.map(|t| t as f32);
    let within = |t: &f32| *t >= ray.near && *t <= ray.far;
    [a.min(b), a.max(b)].into_iter().find(within)
}
