//! Camera paths: made for a scene, read from a recording, written to one.

use super::{GENERATORS, Scene};
use crate::geometry::{Camera, Lens};

mod fly;
mod recording;
mod walk;

/// A camera for each frame, one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraPath {
    /// The frames.
    pub frames: Vec<Camera>,
}

/// Width over height of the picture, which recordings do not hold.
const ASPECT: f32 = 4.0 / 3.0;

/// The lens of generated paths: 60 degrees up and down, 4:3.
const LENS: Lens = Lens::Symmetric { fov_y: std::f32::consts::FRAC_PI_3, aspect: ASPECT };

impl CameraPath {
    /// A path for a scene: a user's walk along the aisles if a generator made it, a flight through its
    /// bounds otherwise. Equal seeds give equal paths.
    pub fn for_scene(scene: &Scene, frames: usize, seed: u64) -> Self {
        match GENERATORS.iter().find(|generator| generator.name == scene.name) {
            Some(generator) => Self::walk(&generator.aisles(), frames, seed),
            None => Self::fly_through(&scene.bounds(), frames, seed),
        }
    }
}
