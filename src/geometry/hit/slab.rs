//! The box test.

use super::Beam;
use crate::geometry::lanes::Lanes;

/// From where to where rays are between the planes of boxes: by axis, those that rays of this way come to `first` and
/// `last`; within `reach`, an interval without a NaN. The first exceeds the second if nowhere.
///
/// The distances are rounded outwards by [`super::aim::SLACK`], which takes in the four roundings of each (the
/// subtraction, the reciprocal, its slack, the product) and those of a triangle test's edges. So the test is
/// conservative where `t >= 0`, which is where rays go. A ray within a plane it is parallel to gives a NaN, which
/// bounds nothing.
///
/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
pub(crate) unsafe fn slab<L: Lanes>(beam: &Beam<L>, reach: [L; 2], first: [L; 3], last: [L; 3]) -> [L; 2] {
    // SAFETY: the processor is the caller's.
    unsafe {
        let [x, y, z] = beam.origin;
        // A NaN among the first arguments is passed over.
        let enters = first[1]
            .sub(y)
            .mul(beam.first_rate[1])
            .max(first[2].sub(z).mul(beam.first_rate[2]).max(reach[0]));
        let leaves =
            last[1].sub(y).mul(beam.last_rate[1]).min(last[2].sub(z).mul(beam.last_rate[2]).min(reach[1]));
        [
            first[0].sub(x).mul(beam.first_rate[0]).max(enters),
            last[0].sub(x).mul(beam.last_rate[0]).min(leaves),
        ]
    }
}
