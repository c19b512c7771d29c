//! Eight volumes number beside number, of whatever kind: a kind says what its numbers are and what they tell, as many
//! volumes at a time as a vector has lanes.

use super::{Eight, Overlap};
use crate::geometry::lanes::{Lanes, Unit, on_unit};

/// What a kind of volume is to a kernel: `N` groups of `W` numbers, which nothing is apart from if they are all NaN.
pub(super) trait Kernel<const N: usize, const W: usize>: Overlap {
    /// A volume's numbers.
    fn numbers(&self) -> [[f32; W]; N];

    /// Which volumes, one a lane, are certainly apart from the moved one. Loops and no closures: a closure is not
    /// compiled for the vector unit.
    ///
    /// # Safety
    /// The processor has the lanes' vector unit.
    unsafe fn separated<L: Lanes>(moved: &Self::Moved, numbers: &[[L; W]; N]) -> u64;
}

/// Eight columns for each of `N` groups of `W` numbers.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub struct Columns<const N: usize, const W: usize>([[[f32; 8]; W]; N]);

impl<V: Kernel<N, W>, const N: usize, const W: usize> Eight<V> for Columns<N, W> {
    const UNUSED: Self = Self([[[f32::NAN; 8]; W]; N]);

    fn set(&mut self, lane: usize, volume: &V) {
        let numbers = volume.numbers();
        for (column, number) in self.0.as_flattened_mut().iter_mut().zip(numbers.as_flattened()) {
            column[lane] = *number;
        }
    }

    #[inline]
    fn apart(&self, unit: Unit, moved: &V::Moved) -> u8 {
        eight::<V, N, W>(unit, moved, &self.0)
    }

    #[inline]
    fn one_apart(volume: &V, moved: &V::Moved) -> bool {
        // SAFETY: one lane needs no vector unit.
        unsafe { V::separated::<f32>(moved, &volume.numbers()) != 0 }
    }
}

on_unit! {
    fn eight[V: Kernel<N, W>, const N: usize, const W: usize](
        moved: &V::Moved, columns: &[[[f32; 8]; W]; N]
    ) -> u8 = eight_by[V, N, W]
}

/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn eight_by<L: Lanes, V: Kernel<N, W>, const N: usize, const W: usize>(
    moved: &V::Moved,
    columns: &[[[f32; 8]; W]; N],
) -> u8 {
    let mut apart = 0;
    for from in (0..8).step_by(L::LEN) {
        // SAFETY: `from` steps by the lanes' number below 8; the processor is the caller's.
        unsafe {
            let mut numbers = [[L::splat(0.0); W]; N];
            for (numbers, columns) in numbers.iter_mut().zip(columns) {
                for (number, column) in numbers.iter_mut().zip(columns) {
                    *number = L::load(column, from);
                }
            }
            apart |= V::separated::<L>(moved, &numbers) << from;
        }
    }
    apart as u8
}
