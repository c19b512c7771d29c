//! What must hold of a scene before anything is built over it.

use glam::Vec3;

use super::{Scene, SceneError};

impl Scene {
    /// Checks that the graph is a forest, that all indices are in range, that key frames are in order, and that all
    /// numbers are finite, in the world as well.
    ///
    /// # Errors
    /// [`SceneError::Malformed`] naming the first node or mesh that is not right.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.validate_as(&self.name)
    }

    /// As [`Scene::validate`], naming `file` in errors.
    pub(super) fn validate_as(&self, file: &str) -> Result<(), SceneError> {
        self.check_meshes(file)?;
        self.check_shading(file)?;
        self.check_nodes(file)?;
        self.check_forest(file)?;
        self.check_animation(file)?;
        let of_meshes = self.world_bounds().into_iter().enumerate();
        let of_flocks = self.flock_bounds().into_iter().map(|(node, bounds)| (node as usize, bounds));
        for (index, bounds) in of_meshes.chain(of_flocks) {
            let finite = bounds.min.is_finite() && bounds.max.is_finite();
            if !finite && !bounds.is_empty() {
                return Err(SceneError::malformed(
                    file,
                    self.node_place(index),
                    "its place in the world overflows",
                    "coordinates within the range of f32",
                ));
            }
        }
        Ok(())
    }

    pub(super) fn node_place(&self, index: usize) -> String {
        let name = self.nodes.get(index).map_or("", |node| node.name.as_str());
        format!("node {index} {name:?}")
    }

    fn check_meshes(&self, file: &str) -> Result<(), SceneError> {
        for (index, mesh) in self.meshes.iter().enumerate() {
            let place = || format!("mesh {index} {:?}", mesh.name);
            if let Some(vertex) = mesh.positions.iter().position(|position| !position.is_finite()) {
                let found = format!("vertex {vertex} is {}", mesh.positions[vertex]);
                return Err(SceneError::malformed(file, place(), found, "finite coordinates"));
            }
            let count = mesh.positions.len();
            let out = |triangle: &[u32; 3]| triangle.iter().any(|vertex| *vertex as usize >= count);
            if let Some(triangle) = mesh.triangles.iter().position(out) {
                let found = format!("triangle {triangle} is {:?}", mesh.triangles[triangle]);
                return Err(SceneError::malformed(file, place(), found, format!("indices below {count}")));
            }
        }
        Ok(())
    }

    /// Indices of materials, textures and corners in range; all numbers finite.
    fn check_shading(&self, file: &str) -> Result<(), SceneError> {
        let fail = |place: String, found: String, expected: String| {
            Err(SceneError::malformed(file, place, found, expected))
        };
        let materials = self.materials.len();
        for (index, mesh) in self.meshes.iter().enumerate() {
            let (place, shading) = (format!("mesh {index} {:?}", mesh.name), &mesh.shading);
            if let Some(material) =
                shading.materials.greatest().filter(|number| *number as usize >= materials)
            {
                return fail(place, format!("material {material}"), format!("a material below {materials}"));
            }
            if let Some(normal) = shading.normals.values.iter().find(|normal| !normal.is_finite()) {
                return fail(place, format!("normal {normal}"), "finite numbers".to_owned());
            }
            if let Some(at) = shading.coordinates.values.iter().find(|at| !at.is_finite()) {
                return fail(place, format!("texture coordinate {at}"), "finite numbers".to_owned());
            }
        }
        for (index, material) in self.materials.iter().enumerate() {
            let place = format!("material {index} {:?}", material.name);
            if let Some(texture) = material.texture.filter(|number| *number as usize >= self.textures.len()) {
                return fail(
                    place,
                    format!("texture {texture}"),
                    format!("one below {}", self.textures.len()),
                );
            }
            let terms = [material.diffuse, material.highlight, material.mirror, material.transmission];
            let finite = terms.iter().chain([&material.absorption]).chain(&material.ambient);
            let finite = finite.copied().all(Vec3::is_finite);
            if !(finite && material.index > 0.0 && material.index.is_finite()) {
                return fail(place, format!("{material:?}"), "finite numbers, an index above 0".to_owned());
            }
        }
        if let Some(bad) = [self.background, self.ambient].into_iter().flatten().find(|c| !c.is_finite()) {
            return fail(
                "background or ambient light".to_owned(),
                bad.to_string(),
                "finite numbers".to_owned(),
            );
        }
        for (index, texture) in self.textures.iter().enumerate() {
            let pixels = texture.width as usize * texture.height as usize;
            if pixels == 0 || texture.pixels.len() != pixels {
                let found =
                    format!("{} pixels for {} x {}", texture.pixels.len(), texture.width, texture.height);
                return fail(format!("texture {index} {:?}", texture.name), found, "all of them".to_owned());
            }
        }
        let flocks = self.flocks.iter().enumerate().flat_map(|(number, flock)| {
            flock
                .primitives
                .iter()
                .enumerate()
                .map(move |(index, primitive)| (Some(number), index, primitive))
        });
        let alone = self.primitives.iter().enumerate().map(|(index, primitive)| (None, index, primitive));
        for (flock, index, primitive) in alone.chain(flocks) {
            let place = || match flock {
                Some(flock) => format!("flock {flock}, primitive {index}"),
                None => format!("primitive {index}"),
            };
            if !primitive.shape.is_sound() {
                let found = format!("{:?}", primitive.shape);
                return fail(place(), found, "finite numbers, radii not below 0".to_owned());
            }
            if let Some(material) = primitive.material.filter(|number| *number as usize >= materials) {
                return fail(place(), format!("material {material}"), format!("one below {materials}"));
            }
        }
        match self.lights.iter().position(|light| !(light.position.is_finite() && light.colour.is_finite())) {
            Some(bad) => {
                fail(format!("light {bad}"), format!("{:?}", self.lights[bad]), "finite numbers".to_owned())
            }
            None => Ok(()),
        }
    }

    fn check_nodes(&self, file: &str) -> Result<(), SceneError> {
        let count = self.nodes.len();
        for (index, flock) in self.flocks.iter().enumerate() {
            if let Some(node) = flock.nodes.iter().find(|node| **node as usize >= count) {
                let place = format!("flock {index} {:?}", flock.name);
                let (found, expected) = (format!("node {node}"), format!("a node below {count}"));
                return Err(SceneError::malformed(file, place, found, expected));
            }
        }
        for (index, node) in self.nodes.iter().enumerate() {
            let fail = |found: String, expected: String| {
                Err(SceneError::malformed(file, self.node_place(index), found, expected))
            };
            if let Some(mesh) = node.mesh.filter(|mesh| *mesh as usize >= self.meshes.len()) {
                return fail(format!("mesh {mesh}"), format!("a mesh below {}", self.meshes.len()));
            }
            if let Some(child) = node.children.iter().find(|child| **child as usize >= count) {
                return fail(format!("child {child}"), format!("a node below {count}"));
            }
            if let Some(parent) = node.parent.filter(|parent| *parent as usize >= count) {
                return fail(format!("parent {parent}"), format!("a node below {count}"));
            }
            if !node.transform.is_finite() {
                return fail("its transform is not finite".to_string(), "finite numbers".to_string());
            }
        }
        Ok(())
    }

    /// Each node must be reached exactly once from the roots, from the parent it names.
    fn check_forest(&self, file: &str) -> Result<(), SceneError> {
        let mut reached = vec![false; self.nodes.len()];
        let mut stack: Vec<(Option<u32>, u32)> = self.roots.iter().map(|root| (None, *root)).collect();
        while let Some((parent, index)) = stack.pop() {
            let place = || self.node_place(index as usize);
            let Some(node) = self.nodes.get(index as usize) else {
                let expected = format!("a node below {}", self.nodes.len());
                return Err(SceneError::malformed(file, "roots", format!("root {index}"), expected));
            };
            if std::mem::replace(&mut reached[index as usize], true) {
                let expected = "a tree: one way to each node, no cycle";
                return Err(SceneError::malformed(file, place(), "it is reached twice", expected));
            }
            if node.parent != parent {
                let found = format!("it names parent {:?} and hangs under {parent:?}", node.parent);
                return Err(SceneError::malformed(file, place(), found, "the two to agree"));
            }
            stack.extend(node.children.iter().map(|child| (Some(index), *child)));
        }
        match reached.iter().position(|reached| !reached) {
            Some(lost) => {
                let (found, expected) = ("no root leads to it", "a tree under each root, no cycle");
                Err(SceneError::malformed(file, self.node_place(lost), found, expected))
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};

    use super::super::{Flock, Mesh, Primitive, Scene, Shape};
    use crate::geometry::Sphere;

    fn good() -> Scene {
        let mut scene = Scene::new("good");
        let mesh = scene.add_mesh(Mesh::new("m", vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
        let root = scene.add_node(None, "root", Affine3A::IDENTITY, None);
        scene.add_node(Some(root), "leaf", Affine3A::from_translation(Vec3::Z), Some(mesh));
        scene
    }

    fn message(change: impl FnOnce(&mut Scene)) -> String {
        let mut scene = good();
        scene.validate().unwrap();
        change(&mut scene);
        scene.validate().unwrap_err().to_string()
    }

    /// One sphere, placed by the leaf.
    fn flock(radius: f32) -> Flock {
        let shape = Shape::Sphere(Sphere { centre: Vec3::X * radius, radius });
        Flock { primitives: vec![Primitive { shape, material: None }], nodes: vec![1], ..Flock::default() }
    }

    #[test]
    fn each_fault_is_named() {
        let cases = [
            (message(|s| s.nodes[1].children.push(0)), "reached twice"),
            (message(|s| s.roots.clear()), "no root leads to it"),
            (message(|s| s.roots.push(9)), "root 9"),
            (message(|s| s.nodes[1].parent = None), "names parent None"),
            (message(|s| s.nodes[0].children.push(7)), "child 7; expected a node below 2"),
            (message(|s| s.nodes[1].mesh = Some(3)), "mesh 3; expected a mesh below 1"),
            (message(|s| s.nodes[1].transform.translation.x = f32::NAN), "not finite"),
            (message(|s| s.meshes[0].positions[2].y = f32::NAN), "vertex 2"),
            (message(|s| s.meshes[0].triangles.push([0, 1, 3])), "triangle 1"),
            (
                message(|s| s.flocks.push(Flock { nodes: vec![1, 2], ..Flock::default() })),
                "flock 0 \"\": node 2",
            ),
            (message(|s| s.flocks.push(flock(f32::NAN))), "flock 0, primitive 0"),
            (message(|s| s.flocks.push(flock(f32::MAX))), "overflows"),
            (message(|s| s.nodes.iter_mut().for_each(|n| n.transform.translation.x = f32::MAX)), "overflows"),
        ];
        for (message, part) in &cases {
            assert!(message.starts_with("good: ") && message.contains(part), "{message:?} lacks {part:?}");
        }
    }

    #[test]
    fn a_deep_chain_is_walked_without_recursion() {
        let mut scene = Scene::new("chain");
        let mut above = None;
        for _ in 0..100_000 {
            above = Some(scene.add_node(above, "link", Affine3A::IDENTITY, None));
        }
        scene.validate().unwrap();
        assert_eq!(scene.depth_first().len(), 100_000);
    }
}
