//! Random boxes in a cube, and cameras that see as much of them as asked for.

use crate::geometry::{Aabb, Camera, Frustum, Lens};
use crate::scene::SplitMix64;
use crate::structure::{Boxes, cull};
use glam::Vec3;

/// Half the side of the cube, in metres.
const HALF_SIDE: f64 = 500.0;
/// Least and greatest half-extent of a box on an axis, in metres.
const HALF_EXTENT: [f64; 2] = [0.25, 2.5];
/// From the middle of the cube to the eye, in metres: all of the cube is before it.
const DISTANCE: f32 = 1000.0;
/// The eye's way round the cube from frame to frame, in radians: no frame repeats another.
const STEP: f32 = 0.31;

/// So many boxes, evenly spread over a cube of 1,000 m, half a metre to five metres wide.
pub fn random_boxes(count: usize, seed: u64) -> Vec<Aabb> {
    let mut random = SplitMix64::new(seed);
    let mut point = |[low, high]: [f64; 2]| {
        let mut one = || random.between(low, high) as f32;
        Vec3::new(one(), one(), one())
    };
    let mut one = || {
        let (centre, half) = (point([-HALF_SIDE, HALF_SIDE]), point(HALF_EXTENT));
        Aabb { min: centre - half, max: centre + half }
    };
    (0..count).map(|_| one()).collect()
}

/// The camera of a frame: it stands outside the cube, looks at its middle, and opens as wide as it takes to see
/// `visible` of 100 boxes.
pub fn camera(boxes: &Boxes, frame: usize, visible: f64) -> Camera {
    let wanted = boxes.len() as f64 * visible / 100.0;
    let turn = STEP * frame as f32;
    let eye = Vec3::new(turn.cos(), 0.45 * (2.0 * turn).sin(), turn.sin()).normalize() * DISTANCE;
    let at = |fov_y: f32| {
        let lens = Lens::Symmetric { fov_y, aspect: 16.0 / 9.0 };
        Camera::look_at(eye, Vec3::ZERO, Vec3::Y, lens, 0.1, 2.5 * DISTANCE)
            .expect("it looks across the up axis")
    };
    let (mut narrow, mut wide) = (1e-4, 2.9);
    // As often as it takes to tell one box of a million from the next.
    for _ in 0..22 {
        let middle = 0.5 * (narrow + wide);
        let seen = cull(boxes, &Frustum::new(&at(middle))).count() as f64;
        if seen < wanted { narrow = middle } else { wide = middle }
    }
    at(wide)
}
