//! Bodies as small, large, far away, odd or deep as they come: what brute force finds is found, and nothing ends in a
//! panic or not at all.

use super::*;
use crate::geometry::overlap::AlignedObb;
use crate::scene::{Mesh as SceneMesh, Scene};
use glam::Affine3A;
use proptest::prelude::*;

/// Sizes in metres, from what f32 holds with its last bits only to what a tree takes.
const SIZES: [f32; 8] = [1e-43, 1e-30, 3e-23, 1e-6, 1.0, 1e3, 1e9, 1e17];

/// A few triangles over a few points, so that corners and triangles come up twice; somewhere.
fn soup() -> impl Strategy<Value = Mesh> {
    let point = prop_oneof![
        prop::array::uniform3(-1.0f32..1.0).prop_map(Vec3::from),
        prop::array::uniform3(-1i8..=1).prop_map(|[x, y, z]| Vec3::new(x.into(), y.into(), z.into())),
    ];
    let points = prop::collection::vec(point, 1..12);
    let numbers = prop::collection::vec(prop::array::uniform3(0u32..12), 1..30);
    let place = prop_oneof![3 => Just(Vec3::ZERO), 1 => Just(Vec3::new(1e6, -7e5, 3e6)), 1 => Just(Vec3::splat(2e17))];
    (points, numbers, place, prop::sample::select(&SIZES[..])).prop_map(|(points, numbers, place, size)| {
        let count = points.len() as u32;
        let points = points.into_iter().map(|point| point * size + place).collect();
        (points, numbers.into_iter().map(|corners| corners.map(|corner| corner % count)).collect())
    })
}

/// A motion that puts a point of one body on, or near, a point of the other.
fn meeting(a: &Mesh, b: &Mesh, (axis, angle): ([f64; 3], f64), off: f64) -> Rigid {
    let turn = DQuat::from_axis_angle(DVec3::from(axis).normalize_or(DVec3::Y), angle);
    let at = |mesh: &Mesh| mesh.0[mesh.1[0][0] as usize].as_dvec3();
    let turned = Rigid::new(turn, DVec3::ZERO);
    let size = |mesh: &Mesh| f64::from(Aabb::of_points(mesh.0.iter().copied()).size().max_element());
    let off = DVec3::new(off, -0.3 * off, 0.0) * size(a).min(size(b));
    turned.then(&Rigid::shift(at(a) - turned.point(at(b)) + off))
}

fn held<V: Overlap>(a: &Mesh, b: &Mesh, motion: &Rigid, reach: f64) -> Result<(), TestCaseError> {
    let expected = brute(a, b, motion, reach);
    for leaf in [1, 64] {
        let tree = |mesh: &Mesh| VolumeTree::<V>::over_triangles(&mesh.0, &mesh.1, leaf).unwrap();
        let told = contacts(&tree(a), &tree(b), motion, Query { first: false, reach });
        prop_assert_eq!(&told.pairs, &expected, "leaves of {} of {}", leaf, std::any::type_name::<V>());
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nothing_is_missed_of_any_size_anywhere(
        a in soup(),
        b in soup(),
        axis in prop_oneof![Just([0.0, 0.0, 1.0]), prop::array::uniform3(-1.0..1.0f64)],
        angle in prop_oneof![Just(0.0), Just(std::f64::consts::FRAC_PI_2), 0.0..1e-7f64, -3.2..3.2f64],
        off in prop_oneof![Just(0.0), -1.0..1.0f64],
        reach in prop_oneof![3 => Just(0.0), 1 => Just(-1.0), 1 => Just(1e-7), 1 => Just(0.3)],
    ) {
        let motion = meeting(&a, &b, (axis, angle), off);
        held::<Aabb>(&a, &b, &motion, reach)?;
        held::<Obb>(&a, &b, &motion, reach)?;
        held::<Sphere>(&a, &b, &motion, reach)?;
        held::<KDop<9>>(&a, &b, &motion, reach)?;
    }
}

/// What brute force says, whatever the numbers: where nobody knows, every pair.
#[test]
fn motions_and_reaches_that_are_no_numbers() {
    let (a, b) = (ball(4, 0.1), ball(3, 0.0));
    let every = a.1.len() * b.1.len();
    let odd_turn = DQuat::from_xyzw(0.0, f64::NAN, 0.0, 1.0);
    let at = |x: f64| Rigid::shift(DVec3::X * x);
    let cases = [
        (at(f64::NAN), 0.0, every),
        (at(f64::INFINITY), 0.0, every),
        (at(f64::NAN), 0.5, every),
        (Rigid::new(odd_turn, DVec3::ZERO), 0.0, every),
        (at(1e30), 0.0, 0),
        (at(1e39), 0.0, 0),
        (at(1e200), 0.0, 0),
        (at(-1e300), 0.5, 0),
        (at(1e200), 1e199, 0),
        (at(1e200), 1e201, every),
        (at(1e9), f64::INFINITY, every),
        (at(50.0), f64::NAN, every),
        (at(50.0), -1.0, 0),
        (at(50.0), f64::NEG_INFINITY, 0),
    ];
    for (motion, reach, count) in cases {
        let expected = brute(&a, &b, &motion, reach);
        assert_eq!(expected.len(), count, "{motion:?} {reach}");
        held::<Aabb>(&a, &b, &motion, reach).unwrap();
        held::<Obb>(&a, &b, &motion, reach).unwrap();
        held::<Sphere>(&a, &b, &motion, reach).unwrap();
        held::<KDop<13>>(&a, &b, &motion, reach).unwrap();
    }
    // A reach below 0 is none: it does not hide what touches.
    assert!(!brute(&a, &b, &Rigid::IDENTITY, 0.0).is_empty());
    assert_eq!(brute(&a, &b, &Rigid::IDENTITY, -9.0), brute(&a, &b, &Rigid::IDENTITY, 0.0));
    held::<Obb>(&a, &b, &Rigid::IDENTITY, -9.0).unwrap();
}

/// A closed body, one with each of its triangles twice over the same corners, and one with corners of their own.
#[test]
fn a_closed_body_that_has_triangles_twice() {
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let own = |mesh: &Mesh| {
        let tree = VolumeTree::<Obb>::over_triangles(&mesh.0, &mesh.1, 1).unwrap();
        own_contacts(&tree, Query::default()).pairs
    };
    let twice = [faces, faces].concat();
    assert_eq!(own(&(corners.clone(), faces.to_vec())), []);
    assert_eq!(own(&(corners.clone(), twice)), [], "all share a corner, or are one and the same");
    let apart: Mesh = (
        [corners.clone(), corners].concat(),
        faces.into_iter().chain(faces.map(|corners| corners.map(|corner| corner + 4))).collect(),
    );
    let all: Vec<(u32, u32)> = (0..4).flat_map(|i| (4..8).map(move |j| (i, j))).collect();
    assert_eq!(own(&apart), all, "every face touches every face of the other");
}

fn node(scene: &mut Scene, parent: Option<u32>, x: f32, mesh: u32) -> u32 {
    scene.add_node(parent, "", Affine3A::from_translation(Vec3::X * x), Some(mesh))
}

/// A chain of nodes: to fit each box to all points below it would take hours.
#[test]
fn a_very_deep_scene() {
    let mut scene = Scene::new("chain");
    let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    scene.meshes.push(SceneMesh::new("triangle", corners, vec![[0, 1, 2]]));
    scene.meshes.push(SceneMesh::new("nothing", vec![], vec![]));
    let mut below = None;
    for i in 0..100_000 {
        below = Some(node(&mut scene, below, 2.0, u32::from(i % 1000 == 999)));
    }
    fn of<V: Overlap>(scene: &Scene) {
        let tree = VolumeTree::<V>::over_nodes(scene);
        assert_eq!(tree.order().len(), 99_900);
        assert!(tree.statistics().depth > 99_000);
        let told = contacts(&tree, &tree, &Rigid::shift(DVec3::Y * 0.5), Query::default()).pairs;
        // Those that touch do; boxes beside each other may.
        assert!(tree.order().iter().all(|&i| told.binary_search(&(i, i)).is_ok()));
        assert!(told.len() <= 3 * tree.order().len());
        let own = own_contacts(&tree, Query::default()).pairs;
        assert!(own.iter().all(|(a, b)| a < b), "none is its own contact");
    }
    of::<Aabb>(&scene);
    of::<Sphere>(&scene);
    of::<AlignedObb>(&scene);
    let whole = VolumeTree::<Aabb>::over_scene(&scene, 4).unwrap();
    assert_eq!(own_contacts(&whole, Query::default()).pairs, []);
}

#[test]
fn meshes_of_nothing() {
    let mut scene = Scene::new("nothing");
    scene.meshes.push(SceneMesh::new("nothing", vec![], vec![]));
    scene.meshes.push(SceneMesh::new("points", vec![Vec3::ONE], vec![]));
    let root = node(&mut scene, None, 0.0, 0);
    node(&mut scene, Some(root), 1.0, 0);
    let tree = VolumeTree::<Obb>::over_nodes(&scene);
    assert!(tree.is_empty() && contacts(&tree, &tree, &Rigid::IDENTITY, Query::default()).pairs.is_empty());
    node(&mut scene, Some(root), 1.0, 1);
    let (tree, whole) =
        (VolumeTree::<Obb>::over_nodes(&scene), VolumeTree::<Obb>::over_scene(&scene, 1).unwrap());
    assert!(whole.is_empty());
    assert_eq!(contacts(&tree, &tree, &Rigid::IDENTITY, Query::default()).pairs, [(2, 2)]);
    assert_eq!(own_contacts(&tree, Query::default()).pairs, []);
    assert_eq!(contacts(&tree, &whole, &Rigid::IDENTITY, Query::default()).pairs, []);
}
