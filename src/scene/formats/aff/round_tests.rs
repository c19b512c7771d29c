use glam::Quat;

use super::super::super::super::{Animation, Motion};
use super::*;

const SPHERE: Round = Round::Sphere { centre: Vec3::X, radius: 2.0 };
const CONE: Round = Round::Cone { base: Vec3::ZERO, base_radius: 1.0, tip: Vec3::Z, tip_radius: 0.25 };

/// A sphere and a cone in a node, which may move.
fn placed(transform: Affine3A, moves: bool) -> Scene {
    let mut scene = Scene::new("s");
    let above = scene.add_node(None, "above", Affine3A::from_translation(Vec3::Y), None);
    let node = scene.add_node(Some(above), "here", transform, None);
    if moves {
        let motions = vec![Motion::default()];
        scene.animation = Animation { motions, followers: vec![(above, 0)], ..Animation::default() };
    }
    let mut rounds = Rounds::default();
    rounds.add(node, SPHERE, None);
    rounds.add(node, CONE, Some(0));
    rounds.add(node, SPHERE, None);
    rounds.place(&mut scene);
    scene
}

#[test]
fn even_transforms_keep_them_primitives() {
    let turn = Quat::from_rotation_z(std::f32::consts::FRAC_PI_2) * Quat::from_rotation_x(0.3);
    let transform = Affine3A::from_scale_rotation_translation(Vec3::new(3.0, -3.0, 3.0), turn, Vec3::Z);
    let scene = placed(transform, false);
    assert_eq!((scene.primitives.len(), scene.nodes.len(), scene.warnings.len()), (3, 2, 0));
    let Shape::Sphere(sphere) = scene.primitives[0].shape else { panic!() };
    let expected = transform.transform_point3(Vec3::X) + Vec3::Y;
    assert!(sphere.centre.abs_diff_eq(expected, 1e-5) && (sphere.radius - 6.0).abs() < 1e-5, "{sphere:?}");
    let Shape::Cone(cone) = scene.primitives[1].shape else { panic!() };
    assert!((cone.base_radius - 3.0).abs() < 1e-5 && (cone.tip_radius - 0.75).abs() < 1e-5, "{cone:?}");
    assert!((cone.base.distance(cone.tip) - 3.0).abs() < 1e-5);
}

#[test]
fn what_moves_or_is_uneven_becomes_meshes_on_the_same_surface() {
    let uneven = Affine3A::from_scale(Vec3::new(1.0, 2.0, 3.0));
    for (transform, moves) in [(uneven, false), (Affine3A::IDENTITY, true), (uneven, true)] {
        let scene = placed(transform, moves);
        assert!(scene.primitives.is_empty());
        assert_eq!((scene.meshes.len(), scene.instances().0), (2, 3), "spheres of one material share a mesh");
        let triangles = scene.instances().1;
        assert_eq!(
            scene.warnings,
            [format!("3 spheres and cones move or are scaled unevenly: they are {triangles} triangles")]
        );
        let to_world = scene.world_transforms();
        for (node, world) in scene.nodes.iter().zip(&to_world) {
            let Some(mesh) = node.mesh.map(|mesh| &scene.meshes[mesh as usize]) else { continue };
            let local = to_world[1].inverse() * *world;
            let is_sphere = mesh.name == "sphere";
            for (position, normal) in mesh.positions.iter().zip(&mesh.shading.normals.values) {
                let at = local.transform_point3(*position);
                let (off, out) = if is_sphere {
                    (at.distance(Vec3::X) - 2.0, at - Vec3::X)
                } else {
                    // Radius 1 at the base, a quarter at the tip.
                    (at.truncate().length() - (1.0 - 0.75 * at.z), Vec3::new(at.x, at.y, 0.0))
                };
                assert!(off.abs() < 1e-5, "{off}");
                assert!(normal.is_normalized() && normal.dot(out) > 0.5 * out.length());
            }
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
                let out = triangle.map(|v| mesh.shading.normals.values[v as usize]).iter().sum::<Vec3>();
                assert!((b - a).cross(c - a).dot(out) > 0.0, "anticlockwise from outside");
            }
        }
    }
}

#[test]
fn cones_that_end_in_a_point_have_no_triangles_without_area() {
    for (base_radius, tip_radius, count) in [(1.0, 0.0, AROUND), (0.0, 1.0, AROUND), (1.0, 1.0, 2 * AROUND)] {
        let mesh = side(Cone { base: Vec3::ONE, base_radius, tip: Vec3::Z, tip_radius });
        assert_eq!(mesh.triangles.len() as u32, count);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
            assert!((b - a).cross(c - a).length() > 1e-3);
        }
    }
}
