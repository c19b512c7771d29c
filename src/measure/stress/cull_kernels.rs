//! Random and adversarial boxes for the culling kernels: nothing visible is culled, all kernels find the same, and the
//! box tree finds it too.

use crate::geometry::oracle::Hexahedron;
use crate::geometry::{Aabb, BoxBlock, BoxTest, Camera, Frustum, Kernel, Lens};
use crate::machine::{Machine, Processor, Threads};
use crate::scene::SplitMix64;
use crate::structure::{BoxTree, cull};
use glam::Vec3;

/// Boxes that one camera is tried on.
const BOXES: usize = 2048;

/// A camera and its boxes on each of up to so many processors; returns the boxes tested.
pub(super) fn check(team: &Threads, processors: usize, random: &mut SplitMix64) -> Result<u64, String> {
    let (processors, seed) = (1 + random.below(processors), random.next_u64());
    let run = team.run(processors, |cpu| one(&mut SplitMix64::new(seed ^ cpu.id() as u64)));
    let tested: Result<Vec<u64>, String> = run.map_err(|e| e.to_string())?.into_iter().collect();
    Ok(tested?.iter().sum())
}

fn one(random: &mut SplitMix64) -> Result<u64, String> {
    let camera = camera(random);
    let (frustum, oracle) = (Frustum::new(&camera), Hexahedron::new(&camera));
    let all: Vec<Aabb> = (0..BOXES).map(|_| bounds(&camera, &frustum, random)).collect();
    let tree = BoxTree::build(&all);
    let (boxes, seen) = (tree.boxes(), tree.cull(&frustum));
    if seen != cull(boxes, &frustum) {
        return Err(format!("the box tree finds {} boxes, or others, from {camera:?}", seen.count()));
    }
    let mut words = vec![0; boxes.blocks().len()];
    for kernel in Kernel::all() {
        BoxTest::with_kernel(&frustum, kernel).visible(boxes.blocks(), &mut words);
        if let Some(block) = (0..words.len()).find(|&block| words[block] != seen.words()[block]) {
            let boxes = BoxBlock::LEN * block;
            return Err(format!("kernel {kernel:?} finds others from box {boxes} on, from {camera:?}"));
        }
    }
    for i in (0..boxes.len()).filter(|&i| !seen.get(i)) {
        let bounds = boxes.get(i);
        if oracle.intersects(&bounds) {
            return Err(format!("{bounds:?} was culled, which is visible from {camera:?}"));
        }
    }
    Ok(boxes.len() as u64)
}

fn share(random: &mut SplitMix64) -> f32 {
    random.between(-1.0, 1.0) as f32
}

fn point(random: &mut SplitMix64) -> Vec3 {
    Vec3::new(share(random), share(random), share(random))
}

/// A power of ten.
fn scale(random: &mut SplitMix64, low: f64, high: f64) -> f32 {
    10f64.powf(random.between(low, high)) as f32
}

/// Near the origin and far from it; lenses wide, narrow and askew; short and long depth ranges.
fn camera(random: &mut SplitMix64) -> Camera {
    loop {
        let far_out = [0.0, 1.0, 100.0, 1e6, 1e9][random.below(5)];
        let eye = point(random) * far_out;
        let lens = match random.below(3) {
            0 => {
                let fov_y = random.between(0.02, 2.8) as f32;
                Lens::Symmetric { fov_y, aspect: random.between(0.2, 4.0) as f32 }
            }
            1 => Lens::Symmetric { fov_y: scale(random, -4.0, -1.0), aspect: 1.0 },
            _ => {
                let (left, bottom) = (2.0 * share(random), 2.0 * share(random));
                let (width, height) = (scale(random, -3.0, 0.5), scale(random, -3.0, 0.5));
                Lens::OffAxis { left, right: left + width, bottom, top: bottom + height }
            }
        };
        let near = scale(random, -3.0, 1.0);
        let far = near * (1.0 + scale(random, -2.0, 5.0));
        let reach = far_out.max(1.0) * 2.0;
        // Now and then straight along an axis, where planes have zeros in their normals.
        let toward = if random.below(4) == 0 { Vec3::X } else { point(random) };
        if let Ok(camera) = Camera::look_at(eye, eye + toward * reach, Vec3::Y, lens, near, far) {
            return camera;
        }
    }
}

/// A box around, on the surface, in the narrow end, or of any bits at all.
fn bounds(camera: &Camera, frustum: &Frustum, random: &mut SplitMix64) -> Aabb {
    let by_centre = |centre: Vec3, half: Vec3| Aabb { min: centre - half.abs(), max: centre + half.abs() };
    match random.below(16) {
        0..6 => {
            let depth = camera.far * random.between(-0.3, 1.3) as f32;
            let [across, up] = [share(random), share(random)].map(|share| 2.0 * share * depth);
            let centre = camera.eye + camera.forward * depth + camera.right * across + camera.up * up;
            by_centre(centre, point(random) * camera.far * scale(random, -7.0, 1.0))
        }
        6..11 => touching(frustum, random),
        11..13 => {
            let depth =
                camera.near * scale(random, -1.0, 2.0) * if random.below(3) == 0 { -1.0 } else { 1.0 };
            let centre = camera.eye + camera.forward * depth + point(random) * depth;
            by_centre(centre, point(random) * depth * scale(random, -4.0, 1.0))
        }
        13 => by_centre(camera.eye + point(random) * camera.far, Vec3::splat(scale(random, 0.0, 38.0))),
        14 => Aabb::of_points([any(random), any(random)]),
        _ => Aabb { min: any(random), max: any(random) },
    }
}

/// Any bits at all: NaNs, infinities, the wrong way round.
fn any(random: &mut SplitMix64) -> Vec3 {
    let mut one = || f32::from_bits(random.next_u64() as u32);
    Vec3::new(one(), one(), one())
}

/// A box with a corner, an edge or a face on a face of the frustum, up to a few steps of its numbers: where
/// rounding decides.
fn touching(frustum: &Frustum, random: &mut SplitMix64) -> Aabb {
    let faces = [[0, 2, 4, 6], [1, 3, 5, 7], [0, 1, 2, 3], [4, 5, 6, 7], [2, 3, 6, 7], [0, 1, 4, 5]];
    let [a, b, c, d] = faces[random.below(6)].map(|corner| frustum.corners[corner]);
    // Pulled toward the ends, so that edges and corners come up too.
    let mut along = || (random.between(-0.2, 1.2) as f32).clamp(0.0, 1.0);
    let (u, v) = (along(), along());
    let on_face = a.lerp(b, u).lerp(c.lerp(d, u), v);
    let nudge = |x: f32, steps: usize| {
        (0..steps / 2).fold(x, |x, _| if steps & 1 == 0 { x.next_up() } else { x.next_down() })
    };
    let corner = Vec3::from_array(on_face.to_array().map(|x| nudge(x, random.below(8))));
    let size = (a - d).length() * scale(random, -7.0, 1.0);
    let flat = Vec3::from_array([0; 3].map(|_| if random.below(4) == 0 { 0.0 } else { 1.0 }));
    Aabb::of_points([corner, corner + point(random) * size * flat])
}
