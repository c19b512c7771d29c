//! Rays from a camera.

use glam::{DMat3, DVec3, Vec2, Vec3};

use crate::geometry::{Camera, Lens, Ray};
use crate::scene::{PointLight, Scene, View};
use crate::structure::bvh::Intersector;

use super::World;

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

    /// The camera of a view before so many pixels; none of a view that looks nowhere. `aspect` is the width over the
    /// height of what is seen.
    pub fn of_view(view: &View, aspect: f32, (width, height): (u32, u32)) -> Option<Self> {
        let lens = Lens::Symmetric { fov_y: view.fov_y, aspect };
        let camera = Camera::look_at(view.eye, view.look, view.up, lens, 1.0, 2.0).ok()?;
        Some(Self::new(&camera, width, height))
    }

    /// Where points are seen: the inverse of [`Eye::ray`], whose rays go through the middles of pixels.
    pub fn projection(&self) -> Projection {
        // The way to a point is so much of the corner's, of a step across and of one down.
        let ways = DMat3::from_cols(self.corner, self.across, self.down);
        Projection { origin: self.origin.as_dvec3(), inverse: ways.inverse() }
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

/// Tells where points are seen.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    origin: DVec3,
    inverse: DMat3,
}

impl Projection {
    /// Where a point in metres is seen, in pixels from the picture's upper left corner; none of one that is not before
    /// the eye.
    #[inline]
    pub fn place_of(&self, point: DVec3) -> Option<(f64, f64)> {
        let way = self.inverse * (point - self.origin);
        (way.x > 0.0).then(|| (way.y / way.x, way.z / way.x))
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

/// Directions in which one looks about to see where one is.
const ABOUT: usize = 128;
/// Of those, how many must end at a surface's front for one to be within a room.
const WALLS: usize = ABOUT * 3 / 5;
/// How far back one steps to see more of a room, as a share of the way to the wall.
const BACK: f32 = 0.8;

/// A camera within a scene that closes in on its middle as the walls of a building do, their fronts turned to it: it
/// looks the longest way there is along the floor. None where the middle is in the open, or within a body, whose
/// surface shows it its back.
pub fn view_within(world: &World, intersector: &dyn Intersector, aspect: f32) -> Option<Camera> {
    let bounds = world.scene().bounds();
    let (middle, size) = (bounds.centre(), bounds.half_diagonal());
    let is_front = |direction: Vec3| {
        let hit = intersector.closest(&Ray::new(middle, direction));
        let corners = hit.and_then(|hit| world.corners(hit.item));
        corners.is_some_and(|[a, b, c]| (b - a).cross(c - a).dot(direction) < 0.0)
    };
    // Points of a sphere, evenly spread (Fibonacci's spiral).
    let about = (0..ABOUT).map(|step| {
        let y = 1.0 - (2 * step + 1) as f32 / ABOUT as f32;
        let (sine, cosine) = (step as f32 * 2.399_963_2).sin_cos();
        Vec3::new(cosine, 0.0, sine) * (1.0 - y * y).sqrt() + Vec3::Y * y
    });
    if about.filter(|direction| is_front(*direction)).count() < WALLS {
        return None;
    }
    let free = |direction: Vec3| intersector.closest(&Ray::new(middle, direction)).map_or(0.0, |hit| hit.t);
    let ways = (0..64).map(|step| Vec2::from_angle(step as f32 * std::f32::consts::TAU / 64.0));
    let ways = ways.map(|way| Vec3::new(way.x, 0.0, way.y));
    let way = ways.max_by(|a, b| (free(*a) + free(-*a)).total_cmp(&(free(*b) + free(-*b))))?;
    let eye = middle - way * (free(-way) * BACK);
    let lens = Lens::Symmetric { fov_y: 1.0, aspect };
    Camera::look_at(eye, middle + way * size, Vec3::Y, lens, size * 1e-4, size * 2.0).ok()
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

#[cfg(test)]
mod tests {
    use super::super::{Hierarchy, TriangleKind};
    use super::*;
    use crate::scene::by_name;
    use crate::structure::bvh::build::{Builder, Settings};

    #[test]
    fn one_looks_about_within_walls_and_not_within_a_body() {
        let shell = by_name("shell").unwrap();
        let seen_within = |scene: Scene| {
            let world = World::new(scene);
            let mut builder = Builder::new("binned_sah", &Settings::default()).unwrap();
            let hierarchy = Hierarchy::new(world.items(), &mut builder, TriangleKind::Watertight).unwrap();
            view_within(&world, &hierarchy, 1.0)
        };
        assert!(seen_within(shell.clone()).is_none(), "a body shows its back");
        let mut room = shell;
        for mesh in &mut room.meshes {
            mesh.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        let (bounds, camera) = (room.bounds(), seen_within(room).expect("walls all round"));
        assert!(camera.eye.cmpgt(bounds.min).all() && camera.eye.cmplt(bounds.max).all());
        assert!((bounds.centre() - camera.eye).dot(camera.forward) > 0.0, "it looks across the middle");
        assert!(seen_within(by_name("robot").unwrap()).is_none(), "its middle is in the open");
        assert!(seen_within(Scene::new("nothing")).is_none());
    }
}
