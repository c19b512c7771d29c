//! Pure rotation: path 3 of Paper I sec. 4.

use std::f64::consts::TAU;

use glam::Vec3;

use super::super::SplitMix64;
use super::waves::Waves;
use super::{CameraPath, LENS, PathKind};
use crate::geometry::{Aabb, Camera};

/// [`CameraPath::rotation`] within a scene's bounds.
pub(super) const ROTATION: PathKind = PathKind {
    name: "rotation",
    about: "a camera turning on the spot about its own up axis (Paper I sec. 4, path 3)",
    make: |scene, frames, seed| CameraPath::rotation(&scene.bounds(), frames, seed),
};

/// Frames to a full turn: a degree a frame, so that a box stays in view for some sixty.
const FRAMES_A_TURN: f64 = 360.0;

impl CameraPath {
    /// A camera that turns on the spot, within a box, level, always the same way: a degree a frame about
    /// its own up axis, which is all that the rotation test of Paper I sec. 3.5 allows. Eye, up vector,
    /// lens and depth range are the same in every frame, bit for bit; the other two axes are turned anew
    /// from the first frame, so no error adds up. Lens and depth range as in
    /// [`CameraPath::fly_through`]. No frames for an empty box or one that overflows.
    pub fn rotation(bounds: &Aabb, frames: usize, seed: u64) -> Self {
        let Some((_, start)) = level(bounds, seed) else { return Self::default() };
        Self { frames: (0..frames).map(|frame| turned(&start, frame)).collect() }
    }
}

/// The first camera of a path of pure rotation, pure translation or both, and the ways it may be moved
/// on: for equal seeds the three begin with the same camera.
pub(super) fn level(bounds: &Aabb, seed: u64) -> Option<(Waves, Camera)> {
    let mut random = SplitMix64::new(seed);
    let waves = Waves::within(bounds, &mut random)?;
    let (near, far) = waves.depth();
    let (sin, cos) = random.between(0.0, TAU).sin_cos();
    let gaze = Vec3::new(cos as f32, 0.0, sin as f32);
    // Made at the origin: far from it, the gaze would be rounded to what the eye's coordinates resolve.
    let camera = Camera::look_at(Vec3::ZERO, gaze, Vec3::Y, LENS, near, far).ok()?;
    let camera = Camera { eye: waves.at(0.0), ..camera };
    Some((waves, camera))
}

/// A camera turned about its up axis for so many frames, anticlockwise seen from above.
pub(super) fn turned(camera: &Camera, frames: usize) -> Camera {
    let (sin, cos) = (frames as f64 * TAU / FRAMES_A_TURN).sin_cos();
    let (right, forward) = (camera.right.as_dvec3(), camera.forward.as_dvec3());
    Camera {
        right: (right * cos + forward * sin).as_vec3(),
        forward: (forward * cos - right * sin).as_vec3(),
        ..*camera
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::scene::path::waves::grown;

    #[test]
    fn only_the_gaze_turns_one_degree_a_frame_one_way() {
        for bounds in [
            Aabb { min: Vec3::new(-3.0, 0.0, 100.0), max: Vec3::new(5.0, 2.0, 400.0) },
            Aabb { min: Vec3::splat(1e6), max: Vec3::splat(1e6 + 0.25) },
        ] {
            let path = CameraPath::rotation(&bounds, 800, 7);
            let first = path.frames[0];
            assert_eq!(path.frames.len(), 800);
            assert!(grown(&bounds).contains(&Aabb { min: first.eye, max: first.eye }));
            for (number, camera) in path.frames.iter().enumerate() {
                let bits = |v: Vec3| v.to_array().map(f32::to_bits);
                assert_eq!(
                    (bits(camera.eye), bits(camera.up), camera.lens, camera.near, camera.far),
                    (bits(first.eye), bits(first.up), first.lens, first.near, first.far)
                );
                // The oracle: quaternions turn about any axis, by a degree a frame.
                let turn = DQuat::from_axis_angle(first.up.as_dvec3(), (number as f64).to_radians());
                assert!((turn * first.forward.as_dvec3() - camera.forward.as_dvec3()).length() < 1e-6);
                assert!((turn * first.right.as_dvec3() - camera.right.as_dvec3()).length() < 1e-6);
            }
        }
    }
}
