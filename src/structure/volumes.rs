//! Other volumes for the nodes of a tree than their axis-aligned boxes: a true hierarchy of each kind, fitted
//! to all geometry at and below a node.

use glam::Vec3;

use super::{NO_SOURCE, SkipTree};
use crate::geometry::{KDop, Obb, Sphere};
use crate::scene::Scene;

/// One volume for each node of a [`SkipTree`], in its order.
#[derive(Clone, Debug, Default)]
pub enum Volumes {
    /// The nodes' own boxes; nothing is kept beside them.
    #[default]
    Aabb,
    /// Oriented boxes.
    Obb(Vec<Obb>),
    /// Spheres.
    Sphere(Vec<Sphere>),
    /// 14-DOPs: a cube's faces and corners.
    Dop14(Vec<KDop<7>>),
    /// 18-DOPs: a cube's faces and edges.
    Dop18(Vec<KDop<9>>),
    /// 26-DOPs: a cube's faces, edges and corners.
    Dop26(Vec<KDop<13>>),
}

/// A kind of volume that a tree can have.
pub struct VolumeKind {
    /// The word.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    fit: fn(&Scene, &SkipTree) -> Volumes,
}

/// All kinds.
pub const VOLUME_KINDS: &[VolumeKind] = &[
    VolumeKind { name: "aabb", about: "axis-aligned boxes", fit: |_, _| Volumes::Aabb },
    VolumeKind {
        name: "aabb_as_obb",
        about: "axis-aligned boxes tested as oriented ones, as Paper I did (section 4)",
        fit: |_, tree| Volumes::Obb(tree.nodes.iter().map(|node| Obb::from(node.bounds)).collect()),
    },
    VolumeKind { name: "obb", about: "oriented boxes, the least surface of three frames", fit: oriented },
    VolumeKind {
        name: "sphere",
        about: "bounding spheres",
        fit: |scene, tree| Volumes::Sphere(each(scene, tree, |_, points| Sphere::of_points(points))),
    },
    VolumeKind {
        name: "14dop",
        about: "14-DOPs",
        fit: |scene, tree| Volumes::Dop14(each(scene, tree, |_, points| KDop::of_points(points))),
    },
    VolumeKind {
        name: "18dop",
        about: "18-DOPs",
        fit: |scene, tree| Volumes::Dop18(each(scene, tree, |_, points| KDop::of_points(points))),
    },
    VolumeKind {
        name: "26dop",
        about: "26-DOPs",
        fit: |scene, tree| Volumes::Dop26(each(scene, tree, |_, points| KDop::of_points(points))),
    },
];

impl VolumeKind {
    /// Fits a volume to each node of the tree of a scene.
    pub fn fit(&self, scene: &Scene, tree: &SkipTree) -> Volumes {
        (self.fit)(scene, tree)
    }
}

/// Fits a volume to the placed vertices of each subtree, whose numbers `fit` is given too.
fn each<V>(scene: &Scene, tree: &SkipTree, fit: impl Fn(usize, &[Vec3]) -> V) -> Vec<V> {
    let world = scene.world_transforms();
    // Depth-first, so the vertices of a subtree lie together as its nodes do.
    let (mut points, mut starts) = (Vec::new(), Vec::with_capacity(tree.nodes.len() + 1));
    for node in &tree.nodes {
        starts.push(points.len());
        let Some(source) = scene.nodes.get(node.source as usize) else { continue };
        if let Some(mesh) = source.mesh {
            let placed = world[node.source as usize];
            let positions = &scene.meshes[mesh as usize].positions;
            points.extend(positions.iter().map(|position| placed.transform_point3(*position)));
        }
    }
    starts.push(points.len());
    let subtree =
        |(i, node): (usize, &super::SkipNode)| fit(i, &points[starts[i]..starts[node.end as usize]]);
    tree.nodes.iter().enumerate().map(subtree).collect()
}

fn oriented(scene: &Scene, tree: &SkipTree) -> Volumes {
    let world = scene.world_transforms();
    let fit = |node: usize, points: &[Vec3]| {
        // The node's own axes: what was modelled along them fits them best.
        let source = tree.nodes[node].source;
        let own = (source != NO_SOURCE).then(|| {
            let axes = world[source as usize].matrix3;
            [axes.x_axis, axes.y_axis, axes.z_axis].map(Vec3::from)
        });
        Obb::of_points(points, own.as_slice())
    };
    Volumes::Obb(each(scene, tree, fit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Volume;
    use crate::scene;
    use crate::structure::AabbTree;

    /// Each volume's centre lies in the node's box, or near it, and it is hardly larger than the box' own sphere: an
    /// oriented box with less surface may have a longer diagonal.
    fn fits<V: Volume>(name: &str, tree: &SkipTree, volumes: &[V]) {
        assert_eq!(volumes.len(), tree.nodes.len());
        for (node, volume) in tree.nodes.iter().zip(volumes) {
            let sphere = node.bounds.half_diagonal();
            assert!(volume.radius() <= sphere * 1.5 + 1e-4, "{name}: {volume:?} for {:?}", node.bounds);
            assert!((volume.centre() - node.bounds.centre()).length() <= sphere, "{name}");
        }
    }

    #[test]
    fn every_kind_fits_every_node() {
        let scene = scene::by_name("factory-small").unwrap();
        let tree = SkipTree::build(&AabbTree::build(&scene));
        for kind in VOLUME_KINDS {
            match kind.fit(&scene, &tree) {
                Volumes::Aabb => assert_eq!(kind.name, "aabb"),
                Volumes::Obb(volumes) => fits(kind.name, &tree, &volumes),
                Volumes::Sphere(volumes) => fits(kind.name, &tree, &volumes),
                Volumes::Dop14(volumes) => fits(kind.name, &tree, &volumes),
                Volumes::Dop18(volumes) => fits(kind.name, &tree, &volumes),
                Volumes::Dop26(volumes) => fits(kind.name, &tree, &volumes),
            }
        }
        let empty = Scene::new("nothing");
        assert!(matches!(oriented(&empty, &SkipTree::default()), Volumes::Obb(none) if none.is_empty()));
    }
}
