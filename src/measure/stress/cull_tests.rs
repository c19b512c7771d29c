//! The culling tests against the exact one: random and adversarial volumes before random cameras that move.

use crate::geometry::culling::{Culler, Motion, Octant, Remembering, Side, Steps};
use crate::geometry::oracle::{Exact, Hexahedron};
use crate::geometry::{Aabb, Camera, Frustum, KDop, Lens, Obb, Sphere, Volume};
use crate::machine::Threads;
use crate::scene::SplitMix64;
use glam::{Mat3, Quat, Vec3};

/// Every step alone, and the combinations that interact.
const STEPS: [&str; 14] = [
    "basic",
    "fields",
    "perspective",
    "clip",
    "plane",
    "crossed",
    "octant",
    "octant_as_published",
    "pair",
    "rotation",
    "translation",
    "plane+octant+fields",
    "plane+octant+tr+fields",
    "crossed+octant+tr+pair",
];
/// Cameras a run goes through with the same volumes.
const FRAMES: usize = 8;
/// Volumes of a kind.
const VOLUMES: usize = 64;

/// A number in 0..1.
fn share(random: &mut SplitMix64) -> f32 {
    (random.next_u64() >> 40) as f32 / (1 << 24) as f32
}

fn direction(random: &mut SplitMix64) -> Vec3 {
    let [x, y, z] = [0; 3].map(|_| share(random) * 2.0 - 1.0);
    Vec3::new(x, y * 0.9, z).normalize_or(Vec3::X)
}

fn camera(random: &mut SplitMix64) -> Option<Camera> {
    let place = [0.0, 50.0, 1e6][random.below(3)];
    let eye = direction(random) * place;
    let lens = match random.below(3) {
        0 => Lens::Symmetric { fov_y: 0.001 + 0.02 * share(random), aspect: 1.0 },
        1 => Lens::Symmetric { fov_y: 0.1 + 2.4 * share(random), aspect: 0.3 + 3.0 * share(random) },
        _ => {
            Lens::OffAxis { left: -1.5 * share(random), right: 0.1, bottom: -0.2, top: 0.01 + share(random) }
        }
    };
    let near = 0.01 + share(random);
    let far = near * (1.5 + 2000.0 * share(random).powi(3));
    Camera::look_at(eye, eye + direction(random) * 16.0, Vec3::Y, lens, near, far).ok()
}

/// The same camera, moved, turned about an axis of its own, both, or neither.
fn moved(camera: &Camera, random: &mut SplitMix64) -> Camera {
    let mut moved = *camera;
    let what = random.below(4);
    if what & 1 != 0 {
        moved.eye += direction(random) * (camera.far * 0.1 * share(random));
    }
    if what & 2 != 0 {
        let axes = [camera.right, camera.up, camera.forward];
        let (axis, angle) = (random.below(3), 0.5 * (share(random) - 0.5));
        let turn = Mat3::from_axis_angle(axes[axis].normalize(), angle);
        let turned = |i: usize| if i == axis { axes[i] } else { (turn * axes[i]).normalize() };
        (moved.right, moved.up, moved.forward) = (turned(0), turned(1), turned(2));
    }
    moved
}

/// A box of any size and shape before, beside or behind the camera; now and then with a corner on one of the
/// frustum's, where rounding decides.
fn bounds(camera: &Camera, frustum: &Frustum, random: &mut SplitMix64) -> Aabb {
    let mut around = |half: f32| [0; 3].map(|_| (share(random) * 2.0 - 1.0) * half);
    let [x, y, z] = around(1.3);
    let sizes = around(1.0).map(|size| size.abs());
    let exponent = share(random) * 8.0 - 5.0;
    if random.below(4) == 0 {
        let [a, b, t] = [0; 3].map(|_| share(random));
        let corner = frustum.corners[random.below(8)]
            .lerp(frustum.corners[random.below(8)], (a * 1.4 - 0.2).clamp(0.0, 1.0));
        let reach = camera.far * 10f32.powf(exponent.min(0.0));
        return Aabb::of_points([corner, corner + Vec3::new(x, y - b, z + t) * reach]);
    }
    let depth = camera.far * (z * 0.8 + 0.5);
    let [.., right, _, top] = camera.lens.tangents().map(|tangent| tangent as f32 * depth.abs());
    let centre = camera.eye + camera.forward * depth + camera.right * (x * right) + camera.up * (y * top);
    let half = Vec3::from_array(sizes) * (10f32.powf(exponent) * depth.abs().max(camera.near));
    Aabb { min: centre - half, max: centre + half }
}

/// Holds every combination of steps against the exact test, over a path; how many verdicts that were.
pub(super) fn check(_: &Threads, _: usize, random: &mut SplitMix64) -> Result<u64, String> {
    let Some(first) = camera(random) else { return Ok(0) };
    let mut path = vec![first];
    while path.len() < FRAMES {
        let next = moved(&path[path.len() - 1], random);
        path.push(next);
    }
    let frustum = Frustum::new(&first);
    let boxes: Vec<Aabb> = (0..VOLUMES).map(|_| bounds(&first, &frustum, random)).collect();
    let turned: Vec<Vec<Vec3>> = boxes
        .iter()
        .map(|bounds| {
            let turn = Quat::from_axis_angle(direction(random), 3.0 * share(random));
            bounds.corners().map(|corner| bounds.centre() + turn * (corner - bounds.centre())).to_vec()
        })
        .collect();
    let mut verdicts = hold(&path, &boxes)?;
    verdicts += hold(&path, &turned.iter().map(|points| Obb::of_points(points, &[])).collect::<Vec<_>>())?;
    verdicts += hold(&path, &turned.iter().map(|points| Sphere::of_points(points)).collect::<Vec<_>>())?;
    // The exact test of these takes long: few of them.
    let few = turned.iter().take(1).map(|points| KDop::<13>::of_points(points));
    verdicts += hold(
        &path,
        &few.filter(|volume| volume.slabs().all(|(_, low, high)| high - low < 1e5)).collect::<Vec<_>>(),
    )?;
    Ok(verdicts)
}

fn hold<V: Exact>(path: &[Camera], volumes: &[V]) -> Result<u64, String> {
    let mut verdicts = 0;
    for words in STEPS {
        let steps: Steps = words.parse().map_err(|error| format!("{words}: {error}"))?;
        let memory = vec![Remembering::default(); volumes.len()];
        let mut motion: Option<Motion> = None;
        for (frame, camera) in path.iter().enumerate() {
            let frustum = Frustum::new(camera);
            let now = motion.map_or_else(|| Motion::start(&frustum), |motion| motion.next(&frustum));
            motion = Some(now);
            let Ok(culler) = Culler::new(&frustum, steps, Some(now)) else { break };
            let exact = Hexahedron::new(camera);
            for (volume, memory) in volumes.iter().zip(&memory) {
                let side = culler.classify(volume, memory, 0).side;
                let wrong = match side {
                    Side::Outside(_) => exact.intersects(volume).then_some("visible, but called outside"),
                    Side::Inside if steps.octant == Octant::AsPublished => None,
                    Side::Inside => (!exact.contains(volume)).then_some("not inside, but called so"),
                    Side::Intersecting => None,
                };
                if let Some(wrong) = wrong {
                    return Err(format!("{words}, frame {frame}: {volume:?} is {wrong} before {camera:?}"));
                }
                verdicts += 1;
            }
        }
    }
    Ok(verdicts)
}
