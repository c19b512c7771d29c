//! The box test.

use super::Beam;
use crate::geometry::lanes::Lanes;

/// From where to where rays are between the planes of boxes, which `plane` tells by axis and by whether it is the one
/// a ray of this way comes to last; within `reach`, an interval without a NaN. The first exceeds the second if nowhere.
///
/// The distances are rounded outwards by [`super::aim::SLACK`], which takes in the four roundings of each (the
/// subtraction, the reciprocal, its slack, the product) and those of a triangle test's edges. So the test is
/// conservative where `t >= 0`, which is where rays go. A ray within a plane it is parallel to gives a NaN, which
/// bounds nothing.
///
/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
pub(crate) unsafe fn slab<L: Lanes>(
    beam: &Beam<L>,
    reach: [L; 2],
    plane: impl Fn(usize, bool) -> L,
) -> [L; 2] {
    // SAFETY: the processor is the caller's.
    unsafe {
        let at = |axis: usize, last: bool| {
            let rate = if last { beam.last_rate[axis] } else { beam.first_rate[axis] };
            plane(axis, last).sub(beam.origin[axis]).mul(rate)
        };
        // A NaN among the first arguments is passed over.
        let enters = at(0, false).max(at(1, false).max(at(2, false).max(reach[0])));
        let leaves = at(0, true).min(at(1, true).min(at(2, true).min(reach[1])));
        [enters, leaves]
    }
}
