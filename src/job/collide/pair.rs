//! Two bodies placed relative to each other, and what is asked of a pair of their boxes.

use crate::geometry::contact::{self, Triangle};
use crate::geometry::overlap::{Eight, Way};
use crate::geometry::{Overlap, Rigid, Unit};
use crate::structure::VolumeTree;
use crate::structure::volume_tree::Link;
use glam::Vec3;

/// A tree of volumes wherever it lies: parts of it may be kept in a machine's shared memory.
#[derive(Clone, Copy, Debug)]
pub struct TreeView<'a, V: Overlap> {
    /// The volumes, by box.
    pub volumes: &'a [V],
    /// Where each box leads to.
    pub links: &'a [Link],
    /// The volumes eight by eight.
    pub blocks: &'a [V::Eight],
    /// The triangles' corners in the order of the tree; none in a tree over scene nodes.
    pub triangles: &'a [[Vec3; 3]],
    /// The same by number.
    pub corners: &'a [[u32; 3]],
    /// Which item of those given stands at each place.
    pub order: &'a [u32],
}

impl<'a, V: Overlap> TreeView<'a, V> {
    /// A tree where it is.
    pub fn of(tree: &'a VolumeTree<V>) -> Self {
        Self {
            volumes: tree.volumes(),
            links: tree.links(),
            blocks: tree.blocks(),
            triangles: tree.triangles(),
            corners: tree.corners(),
            order: tree.order(),
        }
    }
}

/// Two bodies, the second moved; or one, whose own triangles are tested against each other.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a, V: Overlap> {
    pub(super) a: TreeView<'a, V>,
    pub(super) b: TreeView<'a, V>,
    /// From the second body's space to the first's, for corners.
    motion: Rigid,
    /// The ways between the spaces of their volumes.
    a_to_b: Way,
    b_to_a: Way,
    /// In metres.
    reach: f64,
    unit: Unit,
    /// Whether both are one body.
    pub(super) own: bool,
}

impl<'a, V: Overlap> Pair<'a, V> {
    /// Two bodies, the second moved; contacts are what comes nearer than `reach`, in metres.
    pub fn new(a: &'a VolumeTree<V>, b: &'a VolumeTree<V>, motion: &Rigid, reach: f64, unit: Unit) -> Self {
        let ways = (a.way_to(b, &motion.inverse(), reach), b.way_to(a, motion, reach));
        Self::of_views(TreeView::of(a), TreeView::of(b), motion, ways, reach, unit)
    }

    /// One body.
    pub fn of_one(body: &'a VolumeTree<V>, reach: f64, unit: Unit) -> Self {
        Self { own: true, ..Self::new(body, body, &Rigid::IDENTITY, reach, unit) }
    }

    /// Two bodies that lie elsewhere, with the ways between the spaces of their volumes: from the first to the
    /// second, and back.
    pub(super) fn of_views(
        a: TreeView<'a, V>,
        b: TreeView<'a, V>,
        motion: &Rigid,
        (a_to_b, b_to_a): (Way, Way),
        reach: f64,
        unit: Unit,
    ) -> Self {
        Self {
            a,
            b,
            motion: *motion,
            a_to_b,
            b_to_a,
            reach: if reach < 0.0 { 0.0 } else { reach },
            unit,
            own: false,
        }
    }

    /// Whether two boxes are certainly apart: one test.
    #[inline]
    pub(super) fn apart(&self, a: u32, b: u32) -> bool {
        self.a.volumes[a as usize].apart(&self.b.volumes[b as usize].moved(&self.b_to_a))
    }

    /// A box of the second as the first's see it.
    #[inline]
    pub(super) fn at_a(&self, b: u32) -> V::Moved {
        self.b.volumes[b as usize].moved(&self.b_to_a)
    }

    /// A box of the first as the second's see it.
    #[inline]
    pub(super) fn at_b(&self, a: u32) -> V::Moved {
        self.a.volumes[a as usize].moved(&self.a_to_b)
    }

    /// Bit `i` is set when box `i` of a block is not certainly apart from a moved one.
    #[inline]
    pub(super) fn near(&self, block: &V::Eight, moved: &V::Moved) -> u8 {
        !block.apart(self.unit, moved)
    }

    /// Whether two triangles are a contact, by place; neighbours in one body are not.
    pub(super) fn touch(&self, a: u32, b: &Triangle) -> bool {
        let a = self.a.triangles[a as usize].map(Vec3::as_dvec3);
        contact::closer(&a, b, self.reach)
    }

    /// A triangle of the second where it was moved to, by place: the model whose contacts are found.
    pub(super) fn moved_triangle(&self, b: u32) -> Triangle {
        self.b.triangles[b as usize].map(|corner| self.motion.point(corner.as_dvec3()))
    }

    /// Whether two triangles of one body share a corner, or are one and the same.
    pub(super) fn are_neighbours(&self, a: u32, b: u32) -> bool {
        let (a, b) = (self.a.corners[a as usize], self.b.corners[b as usize]);
        a.iter().any(|corner| b.contains(corner))
    }
}
