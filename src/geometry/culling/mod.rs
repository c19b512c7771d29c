//! Volume against frustum: the tests of Paper I (Assarsson and Moeller, "Optimized view frustum culling
//! algorithms", 1999), as steps that can be combined, for boxes, oriented boxes, spheres and k-DOPs.
//!
//! [`Steps`] says which steps a test is made of, a [`Culler`] is the test of one frame, [`Motion`] what the
//! camera did since the last frame, and a [`Memory`] what a volume keeps from frame to frame.
//!
//! What holds, whatever the input and the steps: [`Side::Outside`] and [`Side::Inside`] are facts about
//! the exact bodies, never an accident of rounding; [`Side::Intersecting`] is said whenever neither is
//! certain, so nothing visible is culled. It may be said of a volume that is outside, beyond an edge or a
//! corner of the frustum (Paper I Fig. 2); [`super::oracle`] tells how often. One step is the exception:
//! [`Octant::AsPublished`] may call inside what crosses a plane (finding P1-F04), and is there to show it.
//!
//! Two deviations from the paper, both for that promise. Volumes are taken relative to the eye so that
//! the error grows with the distance from the eye and not from the origin; and each comparison is against
//! a bound on its own rounding instead of against zero. An empty volume is outside; one with a NaN or an
//! infinity is intersecting.

mod culler;
mod memory;
mod motion;
mod perspective;
mod steps;

use super::{Frustum, PLANE_COUNT, Volume};

pub use culler::{Asymmetric, Culler};
pub use memory::{Forgetful, Head, Memory, Remembering};
pub use motion::Motion;
pub use steps::{Cached, Octant, STEPS, Space, Step, Steps, StepsError};

/// Bound on the rounding of one plane test, relative to the 1-norm of the corner. Each of: subtracting
/// the eye, rounding the normal, three products and three sums costs half an ulp (2^-24) at most on any
/// one term, six in a row; eight leaves room for the second-order terms.
pub(super) const ROUNDING: f32 = 8.0 / 16_777_216.0;

/// All six planes, as bits.
const ALL: u8 = (1 << PLANE_COUNT) - 1;

/// Where a volume is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Wholly outside; holds the index of the plane that showed it (left, right, near, far, up, down).
    /// An empty volume is outside plane 0.
    Outside(u8),
    /// Not certainly outside, not certainly inside.
    Intersecting,
    /// Wholly inside.
    Inside,
}

/// The answer of a test and what it cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Where the volume is.
    pub side: Side,
    /// How many planes were tested; finding an octant counts as one, which is about what it costs
    /// (Paper I sec. 3.3), near and far as a pair as one, a distance carried over from an earlier frame as
    /// none.
    pub tests: u32,
    /// The planes that the volume, and so everything in it, is certainly inside of, as bits: what masking
    /// hands down (Paper I sec. 3.4).
    pub inside: u8,
}

/// The basic test: all six planes in order, n-vertex then p-vertex (Paper I sec. 3.1, Fig. 4).
#[inline]
pub fn basic<V: Volume>(volume: &V, frustum: &Frustum) -> Verdict {
    Culler::basic(frustum).classify(volume, &Forgetful, 0)
}

/// The planes whose bit is set, least first.
#[inline]
fn planes(mut bits: u8) -> impl Iterator<Item = usize> {
    bits &= ALL;
    std::iter::from_fn(move || {
        let plane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (plane < PLANE_COUNT).then_some(plane)
    })
}

#[cfg(test)]
mod tests;
