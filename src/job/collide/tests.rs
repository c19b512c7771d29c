//! Queries against brute force: every pair of triangles by the exact test.

use super::*;
use crate::geometry::contact::{self, Triangle};
use crate::geometry::{Aabb, KDop, Obb, Sphere, Volume};
use crate::machine::simulated::Model;
use crate::machine::{Layout, Simulated};
use crate::scheme::tree::share;
use glam::{DQuat, DVec3, Vec3};

mod extremes;

type Mesh = (Vec<Vec3>, Vec<[u32; 3]>);

/// A ball of triangles, open at the poles, with bumps.
fn ball(rings: u32, bumps: f32) -> Mesh {
    let point = |i: u32| {
        let (u, v) = ((i % rings) as f32 / rings as f32, (i / rings) as f32 / rings as f32);
        let (a, b) = (u * std::f32::consts::TAU, (v - 0.5) * 3.0);
        Vec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin())
            * (1.0 + bumps * (a * 5.0).sin() * (b * 7.0).cos())
    };
    let cell = |i: u32| {
        let next = i / rings * rings + (i + 1) % rings;
        [[i, next, i + rings], [next, next + rings, i + rings]]
    };
    ((0..rings * (rings + 1)).map(point).collect(), (0..rings * rings).flat_map(cell).collect())
}

fn brute(a: &Mesh, b: &Mesh, motion: &Rigid, reach: f64) -> Vec<(u32, u32)> {
    let real = |mesh: &Mesh| -> Vec<Triangle> {
        mesh.1.iter().map(|corners| corners.map(|corner| mesh.0[corner as usize].as_dvec3())).collect()
    };
    let moved: Vec<Triangle> = real(b).iter().map(|t| t.map(|corner| motion.point(corner))).collect();
    let mut pairs = Vec::new();
    for (i, s) in (0..).zip(real(a)) {
        pairs.extend((0..).zip(&moved).filter(|(_, t)| contact::closer(&s, t, reach)).map(|(j, _)| (i, j)));
    }
    pairs
}

fn motions() -> Vec<Rigid> {
    let turn = DQuat::from_axis_angle(DVec3::new(0.3, 1.0, -0.2).normalize(), 0.8);
    let mut all =
        vec![Rigid::IDENTITY, Rigid::new(DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2), DVec3::ZERO)];
    for distance in [0.4, 1.7, 1.95, 2.0, 2.2, 9.0] {
        all.push(Rigid::shift(DVec3::X * distance));
        all.push(Rigid::new(turn, DVec3::new(0.0, -distance, 0.1)));
    }
    all
}

fn agrees<V: Overlap>() {
    let (a, b) = (ball(9, 0.2), ball(12, 0.0));
    for leaf in [1, 3] {
        let tree = |mesh: &Mesh| VolumeTree::<V>::over_triangles(&mesh.0, &mesh.1, leaf).unwrap();
        let (tree_a, tree_b) = (tree(&a), tree(&b));
        for motion in motions() {
            for reach in [0.0, 0.15] {
                let expected = brute(&a, &b, &motion, reach);
                let all = contacts(&tree_a, &tree_b, &motion, Query { first: false, reach });
                assert_eq!(all.pairs, expected, "{motion:?} {reach}");
                let one = contacts(&tree_a, &tree_b, &motion, Query { first: true, reach });
                assert_eq!(one.pairs.len(), usize::from(!expected.is_empty()));
                assert!(one.pairs.iter().all(|pair| expected.contains(pair)));
                assert!(one.box_tests <= all.box_tests);
            }
        }
    }
}

#[test]
fn contacts_are_those_of_brute_force_whatever_the_volume() {
    agrees::<Aabb>();
    agrees::<Obb>();
    agrees::<Sphere>();
    agrees::<KDop<7>>();
    agrees::<KDop<9>>();
    agrees::<KDop<13>>();
}

/// Every scheme, both ways of working, on threads and on a simulated machine.
#[test]
fn every_scheme_finds_the_same() {
    let (a, b) = (ball(9, 0.2), ball(12, 0.0));
    let tree = |mesh: &Mesh| VolumeTree::<Obb>::over_triangles(&mesh.0, &mesh.1, 2).unwrap();
    let motion = Rigid::shift(DVec3::new(0.3, 0.1, 0.2));
    let expected = brute(&a, &b, &motion, 0.0);
    assert!(expected.len() > 50);
    fn on<M: Machine>(machine: &M, trees: [VolumeTree<Obb>; 2], motion: &Rigid, expected: &[(u32, u32)]) {
        let [a, b] = trees.map(|tree| SharedTree::new(machine, tree.into()));
        let pair = a.against(&b, motion, 0.0, Unit::best());
        for scheme in crate::scheme::tree::SCHEMES.iter().filter(|s| machine.is_native() || !s.native_only) {
            for first in [false, true] {
                let words = machine.alloc(1, Layout::Packed, |_| M::Word::new(0));
                let stop = first.then_some(&words[0]);
                let batches = share(scheme.name, machine, 3, &BatchWork::new(&pair, stop)).unwrap();
                let batches = Contacts::gather(batches.iter().map(|share| &share.found));
                if first {
                    assert!(!batches.pairs.is_empty(), "{}", scheme.name);
                    assert!(batches.pairs.iter().all(|pair| expected.contains(pair)), "{}", scheme.name);
                } else {
                    assert_eq!(batches.pairs, expected, "{}", scheme.name);
                    let pairs = share(scheme.name, machine, 3, &PairWork::new(&pair, stop)).unwrap();
                    assert_eq!(Contacts::gather(pairs.iter().map(|share| &share.found)).pairs, expected);
                }
            }
        }
    }
    on(&Threads::new(3).unwrap(), [tree(&a), tree(&b)], &motion, &expected);
    on(&Simulated::new(Model::named("e4000").unwrap()), [tree(&a), tree(&b)], &motion, &expected);
}

#[test]
fn a_body_that_folds_touches_itself() {
    let (mut positions, triangles) = ball(14, 0.0);
    let mut body = VolumeTree::<Obb>::over_triangles(&positions, &triangles, 3).unwrap();
    let brute = |positions: &[Vec3]| -> Vec<(u32, u32)> {
        let real = |t: &[u32; 3]| t.map(|corner| positions[corner as usize].as_dvec3());
        let far = |a: &[u32; 3], b: &[u32; 3]| a.iter().all(|corner| !b.contains(corner));
        (0..triangles.len())
            .flat_map(|i| (i + 1..triangles.len()).map(move |j| (i, j)))
            .filter(|&(i, j)| far(&triangles[i], &triangles[j]))
            .filter(|&(i, j)| contact::meet(&real(&triangles[i]), &real(&triangles[j])))
            .map(|(i, j)| (i as u32, j as u32))
            .collect()
    };
    assert_eq!(own_contacts(&body, Query::default()).pairs, brute(&positions));
    for position in &mut positions {
        position.x = if position.z > 0.0 { position.x + position.z * 1.5 } else { position.x };
        position.z = position.z.abs() * 0.3;
    }
    body.refit(&positions).unwrap();
    let expected = brute(&positions);
    assert!(expected.len() > 10);
    assert_eq!(own_contacts(&body, Query::default()).pairs, expected);
    assert_eq!(own_contacts(&body, Query { first: true, reach: 0.0 }).pairs.len(), 1);
}

/// The failure cases of the collision study: touching exactly, coplanar, degenerate, far away, of very different size.
#[test]
fn nasty_bodies() {
    let cube: Mesh = {
        let corners = Aabb { min: Vec3::ZERO, max: Vec3::ONE }.corners().to_vec();
        let faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
        (corners, faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect())
    };
    let needle: Mesh = (vec![Vec3::ZERO, Vec3::X * 2.0, Vec3::X], vec![[0, 1, 2], [0, 0, 0], [1, 1, 2]]);
    let far: Mesh = (cube.0.iter().map(|p| *p + Vec3::splat(1e6)).collect(), cube.1.clone());
    let tiny: Mesh = (cube.0.iter().map(|p| *p * 1e-6).collect(), cube.1.clone());
    let tree = |mesh: &Mesh| VolumeTree::<Obb>::over_triangles(&mesh.0, &mesh.1, 2).unwrap();
    let aside = |x: f64, y: f64| Rigid::shift(DVec3::new(x, y, 0.0));
    let quarter = Rigid::new(DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2), DVec3::new(1.0, 0.0, 0.0));
    let mut some = 0;
    for (a, b) in
        [(&cube, &cube), (&cube, &needle), (&needle, &needle), (&far, &far), (&cube, &tiny), (&tiny, &tiny)]
    {
        for motion in [
            aside(0.0, 0.0),
            aside(1.0, 0.0),
            aside(1.0, 1.0),
            aside(0.5, 0.25),
            aside(1.0 + 1e-9, 0.0),
            quarter,
        ] {
            let expected = brute(a, b, &motion, 0.0);
            some += expected.len();
            assert_eq!(contacts(&tree(a), &tree(b), &motion, Query::default()).pairs, expected, "{motion:?}");
        }
    }
    assert!(some > 100);
    // Bodies a million metres from the origin, brought together by a motion.
    let back = Rigid::shift(DVec3::splat(-1e6));
    let expected = brute(&cube, &far, &back, 0.0);
    assert!(!expected.is_empty());
    let told = contacts(&tree(&cube), &tree(&far), &back, Query::default());
    assert_eq!(told.pairs, expected);
    let nothing = VolumeTree::<Obb>::over_triangles(&[], &[], 2).unwrap();
    assert!(contacts(&nothing, &tree(&cube), &Rigid::IDENTITY, Query::default()).pairs.is_empty());
    assert!(own_contacts(&nothing, Query::default()).pairs.is_empty());
}

/// Scene graphs: leaves are nodes, whose boxes are all there is (Paper II sec. 5).
#[test]
fn scene_nodes_touch_where_their_boxes_do() {
    let scene = crate::scene::by_name("factory-small").unwrap();
    let tree = VolumeTree::<Aabb>::over_nodes(&scene);
    let bounds = scene.world_bounds();
    let motion = Rigid::shift(DVec3::new(3.0, 0.0, 1.0));
    let moved =
        |b: &Aabb| Aabb { min: b.min + Vec3::new(3.0, 0.0, 1.0), max: b.max + Vec3::new(3.0, 0.0, 1.0) };
    let meets = |a: &Aabb, b: &Aabb| a.min.cmple(b.max).all() && b.min.cmple(a.max).all();
    let mut certain = Vec::new();
    for (i, a) in (0..).zip(&bounds) {
        certain.extend(
            (0..).zip(&bounds).filter(|(_, b)| !b.is_empty() && meets(a, &moved(b))).map(|(j, _)| (i, j)),
        );
    }
    let told = contacts(&tree, &tree, &motion, Query::default()).pairs;
    assert!(certain.iter().all(|pair| told.binary_search(pair).is_ok()), "a contact was missed");
    assert!(
        told.len() < certain.len() + certain.len() / 50 + 5,
        "{} told, {} certain",
        told.len(),
        certain.len()
    );
}
