//! Sets of rays.

use crate::geometry::{Camera, Ray};
use crate::job::trace::{Eye, default_view};
use crate::scene::{Scene, SplitMix64};
use crate::structure::bvh::Intersector;
use glam::DVec3;
use std::f64::consts::TAU;

/// A kind of ray set in the list of kinds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Its name: word of the command line, value in rows, legend.
    pub name: &'static str,
    /// Which.
    pub kind: RayKind,
}

/// What rays are like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// Of a camera that sees the whole scene, neighbours together: coherent.
    Camera,
    /// From where those of the camera end, scattered evenly by a matt surface: they start together and part.
    Bounce,
    /// Between random points of the sphere about the scene: they have nothing in common.
    Chord,
    /// From the middle of the scene at the corners and edges of its triangles: those of a closed shape about its middle
    /// must all end there.
    Edge,
}

/// The kinds of ray sets.
pub const KINDS: &[Kind] = &[
    Kind { name: "camera", kind: RayKind::Camera },
    Kind { name: "bounce", kind: RayKind::Bounce },
    Kind { name: "chord", kind: RayKind::Chord },
    Kind { name: "edge", kind: RayKind::Edge },
];

/// Pixels across and down that a camera's rays are taken by: a packet's 16 are a square.
const BLOCK: u32 = 4;

/// About so many rays of a kind through a scene; a camera's are the next square. None where there is nothing to aim at.
pub fn ray_set(
    kind: RayKind,
    scene: &Scene,
    intersector: &dyn Intersector,
    count: usize,
    seed: u64,
) -> Option<Vec<Ray>> {
    let view = default_view(scene, 1.0)?;
    let mut random = SplitMix64::new(seed);
    Some(match kind {
        RayKind::Camera => camera(&view, count),
        RayKind::Bounce => {
            let seen = camera(&view, count);
            seen.iter().filter_map(|ray| bounce(ray, intersector, &mut random)).collect()
        }
        RayKind::Chord => {
            let bounds = scene.bounds();
            let (centre, radius) = (bounds.centre().as_dvec3(), f64::from(bounds.half_diagonal()));
            let mut point = || (centre + direction(&mut random) * radius).as_vec3();
            let ends = (0..count).map(|_| (point(), point()));
            ends.map(|(from, to)| Ray::new(from, (to - from).normalize_or_zero())).collect()
        }
        RayKind::Edge => edges(scene, count, &mut random)?,
    })
}

fn camera(view: &Camera, count: usize) -> Vec<Ray> {
    let side = ((count as f64).sqrt().ceil() as u32).next_multiple_of(BLOCK);
    let eye = Eye::new(view, side, side);
    let blocks = (0..side / BLOCK).flat_map(|y| (0..side / BLOCK).map(move |x| (x * BLOCK, y * BLOCK)));
    let pixels = blocks.flat_map(|(x, y)| (0..BLOCK * BLOCK).map(move |i| (x + i % BLOCK, y + i / BLOCK)));
    pixels.map(|(x, y)| eye.ray(x, y)).collect()
}

/// A direction, all alike likely (Archimedes).
fn direction(random: &mut SplitMix64) -> DVec3 {
    let (z, turn) = (random.between(-1.0, 1.0), random.between(0.0, TAU));
    let across = (1.0 - z * z).sqrt();
    DVec3::new(across * turn.cos(), across * turn.sin(), z)
}

/// How far from where a ray ended the next one starts, as a share of the way it came: above its rounding.
const APART: f32 = 1e-5;

/// A ray from where another ends, away from the side it came to.
fn bounce(ray: &Ray, intersector: &dyn Intersector, random: &mut SplitMix64) -> Option<Ray> {
    let hit = intersector.closest(ray)?;
    let away = direction(random).as_vec3();
    // The surface's own normal is not known here: back is where the ray came from.
    let away = (away - ray.direction.normalize()).try_normalize()?;
    Some(Ray::new(ray.at(hit.t * (1.0 - APART)), away))
}

fn edges(scene: &Scene, count: usize, random: &mut SplitMix64) -> Option<Vec<Ray>> {
    let world = scene.world_transforms();
    let placed: Vec<_> =
        scene.nodes.iter().zip(&world).filter_map(|(node, world)| Some((node.mesh?, world))).collect();
    let placed: Vec<_> =
        placed.into_iter().filter(|(mesh, _)| !scene.meshes[*mesh as usize].triangles.is_empty()).collect();
    let origin = scene.bounds().centre();
    if placed.is_empty() {
        return None;
    }
    let mut rays = Vec::with_capacity(count);
    while rays.len() < count {
        let (mesh, world) = placed[random.below(placed.len())];
        let mesh = &scene.meshes[mesh as usize];
        let corners = mesh.triangles[random.below(mesh.triangles.len())];
        let corners = corners.map(|corner| world.transform_point3(mesh.positions[corner as usize]));
        let first = random.below(3);
        let [from, to] = [corners[first], corners[(first + 1) % 3]];
        // One in four at a corner itself.
        let share = random.between(-0.3, 1.0).max(0.0);
        rays.push(Ray::new(origin, from.as_dvec3().lerp(to.as_dvec3(), share).as_vec3() - origin));
    }
    Some(rays)
}
