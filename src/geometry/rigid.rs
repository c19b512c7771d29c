//! Rigid motions: turned and shifted, never bent.

use glam::{DMat3, DQuat, DVec3};

/// A rotation and then a translation, in metres. In f64: where a body is must not blur what it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigid {
    rotation: DMat3,
    translation: DVec3,
}

impl Rigid {
    /// Stays where it is.
    pub const IDENTITY: Self = Self { rotation: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// Turns about the origin, then shifts. The quaternion is made a unit one.
    pub fn new(rotation: DQuat, translation: DVec3) -> Self {
        Self { rotation: DMat3::from_quat(rotation.normalize()), translation }
    }

    /// Shifts only.
    pub fn shift(translation: DVec3) -> Self {
        Self { translation, ..Self::IDENTITY }
    }

    /// Where a point goes.
    #[inline]
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.translation
    }

    /// The way back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let back = self.rotation.transpose();
        Self { rotation: back, translation: -(back * self.translation) }
    }

    /// This motion, then another.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self { rotation: next.rotation * self.rotation, translation: next.point(self.translation) }
    }

    /// The rotation, as a matrix.
    pub fn rotation(&self) -> DMat3 {
        self.rotation
    }

    /// The translation, in metres.
    pub fn translation(&self) -> DVec3 {
        self.translation
    }

    /// Whether all of its numbers are finite.
    pub fn is_finite(&self) -> bool {
        self.rotation.is_finite() && self.translation.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let turn = DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 2.1) * 3.0;
        let (there, on) = (Rigid::new(turn, DVec3::new(5.0, -1.0, 1e6)), Rigid::shift(DVec3::Y));
        let point = DVec3::new(0.1, 0.2, 0.3);
        assert!((there.inverse().point(there.point(point)) - point).length() < 1e-9);
        assert!((there.then(&on).point(point) - there.point(point) - DVec3::Y).length() < 1e-9);
        let length = (there.point(point) - there.point(DVec3::ZERO)).length();
        assert!((length - point.length()).abs() < 1e-9, "a quaternion of length 3 does not stretch");
        assert!(!Rigid::shift(DVec3::NAN).is_finite() && there.is_finite());
    }
}
