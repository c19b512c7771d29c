//! A tree of volumes in the shared memory of a machine.

use super::{Pair, TreeView};
use crate::geometry::{Overlap, Rigid, Unit};
use crate::machine::{Layout, Machine, Shared};
use crate::structure::VolumeTree;
use crate::structure::volume_tree::Link;
use glam::Vec3;
use std::rc::Rc;

/// A copy of what a query reads of a tree, in the shared memory of a machine.
pub struct SharedTree<V: Overlap> {
    tree: Rc<VolumeTree<V>>,
    volumes: Shared<V>,
    links: Shared<Link>,
    blocks: Shared<V::Eight>,
    triangles: Shared<[Vec3; 3]>,
}

impl<V: Overlap> SharedTree<V> {
    /// Copies a tree into a machine's memory.
    pub fn new<M: Machine>(machine: &M, tree: Rc<VolumeTree<V>>) -> Self {
        fn copy<M: Machine, T: Copy + Send + Sync>(machine: &M, all: &[T]) -> Shared<T> {
            machine.alloc(all.len(), Layout::Packed, |i| all[i])
        }
        Self {
            volumes: copy(machine, tree.volumes()),
            links: copy(machine, tree.links()),
            blocks: copy(machine, tree.blocks()),
            triangles: copy(machine, tree.triangles()),
            tree,
        }
    }

    /// The tree it is a copy of.
    pub fn tree(&self) -> &VolumeTree<V> {
        &self.tree
    }

    fn view(&self) -> TreeView<'_, V> {
        TreeView {
            volumes: self.volumes.as_slice(),
            links: self.links.as_slice(),
            blocks: self.blocks.as_slice(),
            triangles: self.triangles.as_slice(),
            ..TreeView::of(&self.tree)
        }
    }

    /// This body and another, which is moved; contacts are what comes nearer than `reach`, in metres.
    pub fn against<'a>(&'a self, other: &'a Self, motion: &Rigid, reach: f64, unit: Unit) -> Pair<'a, V> {
        let there = self.tree.way_to(&other.tree, &motion.inverse(), reach);
        let back = other.tree.way_to(&self.tree, motion, reach);
        Pair::of_views(self.view(), other.view(), motion, (there, back), reach, unit)
    }
}
