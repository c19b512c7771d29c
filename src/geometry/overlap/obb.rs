//! Oriented boxes: fifteen axes, of which three faces of each and the cross products of their edges may separate
//! them (Paper II sec. 5; some 200 operations, P2-17).

use super::{Columns, Eight, Overlap, ROUNDING, Way};
use crate::geometry::lanes::{Lanes, Unit, on_unit};
use crate::geometry::{Obb, Volume};
use glam::{Vec3, Vec3A};

/// A box moved to where others are.
#[derive(Clone, Copy, Debug)]
pub struct MovedObb {
    centre: [f32; 3],
    axes: [[f32; 3]; 3],
    half: [f32; 3],
    /// Bound on all rounding that does not depend on the other box, with the reach.
    slack: f32,
}

/// The numbers of a box: its centre, its three axes, its half extents.
const NUMBERS: usize = 15;

impl Obb {
    fn numbers(&self) -> [f32; NUMBERS] {
        let [a, b, c] = self.axes();
        let parts = [self.centre(), a, b, c, self.half()];
        std::array::from_fn(|i| parts[i / 3][i % 3])
    }
}

impl Overlap for Obb {
    type Moved = MovedObb;
    type Eight = Columns<NUMBERS>;

    fn around(points: &[Vec3]) -> Self {
        Self::tight(points)
    }

    fn surface(&self) -> f32 {
        Self::surface(self)
    }

    #[inline]
    fn moved(&self, way: &Way) -> MovedObb {
        let half = self.half();
        MovedObb {
            centre: way.point(self.centre()).to_array(),
            axes: self.axes().map(|axis| (way.rotation * Vec3A::from(axis)).to_array()),
            half: half.to_array(),
            slack: way.slack(self.centre(), half.element_sum()),
        }
    }

    #[inline]
    fn apart(&self, moved: &MovedObb) -> bool {
        let numbers = self.numbers();
        // SAFETY: one lane needs no vector unit.
        unsafe { separated::<f32>(moved, |i| numbers[i]) != 0 }
    }
}

impl Eight<Obb> for Columns<NUMBERS> {
    const UNUSED: Self = Self::UNUSED;

    fn set(&mut self, lane: usize, volume: &Obb) {
        self.set(lane, volume.numbers());
    }

    #[inline]
    fn apart(&self, unit: Unit, moved: &MovedObb) -> u8 {
        eight(unit, moved, &self.0)
    }
}

on_unit! {
    fn eight(moved: &MovedObb, columns: &[[f32; 8]; NUMBERS]) -> u8 = eight_by
}

/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn eight_by<L: Lanes>(moved: &MovedObb, columns: &[[f32; 8]; NUMBERS]) -> u8 {
    let mut apart = 0;
    for from in (0..8).step_by(L::LEN) {
        // SAFETY: `from` steps by the lanes' number below 8; the processor is the caller's.
        apart |= unsafe { separated::<L>(moved, |i| L::load(&columns[i], from)) << from };
    }
    apart as u8
}

/// The other two axes.
const OTHERS: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// Which boxes an axis separates from the moved one, by as many as there are lanes; `number` gets a number of all.
///
/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn separated<L: Lanes>(moved: &MovedObb, number: impl Fn(usize) -> L) -> u64 {
    let all = u64::MAX >> (64 - L::LEN);
    // SAFETY: the processor is the caller's.
    unsafe {
        let dot = |v: [L; 3], fixed: &[f32; 3]| {
            let [x, y, z] = [0, 1, 2].map(|k| v[k].mul(L::splat(fixed[k])));
            x.add(y).add(z)
        };
        let of = |first: usize| [0, 1, 2].map(|k| number(first + k));
        let centre = of(0);
        let half = of(12);
        let between = [0, 1, 2].map(|k| centre[k].sub(L::splat(moved.centre[k])));
        let size = |v: [L; 3]| v[0].abs().add(v[1].abs()).add(v[2].abs());
        let slack = size(between).add(size(half)).mul(L::splat(ROUNDING)).add(L::splat(moved.slack));
        // What each axis of the one has of each axis of the other.
        let axes = [of(3), of(6), of(9)];
        let turn = moved.axes.map(|own| axes.map(|axis| dot(axis, &own)));
        let abs = turn.map(|row| row.map(|x| x.abs()));

        let mut apart = 0;
        let along = [0, 1, 2].map(|i| dot(between, &moved.axes[i]));
        for i in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|k| half[k].mul(abs[i][k]));
            let reach = a.add(b).add(c).add(L::splat(moved.half[i])).add(slack);
            apart |= along[i].abs().greater(reach);
        }
        for j in 0..3 {
            let [x, y, z] = [0, 1, 2].map(|k| between[k].mul(axes[j][k]));
            let reach = dot([abs[0][j], abs[1][j], abs[2][j]], &moved.half).add(half[j]).add(slack);
            apart |= x.add(y).add(z).abs().greater(reach);
        }
        // Most pairs that are apart are so along a face.
        if apart == all {
            return all;
        }
        for (i, [i1, i2]) in OTHERS.into_iter().enumerate() {
            for (j, [j1, j2]) in OTHERS.into_iter().enumerate() {
                let way = along[i2].mul(turn[i1][j]).sub(along[i1].mul(turn[i2][j]));
                let own =
                    abs[i2][j].mul(L::splat(moved.half[i1])).add(abs[i1][j].mul(L::splat(moved.half[i2])));
                let other = half[j1].mul(abs[i][j2]).add(half[j2].mul(abs[i][j1]));
                apart |= way.abs().greater(own.add(other).add(slack));
            }
        }
        apart
    }
}
