//! Oriented boxes: fifteen axes, of which three faces of each and the cross products of their edges may separate
//! them (Paper II sec. 5; some 200 operations, P2-17).

use super::{Columns, Kernel, Overlap, ROUNDING, Way};
use crate::geometry::lanes::Lanes;
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

impl Overlap for Obb {
    type Moved = MovedObb;
    type Eight = Columns<5, 3>;

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
}

/// The other two axes.
const OTHERS: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// A product of vectors, of which one is the same in all lanes.
///
/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn dot<L: Lanes>(x: L, y: L, z: L, fixed: &[f32; 3]) -> L {
    // SAFETY: the processor is the caller's.
    unsafe { x.mul(L::splat(fixed[0])).add(y.mul(L::splat(fixed[1]))).add(z.mul(L::splat(fixed[2]))) }
}

/// Its centre, its three axes, its half extents.
impl Kernel<5, 3> for Obb {
    fn numbers(&self) -> [[f32; 3]; 5] {
        let [a, b, c] = self.axes();
        [self.centre(), a, b, c, self.half()].map(|part| part.to_array())
    }

    #[inline(always)]
    unsafe fn separated<L: Lanes>(moved: &MovedObb, numbers: &[[L; 3]; 5]) -> u64 {
        let all = u64::MAX >> (64 - L::LEN);
        let [[x, y, z], a, b, c, half] = *numbers;
        let axes = [a, b, c];
        // SAFETY: the processor is the caller's.
        unsafe {
            let x = x.sub(L::splat(moved.centre[0]));
            let y = y.sub(L::splat(moved.centre[1]));
            let z = z.sub(L::splat(moved.centre[2]));
            let size = x.abs().add(y.abs()).add(z.abs());
            let extent = half[0].abs().add(half[1].abs()).add(half[2].abs());
            let slack = size.add(extent).mul(L::splat(ROUNDING)).add(L::splat(moved.slack));

            // What each axis of the one has of each axis of the other.
            let none = L::splat(0.0);
            let (mut turn, mut abs, mut along) = ([[none; 3]; 3], [[none; 3]; 3], [none; 3]);
            let mut apart = 0;
            for i in 0..3 {
                for j in 0..3 {
                    let [u, v, w] = axes[j];
                    turn[i][j] = dot(u, v, w, &moved.axes[i]);
                    abs[i][j] = turn[i][j].abs();
                }
                along[i] = dot(x, y, z, &moved.axes[i]);
                let other = half[0].mul(abs[i][0]).add(half[1].mul(abs[i][1])).add(half[2].mul(abs[i][2]));
                apart |= along[i].abs().greater(other.add(L::splat(moved.half[i])).add(slack));
            }
            for j in 0..3 {
                let [u, v, w] = axes[j];
                let way = x.mul(u).add(y.mul(v)).add(z.mul(w));
                let own = dot(abs[0][j], abs[1][j], abs[2][j], &moved.half);
                apart |= way.abs().greater(own.add(half[j]).add(slack));
            }
            // Most pairs that are apart are so along a face.
            if apart == all {
                return all;
            }
            for i in 0..3 {
                let [i1, i2] = OTHERS[i];
                for j in 0..3 {
                    let [j1, j2] = OTHERS[j];
                    let way = along[i2].mul(turn[i1][j]).sub(along[i1].mul(turn[i2][j]));
                    let own = abs[i2][j]
                        .mul(L::splat(moved.half[i1]))
                        .add(abs[i1][j].mul(L::splat(moved.half[i2])));
                    let other = half[j1].mul(abs[i][j2]).add(half[j2].mul(abs[i][j1]));
                    apart |= way.abs().greater(own.add(other).add(slack));
                }
            }
            apart
        }
    }
}
