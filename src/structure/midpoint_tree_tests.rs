//! The tree over objects, and the boxes of placed leaves.

use std::num::NonZeroUsize;

use glam::{Affine3A, Vec3};

use super::*;
use crate::geometry::Aabb;
use crate::scene::{Scene, SplitMix64, by_name};
use crate::structure::{PlacedLeaves, TreeStatistics};

fn objects(count: usize, mut place: impl FnMut(usize) -> Vec3) -> Vec<Object> {
    let at = |index| {
        let centre: Vec3 = place(index);
        Object { bounds: Aabb { min: centre - 0.5, max: centre + 0.5 }, triangles: index as u32 + 1 }
    };
    (0..count).map(at).collect()
}

/// What must hold: a valid tree of two children a node, each object in one leaf under its own box.
fn check(objects: &[Object]) -> MidpointStatistics {
    let (tree, statistics) = midpoint_tree(objects);
    tree.validate().unwrap();
    let shape = TreeStatistics::of(&tree);
    assert_eq!(shape.nodes, (2 * objects.len()).saturating_sub(1));
    assert_eq!((shape.leaves, shape.depth), (objects.len(), statistics.depth as usize));
    let mut seen: Vec<u32> = Vec::new();
    for (index, node) in tree.nodes.iter().enumerate() {
        if node.source == NO_SOURCE {
            assert_eq!((tree.children(index as u32).count(), node.triangles), (2, 0));
        } else {
            let object = &objects[node.source as usize];
            assert_eq!((object.bounds, object.triangles), (node.bounds, node.triangles));
            seen.push(node.source);
        }
    }
    seen.sort_unstable();
    assert!(seen.into_iter().eq(0..objects.len() as u32));
    statistics
}

/// The oracle: parts as lists, boxes taken anew from all objects, no threads. None where a median is due.
fn plain(objects: &[Object], part: Vec<u32>, nodes: &mut Vec<SkipNode>) -> Option<()> {
    let here = nodes.len();
    let bounds = part.iter().fold(Aabb::EMPTY, |all, object| all.union(objects[*object as usize].bounds));
    nodes.push(SkipNode { bounds, end: 0, triangles: 0, source: NO_SOURCE });
    if let [only] = part[..] {
        (nodes[here].triangles, nodes[here].source) = (objects[only as usize].triangles, only);
    } else {
        let size = bounds.size().to_array();
        let axis = (0..3).rev().max_by(|a, b| size[*a].total_cmp(&size[*b])).expect("three axes");
        let below = |object: &u32| objects[*object as usize].bounds.centre()[axis] < bounds.centre()[axis];
        let (one, other): (Vec<_>, Vec<_>) = part.into_iter().partition(below);
        if one.is_empty() || other.is_empty() {
            return None;
        }
        plain(objects, one, nodes)?;
        plain(objects, other, nodes)?;
    }
    nodes[here].end = nodes.len() as u32;
    Some(())
}

#[test]
fn trees_without_medians_are_those_of_the_oracle() {
    let mut random = SplitMix64::new(2);
    let mut compared = 0;
    for round in 0..200 {
        let reach = [1.0, 1e-3, 1e6][round % 3];
        let far = [0.0, 4.0][round % 2] * reach as f32;
        let objects = objects(1 + round % 60, |_| {
            Vec3::from([(); 3].map(|()| random.between(-reach, reach) as f32)) + far
        });
        let mut expected = Vec::new();
        let all_midpoints = plain(&objects, (0..objects.len() as u32).collect(), &mut expected).is_some();
        let (tree, statistics) = midpoint_tree(&objects);
        if all_midpoints && statistics.medians == 0 {
            assert_eq!(tree.nodes, expected, "round {round}");
            compared += 1;
        }
    }
    assert!(compared > 20, "{compared}");
}

#[test]
fn every_object_is_a_leaf() {
    let mut random = SplitMix64::new(1);
    let mut point = |_| Vec3::from([(); 3].map(|()| random.between(-100.0, 100.0) as f32));
    for count in [0, 1, 2, 3, 1000, 10_000] {
        let objects = objects(count, &mut point);
        let statistics = check(&objects);
        assert!(statistics.depth <= 40, "depth {} of {count}", statistics.depth);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        assert_eq!(pool.install(|| midpoint_tree(&objects)).0.nodes, midpoint_tree(&objects).0.nodes);
    }
}

#[test]
fn objects_in_one_place_and_outliers_keep_the_depth_bounded() {
    let statistics = check(&objects(1024, |_| Vec3::ONE));
    assert_eq!((statistics.medians, statistics.depth), (1023, 11));
    assert!(check(&objects(120, |index| Vec3::X * 1.9f32.powi(index as i32))).depth <= 40);
    let mut odd = objects(9, |index| Vec3::X * index as f32);
    odd[3].bounds = Aabb::EMPTY;
    let (tree, _) = midpoint_tree(&odd);
    tree.validate().unwrap();
    odd[5].bounds.min.x = f32::NAN;
    odd[6].bounds.max.y = f32::INFINITY;
    let (tree, _) = midpoint_tree(&odd);
    assert_eq!(tree.nodes.iter().filter(|node| node.source != NO_SOURCE).count(), 9);
    // Whatever stands above a NaN may be anywhere on that side.
    let leaf = tree.nodes.iter().position(|node| node.source == 5).unwrap();
    for node in &tree.nodes[..leaf] {
        assert!(node.end as usize <= leaf || node.bounds.min.x == f32::NEG_INFINITY);
    }
}

#[test]
fn placed_boxes_hold_every_vertex_exactly() {
    let mut scene = Scene::new("turned");
    let mesh = scene.add_mesh(by_name("dragon").unwrap().meshes.remove(0));
    for (index, far) in [0.0f32, 3.0, 1e6, -4e7].into_iter().enumerate() {
        let turn = Affine3A::from_axis_angle(Vec3::new(1.0, 2.0, index as f32).normalize(), 0.7 + far);
        let scale = Affine3A::from_scale(Vec3::new(1.0, -3.0, 0.01));
        let place = Affine3A::from_translation(Vec3::splat(far)) * turn * scale;
        scene.add_node(None, "copy", place, Some(mesh));
    }
    let leaves = PlacedLeaves::new(&scene, NonZeroUsize::new(2000).unwrap()).unwrap();
    assert_eq!(leaves.leaves.len(), 4 * leaves.splits[0].leaves.len());
    assert_eq!(leaves.objects.len(), leaves.leaves.len());
    let worlds = scene.world_transforms();
    for (leaf, object) in leaves.leaves.iter().zip(&leaves.objects) {
        let split = &leaves.splits[leaf.mesh as usize];
        let range = split.leaves[leaf.leaf as usize].triangles.clone();
        let world = worlds[leaf.node as usize];
        let (turn, place) = (world.matrix3.as_dmat3(), world.translation.as_dvec3());
        for vertex in split.triangles[range.start as usize..range.end as usize].iter().flatten() {
            let at = turn * scene.meshes[0].positions[*vertex as usize].as_dvec3() + place;
            let (min, max) = (object.bounds.min.as_dvec3(), object.bounds.max.as_dvec3());
            assert!(min.cmple(at).all() && max.cmpge(at).all(), "{at} leaves {:?}", object.bounds);
        }
    }
}
