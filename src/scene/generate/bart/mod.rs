//! Stand-ins for the three animated scenes of BART (Lext, Assarsson and Möller 2001), at the counts the paper gives
//! (P3-02 to P3-04), so that its benchmark runs without its files. What the paper says they keep; what it does not say,
//! every shape, place and key frame, is made up here. Metres, seconds; y is up.

use glam::{Affine3A, Mat3, Quat, Vec3};

use super::super::{Corners, Curve, Material, Materials, Mesh, Motion, Scene, SplineKey};
use super::{Aisles, Generator};

mod art;
mod car;
mod city;
mod kitchen;
mod museum;
mod pictures;
mod robots;
mod stresses;
mod walker;

pub(super) use kitchen::{EIGHT, FIVE, FOUR, KITCHEN, NINE, ONE, SEVEN, SIX, TEN, THREE, TWO};
pub(super) use museum::{K3, K4, K5, K6, K7, K8};
pub(super) use robots::ROBOTS;
pub(super) use stresses::{S1, S2, S3, S4, S5, S5_SMALL, S6, S7, S8};

/// A scene in the making.
struct Stage {
    scene: Scene,
}

impl Stage {
    fn new(name: &str) -> Self {
        Self { scene: Scene::new(name) }
    }

    fn material(&mut self, material: Material) -> u32 {
        self.scene.add_material(material)
    }

    fn mesh(&mut self, mut mesh: Mesh, material: u32) -> u32 {
        mesh.shading.materials = Materials::One(material);
        self.scene.add_mesh(mesh)
    }

    /// Places a mesh of its own.
    fn put(&mut self, mesh: Mesh, material: u32, place: Affine3A) -> u32 {
        let name = mesh.name.clone();
        let mesh = self.mesh(mesh, material);
        self.scene.add_node(None, name, place, Some(mesh))
    }

    fn set(&mut self, mesh: Mesh, material: u32, place: Vec3) {
        self.put(mesh, material, Affine3A::from_translation(place));
    }

    /// A node that follows a motion.
    fn moving(&mut self, parent: Option<u32>, motion: Motion, mesh: Option<u32>) -> u32 {
        let number = self.scene.animation.motions.len() as u32;
        let node = self.scene.add_node(parent, motion.name.clone(), Affine3A::IDENTITY, mesh);
        self.scene.animation.motions.push(motion);
        self.scene.animation.followers.push((node, number));
        node
    }

    /// Has the camera fly, and the scene seen as it is when the animation starts.
    fn fly(&mut self, motion: Motion, fov_y: f32) {
        let animation = &mut self.scene.animation;
        animation.camera = Some(animation.motions.len() as u32);
        animation.motions.push(motion);
        let view = self.scene.pose(self.scene.animation.start).view;
        self.scene.view = view.map(|view| super::super::View { fov_y, ..view });
    }
}

/// A spline without tension, continuity and bias.
fn spline<T>(keys: impl IntoIterator<Item = (f64, T)>) -> Option<Curve<T>> {
    let key = |(time, value)| SplineKey { time, value, tension: 0.0, continuity: 0.0, bias: 0.0 };
    Some(Curve::Spline(keys.into_iter().map(key).collect()))
}

/// A spline of rotations, each with the sign that is near the one before.
fn turning(keys: impl IntoIterator<Item = (f64, Quat)>) -> Option<Curve<Quat>> {
    let mut last = Quat::IDENTITY;
    spline(keys.into_iter().map(|(time, turn)| {
        last = if last.dot(turn) < 0.0 { -turn } else { turn };
        (time, last)
    }))
}

/// A camera that comes by places and looks at points.
fn flight(keys: &[(f64, Vec3, Vec3)]) -> Motion {
    Motion {
        name: "camera".into(),
        translation: spline(keys.iter().map(|(time, eye, _)| (*time, *eye))),
        rotation: turning(keys.iter().map(|(time, eye, look)| (*time, gaze(*eye, *look)))),
        ..Motion::default()
    }
}

/// Turns -z to a point, and +y as far up as can be.
fn gaze(eye: Vec3, look: Vec3) -> Quat {
    let back = (eye - look).normalize();
    let right = Vec3::Y.cross(back).normalize();
    Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back))
}

/// Turned about an axis, in radians; sines in f64, rounded once, so that they are the same everywhere.
fn about(axis: Vec3, angle: f64) -> Quat {
    let (sin, cos) = (angle * 0.5).sin_cos();
    let axis = axis * sin as f32;
    Quat::from_xyzw(axis.x, axis.y, axis.z, cos as f32)
}

/// A flat triangle, which evens out a count that is odd.
fn pennant(name: &str, corners: [Vec3; 3]) -> Mesh {
    let mut mesh = Mesh::new(name, corners.to_vec(), vec![[0, 1, 2]]);
    mesh.shading.coordinates = Corners::default();
    mesh
}

/// Turned normals and all.
fn smooth(mut mesh: Mesh) -> Mesh {
    let normals = super::noise_sphere::normals(&mesh.positions, &mesh.triangles);
    mesh.shading.normals = Corners::of_vertices(normals);
    mesh
}
