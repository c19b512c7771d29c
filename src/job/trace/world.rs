//! What rays can meet in a scene, by number.

use std::sync::OnceLock;

use glam::{Affine3A, Mat3, Vec3};

use crate::geometry::Aabb;
use crate::scene::{Mesh, PointLight, Pose, Primitive, Scene};
use crate::structure::bvh::Placement;

/// The shapes of a scene in world space, each triangle listed. Item `i` is triangle `i`; then come the primitives, and
/// then those of the flocks, place by place.
#[derive(Clone, Debug, Default)]
pub struct Items {
    /// Triangles, in metres.
    pub triangles: Vec<[Vec3; 3]>,
    /// Spheres and cones.
    pub primitives: Vec<Primitive>,
    /// Spheres and cones of flocks, each in the flock's own space, by number of the flock.
    pub flocks: Vec<Vec<Primitive>>,
    /// The places of flocks, by number of the flock, in the order of their items.
    pub places: Vec<(u32, Affine3A)>,
}

impl Items {
    /// The boxes around the triangles; of one with a corner that is NaN, a box that holds no point.
    pub fn triangle_boxes(&self) -> Vec<Aabb> {
        self.triangles.iter().map(|corners| Aabb::of_points(corners.iter().copied())).collect()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        let placed = self.places.iter().map(|(flock, _)| self.flocks[*flock as usize].len());
        self.triangles.len() + self.primitives.len() + placed.sum::<usize>()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A scene with what is needed to follow rays through it.
///
/// Triangles are numbered in the order of the nodes that place them, primitives after them, then flocks in the order of
/// theirs. Nothing is listed item by item until somebody asks for [`World::items`]: what stands in a million places
/// takes the memory of one and of its places.
pub struct World {
    pub(super) scene: Scene,
    items: OnceLock<Items>,
    /// One for each node that places a mesh, in the order of their triangles.
    runs: Vec<Placement>,
    /// What takes normals to the world, of each run ([`cofactors`]).
    normals: Vec<Mat3>,
    /// The first triangle of each run: what is searched, close together.
    firsts: Vec<u32>,
    /// Of which run the first of so many triangles is, of the next as many, and so on; and the last run.
    marks: Vec<u32>,
    /// How many those are, as a power of two.
    apart: u32,
    /// How many triangles there are in all.
    triangles: usize,
    flocks: Vec<FlockRun>,
    /// As they are now; the scene has them as they stand when nothing moves.
    lights: Vec<PointLight>,
}

/// The items of one node's flock.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlockRun {
    /// Number of the first of them among the items.
    pub(super) first: u32,
    pub(super) flock: u32,
    pub(super) transform: Affine3A,
}

/// A triangle as the mesh it belongs to knows it.
pub(super) struct Placed<'a> {
    pub(super) mesh: &'a Mesh,
    /// By number in the mesh.
    pub(super) triangle: usize,
    /// In the world.
    pub(super) corners: [Vec3; 3],
    /// Takes normals to the world, but for their length; a mirrored mesh keeps its normals on their side.
    pub(super) normals: &'a Mat3,
}

impl World {
    /// Numbers the items of a valid scene.
    ///
    /// # Panics
    /// If there are 2^32 of them or more; [`World::count`] tells beforehand.
    pub fn new(scene: Scene) -> Self {
        let lights = scene.lights.clone();
        let mut world = Self {
            scene,
            items: OnceLock::new(),
            runs: Vec::new(),
            normals: Vec::new(),
            firsts: Vec::new(),
            marks: Vec::new(),
            apart: 0,
            triangles: 0,
            flocks: Vec::new(),
            lights,
        };
        let transforms = world.scene.world_transforms();
        world.number(&transforms, |_| true);
        world
    }

    /// How many items a scene has; a world holds less than 2^32.
    pub fn count(scene: &Scene) -> usize {
        scene.instances().1 + scene.primitives_placed()
    }

    /// Follows what moves: takes over a pose of its own scene. What is not seen is left out, so items are numbered anew.
    ///
    /// # Panics
    /// If it is a pose of another scene.
    pub fn follow(&mut self, pose: &Pose) {
        for bent in &pose.bent {
            let mesh = &mut self.scene.meshes[bent.mesh as usize];
            mesh.positions.clone_from(&bent.positions);
            mesh.shading.normals.values.clone_from(&bent.normals);
            mesh.bounds = bent.bounds;
        }
        self.lights.clone_from(&pose.lights);
        self.number(&pose.world, |node| pose.visible[node as usize]);
    }

    fn number(&mut self, transforms: &[Affine3A], is_seen: impl Fn(u32) -> bool) {
        assert_eq!(transforms.len(), self.scene.nodes.len(), "a transform for each node");
        self.items = OnceLock::new();
        let mut next = 0;
        let mut take = |count: usize| {
            let first = next;
            next += count;
            assert!(u32::try_from(next).is_ok(), "items are numbered in 32 bits");
            first as u32
        };
        self.runs.clear();
        for (node, (of, transform)) in (0..).zip(self.scene.nodes.iter().zip(transforms)) {
            let Some(mesh) = of.mesh.filter(|_| is_seen(node)) else { continue };
            let first = take(self.scene.meshes[mesh as usize].triangles.len());
            self.runs.push(Placement { mesh, first, transform: *transform });
        }
        self.normals.clear();
        self.normals.extend(self.runs.iter().map(|run| cofactors(run.transform.matrix3.into())));
        self.firsts.clear();
        self.firsts.extend(self.runs.iter().map(|run| run.first));
        self.triangles = take(self.scene.primitives.len()) as usize;
        self.mark();
        self.flocks.clear();
        for (number, flock) in (0..).zip(&self.scene.flocks) {
            for node in flock.nodes.iter().filter(|node| is_seen(**node)) {
                let (first, transform) = (take(flock.primitives.len()), transforms[*node as usize]);
                self.flocks.push(FlockRun { first, flock: number, transform });
            }
        }
    }

    /// Marks where runs are, about as often as there are runs.
    fn mark(&mut self) {
        self.apart = (self.triangles / self.runs.len().max(1)).max(1).ilog2();
        self.marks.clear();
        let mut run = 0;
        for first in (0..self.triangles).step_by(1 << self.apart) {
            while self.firsts.get(run + 1).is_some_and(|next| *next as usize <= first) {
                run += 1;
            }
            self.marks.push(run as u32);
        }
        self.marks.push(self.runs.len().saturating_sub(1) as u32);
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Adds a light.
    pub fn add_light(&mut self, light: PointLight) {
        self.lights.push(light);
    }

    /// The lights there are now.
    pub fn lights(&self) -> &[PointLight] {
        &self.lights
    }

    /// What rays can meet, one by one: made when it is first asked for, and as large as it comes to.
    pub fn items(&self) -> &Items {
        self.items.get_or_init(|| {
            let mut triangles = Vec::with_capacity(self.triangles);
            for run in &self.runs {
                let mesh = &self.scene.meshes[run.mesh as usize];
                let place = |vertex: u32| run.transform.transform_point3(mesh.positions[vertex as usize]);
                triangles.extend(mesh.triangles.iter().map(|corners| corners.map(place)));
            }
            Items {
                triangles,
                primitives: self.scene.primitives.clone(),
                flocks: self.scene.flocks.iter().map(|flock| flock.primitives.clone()).collect(),
                places: self.flocks.iter().map(|run| (run.flock, run.transform)).collect(),
            }
        })
    }

    /// How many triangles there are; items of greater numbers are none.
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// The corners of a triangle, by item number, in metres; none of what is no triangle.
    pub fn corners(&self, item: u32) -> Option<[Vec3; 3]> {
        ((item as usize) < self.triangles).then(|| self.placed(item).corners)
    }

    /// Where each mesh stands.
    pub(super) fn placements(&self) -> &[Placement] {
        &self.runs
    }

    /// Where each flock stands.
    pub(super) fn flocks(&self) -> &[FlockRun] {
        &self.flocks
    }

    /// Which run a triangle is of, by item number.
    #[inline(always)]
    fn run_of(&self, item: u32) -> usize {
        let mark = (item >> self.apart) as usize;
        let [from, to] = [self.marks[mark], self.marks[mark + 1]].map(|run| run as usize);
        from + self.firsts[from + 1..=to].partition_point(|first| *first <= item)
    }

    /// A triangle in the world, by item number.
    #[inline(always)]
    pub(super) fn placed(&self, item: u32) -> Placed<'_> {
        let number = self.run_of(item);
        let run = &self.runs[number];
        let (mesh, triangle) = (&self.scene.meshes[run.mesh as usize], (item - run.first) as usize);
        let put = |vertex: u32| run.transform.transform_point3(mesh.positions[vertex as usize]);
        let corners = match self.items.get() {
            Some(items) => items.triangles[item as usize],
            None => mesh.triangles[triangle].map(put),
        };
        Placed { mesh, triangle, corners, normals: &self.normals[number] }
    }

    /// A sphere or cone, by item number; and from its space to the world's, where that is not the same.
    pub(super) fn primitive(&self, item: u32) -> (&Primitive, Option<&Affine3A>) {
        let alone = item as usize - self.triangles;
        if let Some(primitive) = self.scene.primitives.get(alone) {
            return (primitive, None);
        }
        let run = &self.flocks[self.flocks.partition_point(|run| run.first <= item) - 1];
        let flock = &self.scene.flocks[run.flock as usize];
        (&flock.primitives[(item - run.first) as usize], Some(&run.transform))
    }
}

/// The inverse transpose, times the determinant's size: it takes normals along with their surface, and never divides.
pub(super) fn cofactors(matrix: Mat3) -> Mat3 {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let turned = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if x.dot(y.cross(z)) < 0.0 { -turned } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_found_whatever_the_sizes_of_meshes() {
        for counts in
            [&[][..], &[0], &[1], &[0, 0, 3, 0], &[1; 70], &[5, 0, 300, 0, 0, 1, 2, 40, 0], &[1, 1000, 1]]
        {
            let mut scene = Scene::new("meshes");
            for (number, count) in counts.iter().enumerate() {
                let corner = |at: u32| Vec3::new(at as f32, number as f32, 0.0);
                let triangles: Vec<[u32; 3]> = (0..*count).map(|at| [at, at + 1, at + 2]).collect();
                let mesh = scene.add_mesh(Mesh::new("mesh", (0..count + 2).map(corner).collect(), triangles));
                scene.add_node(None, "node", Affine3A::from_translation(Vec3::Z), Some(mesh));
            }
            let world = World::new(scene);
            // Before they are listed: what is listed is told of then.
            let told: Vec<_> = (0..counts.iter().sum()).map(|item| world.corners(item)).collect();
            let listed = &world.items().triangles;
            assert_eq!(listed.len(), counts.iter().sum::<u32>() as usize);
            for (item, corners) in (0..).zip(listed) {
                assert_eq!(told[item as usize], Some(*corners), "{item} of {counts:?}");
                assert_eq!(world.corners(item), Some(*corners), "{item} of {counts:?}");
            }
            assert_eq!(world.corners(listed.len() as u32), None);
        }
    }
}
