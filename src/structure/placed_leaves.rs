//! The leaves of split meshes as they are placed in a scene: what is drawn or left out as a whole.

use std::num::NonZeroUsize;

use glam::{Affine3A, Vec3};
use rayon::prelude::*;

use super::{Object, Split, SplitError};
use crate::geometry::Aabb;
use crate::scene::Scene;

/// Bound on the rounding of a placed coordinate, relative to the sum of its terms: three products, three
/// sums and the conversion of each operand, half an ulp (2^-24) each.
const ROUNDING: f32 = 8.0 / 16_777_216.0;

/// A leaf of a mesh, placed in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlacedLeaf {
    /// The scene node that places the mesh.
    pub node: u32,
    /// The mesh.
    pub mesh: u32,
    /// The leaf, by index into the mesh's [`Split::leaves`].
    pub leaf: u32,
}

/// A scene whose meshes are split. A mesh is split once, however often it is placed; only boxes are made
/// for each copy, so that memory grows with copies times leaves and not with triangles (BU-F08).
#[derive(Clone, Debug, Default)]
pub struct PlacedLeaves {
    /// Each mesh of the scene, split; empty for a mesh that is nowhere placed.
    pub splits: Vec<Split>,
    /// The leaves, node after node.
    pub leaves: Vec<PlacedLeaf>,
    /// The box of each and its triangles, in the same order: what [`super::midpoint_tree`] is built over.
    pub objects: Vec<Object>,
}

impl PlacedLeaves {
    /// Splits the meshes of a valid scene (see [`Scene::validate`]) into leaves of at most `most` triangles
    /// and places them.
    ///
    /// # Errors
    /// [`SplitError`], see [`Split::new`].
    pub fn new(scene: &Scene, most: NonZeroUsize) -> Result<Self, SplitError> {
        let mut is_placed = vec![false; scene.meshes.len()];
        for mesh in scene.nodes.iter().filter_map(|node| node.mesh) {
            is_placed[mesh as usize] = true;
        }
        let split = |(mesh, is_placed): (_, bool)| match is_placed {
            true => Split::new(mesh, most),
            false => Ok(Split::default()),
        };
        let splits: Vec<Split> =
            scene.meshes.par_iter().zip(is_placed).map(split).collect::<Result<_, _>>()?;
        let (mut leaves, mut objects) = (Vec::new(), Vec::new());
        for ((node, index), world) in scene.nodes.iter().zip(0..).zip(scene.world_transforms()) {
            let Some(mesh) = node.mesh else { continue };
            for (part, leaf) in splits[mesh as usize].leaves.iter().zip(0..) {
                leaves.push(PlacedLeaf { node: index, mesh, leaf });
                let triangles = part.triangles.end - part.triangles.start;
                objects.push(Object { bounds: placed(&part.bounds, &world), triangles });
            }
        }
        Ok(Self { splits, leaves, objects })
    }
}

/// A box around everything in `bounds` after an exact transform: wider than [`Aabb::transformed`] by what
/// that may have rounded away, so that whoever culls by it culls nothing visible.
fn placed(bounds: &Aabb, world: &Affine3A) -> Aabb {
    let reach = bounds.min.abs().max(bounds.max.abs());
    let [x, y, z] = [world.matrix3.x_axis, world.matrix3.y_axis, world.matrix3.z_axis].map(Vec3::from);
    let terms =
        x.abs() * reach.x + y.abs() * reach.y + z.abs() * reach.z + Vec3::from(world.translation).abs();
    let slack = terms * ROUNDING + Vec3::splat(f32::MIN_POSITIVE);
    let rounded = bounds.transformed(world);
    Aabb { min: rounded.min - slack, max: rounded.max + slack }
}
