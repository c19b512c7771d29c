use super::*;
use crate::geometry::oracle::Hexahedron;
use crate::geometry::{Aabb, Camera, Lens};
use crate::machine::{Simulated, Threads, simulated::Model};
use crate::scene::{self, CameraPath};
use crate::scheme::tree::{SCHEMES, Scheme, Share, share};
use crate::structure::AabbTree;
use glam::Vec3;
use std::collections::BTreeMap;

fn small() -> (SkipTree, CameraPath) {
    let scene = scene::by_name("factory-small").unwrap();
    let path = CameraPath::for_scene(&scene, 12, 1);
    (SkipTree::build(&AabbTree::build(&scene)), path)
}

fn found(shares: &[Share<Visible>]) -> impl Iterator<Item = &Visible> {
    shares.iter().map(|share| &share.found)
}

/// The oracle: every node with triangles whose box meets the frustum, by the exact test, one by one.
fn must_see(tree: &SkipTree, camera: &Camera) -> Vec<u32> {
    let exact = Hexahedron::new(camera);
    let seen =
        |(_, node): &(u32, &crate::structure::SkipNode)| node.triangles > 0 && exact.intersects(&node.bounds);
    (0..).zip(&tree.nodes).filter(seen).map(|(i, _)| i).collect()
}

#[test]
fn every_scheme_and_machine_finds_the_serial_set_and_nothing_visible_is_lost() {
    let (skip, path) = small();
    let threads = Threads::new(4).unwrap();
    let e4000 = Simulated::new(Model::named("e4000").unwrap());
    let (native, simulated) =
        (CullTree::new(&threads, &skip, History::Plane), CullTree::new(&e4000, &skip, History::Distances));
    let mut seen = 0;
    for (number, camera) in path.frames.iter().enumerate() {
        let frustum = Frustum::new(camera);
        let native = Frame::new(&native, number, &frustum, Tests::default()).unwrap();
        let simulated = Frame::new(&simulated, number, &frustum, Tests::default()).unwrap();
        let serial = share("serial", &threads, 1, &native.ranges()).unwrap();
        let serial = native.tree.visible(found(&serial));
        for node in must_see(&skip, camera) {
            assert!(serial.binary_search(&node).is_ok(), "frame {number}: visible node {node} was culled");
        }
        seen += serial.len();
        for name in SCHEMES.iter().map(|scheme| scheme.name) {
            for processors in [1, 2, 4] {
                let shares = share(name, &threads, processors, &native.ranges()).unwrap();
                assert_eq!(native.tree.visible(found(&shares)), serial, "{name} on {processors} threads");
                let shares = share(name, &threads, processors, &native.nodes()).unwrap();
                assert_eq!(native.tree.visible(found(&shares)), serial, "{name} by nodes");
            }
            for processors in [1, 2, 7, 13] {
                let Ok(shares) = share(name, &e4000, processors, &simulated.ranges()) else {
                    assert!(["crossbeam_deque", "rayon_join"].contains(&name));
                    continue;
                };
                assert_eq!(
                    simulated.tree.visible(found(&shares)),
                    serial,
                    "{name} on {processors} simulated"
                );
            }
        }
    }
    assert!(seen > 100, "the walk sees something: {seen}");
}

#[test]
fn every_combination_of_tests_and_descents_finds_the_same() {
    let (skip, path) = small();
    let threads = Threads::new(1).unwrap();
    let tree = CullTree::new(&threads, &skip, History::Plane);
    for (number, camera) in path.frames.iter().enumerate() {
        let frustum = Frustum::new(camera);
        let mut sets = Vec::new();
        for (plane_coherency, octant) in [(false, false), (true, false), (false, true), (true, true)] {
            for descent in [Descent::Pruned, Descent::NoWork] {
                let tests = Tests { plane_coherency, octant };
                let frame = Frame::new(&tree, number, &frustum, tests).unwrap().descent(descent);
                let shares = share("serial", &threads, 1, &frame.ranges()).unwrap();
                sets.push(tree.visible(found(&shares)));
            }
        }
        sets.dedup();
        assert_eq!(sets.len(), 1, "frame {number}");
    }
}

#[test]
fn the_whole_tree_is_visited_when_asked() {
    let (skip, path) = small();
    let threads = Threads::new(2).unwrap();
    let tree = CullTree::new(&threads, &skip, History::Plane);
    let frustum = Frustum::new(&path.frames[0]);
    let frame = Frame::new(&tree, 0, &frustum, Tests::default()).unwrap().descent(Descent::WholeTree);
    let mut scheme = Scheme::new("lock_free", &threads, 2, BTreeMap::new()).unwrap();
    let shares = scheme.run(&threads, &frame.ranges()).unwrap();
    assert_eq!(shares.iter().map(|s| s.visited).sum::<u64>(), 254);
}

#[test]
fn an_asymmetric_frustum_refuses_the_octant_test() {
    let lens = Lens::OffAxis { left: -0.5, right: 0.2, bottom: -0.3, top: 0.3 };
    let camera = Camera::look_at(Vec3::ZERO, Vec3::X, Vec3::Z, lens, 0.1, 10.0).unwrap();
    let frustum = Frustum::new(&camera);
    let threads = Threads::new(1).unwrap();
    let tree = CullTree::new(&threads, &SkipTree::default(), History::Plane);
    let error = Frame::new(&tree, 7, &frustum, Tests::default()).err().unwrap();
    assert!(error.to_string().contains("frame 7"));
    let tests = Tests { octant: false, ..Tests::default() };
    let frame = Frame::new(&tree, 7, &frustum, tests).unwrap();
    assert_eq!(share("serial", &threads, 1, &frame.ranges()).unwrap()[0].visited, 0, "an empty tree");
}

#[test]
fn what_is_not_a_number_is_never_culled() {
    let camera =
        Camera::look_at(Vec3::ZERO, Vec3::X, Vec3::Z, Lens::Symmetric { fov_y: 1.0, aspect: 1.0 }, 0.1, 10.0);
    let frustum = Frustum::new(&camera.unwrap());
    let threads = Threads::new(1).unwrap();
    let bounds = Aabb { min: Vec3::splat(f32::NAN), max: Vec3::splat(1.0) };
    let node = crate::structure::SkipNode { bounds, end: 1, triangles: 1, source: 0 };
    let tree = CullTree::new(&threads, &SkipTree { nodes: vec![node] }, History::Plane);
    let frame = Frame::new(&tree, 0, &frustum, Tests::default()).unwrap();
    let shares = share("serial", &threads, 1, &frame.ranges()).unwrap();
    assert_eq!(tree.visible(found(&shares)), [0]);
}
