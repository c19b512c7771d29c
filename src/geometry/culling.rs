//! Box against frustum: the plane tests of Paper I (Assarsson and Moeller, "Optimized view frustum
//! culling algorithms", 1999), sec. 3.
//!
//! What holds, whatever the input: [`Side::Outside`] and [`Side::Inside`] are facts about the exact
//! bodies, never an accident of rounding; [`Side::Intersecting`] is said whenever neither is certain,
//! so nothing visible is culled. It may be said of a box that is outside, beyond an edge or a corner of
//! the frustum (Paper I Fig. 2); [`super::oracle`] tells how often.
//!
//! Two deviations from the paper, both for that promise. Boxes are taken relative to the eye (one
//! subtraction a corner) so that the error grows with the distance from the eye and not from the
//! origin; and each comparison is against a bound on its own rounding instead of against zero.
//! An empty box is outside; a box with a NaN or an infinity is intersecting.

use glam::Vec3;

use super::{Aabb, Frustum, PLANE_COUNT};

/// Bound on the rounding of one plane test, relative to the 1-norm of the corner. Each of: subtracting
/// the eye, rounding the normal, three products and three sums costs half an ulp (2^-24) at most on any
/// one term, six in a row; eight leaves room for the second-order terms.
pub(super) const ROUNDING: f32 = 8.0 / 16_777_216.0;

/// Where a box is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Wholly outside; holds the index of the plane that showed it (left, right, near, far, up, down),
    /// to be tested first next time. An empty box is outside plane 0.
    Outside(u8),
    /// Not certainly outside, not certainly inside.
    Intersecting,
    /// Wholly inside.
    Inside,
}

/// The answer of a test and what it cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Where the box is.
    pub side: Side,
    /// How many planes were tested; finding an octant counts as one, which is about what it costs
    /// (Paper I sec. 3.3).
    pub tests: u32,
}

/// The basic test: all six planes in order, n-vertex then p-vertex (Paper I sec. 3.1, Fig. 4).
#[inline]
pub fn basic(bounds: &Aabb, frustum: &Frustum) -> Verdict {
    let mut test = match Test::begin(bounds, frustum) {
        Ok(test) => test,
        Err(verdict) => return verdict,
    };
    for plane in 0..PLANE_COUNT {
        if test.is_outside(plane) {
            return test.outside(plane);
        }
    }
    test.end()
}

/// Plane-coherency: the plane that rejected the box last time first, then the others in order
/// (Paper I sec. 3.2).
///
/// # Panics
/// If `first` is not below [`PLANE_COUNT`].
#[inline]
pub fn from_plane(bounds: &Aabb, frustum: &Frustum, first: u8) -> Verdict {
    let first = usize::from(first);
    let mut test = match Test::begin(bounds, frustum) {
        Ok(test) => test,
        Err(verdict) => return verdict,
    };
    if test.is_outside(first) {
        return test.outside(first);
    }
    for plane in (0..PLANE_COUNT).filter(|plane| *plane != first) {
        if test.is_outside(plane) {
            return test.outside(plane);
        }
    }
    test.end()
}

/// The octant test of a symmetric frustum (Paper I sec. 3.3).
///
/// The frustum is halved along its three axes; a box no larger than the frustum is wide there
/// (half-diagonal at most [`Frustum::least_distance`]) is tested against the three planes of the octant
/// its centre lies in. Boxes too large for that, and boxes with their centre behind the eye, where
/// "right of the middle" no longer means "within the left plane", go through all six.
///
/// The paper stops there, and its "inside" can be wrong: near the narrow end an elongated box may cross
/// a plane that was not chosen (finding P1-F04). So when the three planes say inside, the other three
/// are asked as well, and the answer is that of [`basic`].
#[derive(Clone, Copy, Debug)]
pub struct OctantTest<'a> {
    frustum: &'a Frustum,
}

impl<'a> OctantTest<'a> {
    /// The test for a frustum; `None` if the frustum is not symmetric, where the halves do not choose
    /// their planes (Paper I sec. 3.3 and 4).
    pub fn new(frustum: &'a Frustum) -> Option<Self> {
        frustum.symmetric.then_some(Self { frustum })
    }

    /// Tests a box; `first`, if given, is a plane to test before anything else (plane-coherency, in the
    /// order Paper I sec. 3 lists the steps).
    ///
    /// # Panics
    /// If `first` is not below [`PLANE_COUNT`].
    #[inline]
    pub fn classify(&self, bounds: &Aabb, first: Option<u8>) -> Verdict {
        let mut test = match Test::begin(bounds, self.frustum) {
            Ok(test) => test,
            Err(verdict) => return verdict,
        };
        let mut done = 0u8;
        if let Some(first) = first {
            done = 1 << first;
            if test.is_outside(usize::from(first)) {
                return test.outside(usize::from(first));
            }
        }
        // Written so that a NaN takes the way of all six planes.
        let fits = bounds.half_diagonal() <= self.frustum.least_distance;
        let octant = if fits { self.octant(&test) } else { None };
        let chosen = octant.unwrap_or(ALL);
        test.tests += u32::from(octant.is_some());
        for plane in planes(chosen & !done) {
            if test.is_outside(plane) {
                return test.outside(plane);
            }
        }
        if !test.crosses {
            for plane in planes(!(chosen | done)) {
                test.tests += 1;
                test.crosses |= test.is_crossed(plane);
            }
        }
        test.end()
    }

    /// The three planes of the octant of the box's centre, as bits; `None` behind the eye.
    #[inline]
    fn octant(&self, test: &Test<'_>) -> Option<u8> {
        let [x, y, z, to_x, to_y, to_z] = test.coordinates;
        let centre = (Vec3::new(x, y, z) + Vec3::new(to_x, to_y, to_z)) * 0.5;
        let [right, up, forward] = self.frustum.axes;
        let depth = forward.dot(centre);
        if depth <= 0.0 {
            return None;
        }
        // The frustum's middle lies on the line of sight, which goes through the eye: only its depth
        // has to be looked up.
        let pick = |less: bool, plane: u8, other: u8| 1 << if less { plane } else { other };
        Some(
            pick(right.dot(centre) < 0.0, 0, 1)
                | pick(depth < self.frustum.middle_depth, 2, 3)
                | pick(up.dot(centre) < 0.0, 5, 4),
        )
    }
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

/// All six planes, as bits.
const ALL: u8 = (1 << PLANE_COUNT) - 1;

/// Which of the six coordinates (three least, three greatest) make the corner with the least product
/// with a normal of that sign field: the corner table of Paper I sec. 3.1. The complemented field gives
/// the corner with the greatest.
const CORNERS: [[u8; 3]; 8] =
    [[0, 1, 2], [3, 1, 2], [0, 4, 2], [3, 4, 2], [0, 1, 5], [3, 1, 5], [0, 4, 5], [3, 4, 5]];

/// One box on its way through the planes.
struct Test<'a> {
    frustum: &'a Frustum,
    /// Least and greatest corner, relative to the eye.
    coordinates: [f32; 6],
    /// Bound on the rounding of any of the box's products.
    slack: f32,
    crosses: bool,
    tests: u32,
}

impl<'a> Test<'a> {
    #[inline]
    fn begin(bounds: &Aabb, frustum: &'a Frustum) -> Result<Self, Verdict> {
        if bounds.is_empty() {
            let side = if bounds.is_nan() { Side::Intersecting } else { Side::Outside(0) };
            return Err(Verdict { side, tests: 0 });
        }
        let (low, high) = (bounds.min - frustum.eye, bounds.max - frustum.eye);
        // A sum, not a maximum: a NaN or an infinity anywhere reaches the slack, and with such a slack
        // no comparison below can claim "outside" or "inside". The last term covers underflow.
        let slack = (low.abs() + high.abs()).element_sum() * ROUNDING + f32::MIN_POSITIVE;
        let coordinates = [low.x, low.y, low.z, high.x, high.y, high.z];
        Ok(Self { frustum, coordinates, slack, crosses: false, tests: 0 })
    }

    #[inline]
    fn corner(&self, field: u8) -> Vec3 {
        let [x, y, z] = CORNERS[usize::from(field & 7)];
        let at = |i: u8| self.coordinates[usize::from(i)];
        Vec3::new(at(x), at(y), at(z))
    }

    /// Whether the box is outside a plane; if not, notes whether the plane may cross it.
    #[inline]
    fn is_outside(&mut self, plane: usize) -> bool {
        let at = &self.frustum.kernel[plane];
        self.tests += 1;
        if at.normal.dot(self.corner(at.signs)) + at.low > self.slack {
            return true;
        }
        self.crosses |= self.is_crossed(plane);
        false
    }

    /// Whether the p-vertex is not certainly inside. The comparison is this way round for NaN's sake.
    #[inline]
    fn is_crossed(&self, plane: usize) -> bool {
        let at = &self.frustum.kernel[plane];
        let inside = at.normal.dot(self.corner(!at.signs)) + at.high <= -self.slack;
        !inside
    }

    #[inline]
    fn outside(&self, plane: usize) -> Verdict {
        Verdict { side: Side::Outside(plane as u8), tests: self.tests }
    }

    #[inline]
    fn end(&self) -> Verdict {
        let side = if self.crosses { Side::Intersecting } else { Side::Inside };
        Verdict { side, tests: self.tests }
    }
}

#[cfg(test)]
#[path = "culling_tests.rs"]
mod tests;
