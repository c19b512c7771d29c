//! k-DOPs: an interval a direction. One that was turned on the way is taken for the k-DOP around the three slabs
//! along its own axes: with a rotation little is left of what the other directions were for.

use super::{Columns, Kernel, Overlap, ROUNDING, Way};
use crate::geometry::lanes::Lanes;
use crate::geometry::{KDop, Volume};
use glam::{Vec3, Vec3A};

/// The k-DOP around one that was moved to where others are: least and greatest product by direction, with a bound on
/// all rounding that does not depend on the other, and the reach.
#[derive(Clone, Copy, Debug)]
pub struct MovedKDop<const D: usize> {
    ends: [[f32; D]; 2],
}

/// A direction is at most the square root of 3 long.
const LONGEST: f32 = 1.75;

impl<const D: usize> Overlap for KDop<D> {
    type Moved = MovedKDop<D>;
    type Eight = Columns<D, 2>;

    fn around(points: &[Vec3]) -> Self {
        Self::of_points(points)
    }

    fn surface(&self) -> f32 {
        // That of its box.
        let [low, high] = [0, 7].map(|corner: usize| self.corners()[corner]);
        let size = high - low;
        2.0 * (size.x * size.y + size.y * size.z + size.z * size.x)
    }

    #[inline]
    fn moved(&self, way: &Way) -> MovedKDop<D> {
        let (mut low, mut high) = ([f32::INFINITY; D], [f32::NEG_INFINITY; D]);
        let centre = Volume::centre(self);
        let extent = 2.0 * self.radius();
        if way.straight {
            for (i, (direction, least, greatest)) in self.slabs().enumerate() {
                let shift = way.translation.dot(Vec3A::from(direction));
                (low[i], high[i]) = (least + shift, greatest + shift);
            }
        } else {
            let corners = self.corners().map(|corner| way.point(corner));
            for (i, (direction, ..)) in self.slabs().enumerate() {
                for corner in corners {
                    let product = corner.dot(Vec3A::from(direction));
                    (low[i], high[i]) = (low[i].min(product), high[i].max(product));
                }
            }
        }
        let slack = LONGEST * way.slack(centre, extent);
        MovedKDop { ends: [low.map(|least| least - slack), high.map(|greatest| greatest + slack)] }
    }
}

/// Least and greatest product, by direction; a direction separates.
impl<const D: usize> Kernel<D, 2> for KDop<D> {
    fn numbers(&self) -> [[f32; 2]; D] {
        let mut slabs = self.slabs();
        [(); D].map(|()| slabs.next().map_or([f32::NAN; 2], |(_, least, greatest)| [least, greatest]))
    }

    #[inline(always)]
    unsafe fn separated<L: Lanes>(moved: &MovedKDop<D>, numbers: &[[L; 2]; D]) -> u64 {
        let mut apart = 0;
        for (i, &[least, greatest]) in numbers.iter().enumerate() {
            // SAFETY: the processor is the caller's.
            unsafe {
                let slack = least.abs().add(greatest.abs()).mul(L::splat(ROUNDING));
                apart |= least.sub(slack).greater(L::splat(moved.ends[1][i]));
                apart |= L::splat(moved.ends[0][i]).greater(greatest.add(slack));
            }
        }
        apart
    }
}
