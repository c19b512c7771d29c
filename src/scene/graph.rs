//! The scene graph: a forest of transforms with meshes on it.

use glam::{Affine3A, Vec3};

use super::{Animation, Flock, Material, PointLight, Primitive, Shading, Texture, View};
use crate::geometry::Aabb;

/// A scene: a forest of nodes that place meshes in the world.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What it is called: the name of its generator or of its file.
    pub name: String,
    /// All nodes.
    pub nodes: Vec<Node>,
    /// All meshes; several nodes may share one.
    pub meshes: Vec<Mesh>,
    /// The nodes without a parent, by index.
    pub roots: Vec<u32>,
    /// Spheres and cones, which hang on no node: only rays see them.
    pub primitives: Vec<Primitive>,
    /// Spheres and cones that hang on nodes.
    pub flocks: Vec<Flock>,
    /// What surfaces are made of.
    pub materials: Vec<Material>,
    /// Pictures laid on surfaces.
    pub textures: Vec<Texture>,
    /// Lights.
    pub lights: Vec<PointLight>,
    /// Where it wants to be looked at from.
    pub view: Option<View>,
    /// Seen where nothing is, linear; absent where nobody said.
    pub background: Option<Vec3>,
    /// Light from everywhere, linear; absent where nobody said.
    pub ambient: Option<Vec3>,
    /// What moves in it, and when.
    pub animation: Animation,
    /// What a file asked for and could not be had, such as the picture of a texture: the scene is whole without.
    pub warnings: Vec<String>,
}

/// A place in the scene graph.
#[derive(Clone, Debug)]
pub struct Node {
    /// What it is called; need not be unique.
    pub name: String,
    /// The node above, by index.
    pub parent: Option<u32>,
    /// The nodes below, by index.
    pub children: Vec<u32>,
    /// From this node's space to its parent's; lengths in metres.
    pub transform: Affine3A,
    /// The mesh placed here, by index. A node may have a mesh and children both.
    pub mesh: Option<u32>,
}

/// A triangle mesh in the space of the nodes that place it.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// What it is called; need not be unique.
    pub name: String,
    /// Vertices, in metres.
    pub positions: Vec<Vec3>,
    /// Triangles by vertex index; anticlockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The smallest box around all vertices.
    pub bounds: Aabb,
    /// What it has beside its shape, to be seen with.
    pub shading: Shading,
}

impl Mesh {
    /// A mesh with its bounds worked out, of no known material.
    pub fn new(name: impl Into<String>, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        let bounds = Aabb::of_points(positions.iter().copied());
        Self { name: name.into(), positions, triangles, bounds, shading: Shading::default() }
    }

    /// The smallest box around its vertices after a transform.
    fn bounds_in(&self, world: &Affine3A) -> Aabb {
        let columns = [world.matrix3.x_axis, world.matrix3.y_axis, world.matrix3.z_axis];
        // Rounding keeps the order of coordinates that depend on one other alone, so the corners tell of all vertices: a
        // million copies need not be gone through vertex by vertex.
        let lone = |axis: usize| columns.iter().filter(|column| column[axis] != 0.0).count() <= 1;
        if (0..3).all(lone) && !self.bounds.is_empty() {
            let corners = [self.bounds.min, self.bounds.max];
            return Aabb::of_points(corners.map(|corner| world.transform_point3(corner)));
        }
        Aabb::of_points(self.positions.iter().map(|position| world.transform_point3(*position)))
    }
}

impl Scene {
    /// An empty scene.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Adds a node under `parent`, or as a root, and returns its index.
    ///
    /// # Panics
    /// If `parent` is not a node of this scene.
    pub fn add_node(
        &mut self,
        parent: Option<u32>,
        name: impl Into<String>,
        transform: Affine3A,
        mesh: Option<u32>,
    ) -> u32 {
        let index = self.nodes.len() as u32;
        match parent {
            Some(parent) => self.nodes[parent as usize].children.push(index),
            None => self.roots.push(index),
        }
        self.nodes.push(Node { name: name.into(), parent, children: Vec::new(), transform, mesh });
        index
    }

    /// Adds a mesh and returns its index.
    pub fn add_mesh(&mut self, mesh: Mesh) -> u32 {
        self.meshes.push(mesh);
        self.meshes.len() as u32 - 1
    }

    /// Adds a material and returns its index.
    pub fn add_material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }

    /// All nodes, each after its parent, children in order: the order of a depth-first walk. Works for
    /// any depth. The scene must be valid (see [`Scene::validate`]).
    pub fn depth_first(&self) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.nodes.len());
        let mut stack: Vec<u32> = self.roots.iter().rev().copied().collect();
        while let Some(node) = stack.pop() {
            order.push(node);
            stack.extend(self.nodes[node as usize].children.iter().rev());
        }
        order
    }

    /// From each node's space to the world's, by node index; lengths in metres. The scene must be valid.
    pub fn world_transforms(&self) -> Vec<Affine3A> {
        let mut world = vec![Affine3A::IDENTITY; self.nodes.len()];
        for index in self.depth_first() {
            let node = &self.nodes[index as usize];
            let above = node.parent.map_or(Affine3A::IDENTITY, |parent| world[parent as usize]);
            world[index as usize] = above * node.transform;
        }
        world
    }

    /// The box around each node's own mesh in the world, by node index; empty where there is no mesh.
    /// Taken over the placed vertices, so it is as small as an axis-aligned box can be.
    pub fn world_bounds(&self) -> Vec<Aabb> {
        let place = |(node, world): (&Node, Affine3A)| match node.mesh {
            Some(mesh) => self.meshes[mesh as usize].bounds_in(&world),
            None => Aabb::EMPTY,
        };
        self.nodes.iter().zip(self.world_transforms()).map(place).collect()
    }

    /// The box around everything in the world, in metres; empty for an empty scene.
    pub fn bounds(&self) -> Aabb {
        let primitives = self.primitives.iter().map(|primitive| primitive.shape.bounds());
        let all = self.world_bounds().into_iter().chain(primitives).fold(Aabb::EMPTY, Aabb::union);
        self.flock_bounds().into_iter().fold(all, |all, (_, bounds)| all.union(bounds))
    }

    /// Nodes that place flocks, flock by flock, and the box around what each places in the world, in metres: that around
    /// the flock's own box, so it may be larger than need be. The scene must be valid.
    pub fn flock_bounds(&self) -> Vec<(u32, Aabb)> {
        if self.flocks.is_empty() {
            return Vec::new();
        }
        let world = self.world_transforms();
        let of = |flock: &Flock| {
            let own = flock.bounds();
            flock
                .nodes
                .iter()
                .map(|node| (*node, own.transformed(&world[*node as usize])))
                .collect::<Vec<_>>()
        };
        self.flocks.iter().flat_map(of).collect()
    }

    /// How many spheres and cones there are in the world: those of a flock count for each node that places it.
    pub fn primitives_placed(&self) -> usize {
        let placed = self.flocks.iter().map(|flock| flock.primitives.len() * flock.nodes.len());
        self.primitives.len() + placed.sum::<usize>()
    }

    /// How many nodes place a mesh, and how many triangles that makes, shared meshes counted each time.
    pub fn instances(&self) -> (usize, usize) {
        let placed = self.nodes.iter().filter_map(|node| node.mesh);
        placed.fold((0, 0), |(count, triangles), mesh| {
            (count + 1, triangles + self.meshes[mesh as usize].triangles.len())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SplitMix64;
    use glam::Mat3A;

    #[test]
    fn boxes_of_placed_meshes_are_those_of_their_vertices() {
        let mut random = SplitMix64::new(1);
        let mut draw = || random.between(-3.0, 3.0) as f32;
        let positions: Vec<Vec3> = (0..200).map(|_| Vec3::new(draw(), draw(), draw())).collect();
        let mesh = Mesh::new("m", positions, Vec::new());
        let turn = Mat3A::from_rotation_z(0.3);
        let along = Mat3A::from_cols(-glam::Vec3A::Z * 0.3, glam::Vec3A::ZERO, glam::Vec3A::X * 7.1);
        for matrix3 in
            [Mat3A::IDENTITY, along, turn, Mat3A::ZERO, Mat3A::from_diagonal(Vec3::new(-0.1, 3.0, 1e-9))]
        {
            let world = Affine3A { matrix3, translation: glam::Vec3A::new(0.7, -1e5, 3e-3) };
            let expected = Aabb::of_points(mesh.positions.iter().map(|at| world.transform_point3(*at)));
            assert_eq!(mesh.bounds_in(&world), expected);
        }
        assert!(Mesh::new("none", Vec::new(), Vec::new()).bounds_in(&Affine3A::IDENTITY).is_empty());
    }
}
