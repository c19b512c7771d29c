//! Smooth, seeded ways round and round within a box, which several paths follow.

use std::f64::consts::TAU;

use glam::Vec3;

use super::super::SplitMix64;
use crate::geometry::Aabb;

/// Where an eye may be, frame by frame: on a wave of its own along each axis of a box. A flat box it
/// leaves, by no more than a fiftieth of the diagonal, so that it moves along all three.
pub(super) struct Waves {
    /// Diagonal of the box, in metres, above 0: what depth ranges and heights are shares of.
    pub(super) diagonal: f32,
    centre: Vec3,
    reach: Vec3,
    /// For each axis: where on its wave it begins, in radians, and how many waves it makes in 1000
    /// frames. Different counts, so that the figure closes late.
    waves: [(f64, f64); 3],
}

impl Waves {
    /// Waves within a box; none for an empty box or one that overflows.
    pub(super) fn within(bounds: &Aabb, random: &mut SplitMix64) -> Option<Self> {
        let diagonal = bounds.size().length();
        if bounds.is_empty() || !diagonal.is_finite() {
            return None;
        }
        // A single point is flown past at a distance of the order of a metre.
        let diagonal = if diagonal > 0.0 { diagonal } else { 1.0 };
        let waves = [2.0, 3.0, 5.0].map(|turns| (random.between(0.0, TAU), turns * random.between(0.8, 1.2)));
        let reach = bounds.size().max(Vec3::splat(diagonal * 0.05)) * 0.4;
        Some(Self { diagonal, centre: bounds.centre(), reach, waves })
    }

    /// The place at a frame, in metres.
    pub(super) fn at(&self, frame: f64) -> Vec3 {
        let along = |(start, turns): (f64, f64)| (start + turns * TAU * frame / 1000.0).sin() as f32;
        self.centre + Vec3::from(self.waves.map(along)) * self.reach
    }

    /// Near and far plane for a look around from within, in metres: from a thousandth of the diagonal
    /// to all of it.
    pub(super) fn depth(&self) -> (f32, f32) {
        (self.diagonal * 1e-3, self.diagonal)
    }
}

/// The box that waves within `bounds` keep to, a touch larger for rounding.
#[cfg(test)]
pub(super) fn grown(bounds: &Aabb) -> Aabb {
    let margin = bounds.size().length() * 0.021;
    Aabb { min: bounds.min - margin, max: bounds.max + margin }
}
