//! k-DOPs: an interval a direction. One that was turned on the way is taken for the k-DOP around the three slabs
//! along its own axes: with a rotation little is left of what the other directions were for.

use super::{Columns, Eight, Overlap, ROUNDING, Way, load};
use crate::geometry::lanes::{Lanes, Unit, on_unit};
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

impl<const D: usize> KDop<D> {
    /// Least and greatest product, by direction.
    fn numbers<const N: usize>(&self) -> [f32; N] {
        let mut slabs = self.slabs();
        let mut next = [0.0; 2];
        std::array::from_fn(|i| {
            if i % 2 == 0 {
                next = slabs.next().map_or([f32::NAN; 2], |(_, least, greatest)| [least, greatest]);
            }
            next[i % 2]
        })
    }

    fn moved_ends(&self, way: &Way) -> MovedKDop<D> {
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

/// Which k-DOPs a direction separates from the moved one.
///
/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn separated<L: Lanes, const D: usize, const N: usize>(moved: &MovedKDop<D>, numbers: &[L; N]) -> u64 {
    let mut apart = 0;
    for i in 0..D {
        // SAFETY: the processor is the caller's.
        unsafe {
            let (least, greatest) = (numbers[2 * i], numbers[2 * i + 1]);
            let slack = least.abs().add(greatest.abs()).mul(L::splat(ROUNDING));
            apart |= least.sub(slack).greater(L::splat(moved.ends[1][i]));
            apart |= L::splat(moved.ends[0][i]).greater(greatest.add(slack));
        }
    }
    apart
}

/// The same for each number of directions, as the length of an array cannot be worked out from it.
macro_rules! kdops {
    ($($module:ident: $directions:literal directions, $numbers:literal numbers;)*) => {$(
        mod $module {
            use super::*;

            impl Overlap for KDop<$directions> {
                type Moved = MovedKDop<$directions>;
                type Eight = Columns<$numbers>;

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
                fn moved(&self, way: &Way) -> Self::Moved {
                    self.moved_ends(way)
                }

                #[inline]
                fn apart(&self, moved: &Self::Moved) -> bool {
                    let numbers: [f32; $numbers] = self.numbers();
                    // SAFETY: one lane needs no vector unit.
                    unsafe { separated::<f32, $directions, $numbers>(moved, &numbers) != 0 }
                }
            }

            impl Eight<KDop<$directions>> for Columns<$numbers> {
                const UNUSED: Self = Self::UNUSED;

                fn set(&mut self, lane: usize, volume: &KDop<$directions>) {
                    self.set(lane, volume.numbers());
                }

                #[inline]
                fn apart(&self, unit: Unit, moved: &MovedKDop<$directions>) -> u8 {
                    eight(unit, moved, &self.0)
                }
            }

            on_unit! {
                fn eight(moved: &MovedKDop<$directions>, columns: &[[f32; 8]; $numbers]) -> u8 = eight_by
            }

            /// # Safety
            /// The processor has the lanes' vector unit.
            #[inline(always)]
            unsafe fn eight_by<L: Lanes>(
                moved: &MovedKDop<$directions>,
                columns: &[[f32; 8]; $numbers],
            ) -> u8 {
                let mut apart = 0;
                for from in (0..8).step_by(L::LEN) {
                    // SAFETY: `from` steps by the lanes' number below 8; the processor is the caller's.
                    apart |= unsafe { separated::<L, $directions, $numbers>(moved, &load(columns, from)) << from };
                }
                apart as u8
            }
        }
    )*};
}

kdops! {
    dop14: 7 directions, 14 numbers;
    dop18: 9 directions, 18 numbers;
    dop26: 13 directions, 26 numbers;
}
