//! The volumes after any moves against the placed vertices, and against a tree built anew over the moved scene.

use glam::{DMat3, DVec3, Quat, Vec3};

use super::*;
use crate::geometry::Volume;
use crate::scene::{Mesh, SplitMix64};
use crate::structure::{AabbTree, VOLUME_KINDS};

fn spike() -> Mesh {
    let points = vec![Vec3::ZERO, Vec3::X, Vec3::new(0.2, 3.0, 0.1), Vec3::new(-0.5, 0.5, 0.7)];
    Mesh::new("spike", points, vec![[0, 1, 2], [0, 2, 3]])
}

fn moving(scene: &Scene, kind: &VolumeKind) -> MovingTree {
    scene.validate().unwrap();
    MovingTree::new(scene, SkipTree::build(&AabbTree::build(scene)), kind)
}

fn kind(name: &str) -> &'static VolumeKind {
    VOLUME_KINDS.iter().find(|kind| kind.name == name).unwrap()
}

fn number(random: &mut SplitMix64, size: f64) -> f32 {
    random.between(-size, size) as f32
}

fn vector(random: &mut SplitMix64, size: f64) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| number(random, size)))
}

/// Rigid, or one in five stretched or flattened; some of it far away.
fn transform(random: &mut SplitMix64) -> Affine3A {
    let axis = vector(random, 1.0).try_normalize().unwrap_or(Vec3::Y);
    let turn = Quat::from_axis_angle(axis, number(random, 4.0));
    let scale = match random.below(10) {
        0 => Vec3::new(2.0, -0.5, 1.0),
        1 => Vec3::new(1.0, 0.0, 1.0),
        _ => Vec3::ONE,
    };
    let far = if random.below(8) == 0 { 1e4 } else { 5.0 };
    Affine3A::from_scale_rotation_translation(scale, turn, vector(random, far))
}

fn any_scene(random: &mut SplitMix64, nodes: usize) -> Scene {
    let mut scene = Scene::new("random");
    let mesh = scene.add_mesh(spike());
    for index in 0..nodes {
        let parent = Some(index).filter(|index| *index > 0 && random.below(9) > 0);
        let parent = parent.map(|index| random.below(index) as u32);
        let (place, own) = (transform(random), Some(mesh).filter(|_| random.below(3) > 0));
        scene.add_node(parent, "node", place, own);
    }
    scene
}

/// By how much a point sticks out of a node's volume, metres.
fn sticks_out(volumes: &Volumes, node: usize, point: Vec3) -> f32 {
    fn slabs<const D: usize>(volume: &crate::geometry::KDop<D>, point: Vec3) -> f32 {
        let out = |(direction, low, high): (Vec3, f32, f32)| {
            (low - direction.dot(point)).max(direction.dot(point) - high)
        };
        volume.slabs().map(out).fold(f32::MIN, f32::max)
    }
    match volumes {
        Volumes::Aabb => f32::MIN,
        Volumes::Obb(all) => {
            let [x, y, z] = all[node].axes().map(Vec3::as_dvec3);
            let inverse = DMat3::from_cols(x, y, z).inverse();
            let at = inverse * (point - all[node].centre()).as_dvec3();
            // Axes of what was stretched may lie nearly in a plane: coordinates are then longer than the way out.
            let longest = inverse.transpose();
            let longest = [longest.x_axis, longest.y_axis, longest.z_axis]
                .map(DVec3::length)
                .into_iter()
                .fold(1.0, f64::max);
            ((at.abs() - all[node].half().as_dvec3()).max_element() / longest) as f32
        }
        Volumes::Sphere(all) => point.distance(all[node].centre) - all[node].radius,
        Volumes::Dop14(all) => slabs(&all[node], point),
        Volumes::Dop18(all) => slabs(&all[node], point),
        Volumes::Dop26(all) => slabs(&all[node], point),
    }
}

/// The oracle: every vertex, placed by the scene graph's own transforms, in its node's volume and all above.
fn holds_everything(scene: &Scene, moving: &MovingTree, what: &str) {
    let (tree, world) = (moving.tree(), scene.world_transforms());
    for (at, node) in tree.nodes.iter().enumerate() {
        for (below, under) in tree.nodes.iter().enumerate().take(node.end as usize).skip(at) {
            let Some(source) = scene.nodes.get(under.source as usize) else { continue };
            assert_eq!(moving.world(below as u32), world[under.source as usize], "{what}, node {below}");
            let Some(mesh) = source.mesh else { continue };
            for position in &scene.meshes[mesh as usize].positions {
                let point = world[under.source as usize].transform_point3(*position);
                // Where f32 puts a vertex is only near to where the transforms do; they may be long and cancel.
                let placed = world[under.source as usize];
                let size = |axis: Vec3A| axis.abs().max_element();
                let stretch = size(placed.x_axis).max(size(placed.y_axis)).max(size(placed.z_axis));
                let room = 1e-5 * (1.0 + point.abs().max_element() + stretch + size(placed.translation));
                let bounds = Aabb { min: node.bounds.min - room, max: node.bounds.max + room };
                assert!(bounds.contains(&Aabb { min: point, max: point }), "{what}, node {at}: box");
                let out = sticks_out(moving.volumes(), at, point);
                assert!(out <= 2.0 * room, "{what}, node {at}: volume, by {out} m");
            }
        }
    }
}

/// The nodes whose box or volume is another in the two.
fn differences(before: &(SkipTree, Volumes), after: &MovingTree) -> Vec<u32> {
    fn differ<V: PartialEq>(a: &[V], b: &[V], node: usize) -> bool {
        a[node] != b[node]
    }
    let volume = |node: usize| match (&before.1, after.volumes()) {
        (Volumes::Aabb, Volumes::Aabb) => false,
        (Volumes::Obb(a), Volumes::Obb(b)) => differ(a, b, node),
        (Volumes::Sphere(a), Volumes::Sphere(b)) => differ(a, b, node),
        (Volumes::Dop14(a), Volumes::Dop14(b)) => differ(a, b, node),
        (Volumes::Dop18(a), Volumes::Dop18(b)) => differ(a, b, node),
        (Volumes::Dop26(a), Volumes::Dop26(b)) => differ(a, b, node),
        _ => panic!("another kind"),
    };
    let nodes = 0..before.0.nodes.len();
    let boxes = |node: usize| before.0.nodes[node].bounds != after.tree().nodes[node].bounds;
    nodes.filter(|&node| boxes(node) || volume(node)).map(|node| node as u32).collect()
}

#[test]
fn after_any_moves_every_volume_holds_what_is_below_it() {
    let mut random = SplitMix64::new(3);
    for round in 0..40 {
        let count = 1 + random.below(40);
        let mut scene = any_scene(&mut random, count);
        for kind in VOLUME_KINDS {
            let mut tree = moving(&scene, kind);
            for step in 0..6 {
                let before = (tree.tree().clone(), tree.volumes().clone());
                for _ in 0..random.below(4) {
                    // Inner nodes too, some twice, some below others that move.
                    let node = random.below(count);
                    scene.nodes[node].transform = transform(&mut random);
                    tree.set_transform(node as u32, scene.nodes[node].transform);
                }
                tree.refit();
                let what = format!("{}, round {round}, step {step}", kind.name);
                holds_everything(&scene, &tree, &what);
                tree.tree().validate().expect(&what);
                let mut changed = tree.changed().to_vec();
                assert!(changed.is_sorted_by(|a, b| a > b), "{what}: each before the one above it, once");
                changed.reverse();
                assert_eq!(changed, differences(&before, &tree), "{what}");
            }
        }
    }
}

/// Parts under parts that stand along the axes: what shifts is as tight as if it had been built there.
#[test]
fn shifted_boxes_are_those_of_a_tree_built_anew() {
    let mut scene = Scene::new("shifted");
    let mesh = scene.add_mesh(spike());
    let mut random = SplitMix64::new(5);
    for index in 0..60 {
        let parent = Some(index).filter(|index| *index > 0).map(|index| random.below(index) as u32);
        let place = Affine3A::from_translation(vector(&mut random, 4.0));
        scene.add_node(parent, "node", place, Some(mesh));
    }
    let mut tree = moving(&scene, kind("aabb"));
    for _ in 0..20 {
        let node = random.below(60);
        scene.nodes[node].transform = Affine3A::from_translation(vector(&mut random, 4.0));
        tree.set_transform(node as u32, scene.nodes[node].transform);
        tree.refit();
        let anew = SkipTree::build(&AabbTree::build(&scene));
        for (kept, built) in tree.tree().nodes.iter().zip(&anew.nodes) {
            let off = (kept.bounds.min - built.bounds.min).abs() + (kept.bounds.max - built.bounds.max).abs();
            assert!(off.max_element() < 1e-4, "{:?} where {:?} would be built", kept.bounds, built.bounds);
        }
    }
}

#[test]
fn volumes_do_not_grow_however_often_things_move_away_and_back() {
    let mut random = SplitMix64::new(11);
    let scene = any_scene(&mut random, 30);
    for kind in VOLUME_KINDS {
        let mut tree = moving(&scene, kind);
        let away = |tree: &mut MovingTree, way: f32| {
            (0..30).for_each(|node| tree.set_transform(node, Affine3A::from_translation(Vec3::splat(way))));
            tree.refit();
            let there = (tree.tree().clone(), tree.volumes().clone());
            (0..30).for_each(|node| tree.set_transform(node, scene.nodes[node as usize].transform));
            tree.refit();
            there
        };
        away(&mut tree, 1.0);
        let back = (tree.tree().clone(), tree.volumes().clone());
        for way in [1.0, 1e6, 1e37, f32::INFINITY, f32::NAN].repeat(20) {
            let there = away(&mut tree, way);
            assert!(!differences(&there, &tree).is_empty(), "{}: something moved by {way}", kind.name);
            let tight = back.0.nodes.iter().zip(&tree.tree().nodes).all(|(a, b)| a.bounds == b.bounds);
            assert!(tight, "{}: boxes, back from {way}", kind.name);
            // The axes of an oriented box around others are those it had, wherever it is.
            assert!(differences(&back, &tree).is_empty(), "{}: back from {way}", kind.name);
        }
    }
}

/// A mesh far from where it began, and far from its own origin: what it is held against is placed where it is now.
#[test]
fn where_things_were_at_first_leaves_no_trace() {
    let mut scene = Scene::new("from afar");
    let mesh = scene.add_mesh(spike());
    let afar = Affine3A::from_rotation_translation(Quat::from_rotation_y(0.3), Vec3::new(3e6, -1e6, 2e6));
    let node = scene.add_node(None, "part", afar, Some(mesh));
    for kind in VOLUME_KINDS {
        let (mut tree, mut scene) = (moving(&scene, kind), scene.clone());
        scene.nodes[0].transform = Affine3A::from_rotation_y(1.0);
        tree.set_transform(node, scene.nodes[0].transform);
        tree.refit();
        holds_everything(&scene, &tree, kind.name);
        assert!(tree.tree().nodes[0].bounds.half_diagonal() < 3.0, "{}", kind.name);
    }
}

#[test]
fn what_is_lost_is_nowhere_and_all_above_it() {
    for kind in VOLUME_KINDS {
        let mut scene = Scene::new("two arms");
        let mesh = scene.add_mesh(spike());
        let root = scene.add_node(None, "root", Affine3A::IDENTITY, None);
        let [left, right] =
            ["left", "right"].map(|name| scene.add_node(Some(root), name, Affine3A::IDENTITY, None));
        let tip = scene.add_node(Some(left), "tip", Affine3A::IDENTITY, Some(mesh));
        for (above, way) in [(left, Vec3::X), (right, Vec3::Y), (right, Vec3::Z)] {
            scene.add_node(Some(above), "part", Affine3A::from_translation(way), Some(mesh));
        }
        let mut tree = moving(&scene, kind);
        for lost in [Vec3::NAN, Vec3::splat(f32::INFINITY), Vec3::splat(f32::MAX)] {
            tree.set_transform(tip, Affine3A::from_translation(lost));
            assert_eq!(tree.refit(), [2, 1, 0], "{}: the tip, its arm, the root", kind.name);
            let nan: Vec<bool> = tree.tree().nodes.iter().map(|node| node.bounds.is_nan()).collect();
            assert_eq!(nan, [true, true, true, false, false, false, false], "{}: {lost}", kind.name);
            tree.set_transform(tip, Affine3A::IDENTITY);
            tree.refit();
            tree.tree().validate().unwrap();
            holds_everything(&scene, &tree, kind.name);
        }
    }
}

#[test]
fn nothing_to_move_the_only_leaf_and_nodes_that_place_nothing() {
    let mut scene = Scene::new("one");
    assert!(moving(&scene, kind("obb")).refit().is_empty(), "an empty tree");
    let mesh = scene.add_mesh(spike());
    let bare = scene.add_node(None, "bare", Affine3A::IDENTITY, None);
    let only = scene.add_node(None, "only", Affine3A::IDENTITY, Some(mesh));
    for kind in VOLUME_KINDS {
        let mut tree = moving(&scene, kind);
        tree.set_transform(bare, Affine3A::from_translation(Vec3::X));
        tree.set_transform(only, Affine3A::IDENTITY);
        assert!(tree.refit().is_empty(), "{}: nothing moved", kind.name);
        let mut moved = scene.clone();
        moved.nodes[1].transform = transform(&mut SplitMix64::new(1));
        tree.set_transform(only, moved.nodes[1].transform);
        assert_eq!(tree.refit(), [0], "{}", kind.name);
        holds_everything(&moved, &tree, kind.name);
        assert!(tree.refit().is_empty(), "{}: once is enough", kind.name);
    }
}
