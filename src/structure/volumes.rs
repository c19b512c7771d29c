//! Other volumes for the nodes of a tree than their axis-aligned boxes: a true hierarchy of each kind, fitted
//! to all geometry at and below a node.

use std::ops::Range;

use glam::{Affine3A, Vec3};

use super::{SkipNode, SkipTree};
use crate::geometry::{Aabb, KDop, Obb, Sphere};
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
    fit: fn(&Points) -> Volumes,
}

/// All kinds.
pub const VOLUME_KINDS: &[VolumeKind] = &[
    VolumeKind { name: "aabb", about: "axis-aligned boxes", fit: |_| Volumes::Aabb },
    VolumeKind {
        name: "aabb_as_obb",
        about: "axis-aligned boxes tested as oriented ones, as Paper I did (section 4)",
        fit: |points| {
            Volumes::Obb(points.each(|_, points| Obb::from(Aabb::of_points(points.iter().copied()))))
        },
    },
    VolumeKind {
        name: "obb",
        about: "oriented boxes, the least surface of three frames",
        fit: |points| Volumes::Obb(points.each(|own, points| Obb::of_points(points, own.as_slice()))),
    },
    VolumeKind {
        name: "sphere",
        about: "bounding spheres",
        fit: |points| Volumes::Sphere(points.each(|_, points| Sphere::of_points(points))),
    },
    VolumeKind {
        name: "14dop",
        about: "14-DOPs",
        fit: |points| Volumes::Dop14(points.each(|_, points| KDop::of_points(points))),
    },
    VolumeKind {
        name: "18dop",
        about: "18-DOPs",
        fit: |points| Volumes::Dop18(points.each(|_, points| KDop::of_points(points))),
    },
    VolumeKind {
        name: "26dop",
        about: "26-DOPs",
        fit: |points| Volumes::Dop26(points.each(|_, points| KDop::of_points(points))),
    },
];

impl VolumeKind {
    /// Fits a volume to each node of the tree of a scene.
    pub fn fit(&self, scene: &Scene, tree: &SkipTree) -> Volumes {
        (self.fit)(&Points::below(scene, tree))
    }

    /// Fits a volume to some points for each node.
    pub(super) fn fit_points(&self, points: &Points) -> Volumes {
        (self.fit)(points)
    }
}

/// The vertices that each node of a tree is to have a volume around.
pub(super) struct Points {
    points: Vec<Vec3>,
    /// Each node's among them.
    ranges: Vec<Range<usize>>,
    /// Each node's own axes: what was modelled along them fits them best.
    axes: Vec<Option<[Vec3; 3]>>,
}

impl Points {
    /// Those placed in the world at and below each node.
    fn below(scene: &Scene, tree: &SkipTree) -> Self {
        let world = scene.world_transforms();
        let place = |node: &SkipNode| world.get(node.source as usize).copied();
        let mut points = Self::own(scene, tree, place);
        // Depth-first, so the vertices of a subtree lie together as its nodes do.
        let ends: Vec<usize> =
            tree.nodes.iter().map(|node| points.ranges[node.end as usize - 1].end).collect();
        points.ranges.iter_mut().zip(ends).for_each(|(range, end)| range.end = end);
        points
    }

    /// Those of the mesh at each node itself, placed by `place`; no source, no place.
    pub(super) fn own(scene: &Scene, tree: &SkipTree, place: impl Fn(&SkipNode) -> Option<Affine3A>) -> Self {
        let mut all = Points { points: Vec::new(), ranges: Vec::new(), axes: Vec::new() };
        for node in &tree.nodes {
            let (start, placed) = (all.points.len(), place(node));
            let mesh = scene.nodes.get(node.source as usize).and_then(|source| source.mesh);
            if let (Some(mesh), Some(placed)) = (mesh, placed) {
                let positions = &scene.meshes[mesh as usize].positions;
                all.points.extend(positions.iter().map(|position| placed.transform_point3(*position)));
            }
            all.ranges.push(start..all.points.len());
            let axes = |placed: Affine3A| [placed.x_axis, placed.y_axis, placed.z_axis].map(Vec3::from);
            all.axes.push(placed.map(axes));
        }
        all
    }

    /// Fits a volume for each node, given its own axes.
    pub(super) fn each<V>(&self, fit: impl Fn(Option<[Vec3; 3]>, &[Vec3]) -> V) -> Vec<V> {
        let one =
            |(range, axes): (&Range<usize>, &Option<[Vec3; 3]>)| fit(*axes, &self.points[range.clone()]);
        self.ranges.iter().zip(&self.axes).map(one).collect()
    }
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
        let nothing = VOLUME_KINDS.iter().find(|kind| kind.name == "obb").unwrap();
        let nothing = nothing.fit(&Scene::new("nothing"), &SkipTree::default());
        assert!(matches!(nothing, Volumes::Obb(none) if none.is_empty()));
    }
}
