//! A flight through any scene.

use glam::Vec3;

use super::super::SplitMix64;
use super::waves::Waves;
use super::{CameraPath, PathKind, looking};
use crate::geometry::Aabb;

/// [`CameraPath::fly_through`] over a scene's bounds.
pub(super) const FLY: PathKind = PathKind {
    name: "fly",
    about: "a flight round and round within the bounds, looking ahead",
    make: |scene, frames, seed| CameraPath::fly_through(&scene.bounds(), frames, seed),
};

impl CameraPath {
    /// A flight through a box: round and round within it on smooth, seeded waves, looking ahead along
    /// the way and now and then down. Translation and rotation in every frame, as in path 2 of Paper I
    /// sec. 4. 60 degrees up and down, 4:3; the depth range is from a thousandth of the box's diagonal
    /// to all of it. No frames for an empty box or one that overflows.
    pub fn fly_through(bounds: &Aabb, frames: usize, seed: u64) -> Self {
        let Some(waves) = Waves::within(bounds, &mut SplitMix64::new(seed)) else { return Self::default() };
        let (near, far) = waves.depth();
        let cameras = (0..frames).filter_map(|frame| {
            let look = waves.at(frame as f64 + 25.0) - Vec3::Y * (waves.diagonal * 0.02);
            looking(waves.at(frame as f64), look, near, far).ok()
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
