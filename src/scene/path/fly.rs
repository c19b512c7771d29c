//! A flight through any scene.

use std::f64::consts::TAU;

use glam::Vec3;

use super::super::SplitMix64;
use super::{CameraPath, LENS};
use crate::geometry::{Aabb, Camera};

impl CameraPath {
    /// A flight through a box: round and round within it on smooth, seeded waves, looking ahead along
    /// the way and now and then down. Translation and rotation in every frame, as in path 2 of Paper I
    /// sec. 4. 60 degrees up and down, 4:3; the depth range is from a thousandth of the box's diagonal
    /// to all of it. No frames for an empty box or one that overflows.
    pub fn fly_through(bounds: &Aabb, frames: usize, seed: u64) -> Self {
        let diagonal = bounds.size().length();
        if bounds.is_empty() || !diagonal.is_finite() {
            return Self::default();
        }
        // A single point is flown past at a distance of the order of a metre.
        let diagonal = if diagonal > 0.0 { diagonal } else { 1.0 };
        let mut random = SplitMix64::new(seed);
        // For each axis: where on its wave it begins, and how many waves it makes on a flight of 1000
        // frames. Different counts, so that the figure closes late.
        let waves = [2.0, 3.0, 5.0].map(|turns| (random.between(0.0, TAU), turns * random.between(0.8, 1.2)));
        let at = |frame: f64| {
            let share =
                Vec3::from(waves.map(|(start, turns)| (start + turns * TAU * frame / 1000.0).sin() as f32));
            bounds.centre() + share * (bounds.size().max(Vec3::splat(diagonal * 0.05)) * 0.4)
        };
        let cameras = (0..frames).filter_map(|frame| {
            let eye = at(frame as f64);
            let look = at(frame as f64 + 25.0) - Vec3::Y * (diagonal * 0.02);
            [Vec3::Y, Vec3::Z]
                .into_iter()
                .find_map(|up| Camera::look_at(eye, look, up, LENS, diagonal * 1e-3, diagonal).ok())
        });
        Self { frames: cameras.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flights_stay_inside_and_move_each_frame() {
        let bounds = Aabb { min: Vec3::new(-3.0, 0.0, 100.0), max: Vec3::new(5.0, 2.0, 400.0) };
        let path = CameraPath::fly_through(&bounds, 500, 1);
        assert_eq!((path.frames.len(), &path), (500, &CameraPath::fly_through(&bounds, 500, 1)));
        for pair in path.frames.windows(2) {
            assert!(pair[0].eye != pair[1].eye && pair[0].forward != pair[1].forward);
            let eye = Aabb { min: pair[0].eye, max: pair[0].eye };
            let roomy = Aabb { min: bounds.min - 8.0, max: bounds.max + 8.0 };
            assert!(roomy.contains(&eye));
        }
        assert!(CameraPath::fly_through(&Aabb::EMPTY, 10, 1).frames.is_empty());
        let point = Aabb { min: Vec3::ONE, max: Vec3::ONE };
        assert_eq!(CameraPath::fly_through(&point, 10, 1).frames.len(), 10);
    }
}
