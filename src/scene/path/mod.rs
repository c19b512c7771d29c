//! Camera paths: made for a scene, read from a recording, written to one.
//!
//! [`PATHS`] lists the kinds that can be made; the first four are those of Paper I sec. 4.

use glam::Vec3;

use super::{GENERATORS, Scene};
use crate::geometry::{Camera, CameraError, Lens};

mod bezier;
mod both;
mod fly;
mod recording;
mod rotation;
mod translation;
mod walk;
mod waves;
mod whole;

pub use bezier::Waypoint;

/// A camera for each frame, one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraPath {
    /// The frames.
    pub frames: Vec<Camera>,
}

/// A kind of camera path that can be made for a scene.
pub struct PathKind {
    /// Name: in experiments (`scene.path`), in rows, in legends.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    make: fn(&Scene, usize, u64) -> CameraPath,
}

impl PathKind {
    /// Makes a path of so many frames. Equal seeds give equal paths. No frames where the scene has
    /// nothing that such a path could lead past: it is empty, or, for `walk`, it has no aisles.
    pub fn make(&self, scene: &Scene, frames: usize, seed: u64) -> CameraPath {
        (self.make)(scene, frames, seed)
    }
}

/// All kinds of path that can be made.
pub const PATHS: &[PathKind] = &[
    walk::WALK,
    both::BOTH,
    rotation::ROTATION,
    translation::TRANSLATION,
    fly::FLY,
    bezier::BEZIER,
    whole::WHOLE,
];

/// Width over height of the picture, which recordings do not hold.
const ASPECT: f32 = 4.0 / 3.0;

/// The lens of generated paths: 60 degrees up and down, 4:3.
const LENS: Lens = Lens::Symmetric { fov_y: std::f32::consts::FRAC_PI_3, aspect: ASPECT };

impl CameraPath {
    /// A path for a scene: a user's walk along the aisles if a generator made it with some, a flight through
    /// its bounds otherwise. Equal seeds give equal paths.
    pub fn for_scene(scene: &Scene, frames: usize, seed: u64) -> Self {
        let generator = GENERATORS.iter().find(|generator| generator.name == scene.name);
        let has_aisles = generator.is_some_and(|generator| !generator.aisles().is_empty());
        let kind = if has_aisles { walk::WALK } else { fly::FLY };
        kind.make(scene, frames, seed)
    }
}

/// A camera with the lens of generated paths and its top to the y axis, or to z if it looks along y.
fn looking(eye: Vec3, look: Vec3, near: f32, far: f32) -> Result<Camera, CameraError> {
    let camera = Camera::look_at(eye, look, Vec3::Y, LENS, near, far);
    camera.or_else(|_| Camera::look_at(eye, look, Vec3::Z, LENS, near, far))
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use glam::Affine3A;

    use super::super::{Mesh, by_name};
    use super::*;

    #[test]
    fn kinds_have_names_of_their_own_and_keep_to_their_seed() {
        let names: HashSet<&str> = PATHS.iter().map(|kind| kind.name).collect();
        assert_eq!(names.len(), PATHS.len());
        let scene = by_name("factory-small").unwrap();
        for kind in PATHS {
            let path = kind.make(&scene, 40, 3);
            assert!(path.frames.len() == 40 && path == kind.make(&scene, 40, 3), "{}", kind.name);
            assert!(path != kind.make(&scene, 40, 4), "{}", kind.name);
            let bits = |frame: &Camera| [frame.eye, frame.forward].map(|v| v.to_array().map(f32::to_bits));
            let seen: HashSet<_> = path.frames.iter().map(bits).collect();
            assert!(kind.name == "walk" || seen.len() == 40, "{}: each frame is another", kind.name);
        }
    }

    #[test]
    fn empty_single_and_far_off_scenes_give_cameras_that_can_see_or_none() {
        let mut far_off = Scene::new("far off");
        let corners = [Vec3::splat(1e6), Vec3::splat(1e6) + Vec3::X, Vec3::splat(1e6) + Vec3::Y];
        let mesh = far_off.add_mesh(Mesh::new("", corners.to_vec(), vec![[0, 1, 2]]));
        far_off.add_node(None, "", Affine3A::IDENTITY, Some(mesh));
        let mut point = far_off.clone();
        point.meshes[0] = Mesh::new("", vec![Vec3::ONE], vec![[0, 0, 0]]);
        let mut huge = far_off.clone();
        huge.meshes[0] = Mesh::new("", vec![Vec3::MAX, Vec3::MIN], vec![[0, 1, 0]]);
        for kind in PATHS.iter().filter(|kind| kind.name != "walk") {
            for (scene, expected) in [(&Scene::new("empty"), 0), (&far_off, 30), (&point, 30), (&huge, 0)] {
                let path = kind.make(scene, 30, 1);
                assert_eq!(path.frames.len(), expected, "{} of {}", kind.name, scene.name);
                for camera in &path.frames {
                    assert!(camera.eye.is_finite() && camera.near > 0.0 && camera.near < camera.far);
                    let axes = [camera.right, camera.up, camera.forward];
                    assert!(axes.iter().all(|axis| (axis.length() - 1.0).abs() < 1e-6));
                    assert!((camera.right.cross(camera.up) + camera.forward).length() < 1e-6);
                }
            }
        }
    }
}
