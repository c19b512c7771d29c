//! Axis-aligned boxes.

use glam::{Affine3A, Vec3, Vec3A};

/// An axis-aligned box, in metres. A box whose least corner exceeds its greatest on some axis is empty:
/// it holds no point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing, and is neutral in [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The box that holds nothing.
    pub const fn empty() -> Self {
        Self::EMPTY
    }

    /// The smallest box around some points; empty if there are none.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with_point)
    }

    /// The smallest box around this one and a point.
    #[must_use]
    pub fn with_point(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box holds no point. A box with a NaN in it counts as empty only if another axis is.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Whether any coordinate is NaN.
    #[inline]
    pub fn is_nan(&self) -> bool {
        self.min.is_nan() || self.max.is_nan()
    }

    /// Whether `other` lies wholly in this box; an empty box lies in every box.
    pub fn contains(&self, other: &Self) -> bool {
        other.is_empty() || (self.min.cmple(other.min).all() && self.max.cmpge(other.max).all())
    }

    /// The middle, in metres.
    #[inline]
    pub fn centre(&self) -> Vec3 {
        // Halved before adding, so that boxes near the end of the number range do not overflow.
        self.min * 0.5 + self.max * 0.5
    }

    /// Half the space diagonal, in metres: the `d2` of the octant test (Paper I sec. 3.3).
    #[inline]
    pub fn half_diagonal(&self) -> f32 {
        (self.max * 0.5 - self.min * 0.5).length()
    }

    /// Extent on each axis, in metres; zero for an empty box.
    pub fn size(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }

    /// The smallest box around this one after a transform, up to rounding; an empty box stays empty.
    #[must_use]
    pub fn transformed(&self, transform: &Affine3A) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let (min, max) = (Vec3A::from(self.min), Vec3A::from(self.max));
        let mut low = transform.translation;
        let mut high = transform.translation;
        for (column, axis) in [transform.matrix3.x_axis, transform.matrix3.y_axis, transform.matrix3.z_axis]
            .into_iter()
            .enumerate()
        {
            let (a, b) = (axis * min[column], axis * max[column]);
            low += a.min(b);
            high += a.max(b);
        }
        Self { min: low.into(), max: high.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_is_neutral_and_stays_empty() {
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        assert_eq!(Aabb::empty().union(unit), unit);
        assert!(Aabb::EMPTY.is_empty());
        assert!(Aabb::EMPTY.transformed(&Affine3A::from_translation(Vec3::ONE)).is_empty());
        assert!(unit.contains(&Aabb::EMPTY));
        assert!(!Aabb::EMPTY.contains(&unit));
        assert_eq!(Aabb::EMPTY.size(), Vec3::ZERO);
    }

    #[test]
    fn transform_matches_the_eight_corners() {
        let bounds = Aabb { min: Vec3::new(-1.0, 2.0, 0.5), max: Vec3::new(3.0, 2.5, 4.0) };
        let turned = Affine3A::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), 0.7)
            * Affine3A::from_scale(Vec3::new(2.0, -1.0, 0.5));
        let corners = (0..8).map(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
            turned.transform_point3(Vec3::new(pick(0), pick(1), pick(2)))
        });
        let (expected, got) = (Aabb::of_points(corners), bounds.transformed(&turned));
        assert!((expected.min - got.min).length() < 1e-5 && (expected.max - got.max).length() < 1e-5);
    }

    #[test]
    fn centre_and_half_diagonal() {
        let bounds = Aabb { min: Vec3::new(0.0, 0.0, 0.0), max: Vec3::new(2.0, 4.0, 4.0) };
        assert_eq!(bounds.centre(), Vec3::new(1.0, 2.0, 2.0));
        assert_eq!(bounds.half_diagonal(), 3.0);
        let huge = Aabb { min: Vec3::splat(f32::MIN), max: Vec3::splat(f32::MAX) };
        assert_eq!(huge.centre(), Vec3::ZERO);
    }
}
