//! A tree over a scene whose objects move: volumes follow transforms, and those above them are fitted anew.
//!
//! Paper I sec. 3.5 and P1-F06: what a test remembers of a volume holds while it has not moved. So a refit says which
//! nodes have another volume than before it; whoever keeps something about nodes forgets it for these.

use glam::{Affine3A, DAffine3, Vec3A};

use super::volumes::Points;
use super::{NO_SOURCE, SkipTree, VolumeKind, Volumes};
use crate::geometry::{Aabb, Movable};
use crate::scene::Scene;

/// A tree and its volumes, kept up to date with the transforms of the scene graph they were built over.
///
/// An object's volume is the one fitted to it at first, carried along, whatever the mesh's size: an oriented box and
/// a sphere as they are, a box and a k-DOP made anew around the moved one. It is always carried from the first place,
/// so nothing adds up. A volume above is made
/// anew around those right below it. The tree itself stays as it is (no rebuild): where things moved far apart,
/// volumes are large and culling is slow, but never wrong. What is moved to where no number is (NaN, overflow) has a
/// volume that no test rejects, and so have all nodes above it, until it is moved back.
///
/// Invariant after [`MovingTree::refit`]: a node's box and volume hold everything at and below it, where its
/// transforms put it.
pub struct MovingTree {
    tree: SkipTree,
    volumes: Volumes,
    /// What is placed at each node itself: boxes, and volumes of the kind asked for.
    boxes: Own<Vec<Aabb>>,
    own: Own<Volumes>,
    nodes: Vec<Node>,
    /// The tree's node of each scene node, or [`NO_SOURCE`].
    places: Vec<u32>,
    /// The nodes whose transforms were set since the last refit.
    moved: Vec<u32>,
    changed: Vec<u32>,
}

/// The volumes of nodes' own meshes, at rest and now; empty where there is none.
struct Own<V> {
    rest: V,
    now: V,
}

/// Where a node is.
struct Node {
    /// The node above, or [`NO_SOURCE`].
    parent: u32,
    /// To the space of the node above.
    local: Affine3A,
    /// To the world.
    world: Affine3A,
    /// From where the volumes at rest are to the mesh's own space.
    back: DAffine3,
}

/// How far from a rotation a matrix may be, as the product of its norm and its inverse's: double precision still
/// leaves more digits than f32 has.
const STEEPEST: f64 = 1e6;

impl Node {
    /// A node, and how its mesh is to be placed for its volumes at rest: turned and stretched as at first, so that
    /// boxes are as tight as those built there, but about the origin, since rounding grows with the distance from it.
    /// In the mesh's own space if that is too flat to have a way back.
    fn new(parent: u32, local: Affine3A, world: Affine3A) -> (Self, Affine3A) {
        let turned = Affine3A { translation: Vec3A::ZERO, ..world };
        let there = turned.as_daffine3();
        let back = there.inverse();
        let norm = |m: &DAffine3| m.matrix3.to_cols_array().map(|x| x * x).iter().sum::<f64>().sqrt();
        // Written so that a NaN has no way back.
        let returns = back.is_finite() && norm(&there) * norm(&back) < STEEPEST;
        let (back, at_rest) = if returns { (back, turned) } else { (DAffine3::IDENTITY, Affine3A::IDENTITY) };
        (Node { parent, local, world, back }, at_rest)
    }

    /// What carries a volume at rest to where the node is.
    fn motion(&self) -> DAffine3 {
        self.world.as_daffine3() * self.back
    }
}

/// Runs a generic function on the volumes of whatever kind; nothing on boxes, which are the tree's own.
macro_rules! with_kind {
    ($rest:expr, $now:expr, $whole:expr, $do:expr) => {
        match ($rest, $now, $whole) {
            (Volumes::Aabb, _, _) => Default::default(),
            (Volumes::Obb(rest), Volumes::Obb(now), Volumes::Obb(whole)) => $do(rest, now, whole),
            (Volumes::Sphere(rest), Volumes::Sphere(now), Volumes::Sphere(whole)) => $do(rest, now, whole),
            (Volumes::Dop14(rest), Volumes::Dop14(now), Volumes::Dop14(whole)) => $do(rest, now, whole),
            (Volumes::Dop18(rest), Volumes::Dop18(now), Volumes::Dop18(whole)) => $do(rest, now, whole),
            (Volumes::Dop26(rest), Volumes::Dop26(now), Volumes::Dop26(whole)) => $do(rest, now, whole),
            _ => unreachable!("all three were made of one kind"),
        }
    };
}

impl MovingTree {
    /// A tree over a scene, with volumes of a kind.
    ///
    /// # Panics
    /// If the tree is not one of this very scene, see [`AabbTree::build`](super::AabbTree::build): a node stands for
    /// a scene node that is not there.
    pub fn new(scene: &Scene, tree: SkipTree, kind: &VolumeKind) -> Self {
        let world = scene.world_transforms();
        let mut places = vec![NO_SOURCE; scene.nodes.len()];
        let mut nodes: Vec<Node> = Vec::with_capacity(tree.nodes.len());
        let mut frames = Vec::with_capacity(tree.nodes.len());
        let mut open: Vec<u32> = Vec::new();
        for (index, node) in (0..).zip(&tree.nodes) {
            while open.last().is_some_and(|above| tree.nodes[*above as usize].end <= index) {
                open.pop();
            }
            let parent = open.last().copied().unwrap_or(NO_SOURCE);
            open.push(index);
            let (local, world) = match node.source {
                NO_SOURCE => Default::default(),
                source => (scene.nodes[source as usize].transform, world[source as usize]),
            };
            if let Some(place) = places.get_mut(node.source as usize) {
                *place = index;
            }
            let (node, frame) = Node::new(parent, local, world);
            nodes.push(node);
            frames.push(frame);
        }
        let frame = |source: u32| places.get(source as usize).map(|place| frames[*place as usize]);
        let at_rest = Points::own(scene, &tree, |node| frame(node.source));
        let boxes = at_rest.each(|_, points| Aabb::of_points(points.iter().copied()));
        let own = kind.fit_points(&at_rest);
        let volumes = kind.fit(scene, &tree);
        let mut all = Self {
            tree,
            volumes,
            boxes: Own { rest: boxes.clone(), now: boxes },
            own: Own { rest: own.clone(), now: own },
            nodes,
            places,
            moved: Vec::new(),
            changed: Vec::new(),
        };
        (0..all.nodes.len()).for_each(|node| all.carry(node));
        all
    }

    /// The tree, as the last refit left it.
    pub fn tree(&self) -> &SkipTree {
        &self.tree
    }

    /// The volumes of its nodes, as the last refit left them.
    pub fn volumes(&self) -> &Volumes {
        &self.volumes
    }

    /// From a tree node's space to the world's, as the last refit left it; lengths in metres.
    ///
    /// # Panics
    /// If `node` is not in the tree.
    pub fn world(&self, node: u32) -> Affine3A {
        self.nodes[node as usize].world
    }

    /// The nodes whose box or volume the last refit changed, each before the one above it.
    pub fn changed(&self) -> &[u32] {
        &self.changed
    }

    /// Moves a scene node and all below it: sets its transform to its parent's space, as in
    /// [`Node::transform`](crate::scene::Node::transform). What that means for volumes waits for
    /// [`MovingTree::refit`]. Where nothing is placed at or below the node, nothing moves.
    ///
    /// # Panics
    /// If the scene had no such node.
    pub fn set_transform(&mut self, scene_node: u32, transform: Affine3A) {
        let place = self.places[scene_node as usize];
        if let Some(node) = self.nodes.get_mut(place as usize).filter(|node| node.local != transform) {
            node.local = transform;
            self.moved.push(place);
        }
    }

    /// Brings boxes and volumes up to date with the transforms, from the nodes that moved up to the root or to where
    /// nothing changes any more, and returns [`MovingTree::changed`]. It takes time for the nodes at and below those
    /// whose transforms were set, and for the ones above them and their children; none for others.
    pub fn refit(&mut self) -> &[u32] {
        self.changed.clear();
        let mut moved = std::mem::take(&mut self.moved);
        moved.sort_unstable();
        // Nodes whose own mesh moved, least first.
        let mut own = Vec::new();
        let mut done = 0;
        for start in moved.drain(..) {
            // It may have been moved along with one above it.
            for node in start.max(done)..self.tree.nodes[start as usize].end {
                self.place(node as usize);
                if !self.boxes.rest[node as usize].is_empty() {
                    self.carry(node as usize);
                    own.push(node);
                }
                done = node + 1;
            }
        }
        self.moved = moved;
        // Nodes above changed ones, the greatest last. It stays so: whatever comes between one of them and what it
        // was put here for is below it, and so has its parent there or below.
        let mut above: Vec<u32> = Vec::new();
        while let Some(node) = own.last().max(above.last()).copied() {
            own.pop_if(|last| *last == node);
            above.pop_if(|last| *last == node);
            if self.gather(node) {
                self.changed.push(node);
                let parent = self.nodes[node as usize].parent;
                if parent != NO_SOURCE && above.last() != Some(&parent) {
                    above.push(parent);
                }
            }
        }
        &self.changed
    }

    /// Works out where a node is; the one above it is known.
    fn place(&mut self, node: usize) {
        let parent = self.nodes[node].parent;
        let above = self.nodes.get(parent as usize).map_or(Affine3A::IDENTITY, |parent| parent.world);
        self.nodes[node].world = above * self.nodes[node].local;
    }

    /// Carries the volumes of a node's own mesh to where the node is.
    fn carry(&mut self, node: usize) {
        let motion = self.nodes[node].motion();
        carry(&self.boxes.rest, &mut self.boxes.now, node, &motion);
        let (rest, now) = (&self.own.rest, &mut self.own.now);
        with_kind!(rest, now, &self.volumes, |rest, now, _| carry(rest, now, node, &motion));
    }

    /// Fits a node's box and volume anew around its own mesh and the nodes right below; whether either changed.
    fn gather(&mut self, node: u32) -> bool {
        let (tree, at) = (&mut self.tree, node as usize);
        let below = tree.children(node).map(|child| tree.nodes[child as usize].bounds);
        let bounds = gathered(tree.nodes[at].bounds, self.boxes.now[at], below);
        let other = std::mem::replace(&mut tree.nodes[at].bounds, bounds) != bounds;
        let (now, whole) = (&self.own.now, &mut self.volumes);
        let volume: bool = with_kind!(now, now, whole, |_, now, whole| regather(tree, now, whole, node));
        other || volume
    }
}

fn carry<V: Movable>(rest: &[V], now: &mut [V], node: usize, motion: &DAffine3) {
    now[node] = rest[node].moved(motion);
}

fn regather<V: Movable>(tree: &SkipTree, now: &[V], whole: &mut [V], node: u32) -> bool {
    let at = node as usize;
    let volume = gathered(whole[at], now[at], tree.children(node).map(|child| whole[child as usize]));
    std::mem::replace(&mut whole[at], volume) != volume
}

/// The volume of a node with its own mesh's and those below; `present` is the one it had.
fn gathered<V: Movable>(present: V, own: V, below: impl Iterator<Item = V> + Clone) -> V {
    let parts = std::iter::once(own).chain(below).filter(|part| !part.is_empty());
    let mut some = parts.clone();
    match (some.next(), some.next()) {
        (None, _) => present,
        (Some(only), None) => only,
        _ => present.around(parts),
    }
}

#[cfg(test)]
#[path = "moving_tree_tests.rs"]
mod tests;
