//! Culling while objects move: every frame against a tree that never saw another, and against the exact test.

use super::*;
use crate::geometry::oracle::{Exact, Hexahedron};
use crate::geometry::{Camera, Lens};
use crate::machine::Threads;
use crate::scene::{self, Mesh, Movers, PATHS, Scene};
use crate::scheme::tree::share;
use crate::structure::{AabbTree, VOLUME_KINDS, VolumeKind};
use glam::{Affine3A, Vec3};

const STEPS: [&str; 8] = [
    "basic",
    "plane",
    "tr",
    "plane+tr+fields",
    "rotation",
    "plane+translation",
    "crossed+octant+tr+pair",
    "plane+mask+tr+fields",
];

fn cull(threads: &Threads, tree: &CullTree<Threads>, frustum: &Frustum, steps: Steps) -> (Vec<u32>, u64) {
    let frame = Frame::new(tree, 0, frustum, steps).unwrap();
    let shares = share("serial", threads, 1, &frame.ranges()).unwrap();
    let tests = shares.iter().map(|share| share.found.plane_tests).sum();
    (tree.visible(shares.iter().map(|share| &share.found)), tests)
}

/// The oracle: a descent by the exact test. The volume of a node need not hold those below it, only their triangles.
fn must_see(moving: &MovingTree, camera: &Camera) -> Vec<u32> {
    let (exact, nodes) = (Hexahedron::new(camera), &moving.tree().nodes);
    fn meets<V: Exact>(volumes: &[V], exact: &Hexahedron, node: usize) -> bool {
        exact.intersects(&volumes[node])
    }
    let meets = |node: usize| match moving.volumes() {
        Volumes::Aabb => exact.intersects(&nodes[node].bounds),
        Volumes::Obb(volumes) => meets(volumes, &exact, node),
        Volumes::Sphere(volumes) => meets(volumes, &exact, node),
        Volumes::Dop14(volumes) => meets(volumes, &exact, node),
        Volumes::Dop18(volumes) => meets(volumes, &exact, node),
        Volumes::Dop26(volumes) => meets(volumes, &exact, node),
    };
    let (mut seen, mut node) = (Vec::new(), 0);
    while node < nodes.len() {
        if !meets(node) {
            node = nodes[node].end as usize;
            continue;
        }
        if nodes[node].triangles > 0 {
            seen.push(node as u32);
        }
        node += 1;
    }
    seen
}

fn kind(name: &str) -> &'static VolumeKind {
    VOLUME_KINDS.iter().find(|kind| kind.name == name).unwrap()
}

/// A scene's moving tree and, beside it, one to be culled.
fn both(threads: &Threads, scene: &Scene, kind: &VolumeKind) -> (MovingTree, CullTree<Threads>) {
    let moving = MovingTree::new(scene, SkipTree::build(&AabbTree::build(scene)), kind);
    let tree = CullTree::with_volumes(threads, moving.tree(), moving.volumes(), History::Distances);
    (moving, tree)
}

/// Culls a frame by a tree that looks back and holds it against one that does not; that one's own against the exact
/// test, once for all steps, for that is slow.
fn check(
    threads: &Threads,
    (moving, tree): (&MovingTree, &CullTree<Threads>),
    camera: &Camera,
    words: &str,
    what: &str,
) -> Vec<u32> {
    let frustum = Frustum::new(camera);
    let (found, _) = cull(threads, tree, &frustum, words.parse().unwrap());
    let must_see = if words == "basic" { must_see(moving, camera) } else { Vec::new() };
    for node in must_see {
        assert!(found.binary_search(&node).is_ok(), "{what}: visible node {node} was culled");
    }
    let fresh = CullTree::with_volumes(threads, moving.tree(), moving.volumes(), History::Plane);
    // Carried distances are in doubt a little earlier or later than tested ones; here nothing is so near a plane.
    assert_eq!(found, cull(threads, &fresh, &frustum, Steps::BASIC).0, "{what}");
    found
}

#[test]
fn every_frame_of_moving_objects_is_culled_as_if_it_were_the_first() {
    let scene = scene::by_name("factory-small").unwrap();
    let threads = Threads::new(1).unwrap();
    let mut seen = 0;
    for kind in VOLUME_KINDS {
        for (path, share) in PATHS.iter().flat_map(|path| [0.05, 1.0].map(|share| (path, share))) {
            let cameras = path.make(&scene, 6, 5).frames;
            for words in STEPS {
                let (mut moving, mut tree) = both(&threads, &scene, kind);
                let leaves =
                    (0..scene.nodes.len() as u32).filter(|i| scene.nodes[*i as usize].mesh.is_some());
                let movers = Movers::new(&scene, leaves.collect(), share, 3);
                for (number, camera) in cameras.iter().enumerate() {
                    // Ten frames of the round in one, so that things come into view and go.
                    for (node, transform) in movers.transforms(10 * number) {
                        moving.set_transform(node, transform);
                    }
                    moving.refit();
                    tree.refit(&moving);
                    let what = format!("{}, {}, {share}, {words}, frame {number}", kind.name, path.name);
                    seen += check(&threads, (&moving, &tree), camera, words, &what).len();
                }
            }
        }
    }
    assert!(seen > 1000, "the paths see something: {seen}");
}

/// Some boxes ahead of a camera and some beside it, all under one root.
fn beside_and_ahead() -> (Scene, Camera) {
    let mut scene = Scene::new("few");
    let spike = vec![Vec3::ZERO, Vec3::X, Vec3::new(0.2, 1.0, 0.1), Vec3::new(-0.5, 0.5, 0.7)];
    let mesh = scene.add_mesh(Mesh::new("spike", spike, vec![[0, 1, 2], [0, 2, 3]]));
    let root = scene.add_node(None, "root", Affine3A::IDENTITY, None);
    for way in [-30.0, -20.0, 0.0, 20.0, 30.0] {
        let place = Affine3A::from_translation(Vec3::new(way, 0.0, -20.0));
        scene.add_node(Some(root), "part", place, Some(mesh));
    }
    let lens = Lens::Symmetric { fov_y: 0.6, aspect: 1.2 };
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, lens, 0.1, 50.0).unwrap();
    (scene, camera)
}

#[test]
fn what_moves_into_view_is_found_in_that_very_frame() {
    let (scene, start) = beside_and_ahead();
    let threads = Threads::new(1).unwrap();
    let turned = |camera: &Camera, angle: f32| {
        let turn = glam::Quat::from_rotation_y(angle);
        Camera { right: turn * camera.right, forward: turn * camera.forward, ..*camera }
    };
    type Way<'a> = (&'a str, &'a dyn Fn(&Camera, usize) -> Camera);
    let ways: [Way<'_>; 3] = [
        ("standing", &|camera, _| *camera),
        ("shifting", &|camera, i| Camera { eye: camera.eye + Vec3::X * (0.01 * i as f32), ..*camera }),
        ("turning", &|camera, i| turned(camera, 0.01 * i as f32)),
    ];
    for (kind, (way, at)) in VOLUME_KINDS.iter().flat_map(|kind| ways.map(|way| (kind, way))) {
        for words in STEPS {
            let (mut moving, mut tree) = both(&threads, &scene, kind);
            for frame in 0..12 {
                // Scene node 1, tree node 1, is outside on the left, then ahead, then outside again.
                let x = if (5..9).contains(&frame) { 1.0 } else { -30.0 };
                moving.set_transform(1, Affine3A::from_translation(Vec3::new(x, 0.0, -20.0)));
                moving.refit();
                tree.refit(&moving);
                let what = format!("{}, {way}, {words}, frame {frame}", kind.name);
                let found = check(&threads, (&moving, &tree), &at(&start, frame), words, &what);
                assert_eq!(found.contains(&1), (5..9).contains(&frame), "{what}: {found:?}");
            }
        }
    }
}

/// What stays where it is keeps what is known of it: only what moved, and what is around it, is tested anew.
#[test]
fn only_what_changed_is_forgotten() {
    let (scene, camera) = beside_and_ahead();
    let threads = Threads::new(1).unwrap();
    let (mut moving, mut tree) = both(&threads, &scene, kind("aabb"));
    // Once moved, its box is larger by a rounding, and so is the root's that stood as close.
    moving.set_transform(2, Affine3A::from_translation(Vec3::new(-20.5, 0.0, -20.0)));
    assert_eq!(moving.refit(), [2, 0]);
    tree.refit(&moving);
    let steps: Steps = "plane+tr".parse().unwrap();
    let tests_of = |tree: &CullTree<Threads>, frame: usize| {
        let eye = camera.eye + Vec3::X * (0.001 * frame as f32);
        cull(&threads, tree, &Frustum::new(&Camera { eye, ..camera }), steps).1
    };
    let still: Vec<u64> = (0..5).map(|frame| tests_of(&tree, frame)).collect();
    assert_eq!(still[2..], [0, 0, 0], "all is carried over: {still:?}");
    moving.set_transform(2, Affine3A::from_translation(Vec3::new(-21.0, 0.0, -20.0)));
    assert_eq!(moving.refit(), [2], "between others it changes nothing about the box around them");
    tree.refit(&moving);
    let after = tests_of(&tree, 5);
    assert!(after > 0 && after < still[0], "{after} of {} tests", still[0]);
    assert_eq!(tests_of(&tree, 6), 0, "and known from then on");
}

#[test]
fn what_is_lost_is_seen_until_it_is_found_again() {
    let (scene, camera) = beside_and_ahead();
    let threads = Threads::new(1).unwrap();
    for (kind, words) in VOLUME_KINDS.iter().flat_map(|kind| STEPS.map(|words| (kind, words))) {
        let (mut moving, mut tree) = both(&threads, &scene, kind);
        let mut frame = |moving: &mut MovingTree, to: Vec3, what: &str| {
            moving.set_transform(2, Affine3A::from_translation(to));
            moving.refit();
            tree.refit(moving);
            check(&threads, (moving, &tree), &camera, words, &format!("{}, {words}, {what}", kind.name))
        };
        let outside = Vec3::new(-20.0, 0.0, -20.0);
        for lost in [Vec3::NAN, Vec3::splat(f32::INFINITY), Vec3::new(f32::MAX, 0.0, f32::NAN)] {
            assert_eq!(frame(&mut moving, outside, "outside"), [3]);
            assert_eq!(frame(&mut moving, lost, "lost"), [2, 3], "{}, {words}: {lost}", kind.name);
            assert_eq!(frame(&mut moving, outside, "found"), [3]);
            assert_eq!(frame(&mut moving, Vec3::new(1e30, 0.0, 0.0), "far away").last(), Some(&3));
            assert_eq!(frame(&mut moving, Vec3::new(0.0, 0.0, -10.0), "ahead"), [2, 3]);
        }
    }
}

#[test]
fn a_single_leaf_and_no_leaf_at_all() {
    let threads = Threads::new(1).unwrap();
    let (_, camera) = beside_and_ahead();
    let (mut moving, mut tree) = both(&threads, &Scene::new("nothing"), kind("aabb"));
    moving.refit();
    tree.refit(&moving);
    assert!(check(&threads, (&moving, &tree), &camera, "plane+tr", "nothing").is_empty());
    let mut scene = Scene::new("one");
    let mesh = scene.add_mesh(Mesh::new("one", vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
    scene.add_node(None, "one", Affine3A::from_translation(Vec3::X * 30.0), Some(mesh));
    for kind in VOLUME_KINDS {
        let (mut moving, mut tree) = both(&threads, &scene, kind);
        for (x, count) in [(30.0, 0), (30.0, 0), (0.0, 1), (0.0, 1), (30.0, 0)] {
            moving.set_transform(0, Affine3A::from_translation(Vec3::new(x, 0.0, -20.0)));
            moving.refit();
            tree.refit(&moving);
            let what = format!("{} at {x}", kind.name);
            assert_eq!(check(&threads, (&moving, &tree), &camera, "plane+tr", &what).len(), count, "{what}");
        }
    }
}

#[test]
#[should_panic(expected = "of the kind that the tree was made with")]
fn a_tree_takes_no_volumes_of_another_kind() {
    let (scene, _) = beside_and_ahead();
    let threads = Threads::new(1).unwrap();
    let (_, mut tree) = both(&threads, &scene, kind("sphere"));
    tree.refit(&both(&threads, &scene, kind("obb")).0);
}
