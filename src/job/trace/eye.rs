//! Rays from a camera.

use glam::{DVec3, Vec3};

use crate::geometry::{Camera, Lens, Ray};
use crate::scene::{PointLight, Scene};

/// A camera before a picture of so many pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    width: u32,
    height: u32,
    origin: Vec3,
    /// Through the picture's upper left corner, and from a pixel to the next across and down.
    corner: DVec3,
    across: DVec3,
    down: DVec3,
}

impl Eye {
    /// Rays go through the middles of pixels. The camera's near and far planes do not cut them.
    pub fn new(camera: &Camera, width: u32, height: u32) -> Self {
        let [left, right, bottom, top] = camera.lens.tangents();
        let [x, y, ahead] = [camera.right, camera.up, camera.forward].map(|axis| axis.as_dvec3());
        Self {
            width,
            height,
            origin: camera.eye,
            corner: ahead + x * left + y * top,
            across: x * ((right - left) / f64::from(width)),
            down: y * ((bottom - top) / f64::from(height)),
        }
    }

    /// Pixels across and down.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// The ray of a pixel, counted from the upper left; its direction is of unit length.
    #[inline]
    pub fn ray(&self, x: u32, y: u32) -> Ray {
        let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let direction = self.corner + self.across * x + self.down * y;
        Ray::new(self.origin, direction.normalize().as_vec3())
    }
}

/// Half the height of the picture, as a tangent: a vertical angle of 45 degrees.
const HALF: f32 = 0.414_213_57;

/// The camera of the scene's own view, or, if it has none that can be had, one that sees all of it from above its
/// right front corner, y being up; `aspect` is the picture's width over its height. None for a scene in which there is
/// nothing, or whose size overflows.
pub fn default_view(scene: &Scene, aspect: f32) -> Option<Camera> {
    let bounds = scene.bounds();
    if bounds.is_empty() {
        return None;
    }
    let centre = bounds.centre();
    // A point is given a size that can be told from its own rounding.
    let radius = bounds.half_diagonal().max(centre.abs().max_element() * 1e-5).max(f32::MIN_POSITIVE * 1e6);
    let make = |eye: Vec3, look: Vec3, up: Vec3, fov_y: f32| {
        let far = eye.distance(centre) + 1.1 * radius;
        Camera::look_at(eye, look, up, Lens::Symmetric { fov_y, aspect }, far * 1e-4, far).ok()
    };
    let own = scene.view.and_then(|view| make(view.eye, view.look, view.up, view.fov_y));
    own.or_else(|| {
        let toward = Vec3::new(0.5, 0.45, 1.0).normalize();
        let right = Vec3::Y.cross(toward).normalize();
        let up = toward.cross(right);
        // As near as lets every corner of the bounds into the picture, or into its own rounding.
        let half = bounds.size() * 0.5;
        let corners = (0..8).map(|corner| {
            let side = |axis: usize| if corner >> axis & 1 == 1 { half[axis] } else { -half[axis] };
            let off = Vec3::new(side(0), side(1), side(2));
            let reach = (off.dot(right).abs() / aspect).max(off.dot(up).abs());
            off.dot(toward) + reach / HALF
        });
        let distance = corners.fold(radius * 0.1, f32::max) * 1.05;
        make(centre + toward * distance, centre, Vec3::Y, std::f32::consts::FRAC_PI_4)
    })
}

/// A light for a scene that has none: above the eye to its left, far enough off that surfaces show their shape; close by
/// where the eye is within the scene, so that no wall is between.
pub fn light_at(camera: &Camera, scene: &Scene) -> PointLight {
    let bounds = scene.bounds();
    let is_within = camera.eye.cmpge(bounds.min).all() && camera.eye.cmple(bounds.max).all();
    let far = bounds.half_diagonal() * if is_within { 0.02 } else { 1.0 };
    PointLight {
        position: camera.eye + (camera.up * 0.8 - camera.right * 0.6) * far,
        colour: Vec3::splat(0.9),
    }
}
