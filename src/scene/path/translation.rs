//! Pure translation: path 4 of Paper I sec. 4.

use super::rotation::level;
use super::{CameraPath, PathKind};
use crate::geometry::{Aabb, Camera};

/// [`CameraPath::translation`] within a scene's bounds.
pub(super) const TRANSLATION: PathKind = PathKind {
    name: "translation",
    about: "a camera moving without turning (Paper I sec. 4, path 4)",
    make: |scene, frames, seed| CameraPath::translation(&scene.bounds(), frames, seed),
};

impl CameraPath {
    /// A camera that moves within a box in every frame and never turns: its eye follows the smooth,
    /// seeded waves of [`CameraPath::fly_through`], its gaze is level. Axes, lens and depth range are the
    /// same in every frame, bit for bit, as the translation test of Paper I sec. 3.5 needs. Lens and
    /// depth range as in [`CameraPath::fly_through`]. No frames for an empty box or one that overflows.
    pub fn translation(bounds: &Aabb, frames: usize, seed: u64) -> Self {
        let Some((waves, start)) = level(bounds, seed) else { return Self::default() };
        let at = |frame| Camera { eye: waves.at(frame as f64), ..start };
        Self { frames: (0..frames).map(at).collect() }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::path::waves::grown;

    #[test]
    fn only_the_eye_moves_in_each_frame_and_smoothly() {
        let bounds = Aabb { min: Vec3::new(-3.0, 0.0, 100.0), max: Vec3::new(5.0, 2.0, 400.0) };
        let path = CameraPath::translation(&bounds, 800, 7);
        let first = path.frames[0];
        assert_eq!(path.frames.len(), 800);
        for pair in path.frames.windows(2) {
            let [before, now] = [pair[0], pair[1]];
            let step = now.eye.distance(before.eye);
            assert!(step > 0.0 && step < 0.02 * bounds.size().length(), "a step of {step} m");
            assert!(grown(&bounds).contains(&Aabb { min: now.eye, max: now.eye }));
            // All but the eye, in bits: Debug tells -0 from 0 and prints each f32 as no other.
            let still = Camera { eye: first.eye, ..now };
            assert_eq!(format!("{still:?}"), format!("{first:?}"));
        }
    }
}
