//! All cost in one corner of the picture (PK-F04, Parker et al. 1999, sec. 2.1): a heap of glass balls at its lower
//! right, whose tiles a scheme of static sizes hands out last, and elsewhere a bare floor.

use glam::{Affine3A, Vec3};

use super::super::{Material, Mesh, PointLight, Primitive, Scene, Shape, SplitMix64, View};
use super::{Aisles, Generator};
use crate::geometry::Sphere;

pub(super) const CORNER: Generator = Generator {
    name: "corner",
    about: "glass balls at the picture's lower right, bare floor elsewhere: all cost in one corner (PK-F04)",
    generate,
    aisles: || Aisles::NONE,
};

/// Balls in the heap, and edge of the box they lie in, in metres.
const BALLS: usize = 150;
const HEAP: f64 = 2.4;

fn generate() -> Scene {
    let mut scene = Scene::new("corner");
    let (floor, glass) =
        (Material::matt("floor", Vec3::new(0.55, 0.5, 0.45)), Material::dielectric("glass", 1.5));
    let (floor, glass) = (scene.add_material(floor), scene.add_material(glass));
    let plane = [(-60.0, -60.0), (-60.0, 60.0), (60.0, 60.0), (60.0, -60.0)];
    let corners = plane.map(|(x, z)| Vec3::new(x, 0.0, z)).to_vec();
    let mut mesh = Mesh::new("floor", corners, vec![[0, 1, 2], [0, 2, 3]]);
    mesh.shading.materials = super::super::Materials::One(floor);
    let mesh = scene.add_mesh(mesh);
    scene.add_node(None, "floor", Affine3A::IDENTITY, Some(mesh));
    let mut random = SplitMix64::new(4);
    scene.primitives = (0..BALLS)
        .map(|_| {
            let radius = random.between(0.15, 0.4);
            let [x, z] = [(); 2].map(|()| random.between(-HEAP / 2.0, HEAP / 2.0));
            let y = random.between(radius, HEAP * 0.6);
            let centre = Vec3::new(x as f32 + 3.0, y as f32, z as f32 + 1.5);
            Primitive {
                shape: Shape::Sphere(Sphere { centre, radius: radius as f32 }),
                material: Some(glass),
            }
        })
        .collect();
    scene.lights = vec![PointLight { position: Vec3::new(-8.0, 15.0, 10.0), colour: Vec3::splat(0.9) }];
    scene.view = Some(View {
        eye: Vec3::new(0.0, 4.4, 12.0),
        look: Vec3::new(0.0, 3.4, 0.0),
        up: Vec3::Y,
        fov_y: 0.8,
    });
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_heap_is_seen_in_the_lower_right_quarter() {
        let scene = generate();
        scene.validate().unwrap();
        assert_eq!((scene.primitives.len(), scene.instances().1), (BALLS, 2));
        let view = scene.view.expect("it has one");
        let forward = (view.look - view.eye).normalize();
        let right = forward.cross(view.up).normalize();
        let up = right.cross(forward);
        let half = (view.fov_y / 2.0).tan();
        for primitive in &scene.primitives {
            let Shape::Sphere(sphere) = primitive.shape else { panic!("only balls") };
            let to = sphere.centre - view.eye;
            let (x, y) = (to.dot(right) / to.dot(forward) / half, to.dot(up) / to.dot(forward) / half);
            assert!(x > 0.0 && x < 4.0 / 3.0 && y < 0.0 && y > -1.0, "{x} {y}");
        }
    }
}
