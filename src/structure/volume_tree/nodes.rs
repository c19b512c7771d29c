//! Trees over the nodes of a scene graph, in its shape: what Paper II tested against one another (P2-21).

use super::topology::Topology;
use super::{Items, LEAF, Link, VolumeTree};
use crate::geometry::{Aabb, Overlap};
use crate::scene::Scene;
use glam::{DVec3, Vec3};

impl<V: Overlap> VolumeTree<V> {
    /// A tree over the nodes of a scene that have a mesh, each a leaf; a node that has both a mesh and nodes below
    /// gets a leaf of its own beside them. Nodes with no points below are left out. Items are numbered as nodes are.
    pub fn over_nodes(scene: &Scene) -> Self {
        let world = scene.world_transforms();
        let depth_first = scene.depth_first();
        let (mut points, mut starts, mut order) = (Vec::new(), vec![0], Vec::new());
        // The items from each node on, and below it: in depth-first order they are in one piece.
        let mut below = vec![(0, 0); scene.nodes.len()];
        for &node in &depth_first {
            below[node as usize].0 = order.len() as u32;
            let Some(mesh) = scene.nodes[node as usize].mesh.map(|mesh| &scene.meshes[mesh as usize]) else {
                continue;
            };
            if mesh.positions.is_empty() {
                continue;
            }
            let place = |position: &Vec3| world[node as usize].transform_point3(*position);
            points.extend(mesh.positions.iter().map(place));
            starts.push(points.len());
            order.push(node);
        }
        for &node in depth_first.iter().rev() {
            let own = u32::from(order.get(below[node as usize].0 as usize) == Some(&node));
            let end = scene.nodes[node as usize].children.iter().map(|&child| below[child as usize].1).max();
            below[node as usize].1 = (below[node as usize].0 + own).max(end.unwrap_or(0));
        }
        let bounds = Aabb::of_points(points.iter().copied());
        let origin = if bounds.is_empty() { DVec3::ZERO } else { bounds.centre().as_dvec3() };
        let topology = shape(scene, &order, &below);
        let (links, items) = (topology.links, topology.items);
        let content = Items::Nodes { points, starts };
        let mut tree = Self { volumes: Vec::new(), links, blocks: Vec::new(), items, order, content, origin };
        tree.fit();
        tree
    }
}

/// What a box of the tree stands for.
#[derive(Clone, Copy)]
enum Part {
    /// A node with all below it.
    Node(u32),
    /// The own mesh of a node that has nodes below, by place.
    Own(u32),
}

fn shape(scene: &Scene, order: &[u32], below: &[(u32, u32)]) -> Topology {
    let mut topology = Topology { links: Vec::new(), items: Vec::new() };
    let filled = |nodes: &[u32]| -> Vec<Part> {
        let holds = |node: &&u32| below[**node as usize].0 < below[**node as usize].1;
        nodes.iter().filter(holds).map(|node| Part::Node(*node)).collect()
    };
    let roots = filled(&scene.roots);
    let mut stack = Vec::new();
    match roots.as_slice() {
        [] => return topology,
        [root] => {
            topology.grow(1);
            stack.push((0, *root));
        }
        several => {
            // A box over all of them.
            topology.grow(1);
            let first = topology.grow(several.len());
            topology.links[0] = Link { first: first as u32, count: several.len() as u32, surface: 0.0 };
            topology.items[0] = (0, order.len() as u32);
            stack.extend(several.iter().enumerate().map(|(i, part)| (first + i, *part)));
        }
    }
    while let Some((at, part)) = stack.pop() {
        let range = match part {
            Part::Node(node) => below[node as usize],
            Part::Own(place) => (place, place + 1),
        };
        topology.items[at] = range;
        let mut parts = Vec::new();
        if let Part::Node(node) = part {
            parts = filled(&scene.nodes[node as usize].children);
            if !parts.is_empty() && order[range.0 as usize] == node {
                parts.insert(0, Part::Own(range.0));
            }
        }
        if parts.is_empty() {
            topology.links[at] = Link { first: range.0, count: 1 | LEAF, surface: 0.0 };
        } else {
            let first = topology.grow(parts.len());
            topology.links[at] = Link { first: first as u32, count: parts.len() as u32, surface: 0.0 };
            stack.extend(parts.iter().enumerate().map(|(i, part)| (first + i, *part)));
        }
    }
    topology
}
