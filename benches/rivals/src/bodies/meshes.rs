//! The bodies, and where two of them lie close to each other.

use apportion::geometry::{Aabb, Obb, Overlap, Rigid};
use apportion::job::collide::{Query, contacts};
use apportion::scene::{self, Scene};
use apportion::structure::VolumeTree;
use apportion::structure::volume_tree::in_world;
use glam_ours::{DVec3, Vec3};
use std::path::Path;

/// The longest side of every body, in metres. Parry's test of two triangles depends on how large they are: it tells
/// the Stanford bunny as it comes, 0.16 m, to touch what is 0.16 mm away, and a shell of 1 m what is 1 cm away. Of
/// bodies as large as this it tells what we do, but for a few pairs of those that do touch.
const SIDE: f32 = 100.0;

/// A body of triangles; corners in metres.
pub(super) struct Mesh {
    pub(super) name: String,
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Mesh {
    fn new(scene: &Scene) -> Self {
        let (positions, triangles) = in_world(scene).expect("fewer corners than there are numbers");
        Self { name: scene.name.clone(), positions, triangles }
    }

    fn scaled(mut self, by: f32) -> Self {
        self.positions.iter_mut().for_each(|position| *position *= by);
        self
    }

    /// How many triangles it has.
    pub(super) fn len(&self) -> usize {
        self.triangles.len()
    }

    /// A tree over it.
    pub(super) fn tree<V: Overlap>(&self, leaf: usize) -> VolumeTree<V> {
        VolumeTree::over_triangles(&self.positions, &self.triangles, leaf).expect("corners are numbers")
    }
}

/// What a file places in the world, made as large as [`SIDE`].
pub(super) fn of_file(file: &Path) -> Mesh {
    let mesh = Mesh::new(&scene::load(file).unwrap_or_else(|error| panic!("{error}")));
    let by = SIDE / longest_side(&mesh) as f32;
    mesh.scaled(by)
}

/// A shell of about 1 m, made as large as [`SIDE`].
pub(super) fn shell(name: &str) -> Mesh {
    Mesh::new(&scene::by_name(name).expect("a generator of that name")).scaled(SIDE / 2.0)
}

/// The shell with bumps of up to 15 %: as many triangles as the bunny has, no plane of symmetry, and places where two
/// of them come near.
pub(super) fn bumpy_ball() -> Mesh {
    let mut ball = shell("shell");
    for position in &mut ball.positions {
        let [x, y, z] = (*position / (SIDE / 2.0)).to_array();
        *position *= 1.0 + 0.15 * (5.0 * x + 1.0).sin() * (4.0 * y + 2.0).sin() * (6.0 * z + 0.5).cos();
    }
    ball.name = "the bumpy ball".to_owned();
    ball
}

/// In metres.
pub(super) fn longest_side(mesh: &Mesh) -> f64 {
    f64::from(Aabb::of_points(mesh.positions.iter().copied()).size().max_element())
}

/// How far along x a body is to be moved so that it has, but for a millionth of its side, this distance from where it
/// was; in metres.
pub(super) fn beside(mesh: &Mesh, gap: f64) -> f64 {
    let tree = mesh.tree::<Obb>(super::LEAF);
    let query = Query { first: true, reach: gap };
    let nearer = |x: f64| !contacts(&tree, &tree, &Rigid::shift(DVec3::X * x), query).pairs.is_empty();
    let side = longest_side(mesh);
    let (mut near, mut far) = (0.0, side + 2.0 * gap);
    assert!(nearer(near) && !nearer(far), "a body touches itself where it lies, and not a side further on");
    while far - near > 1e-6 * side {
        let middle = (near + far) / 2.0;
        if nearer(middle) { near = middle } else { far = middle }
    }
    far
}
