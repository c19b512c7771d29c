//! A scene at a time.

use glam::{Affine3A, DAffine3, DQuat, Vec3};

use super::super::{Mesh, PointLight, Scene, View};
use super::{Animation, Motion};
use crate::geometry::Aabb;

/// Where everything in a scene is at one time, and what it is like. Kept from frame to frame, it asks for no new
/// memory.
#[derive(Clone, Debug, Default)]
pub struct Pose {
    /// When, in seconds.
    pub time: f64,
    /// From each node's space to the world's, by node; lengths in metres.
    pub world: Vec<Affine3A>,
    /// Whether each node is seen: what hangs below one that is not is not either, nor is one whose place overflows.
    pub visible: Vec<bool>,
    /// Where the camera is and looks; the scene's own view if no motion moves it.
    pub view: Option<View>,
    /// The lights, in the scene's order; one that is out is black.
    pub lights: Vec<PointLight>,
    /// The meshes that change shape, in the order of [`Animation::bends`].
    pub bent: Vec<Bent>,
    /// Nodes, each after its parent.
    order: Vec<u32>,
    /// The motion of each node.
    motion: Vec<Option<u32>>,
    /// Each motion's transform, and whether what follows it is seen.
    moved: Vec<(Affine3A, bool)>,
}

/// A mesh that changes shape, at one time.
#[derive(Clone, Debug)]
pub struct Bent {
    /// The mesh, by number.
    pub mesh: u32,
    /// Its vertices, in metres.
    pub positions: Vec<Vec3>,
    /// Its normals, of unit length; 0 where keys had none.
    pub normals: Vec<Vec3>,
    /// The smallest box around all vertices.
    pub bounds: Aabb,
}

impl Scene {
    /// The scene at a time in seconds; before its first key and after its last everything stays. At any time, also
    /// one that is not finite, the numbers of a valid scene's pose are finite.
    pub fn pose(&self, time: f64) -> Pose {
        let mut pose = Pose::default();
        self.pose_into(time, &mut pose);
        pose
    }

    /// The same, into a pose whose memory is used again, whichever scene it was of.
    pub fn pose_into(&self, time: f64, pose: &mut Pose) {
        let animation = &self.animation;
        pose.time = time;
        pose.place_nodes(self, time);
        pose.view = animation.view(self.view, time);
        pose.lights.clone_from(&self.lights);
        for (light, motion) in &animation.lights {
            let (light, motion) = (&mut pose.lights[*light as usize], &animation.motions[*motion as usize]);
            let moved = light.position.as_dvec3() + motion.moved(time);
            light.position = moved.to_array().map(narrowed).into();
            if !motion.is_seen(time) {
                light.colour = Vec3::ZERO;
            }
        }
        let unshaped = || Bent { mesh: 0, positions: Vec::new(), normals: Vec::new(), bounds: Aabb::EMPTY };
        pose.bent.resize_with(animation.bends.len(), unshaped);
        animation.bends.iter().zip(&mut pose.bent).for_each(|(bend, bent)| bend.shape(time, bent));
    }

    /// The scene as it is at a time in seconds, with nothing that moves any more: the slow way to a frame, which whatever
    /// renders a [`Pose`] is held against.
    pub fn still(&self, time: f64) -> Self {
        let pose = self.pose(time);
        let mut still =
            Self { view: pose.view, lights: pose.lights, animation: Animation::default(), ..self.clone() };
        for (index, node) in still.nodes.iter_mut().enumerate() {
            if let Some(motion) = pose.motion[index] {
                node.transform = pose.moved[motion as usize].0;
            }
            node.mesh = node.mesh.filter(|_| pose.visible[index]);
        }
        for flock in &mut still.flocks {
            flock.nodes.retain(|node| pose.visible[*node as usize]);
        }
        for bent in pose.bent {
            let mesh = &mut still.meshes[bent.mesh as usize];
            let (name, triangles) = (std::mem::take(&mut mesh.name), std::mem::take(&mut mesh.triangles));
            mesh.shading.normals.values = bent.normals;
            let shading = std::mem::take(&mut mesh.shading);
            *mesh = Mesh { shading, ..Mesh::new(name, bent.positions, triangles) };
        }
        still
    }
}

impl Pose {
    fn place_nodes(&mut self, scene: &Scene, time: f64) {
        let animation = &scene.animation;
        self.moved.clear();
        let moved = |motion: &Motion| (rounded(motion.transform(time)), motion.is_seen(time));
        self.moved.extend(animation.motions.iter().map(moved));
        self.motion.clear();
        self.motion.resize(scene.nodes.len(), None);
        for (node, motion) in &animation.followers {
            self.motion[*node as usize] = Some(*motion);
        }
        self.order.clear();
        self.order.extend(&scene.roots);
        self.world.clear();
        self.world.resize(scene.nodes.len(), Affine3A::IDENTITY);
        self.visible.clear();
        self.visible.resize(scene.nodes.len(), false);
        let mut next = 0;
        while let Some(index) = self.order.get(next).map(|index| *index as usize) {
            let node = &scene.nodes[index];
            let (own, own_seen) =
                self.motion[index].map_or((node.transform, true), |motion| self.moved[motion as usize]);
            let (above, seen) = node.parent.map_or((Affine3A::IDENTITY, true), |parent| {
                (self.world[parent as usize], self.visible[parent as usize])
            });
            // As a scene that stands still places its nodes, so that what does not move is where it would be.
            let world = above * own;
            let is_finite = world.is_finite();
            self.world[index] = if is_finite { world } else { Affine3A::IDENTITY };
            self.visible[index] = seen && own_seen && is_finite;
            self.order.extend(&node.children);
            next += 1;
        }
    }
}

/// The vertical angle of a camera that moves in a scene without a view: 45 degrees.
const ANGLE: f32 = std::f32::consts::FRAC_PI_4;

impl Animation {
    fn view(&self, rest: Option<View>, time: f64) -> Option<View> {
        let Some(camera) = self.camera else { return rest };
        let motion = &self.motions[camera as usize];
        let eye = motion.moved(time);
        let turn = motion.rotation.as_ref().and_then(|curve| curve.at(time)).unwrap_or(DQuat::IDENTITY);
        let ahead = turn * glam::DVec3::NEG_Z;
        // A point as far ahead as the eye is from the origin: one nearer would turn with the rounding of its place.
        let look = eye + ahead * eye.abs().max_element().max(1.0);
        let [eye, look] = [eye, look].map(|point| Vec3::from(point.to_array().map(narrowed)));
        let fov_y = rest.map_or(ANGLE, |view| view.fov_y);
        Some(View { eye, look, up: (turn * glam::DVec3::Y).as_vec3(), fov_y })
    }
}

/// The nearest 32-bit float that is finite.
fn narrowed(number: f64) -> f32 {
    number.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
}

fn rounded(transform: DAffine3) -> Affine3A {
    Affine3A::from_cols_array(&transform.to_cols_array().map(narrowed))
}

#[cfg(test)]
#[path = "pose_tests.rs"]
mod tests;
