//! A scene many times over.

use glam::{Affine3A, Vec3};

use super::{Animation, Flock, PointLight, Scene};

impl Scene {
    /// So many copies of the scene on a level grid as near to a square as can be, row after row. They
    /// share their meshes, spheres and cones, bring their lights, and move all in step. `spacing` is the way from copy to copy in units of the scene's greater extent
    /// along x and z: at 1 they touch. It goes by another name, as it is another scene; one copy is the
    /// scene itself.
    pub fn repeated(self, copies: u32, spacing: f32) -> Self {
        if copies == 1 {
            return self;
        }
        let size = self.bounds().size();
        let (pitch, columns) = (size.x.max(size.z) * spacing, f64::from(copies).sqrt().ceil() as u32);
        let mut scene = Self::new(format!("{copies} x {}", self.name));
        let mut alone = Flock { name: self.name, primitives: self.primitives, nodes: Vec::new() };
        let bare = |flock: &Flock| Flock { nodes: Vec::new(), ..flock.clone() };
        scene.flocks = self.flocks.iter().map(bare).collect();
        let (mut followers, mut lights) = (Vec::new(), Vec::new());
        for copy in 0..copies {
            let place = Vec3::new((copy % columns) as f32, 0.0, (copy / columns) as f32) * pitch;
            let root = scene.add_node(None, format!("copy {copy}"), Affine3A::from_translation(place), None);
            let (first, first_light) = (scene.nodes.len() as u32, scene.lights.len() as u32);
            let animation = &self.animation;
            followers.extend(animation.followers.iter().map(|(node, motion)| (node + first, *motion)));
            lights.extend(animation.lights.iter().map(|(light, motion)| (light + first_light, *motion)));
            scene.nodes[root as usize].children = self.roots.iter().map(|node| node + first).collect();
            scene.nodes.extend(self.nodes.iter().map(|node| {
                let mut node = node.clone();
                node.parent = Some(node.parent.map_or(root, |parent| parent + first));
                node.children.iter_mut().for_each(|child| *child += first);
                node
            }));
            // Those that hung on no node hang on the copy's.
            alone.nodes.push(root);
            for (flock, own) in scene.flocks.iter_mut().zip(&self.flocks) {
                flock.nodes.extend(own.nodes.iter().map(|node| node + first));
            }
            let standing = self.lights.iter();
            scene
                .lights
                .extend(standing.map(|light| PointLight { position: light.position + place, ..*light }));
        }
        if !alone.primitives.is_empty() {
            scene.flocks.push(alone);
        }
        Self {
            meshes: self.meshes,
            materials: self.materials,
            textures: self.textures,
            warnings: self.warnings,
            background: self.background,
            ambient: self.ambient,
            // That of one copy, which would show some of the others by chance, is none of all.
            view: None,
            animation: Animation { followers, lights, camera: None, ..self.animation },
            ..scene
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Curve, Mesh, Motion, by_name};
    use super::*;

    #[test]
    fn copies_stand_apart_and_share_meshes() {
        let scene = by_name("factory-small").unwrap();
        let (nodes, triangles, bounds) = (scene.nodes.len(), scene.instances().1, scene.bounds());
        for copies in [2, 3, 7] {
            let many = scene.clone().repeated(copies, 2.0);
            many.validate().unwrap();
            let count = copies as usize;
            assert_eq!((many.nodes.len(), many.instances().1), (count * (nodes + 1), count * triangles));
            assert_eq!((many.meshes.len(), many.roots.len()), (scene.meshes.len(), count));
            let columns = if copies == 7 { 3 } else { 2 };
            let expected = bounds.size().x.max(bounds.size().z) * (1.0 + 2.0 * (columns - 1) as f32);
            assert!((many.bounds().size().x - expected).abs() < 1e-3 * expected, "{copies}");
        }
        assert_eq!(scene.clone().repeated(1, 2.0).name, "factory-small");
        assert_eq!(scene.repeated(7, 2.0).name, "7 x factory-small");
    }

    #[test]
    fn copies_share_spheres_too() {
        let scene = by_name("spheres-10k").unwrap();
        let bounds = scene.bounds();
        let twice = scene.clone().repeated(4, 1.5).repeated(3, 1.0);
        twice.validate().unwrap();
        assert_eq!((twice.primitives.len(), twice.flocks.len()), (0, 1));
        assert_eq!((twice.flocks[0].nodes.len(), twice.primitives_placed()), (12, 120_000));
        let size = twice.bounds().size() / bounds.size();
        assert!((size - Vec3::new(5.0, 1.0, 5.0)).abs().max_element() < 1e-3, "{size}");
    }

    #[test]
    fn nothing_can_be_repeated_too() {
        assert_eq!(Scene::new("nothing").repeated(3, 1.0).nodes.len(), 3);
        let mut point = Scene::new("point");
        let mesh = point.add_mesh(Mesh::new("point", vec![Vec3::ONE; 3], vec![[0, 1, 2]]));
        point.add_node(None, "point", Affine3A::IDENTITY, Some(mesh));
        point.repeated(4, 2.0).validate().unwrap();
    }

    #[test]
    fn copies_move_in_step() {
        let mut scene = Scene::new("lift");
        let mesh = scene.add_mesh(Mesh::new("m", vec![Vec3::ZERO, Vec3::X, Vec3::Z], vec![[0, 1, 2]]));
        scene.add_node(None, "cage", Affine3A::IDENTITY, Some(mesh));
        scene.lights = vec![PointLight { position: Vec3::X, colour: Vec3::ONE }];
        let rise = Some(Curve::Linear(vec![(0.0, Vec3::ZERO), (1.0, Vec3::Y * 3.0)]));
        scene.animation = Animation {
            motions: vec![Motion { translation: rise, ..Motion::default() }],
            followers: vec![(0, 0)],
            lights: vec![(0, 0)],
            camera: Some(0),
            ..Animation::default()
        };
        let one = scene.pose(0.5);
        let many = scene.repeated(3, 2.0);
        many.validate().unwrap();
        let (rest, pose) = (many.pose(0.0), many.pose(0.5));
        for copy in 0..3 {
            let (stands, cage) = (rest.world[2 * copy + 1].translation, pose.world[2 * copy + 1].translation);
            assert_eq!(cage, stands + one.world[0].translation, "copy {copy}");
            assert_eq!(pose.lights[copy].position, rest.lights[copy].position + Vec3::Y * 1.5);
        }
        assert_eq!((pose.view, many.animation.motions.len()), (None, 1));
    }
}
