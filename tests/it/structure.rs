//! Trees over generated and real scenes.

use std::path::PathBuf;

use apportion::scene::{self, Scene};
use apportion::structure::{AabbTree, SkipTree, TreeStatistics};

fn statistics(scene: &Scene) -> TreeStatistics {
    let tree = AabbTree::build(scene);
    tree.validate().unwrap();
    let skip = SkipTree::build(&tree);
    skip.validate().unwrap();
    assert_eq!(skip.nodes.first().map(|root| root.bounds), Some(scene.bounds()));
    TreeStatistics::of(&skip)
}

#[test]
fn factories_give_one_tree_node_for_each_graph_node_and_are_unbalanced() {
    for (name, nodes, triangles) in
        [("factory-large", 3932, 184_000), ("factory-medium", 1137, 52_000), ("factory-small", 254, 167_000)]
    {
        let statistics = statistics(&scene::by_name(name).unwrap());
        assert_eq!((statistics.nodes, statistics.triangles), (nodes, triangles), "{name}");
        let shallowest = statistics.leaf_depths.iter().position(|leaves| *leaves > 0);
        assert!(shallowest <= Some(2) && statistics.depth >= 13, "{name}: {statistics:?}");
        assert!(statistics.max_heaviest_share > 0.8, "{name}: {statistics:?}");
    }
}

#[test]
fn the_robot_has_the_tree_of_the_paper() {
    let statistics = statistics(&scene::by_name("robot").unwrap());
    assert_eq!((statistics.nodes, statistics.depth), (102, 11));
    let shallowest = statistics.leaf_depths.iter().position(|leaves| *leaves > 0);
    assert!(shallowest == Some(1) && statistics.max_heaviest_share > 0.9, "{statistics:?}");
}

#[test]
fn real_scenes_give_valid_trees() {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/scenes"));
    for (file, triangles) in [
        ("cad_recip_saw/ReciprocatingSaw.glb", 198_470),
        ("cad_2cylinder_engine/2CylinderEngine.glb", 121_496),
        ("sponza/sponza.obj", 66_450),
    ] {
        let path = folder.join(file);
        if !path.exists() {
            eprintln!("skipped: {} is not here", path.display());
            continue;
        }
        assert_eq!(statistics(&scene::load(&path).unwrap()).triangles, triangles, "{file}");
    }
}
