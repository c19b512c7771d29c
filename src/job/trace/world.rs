//! What rays can meet in a scene, by number.

use glam::{Mat3, Vec3};

use crate::geometry::Aabb;
use crate::scene::{PointLight, Primitive, Scene};

/// The shapes of a scene in world space. Item `i` is triangle `i`, or, after the last triangle, primitive
/// `i - triangles.len()`.
#[derive(Clone, Debug, Default)]
pub struct Items {
    /// Triangles, in metres.
    pub triangles: Vec<[Vec3; 3]>,
    /// Spheres and cones.
    pub primitives: Vec<Primitive>,
}

impl Items {
    /// The boxes around the triangles; of one with a corner that is NaN, a box that holds no point.
    pub fn triangle_boxes(&self) -> Vec<Aabb> {
        self.triangles.iter().map(|corners| Aabb::of_points(corners.iter().copied())).collect()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.triangles.len() + self.primitives.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A scene with what is needed to follow rays through it.
pub struct World {
    pub(super) scene: Scene,
    items: Items,
    /// One for each node that places a mesh, in the order of their triangles.
    runs: Vec<Run>,
}

/// The triangles of one node's mesh.
struct Run {
    /// Number of the first of them among the items.
    first: usize,
    mesh: u32,
    /// Takes normals to the world, but for their length.
    normals: Mat3,
}

/// A triangle as the mesh it belongs to knows it.
pub(super) struct Placed<'a> {
    pub(super) mesh: &'a crate::scene::Mesh,
    /// By number in the mesh.
    pub(super) triangle: usize,
    /// Takes normals to the world, but for their length; a mirrored mesh keeps its normals on their side.
    pub(super) normals: Mat3,
}

impl World {
    /// Lists the items of a valid scene, in the order of its nodes.
    ///
    /// # Panics
    /// If there are 2^32 of them or more.
    pub fn new(scene: Scene) -> Self {
        let (mut triangles, mut runs) = (Vec::with_capacity(scene.instances().1), Vec::new());
        for (node, world) in scene.nodes.iter().zip(scene.world_transforms()) {
            let Some(index) = node.mesh else { continue };
            let mesh = &scene.meshes[index as usize];
            runs.push(Run { first: triangles.len(), mesh: index, normals: cofactors(world.matrix3.into()) });
            let place = |vertex: u32| world.transform_point3(mesh.positions[vertex as usize]);
            triangles.extend(mesh.triangles.iter().map(|corners| corners.map(place)));
        }
        let items = Items { triangles, primitives: scene.primitives.clone() };
        assert!(u32::try_from(items.len()).is_ok(), "items are numbered in 32 bits");
        Self { scene, items, runs }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Adds a light.
    pub fn add_light(&mut self, light: PointLight) {
        self.scene.lights.push(light);
    }

    /// What rays can meet.
    pub fn items(&self) -> &Items {
        &self.items
    }

    /// A triangle, by item number.
    pub(super) fn placed(&self, item: usize) -> Placed<'_> {
        let run = &self.runs[self.runs.partition_point(|run| run.first <= item) - 1];
        let mesh = &self.scene.meshes[run.mesh as usize];
        Placed { mesh, triangle: item - run.first, normals: run.normals }
    }
}

/// The inverse transpose, times the determinant's size: it takes normals along with their surface, and never divides.
fn cofactors(matrix: Mat3) -> Mat3 {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let turned = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if x.dot(y.cross(z)) < 0.0 { -turned } else { turned }
}
