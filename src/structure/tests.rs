//! The trees over chains, stars, forests and random scenes.

use std::collections::HashMap;

use glam::{Affine3A, Vec3};

use super::*;
use crate::scene::{Mesh, Scene, SplitMix64};

fn triangle() -> Mesh {
    Mesh::new("triangle", vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])
}

fn trees(scene: &Scene) -> (AabbTree, SkipTree, TreeStatistics) {
    scene.validate().unwrap();
    let tree = AabbTree::build(scene);
    tree.validate().unwrap();
    let skip = SkipTree::build(&tree);
    skip.validate().unwrap();
    let statistics = TreeStatistics::of(&skip);
    assert_eq!(statistics.leaf_depths.iter().sum::<usize>(), statistics.leaves);
    assert_eq!(statistics.triangles as usize, scene.instances().1);
    (tree, skip, statistics)
}

#[test]
fn empty_scenes_give_empty_trees() {
    let mut scene = Scene::new("empty");
    assert_eq!(trees(&scene).2, TreeStatistics::default());
    scene.add_node(None, "bare", Affine3A::IDENTITY, None);
    assert!(trees(&scene).0.nodes.is_empty());
}

#[test]
fn long_chains_and_wide_stars() {
    let count = 100_000;
    let (mut chain, mut star) = (Scene::new("chain"), Scene::new("star"));
    let (link, ray) = (chain.add_mesh(triangle()), star.add_mesh(triangle()));
    let mut above = None;
    let root = star.add_node(None, "root", Affine3A::IDENTITY, None);
    for _ in 0..count {
        above = Some(chain.add_node(above, "link", Affine3A::from_translation(Vec3::X), Some(link)));
        star.add_node(Some(root), "ray", Affine3A::from_translation(Vec3::Y), Some(ray));
    }
    let (_, skip, statistics) = trees(&chain);
    assert_eq!((statistics.depth, statistics.leaves, statistics.widest_fan_out), (count, 1, 1));
    assert!(skip.nodes.iter().all(|node| node.end as usize == count));
    let (_, skip, statistics) = trees(&star);
    assert_eq!((statistics.depth, statistics.leaves, statistics.widest_fan_out), (2, count, count));
    assert_eq!(skip.children(0).count(), count);
}

#[test]
fn nodes_without_geometry_go_and_several_roots_get_one_over_them() {
    let mut scene = Scene::new("forest");
    let mesh = scene.add_mesh(triangle());
    let first = scene.add_node(None, "first", Affine3A::IDENTITY, Some(mesh));
    scene.add_node(Some(first), "bare", Affine3A::IDENTITY, None);
    scene.add_node(Some(first), "leaf", Affine3A::from_translation(Vec3::Z), Some(mesh));
    scene.add_node(None, "second", Affine3A::from_translation(Vec3::X * 9.0), Some(mesh));
    let (tree, skip, statistics) = trees(&scene);
    assert_eq!(tree.nodes.iter().map(|node| node.source).collect::<Vec<_>>(), [NO_SOURCE, 0, 2, 3]);
    assert_eq!(skip.nodes.iter().map(|node| node.end).collect::<Vec<_>>(), [4, 3, 3, 4]);
    assert_eq!(skip.children(0).collect::<Vec<_>>(), [1, 3]);
    assert_eq!(tree.nodes[1].mesh, Some(mesh), "a mesh on an inner node is kept");
    assert_eq!((statistics.depth, statistics.leaf_depths), (3, vec![0, 1, 1]));
    assert_eq!(statistics.max_heaviest_share, 2.0 / 3.0);
}

#[test]
fn random_trees_agree_with_the_graph() {
    let mut random = SplitMix64::new(7);
    for _ in 0..200 {
        let mut scene = Scene::new("random");
        let mesh = scene.add_mesh(triangle());
        for index in 0..random.below(60) {
            let parent = if index == 0 { None } else { Some(random.below(index) as u32) };
            let place = Affine3A::from_translation(Vec3::splat(random.between(-9.0, 9.0) as f32));
            let own = Some(mesh).filter(|_| random.below(3) > 0);
            scene.add_node(parent, "node", place, own);
        }
        let (tree, skip, _) = trees(&scene);
        assert_eq!(tree.nodes.len(), skip.nodes.len());
        let place: HashMap<u32, usize> =
            skip.nodes.iter().enumerate().map(|(place, node)| (node.source, place)).collect();
        let bounds = scene.world_bounds();
        for (index, node) in scene.nodes.iter().enumerate() {
            let Some(at) = place.get(&(index as u32)) else {
                assert!(node.mesh.is_none());
                continue;
            };
            assert!(skip.nodes[*at].bounds.contains(&bounds[index]));
            let below: Vec<u32> = skip.children(*at as u32).map(|c| skip.nodes[c as usize].source).collect();
            let kept = node.children.iter().copied().filter(|child| place.contains_key(child));
            assert_eq!(below, kept.collect::<Vec<u32>>());
        }
    }
}

#[test]
fn faults_are_found() {
    let mut scene = Scene::new("pair");
    let mesh = scene.add_mesh(triangle());
    let root = scene.add_node(None, "root", Affine3A::IDENTITY, None);
    for _ in 0..2 {
        scene.add_node(Some(root), "leaf", Affine3A::IDENTITY, Some(mesh));
    }
    let (tree, skip, _) = trees(&scene);
    let pointer_faults: [fn(&mut AabbTree); 4] = [
        |tree| tree.nodes[0].children[0] = 9,
        |tree| tree.nodes[1].children.push(1),
        |tree| tree.nodes[0].children.truncate(1),
        |tree| tree.nodes[1].bounds.max.x = 99.0,
    ];
    for fault in pointer_faults {
        let mut tree = tree.clone();
        fault(&mut tree);
        assert!(tree.validate().is_err());
    }
    let skip_faults: [fn(&mut SkipTree); 4] = [
        |skip| skip.nodes[0].end = 2,
        |skip| skip.nodes[1].end = 1,
        |skip| skip.nodes[2].end = 4,
        |skip| skip.nodes[1].bounds.max.x = 99.0,
    ];
    for fault in skip_faults {
        let mut skip = skip.clone();
        fault(&mut skip);
        assert!(skip.validate().is_err());
    }
}
