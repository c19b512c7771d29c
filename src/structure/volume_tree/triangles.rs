//! Trees over the triangles of a mesh, and over all that a scene places in the world.

use super::topology::{self, Item};
use super::{Items, VolumeTree, VolumeTreeError};
use crate::geometry::{Aabb, Overlap};
use crate::scene::Scene;
use glam::{DVec3, Vec3};

/// Triangles, and no more, that can be numbered in a pair of boxes, with their blocks filled up.
const MOST: usize = (u32::MAX >> 5) as usize;

/// No coordinate whose square or cube f32 cannot hold.
const FARTHEST: f32 = 1e18;

impl<V: Overlap> VolumeTree<V> {
    /// A tree over triangles with at most `leaf` of them in a leaf; corners in metres. Empty if there are none.
    ///
    /// # Errors
    /// [`VolumeTreeError`]: a corner is not there or is not a number, too many triangles, leaves of none.
    pub fn over_triangles(
        positions: &[Vec3],
        triangles: &[[u32; 3]],
        leaf: usize,
    ) -> Result<Self, VolumeTreeError> {
        if triangles.len() > MOST {
            return Err(VolumeTreeError::TooMany(triangles.len()));
        }
        if !(1..=64).contains(&leaf) {
            return Err(VolumeTreeError::Leaf(leaf));
        }
        let places = places(positions, triangles)?;
        let bounds = Aabb::of_points(places.iter().flatten().copied());
        let origin = if bounds.is_empty() { DVec3::ZERO } else { bounds.centre().as_dvec3() };
        let middle = |corners: &[Vec3; 3]| {
            let [a, b, c] = corners.map(|corner| (corner.as_dvec3() - origin).as_vec3());
            (a.min(b).min(c) + a.max(b).max(c)) * 0.5
        };
        let mut items: Vec<Item> =
            places.iter().zip(0..).map(|(corners, index)| Item { middle: middle(corners), index }).collect();
        let topology = topology::build(&mut items, leaf);
        let order: Vec<u32> = items.iter().map(|item| item.index).collect();
        let content = Items::Triangles {
            corners: order.iter().map(|&i| triangles[i as usize]).collect(),
            places: order.iter().map(|&i| places[i as usize]).collect(),
        };
        let (links, items) = (topology.links, topology.items);
        let mut tree = Self { volumes: Vec::new(), links, blocks: Vec::new(), items, order, content, origin };
        tree.fit();
        Ok(tree)
    }

    /// A tree over all triangles of a scene, in the world, numbered in the order of its nodes, each node's own in
    /// their order.
    ///
    /// # Errors
    /// As [`VolumeTree::over_triangles`].
    pub fn over_scene(scene: &Scene, leaf: usize) -> Result<Self, VolumeTreeError> {
        let (positions, triangles) = in_world(scene)?;
        Self::over_triangles(&positions, &triangles, leaf)
    }

    /// Fits all volumes anew to triangles whose corners have moved; the tree keeps its shape.
    ///
    /// # Errors
    /// [`VolumeTreeError`]; the tree is then as it was.
    pub fn refit(&mut self, positions: &[Vec3]) -> Result<(), VolumeTreeError> {
        let Items::Triangles { corners, places: old } = &mut self.content else {
            return Err(VolumeTreeError::Nodes);
        };
        let expected = corners.iter().flatten().max().map_or(0, |most| *most as usize + 1);
        if positions.len() < expected {
            return Err(VolumeTreeError::Points { got: positions.len(), expected });
        }
        let new = places(positions, corners).map_err(|error| match error {
            // By the number it was given under.
            VolumeTreeError::Odd(at) => VolumeTreeError::Odd(self.order[at] as usize),
            other => other,
        })?;
        *old = new;
        self.fit();
        Ok(())
    }
}

/// The triangles of a scene in the world: corners, in metres, and three of them a triangle.
///
/// # Errors
/// [`VolumeTreeError::TooManyCorners`], before any of them is placed.
pub fn in_world(scene: &Scene) -> Result<(Vec<Vec3>, Vec<[u32; 3]>), VolumeTreeError> {
    let placed = || {
        let meshes = scene.nodes.iter().map(|node| node.mesh.map(|mesh| &scene.meshes[mesh as usize]));
        meshes.enumerate().filter_map(|(node, mesh)| Some((node, mesh?)))
    };
    let count = placed().map(|(_, mesh)| mesh.positions.len()).fold(0, usize::saturating_add);
    if u32::try_from(count).is_err() {
        return Err(VolumeTreeError::TooManyCorners(count));
    }
    let (mut positions, mut triangles) = (Vec::with_capacity(count), Vec::new());
    let world = scene.world_transforms();
    for (node, mesh) in placed() {
        let first = positions.len() as u32;
        positions.extend(mesh.positions.iter().map(|position| world[node].transform_point3(*position)));
        triangles.extend(mesh.triangles.iter().map(|corners| corners.map(|corner| corner + first)));
    }
    Ok((positions, triangles))
}

/// The corners of each triangle.
fn places(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Vec<[Vec3; 3]>, VolumeTreeError> {
    // Not collected from results, which would not know how many there are to be.
    let mut all = Vec::with_capacity(triangles.len());
    for (triangle, numbers) in triangles.iter().enumerate() {
        let mut places = [Vec3::ZERO; 3];
        for (place, &corner) in places.iter_mut().zip(numbers) {
            let corners = positions.len();
            let missing = VolumeTreeError::NoCorner { triangle, corner, corners };
            *place = *positions.get(corner as usize).ok_or(missing)?;
        }
        if !places.iter().all(|place| place.abs().cmplt(Vec3::splat(FARTHEST)).all()) {
            return Err(VolumeTreeError::Odd(triangle));
        }
        all.push(places);
    }
    Ok(all)
}
