//! Translation and rotation in each frame: path 2 of Paper I sec. 4.

use super::rotation::{level, turned};
use super::{CameraPath, PathKind};
use crate::geometry::{Aabb, Camera};

/// [`CameraPath::both`] within a scene's bounds.
pub(super) const BOTH: PathKind = PathKind {
    name: "both",
    about: "a camera moving and turning in each frame (Paper I sec. 4, path 2)",
    make: |scene, frames, seed| CameraPath::both(&scene.bounds(), frames, seed),
};

impl CameraPath {
    /// A camera that moves and turns in every frame: for the same seed, the eyes of
    /// [`CameraPath::translation`] with the axes of [`CameraPath::rotation`], so that a test that gains by
    /// one kind of motion can be held against the same motion with the other added. No frames for an
    /// empty box or one that overflows.
    pub fn both(bounds: &Aabb, frames: usize, seed: u64) -> Self {
        let Some((waves, start)) = level(bounds, seed) else { return Self::default() };
        let at = |frame| Camera { eye: waves.at(frame as f64), ..turned(&start, frame) };
        Self { frames: (0..frames).map(at).collect() }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn it_is_the_translation_and_the_rotation_of_its_seed() {
        let bounds = Aabb { min: Vec3::new(-3.0, 0.0, 100.0), max: Vec3::new(5.0, 2.0, 400.0) };
        let both = CameraPath::both(&bounds, 100, 9).frames;
        let rotation = CameraPath::rotation(&bounds, 100, 9).frames;
        let translation = CameraPath::translation(&bounds, 100, 9).frames;
        assert_eq!(both[0], rotation[0]);
        for frame in 0..100 {
            assert_eq!(both[frame], Camera { eye: translation[frame].eye, ..rotation[frame] });
        }
    }
}
