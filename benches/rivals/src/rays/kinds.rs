//! The rays.

use apportion::geometry::{Aabb, Ray};
use apportion::job::trace::{World, view_within};
use apportion::structure::bvh::Intersector;
use glam_ours::Vec3;

/// Pixels of a picture's side; a multiple of a tile's, 4.
const SIDE: usize = 1024;
/// Chords, and at most so many bounces, evenly out of all of them.
const OTHERS: usize = 1 << 17;
/// Half of what the camera sees, as the tangent of an angle.
const HALF_VIEW: f32 = 0.5;

/// A number from 0 to 1, and the next one each time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    /// A point of the cube from 0 to 1.
    fn point(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// All kinds over the triangles of a scene, which `tracer` knows.
pub(super) fn all(world: &World, tracer: &impl Intersector) -> [(&'static str, Vec<Ray>); 3] {
    let triangles = &world.items().triangles;
    let bounds = Aabb::of_points(triangles.iter().flatten().copied());
    let mut random = Random(7);
    let camera = match view_within(world, tracer, 1.0) {
        Some(within) => camera(within.eye, within.forward, [within.right, within.up]),
        None => {
            let eye = bounds.centre() + Vec3::new(0.25, 0.18, 0.6) * bounds.size().length();
            let forward = (bounds.centre() - eye).normalize();
            let right = forward.cross(Vec3::Y).normalize();
            camera(eye, forward, [right, right.cross(forward)])
        }
    };
    let every = camera.len().div_ceil(OTHERS);
    let bounces = camera.iter().step_by(every).filter_map(|ray| {
        let hit = tracer.closest(ray)?;
        let [a, b, c] = triangles[hit.item as usize];
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
        let off = (random.point() * 2.0 - 1.0).normalize_or(normal);
        let origin = ray.at(hit.t) + normal * (bounds.size().length() * 1e-5);
        Some(Ray::new(origin, (normal + off).normalize_or(normal)))
    });
    let bounces: Vec<Ray> = bounces.collect();
    let size = bounds.size();
    let chords = (0..OTHERS).map(|_| {
        let (a, b) = (bounds.min + size * random.point(), bounds.min + size * random.point());
        let direction = (b - a).normalize_or(Vec3::X);
        Ray::new(a - direction * size.length(), direction)
    });
    let chords = chords.collect();
    [("camera", camera), ("bounces", bounces), ("chords", chords)]
}

/// A picture, tile after tile; of the whole scene from near enough that it fills more than half, or from within it.
fn camera(eye: Vec3, forward: Vec3, [right, up]: [Vec3; 2]) -> Vec<Ray> {
    let at = |pixel: usize| ((pixel as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0) * HALF_VIEW;
    let tiles = (0..SIDE / 4).flat_map(|y| (0..SIDE / 4).map(move |x| (4 * x, 4 * y)));
    let pixels = tiles.flat_map(|(x, y)| (0..16).map(move |i| (x + i % 4, y + i / 4)));
    pixels.map(|(x, y)| Ray::new(eye, (forward + right * at(x) - up * at(y)).normalize())).collect()
}
