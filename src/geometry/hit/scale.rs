//! The length that everything is counted in.

use glam::Vec3;

/// A power of two that brings the greatest coordinate of a scene to between 1 and 2, so that products of three lengths
/// neither overflow nor vanish. As it is a power of two, no result depends on it but where they would.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale(f32);

impl Scale {
    /// The scale of a scene with these points; those that are not finite do not count.
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        let finite = points.into_iter().filter(|point| point.is_finite());
        Self(to_one(finite.fold(0.0, |greatest, point| point.abs().max_element().max(greatest))))
    }

    /// A point in metres, in this scale's lengths.
    pub fn point(self, point: Vec3) -> Vec3 {
        point * self.0
    }

    /// How many of this scale's lengths a metre has.
    pub fn factor(self) -> f32 {
        self.0
    }

    /// How many metres one of this scale's lengths has.
    pub fn inverse(self) -> f32 {
        inverse(self.0)
    }
}

/// The power of two that brings a number that is not negative to between 1 and 2, as far as powers of two go whose
/// inverse is normal too.
#[inline]
pub(super) fn to_one(value: f32) -> f32 {
    let exponent = value.to_bits() >> 23;
    f32::from_bits((254 - exponent.min(253)).min(253) << 23)
}

/// One over a power of two that [`to_one`] told.
#[inline]
pub(super) fn inverse(power: f32) -> f32 {
    f32::from_bits((254 << 23) - power.to_bits())
}
