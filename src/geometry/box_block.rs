//! Sixty-four boxes, coordinate by coordinate: as many as a mask has bits in a word.

use glam::Vec3;

use super::Aabb;

/// Sixty-four boxes as a structure of arrays, in metres: 24 bytes a box, in the order in which a kernel
/// reads them. Places that hold no box hold the empty one, so a part-filled block needs no count.
///
/// Of what an [`Aabb`] can be, two kinds come back as one of their kind: an empty box as [`Aabb::EMPTY`],
/// and a box with a NaN as a box of NaNs. So one axis tells whether a box is empty, and a NaN is on all.
///
/// ```
/// use apportion::geometry::{Aabb, BoxBlock};
/// let unit = Aabb { min: glam::Vec3::ZERO, max: glam::Vec3::ONE };
/// let mut block = BoxBlock::EMPTY;
/// block.set(5, &unit);
/// assert_eq!((block.get(5), block.get(6)), (unit, Aabb::EMPTY));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct BoxBlock {
    /// By axis, then least and greatest, then box.
    pub(super) coordinates: [[[f32; BoxBlock::LEN]; 2]; 3],
}

impl BoxBlock {
    /// How many boxes a block has.
    pub const LEN: usize = 64;

    /// The block of empty boxes.
    pub const EMPTY: Self =
        Self { coordinates: [[[f32::INFINITY; Self::LEN], [f32::NEG_INFINITY; Self::LEN]]; 3] };

    /// The block of the first 64 of some boxes; empty ones follow where there are fewer.
    pub fn of<'a>(boxes: impl IntoIterator<Item = &'a Aabb>) -> Self {
        let mut block = Self::EMPTY;
        (0..Self::LEN).zip(boxes).for_each(|(i, bounds)| block.set(i, bounds));
        block
    }

    /// Puts a box in place `i`.
    ///
    /// # Panics
    /// If `i` is not below 64.
    pub fn set(&mut self, i: usize, bounds: &Aabb) {
        let kept = if bounds.is_nan() {
            Aabb { min: Vec3::NAN, max: Vec3::NAN }
        } else if bounds.is_empty() {
            Aabb::EMPTY
        } else {
            *bounds
        };
        for (axis, [least, greatest]) in self.coordinates.iter_mut().enumerate() {
            (least[i], greatest[i]) = (kept.min[axis], kept.max[axis]);
        }
    }

    /// The box in place `i`.
    ///
    /// # Panics
    /// If `i` is not below 64.
    pub fn get(&self, i: usize) -> Aabb {
        let corner = |side: usize| Vec3::from_array(self.coordinates.each_ref().map(|axis| axis[side][i]));
        Aabb { min: corner(0), max: corner(1) }
    }

    /// Its six columns of 64 coordinates, in the order in which they lie: least x, greatest x, least y and so on.
    pub fn columns(&self) -> impl Iterator<Item = &[f32; Self::LEN]> {
        self.coordinates.as_flattened().iter()
    }

    /// The smallest box around all; of NaNs if one of them is.
    pub fn bounds(&self) -> Aabb {
        let boxes = (0..Self::LEN).map(|i| self.get(i));
        boxes.reduce(around).unwrap_or(Aabb::EMPTY)
    }
}

/// The smallest box around both; of NaNs if one of them is.
pub(crate) fn around(a: Aabb, b: Aabb) -> Aabb {
    // A minimum passes over a NaN.
    if a.is_nan() || b.is_nan() { Aabb { min: Vec3::NAN, max: Vec3::NAN } } else { a.union(b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_come_back_but_for_the_odd_ones() {
        let plain = Aabb { min: Vec3::new(-1.0, 2.0, 3.0), max: Vec3::new(4.0, 2.0, f32::INFINITY) };
        let inverted = Aabb { min: Vec3::new(0.0, 1.0, 0.0), max: Vec3::new(1.0, 0.0, 1.0) };
        let hole = Aabb { min: Vec3::new(2.0, f32::NAN, 0.0), max: Vec3::ONE };
        let block = BoxBlock::of(&[plain, inverted, hole]);
        assert_eq!(block.get(0), plain);
        assert!(block.columns().map(|column| column[0]).eq([-1.0, 4.0, 2.0, 2.0, 3.0, f32::INFINITY]));
        assert_eq!(block.get(1), Aabb::EMPTY);
        assert!(block.get(2).min.x.is_nan() && block.get(2).max.z.is_nan());
        assert!((3..64).all(|i| block.get(i) == Aabb::EMPTY));
        assert!(block.bounds().is_nan());
        assert_eq!(BoxBlock::of(&[plain, inverted]).bounds(), plain);
        assert!(BoxBlock::EMPTY.bounds().is_empty());
        assert_eq!(BoxBlock::of(&[plain; 70]).get(63), plain);
    }
}
