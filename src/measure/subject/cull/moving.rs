//! Objects that move between the frames of a path: the setting `scene.moving`.

use super::super::Stage;
use crate::geometry::Aabb;
use crate::scene::{Movers, Scene};
use crate::structure::{MovingTree, SkipNode, VolumeKind};
use glam::Affine3A;

/// A stage's tree that follows what moves.
pub(super) struct Moving {
    movers: Movers,
    tree: MovingTree,
    /// Where the movers are to be next.
    next: Vec<(u32, Affine3A)>,
}

impl Moving {
    /// None where nothing is said about moving.
    pub(super) fn of(stage: &Stage, kind: &VolumeKind) -> Option<Self> {
        let movers = stage.movers.clone()?;
        let tree = MovingTree::new(&stage.scene, stage.tree.clone(), kind);
        let mut moving = Moving { movers, tree, next: Vec::new() };
        // Away and back once, so that in the first path too volumes at rest are as a refit leaves them.
        for frame in [1, 0] {
            moving.prepare(frame);
            moving.refit();
        }
        Some(moving)
    }

    /// Works out where things are in a frame: the program's own affair, not the tree's.
    pub(super) fn prepare(&mut self, frame: usize) {
        self.next.clear();
        self.next.extend(self.movers.transforms(frame));
    }

    /// Moves them there and brings the tree up to date.
    pub(super) fn refit(&mut self) {
        for (node, transform) in self.next.drain(..) {
            self.tree.set_transform(node, transform);
        }
        self.tree.refit();
    }

    pub(super) fn tree(&self) -> &MovingTree {
        &self.tree
    }
}

/// The same for the oracle, which also has the scene itself as it is in a frame, to be looked at without any of the
/// tree's code.
pub(super) struct MovingScene {
    moving: Moving,
    scene: Scene,
}

impl MovingScene {
    pub(super) fn of(stage: &Stage, kind: &VolumeKind) -> Option<Self> {
        Some(MovingScene { moving: Moving::of(stage, kind)?, scene: stage.scene.clone() })
    }

    /// Goes to a frame and holds every box of the tree against the scene.
    ///
    /// # Errors
    /// A node whose box does not hold everything below it.
    pub(super) fn go_to(&mut self, frame: usize) -> Result<(), String> {
        self.moving.prepare(frame);
        for (node, transform) in &self.moving.next {
            self.scene.nodes[*node as usize].transform = *transform;
        }
        self.moving.refit();
        let placed = self.scene.world_bounds();
        let mut below = vec![Aabb::EMPTY; placed.len()];
        for index in self.scene.depth_first().into_iter().rev() {
            let here = below[index as usize].union(placed[index as usize]);
            below[index as usize] = here;
            if let Some(parent) = self.scene.nodes[index as usize].parent {
                below[parent as usize] = below[parent as usize].union(here);
            }
        }
        let lost = |node: &SkipNode| {
            let Some(exact) = below.get(node.source as usize) else { return false };
            // Where f32 puts a vertex is only near to where the transforms do.
            let room = 1e-5 * (1.0 + exact.min.abs().max(exact.max.abs()).max_element());
            let around = Aabb { min: node.bounds.min - room, max: node.bounds.max + room };
            !around.contains(exact)
        };
        match self.moving().tree().nodes.iter().position(lost) {
            None => Ok(()),
            Some(node) => {
                Err(format!("frame {frame}: the box of node {node} does not hold what is below it"))
            }
        }
    }

    pub(super) fn moving(&self) -> &MovingTree {
        &self.moving.tree
    }

    pub(super) fn scene(&self) -> &Scene {
        &self.scene
    }
}
