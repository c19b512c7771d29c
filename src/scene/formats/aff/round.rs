//! Spheres and cones within transforms. The scene has them in the world's own space only, so those that move, or are
//! scaled unevenly, become meshes.

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use glam::{Affine3A, DVec3, Mat3, Vec3};

use super::super::super::{Corners, Materials, Mesh, Primitive, Scene, Shape};
use super::statement::Round;
use crate::geometry::Sphere;
use crate::geometry::hit::Cone;

/// How many corners a circle gets.
const AROUND: u32 = 48;
/// How many rings lie between a sphere's poles.
const RINGS: u32 = 24;
/// By what share the axes of what counts as evenly scaled may differ: rounding alone makes 1e-6.
const EVEN: f32 = 1e-5;

/// The spheres and cones of a scene, and the nodes they stand in.
#[derive(Default)]
pub(super) struct Rounds {
    all: Vec<(u32, Round, Option<u32>)>,
}

impl Rounds {
    pub(super) fn add(&mut self, node: u32, round: Round, material: Option<u32>) {
        self.all.push((node, round, material));
    }

    /// Puts them into the scene, once it is known what moves, with a warning of each kind that is not as it was said.
    pub(super) fn place(self, scene: &mut Scene) {
        let world = scene.world_transforms();
        let mut moves = vec![false; scene.nodes.len()];
        scene.animation.followers.iter().for_each(|(node, _)| moves[*node as usize] = true);
        // Parents come before their children here.
        for node in 0..moves.len() {
            moves[node] |= scene.nodes[node].parent.is_some_and(|parent| moves[parent as usize]);
        }
        let (mut meshes, mut triangles, mut inside) = (0, 0, 0);
        let mut spheres = HashMap::new();
        for (node, round, material) in self.all {
            let round = round.outside(&mut inside);
            let place = &world[node as usize];
            let even = scale(place.matrix3.into()).filter(|_| !moves[node as usize]);
            if let Some(scale) = even {
                scene.primitives.push(Primitive { shape: round.placed(place, scale), material });
                continue;
            }
            let (mesh, transform) = match round {
                // One mesh for all.
                Round::Sphere { centre, radius } => {
                    let mesh = *spheres
                        .entry(material)
                        .or_insert_with(|| scene.add_mesh(of_material(sphere(), material)));
                    let transform = Affine3A::from_scale_rotation_translation(
                        Vec3::splat(radius),
                        glam::Quat::IDENTITY,
                        centre,
                    );
                    (mesh, transform)
                }
                Round::Cone { base, base_radius, tip, tip_radius } => {
                    let mesh = side(Cone { base, base_radius, tip, tip_radius });
                    (scene.add_mesh(of_material(mesh, material)), Affine3A::IDENTITY)
                }
            };
            meshes += 1;
            triangles += scene.meshes[mesh as usize].triangles.len();
            let name = scene.meshes[mesh as usize].name.clone();
            scene.add_node(Some(node), name, transform, Some(mesh));
        }
        if inside > 0 {
            scene.warnings.push(format!(
                "{inside} spheres and cones are to be seen from within only: they are seen from both sides"
            ));
        }
        if meshes > 0 {
            scene.warnings.push(format!(
                "{meshes} spheres and cones move or are scaled unevenly: they are {triangles} triangles"
            ));
        }
    }
}

impl Round {
    /// The same with radii that are not below 0; counts it if they were.
    fn outside(self, inside: &mut usize) -> Self {
        let is_inside = match self {
            Self::Sphere { radius, .. } => radius < 0.0,
            Self::Cone { base_radius, tip_radius, .. } => base_radius.min(tip_radius) < 0.0,
        };
        *inside += usize::from(is_inside);
        match self {
            Self::Sphere { centre, radius } => Self::Sphere { centre, radius: radius.abs() },
            Self::Cone { base, base_radius, tip, tip_radius } => {
                Self::Cone { base, base_radius: base_radius.abs(), tip, tip_radius: tip_radius.abs() }
            }
        }
    }

    fn placed(self, place: &Affine3A, scale: f32) -> Shape {
        match self {
            Self::Sphere { centre, radius } => {
                Shape::Sphere(Sphere { centre: place.transform_point3(centre), radius: radius * scale })
            }
            Self::Cone { base, base_radius, tip, tip_radius } => Shape::Cone(Cone {
                base: place.transform_point3(base),
                base_radius: base_radius * scale,
                tip: place.transform_point3(tip),
                tip_radius: tip_radius * scale,
            }),
        }
    }
}

/// By how much a transform makes everything larger; none if it does not so in all directions alike.
fn scale(matrix: Mat3) -> Option<f32> {
    if matrix == Mat3::IDENTITY {
        return Some(1.0);
    }
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.as_dvec3());
    let squares = [x.length_squared(), y.length_squared(), z.length_squared()];
    let mean = squares.iter().sum::<f64>() / 3.0;
    let least = f64::from(EVEN) * mean;
    let is_even = squares.iter().all(|square| (square - mean).abs() <= least);
    let is_square = [x.dot(y), y.dot(z), z.dot(x)].iter().all(|product| product.abs() <= least);
    (is_even && is_square).then(|| mean.sqrt() as f32)
}

fn of_material(mut mesh: Mesh, material: Option<u32>) -> Mesh {
    mesh.shading.materials = material.map_or(Materials::Unknown, Materials::One);
    mesh
}

fn direction(step: u32) -> [f64; 2] {
    let (sine, cosine) = (TAU * f64::from(step) / f64::from(AROUND)).sin_cos();
    [cosine, sine]
}

/// A sphere of radius 1 about the origin.
fn sphere() -> Mesh {
    let mut positions = vec![Vec3::Z];
    for ring in 1..RINGS {
        let (radius, height) = (PI * f64::from(ring) / f64::from(RINGS)).sin_cos();
        positions.extend((0..AROUND).map(|step| {
            let [x, y] = direction(step);
            DVec3::new(x * radius, y * radius, height).as_vec3()
        }));
    }
    positions.push(-Vec3::Z);
    let at = |ring: u32, step: u32| 1 + (ring - 1) * AROUND + step % AROUND;
    let last = positions.len() as u32 - 1;
    let mut triangles = Vec::new();
    for step in 0..AROUND {
        triangles.push([0, at(1, step), at(1, step + 1)]);
        for ring in 1..RINGS - 1 {
            let (a, b) = (at(ring, step), at(ring, step + 1));
            let (c, d) = (at(ring + 1, step), at(ring + 1, step + 1));
            triangles.extend([[a, c, d], [a, d, b]]);
        }
        triangles.push([at(RINGS - 1, step), last, at(RINGS - 1, step + 1)]);
    }
    let normals = Corners::of_vertices(positions.clone());
    let mut mesh = Mesh::new("sphere", positions, triangles);
    mesh.shading.normals = normals;
    mesh
}

/// The side of a cone, anticlockwise seen from outside.
fn side(cone: Cone) -> Mesh {
    let (base, tip) = (cone.base.as_dvec3(), cone.tip.as_dvec3());
    let [base_radius, tip_radius] = [cone.base_radius, cone.tip_radius].map(f64::from);
    let axis = tip - base;
    let along = axis.normalize_or(DVec3::Z);
    let (right, up) = along.any_orthonormal_pair();
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for step in 0..AROUND {
        let [x, y] = direction(step);
        let out = right * x + up * y;
        let normal = (out * axis.length() + along * (base_radius - tip_radius)).normalize_or(out).as_vec3();
        positions.extend([(base + out * base_radius).as_vec3(), (tip + out * tip_radius).as_vec3()]);
        normals.extend([normal; 2]);
    }
    let mut triangles = Vec::new();
    for step in 0..AROUND {
        let (a, b) = (2 * step, 2 * ((step + 1) % AROUND));
        // No triangle without area where the cone ends in a point.
        if base_radius > 0.0 {
            triangles.push([a, b, b + 1]);
        }
        if tip_radius > 0.0 {
            triangles.push([a, b + 1, a + 1]);
        }
    }
    let mut mesh = Mesh::new("cone", positions, triangles);
    mesh.shading.normals = Corners::of_vertices(normals);
    mesh
}

#[cfg(test)]
#[path = "round_tests.rs"]
mod tests;
