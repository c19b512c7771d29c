use glam::Quat;

use super::super::super::{Corners, by_name};
use super::super::{Bend, BendKey, Curve};
use super::*;

fn steps<T>(value: T) -> Option<Curve<T>> {
    Some(Curve::Steps(vec![(0.0, value)]))
}

fn line(to: Vec3) -> Option<Curve<Vec3>> {
    Some(Curve::Linear(vec![(0.0, Vec3::ZERO), (1.0, to)]))
}

/// An arm of two links, the second under the first, a mesh that bends, a light and a camera that move.
fn machine() -> Scene {
    let mut scene = Scene::new("machine");
    let mut mesh = Mesh::new("m", vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    mesh.shading.normals = Corners::of_vertices(vec![Vec3::Z; 3]);
    let mesh = scene.add_mesh(mesh);
    let base = scene.add_node(None, "base", Affine3A::from_translation(Vec3::Z), None);
    let link = scene.add_node(Some(base), "link", Affine3A::IDENTITY, Some(mesh));
    let hand = scene.add_node(Some(link), "hand", Affine3A::from_translation(Vec3::X * 2.0), Some(mesh));
    scene.add_node(Some(hand), "nail", Affine3A::IDENTITY, Some(mesh));
    scene.lights = vec![PointLight { position: Vec3::ONE, colour: Vec3::ONE }; 2];
    scene.view = Some(View { eye: Vec3::ZERO, look: Vec3::X, up: Vec3::Y, fov_y: 0.7 });
    let motions = vec![
        Motion { translation: line(Vec3::X * 10.0), ..Motion::default() },
        Motion {
            rotation: steps(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)),
            visibility: vec![(0.5, false), (0.75, true)],
            ..Motion::default()
        },
        Motion {
            translation: line(Vec3::Y * 4.0),
            rotation: steps(Quat::from_rotation_y(-std::f32::consts::FRAC_PI_2)),
            ..Motion::default()
        },
    ];
    let key = |time: f64, lift: f32, normal: Vec3| BendKey {
        time,
        positions: vec![Vec3::Z * lift, Vec3::X, Vec3::Y],
        normals: vec![normal, Vec3::Z * 0.01, Vec3::Y],
    };
    scene.animation = Animation {
        start: 0.0,
        end: 1.0,
        frames: 11,
        motions,
        followers: vec![(1, 0), (2, 1)],
        camera: Some(2),
        lights: vec![(1, 1)],
        bends: vec![Bend { mesh: 0, keys: vec![key(0.0, 0.0, Vec3::X), key(1.0, 8.0, Vec3::NEG_X)] }],
    };
    scene.validate().unwrap();
    scene
}

#[test]
fn parts_follow_their_motions_and_what_they_hang_on() {
    let pose = machine().pose(0.25);
    let origin = |node: usize| pose.world[node].transform_point3(Vec3::ZERO);
    assert_eq!((origin(0), origin(1)), (Vec3::Z, Vec3::new(2.5, 0.0, 1.0)));
    // The hand's motion stands for its transform: it is no longer 2 m out.
    assert_eq!((origin(2), origin(3)), (origin(1), origin(1)));
    assert!(pose.world[3].transform_vector3(Vec3::X).distance(Vec3::Y) < 1e-6);
    assert_eq!(pose.visible, [true; 4]);
}

#[test]
fn what_hangs_below_what_is_hidden_is_hidden_too() {
    let scene = machine();
    let pose = scene.pose(0.5);
    assert_eq!(pose.visible, [true, true, false, false]);
    assert_eq!((pose.lights[0].colour, pose.lights[1].colour), (Vec3::ONE, Vec3::ZERO));
    assert_eq!(scene.still(0.5).instances(), (1, 1));
    assert_eq!(scene.pose(0.75).visible, [true; 4]);
}

#[test]
fn the_camera_looks_along_its_own_negative_z() {
    let mut scene = machine();
    let view = scene.pose(0.5).view.unwrap();
    assert_eq!((view.eye, view.fov_y), (Vec3::Y * 2.0, 0.7));
    let ahead = (view.look - view.eye).normalize();
    // A quarter turn clockwise about +y takes -z to +x.
    assert!(ahead.distance(Vec3::X) < 1e-6 && view.up.distance(Vec3::Y) < 1e-6, "{ahead}");
    scene.view = None;
    assert_eq!(scene.pose(0.0).view.unwrap().fov_y, ANGLE);
    // Far from the origin it still looks the same way.
    scene.animation.motions[2].translation = steps(Vec3::new(1e7, -3e7, 2e7));
    let view = scene.pose(0.0).view.unwrap();
    assert!((view.look - view.eye).normalize().distance(Vec3::X) < 1e-6);
    scene.animation.camera = None;
    assert_eq!(scene.pose(0.0).view, None);
}

#[test]
fn lights_move_by_the_translation() {
    let mut scene = machine();
    scene.animation.lights = vec![(1, 2)];
    let lights = scene.pose(0.5).lights;
    assert_eq!((lights[0].position, lights[1].position), (Vec3::ONE, Vec3::new(1.0, 3.0, 1.0)));
}

#[test]
fn bent_meshes_lie_between_their_keys_with_normals_of_length_one() {
    let scene = machine();
    for (time, lift) in [(-5.0, 0.0), (0.0, 0.0), (0.25, 2.0), (1.0, 8.0), (9.0, 8.0)] {
        let bent = &scene.pose(time).bent[0];
        assert_eq!(bent.positions, [Vec3::Z * lift, Vec3::X, Vec3::Y], "{time}");
        assert!(bent.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-6));
        assert_eq!(bent.bounds, Aabb::of_points(bent.positions.iter().copied()));
    }
    // Opposite normals cancel halfway, where the key before is as good as any.
    assert_eq!(scene.pose(0.5).bent[0].normals[0], Vec3::X);
}

#[test]
fn memory_is_used_again_and_nothing_of_another_pose_is_left() {
    let (scene, other) = (machine(), by_name("factory-small").unwrap());
    let mut pose = Pose::default();
    for (scene, time) in
        [(&scene, 0.1), (&other, 3.0), (&scene, 0.9), (&scene, 0.5), (&Scene::default(), 0.0)]
    {
        scene.pose_into(time, &mut pose);
        assert_eq!(format!("{pose:?}"), format!("{:?}", scene.pose(time)));
    }
    scene.pose_into(0.2, &mut pose);
    let place = (pose.world.as_ptr(), pose.bent[0].positions.as_ptr());
    scene.pose_into(0.3, &mut pose);
    assert_eq!(place, (pose.world.as_ptr(), pose.bent[0].positions.as_ptr()));
}

#[test]
fn what_does_not_move_is_where_it_was_to_the_bit() {
    let scene = by_name("factory-small").unwrap();
    let pose = scene.pose(1.5);
    assert_eq!(pose.world, scene.world_transforms());
    assert!(pose.visible.iter().all(|visible| *visible) && pose.bent.is_empty());
    assert_eq!((pose.view, pose.lights), (scene.view, scene.lights));
}

#[test]
fn a_still_scene_is_the_pose() {
    let scene = machine();
    for time in [0.0, 0.3, 0.6, 1.0] {
        let (still, pose) = (scene.still(time), scene.pose(time));
        still.validate().unwrap();
        assert!(still.animation.is_still());
        assert_eq!((still.world_transforms(), still.view), (pose.world, pose.view));
        assert_eq!(
            (&still.meshes[0].positions, still.meshes[0].bounds),
            (&pose.bent[0].positions, pose.bent[0].bounds)
        );
        assert_eq!(still.meshes[0].shading.normals.values, pose.bent[0].normals);
        assert_eq!(still.nodes[3].mesh.is_some(), pose.visible[3]);
    }
}

#[test]
fn whatever_overflows_is_not_seen_and_no_number_is_lost() {
    let mut scene = machine();
    let huge = [0.0, 1.0, 2.0, 3.0].map(|time| super::super::SplineKey {
        time,
        value: Vec3::splat(if time == 1.0 { f32::MAX } else { f32::MIN }),
        tension: -9.0,
        continuity: 0.0,
        bias: 9.0,
    });
    let motion = &mut scene.animation.motions[0];
    motion.scale = Some(Curve::Spline(huge.to_vec()));
    motion.translation = Some(Curve::Spline(huge.to_vec()));
    scene.validate().unwrap();
    for time in [0.0, 1.0, 1.3, 1.5, 2.0, f64::NAN, f64::INFINITY, -1e308] {
        let pose = scene.pose(time);
        assert!(pose.world.iter().all(|world| world.is_finite()), "{time}");
        assert!(pose.lights.iter().all(|light| light.position.is_finite()));
        assert!(pose.view.is_some_and(|view| view.eye.is_finite() && view.look.is_finite()));
        assert!(pose.bent[0].positions.iter().chain(&pose.bent[0].normals).all(|vector| vector.is_finite()));
    }
}
