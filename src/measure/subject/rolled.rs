//! Bodies that are rolled up, further from frame to frame.

use crate::geometry::Aabb;
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Corners, in metres, and triangles.
pub(super) type Surface = (Vec<Vec3>, Vec<[u32; 3]>);

/// Below this a turn is none: the body's roll would be wider than f64 can bend it about.
const LEAST: f64 = 1e-6;

/// The corners of a body rolled up about an axis along z, `turns` times from end to end along x; what was in the middle
/// along y keeps its length.
pub(super) fn rolled(flat: &[Vec3], turns: f64) -> Vec<Vec3> {
    let bounds = Aabb::of_points(flat.iter().copied());
    let (low, length) = (f64::from(bounds.min.x), f64::from(bounds.size().x));
    if turns < LEAST || length == 0.0 {
        return flat.to_vec();
    }
    let (middle, radius) = (f64::from(bounds.centre().y), length / (TAU * turns));
    let place = |point: &Vec3| {
        let DVec3 { x, y, z } = point.as_dvec3();
        let ((sin, cos), arm) = (((x - low) / radius).sin_cos(), radius - (y - middle));
        DVec3::new(low + arm * sin, middle + radius - arm * cos, z).as_vec3()
    };
    flat.iter().map(place).collect()
}

/// How far it is rolled up in each of so many frames: not at all in the first, `last` turns in the last.
pub(super) fn turns(last: f64, frames: u32) -> Vec<f64> {
    let whole = (f64::from(frames) - 1.0).max(1.0);
    (0..frames).map(|frame| last * f64::from(frame) / whole).collect()
}
