//! A frame as work for tree schemes: by ranges of the depth-first array, or by nodes.

use super::{Descent, Frame};
use crate::geometry::culling::Side;
use crate::machine::{Machine, Processor};
use crate::scheme::tree::TreeWork;

/// The part of the visible set that one processor found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Visible {
    /// Ranges of nodes, disjoint, in the order found. A range is a single node that crosses the frustum,
    /// or a subtree that lies inside.
    pub ranges: Vec<(u32, u32)>,
    /// Planes tested.
    pub plane_tests: u64,
}

impl<M: Machine> Frame<'_, M> {
    /// Visits a node; says where to go on if its subtree is done with (`Err`: after it, `Ok`: below it).
    #[inline]
    fn visit_node<P: Processor>(&self, node: u32, found: &mut Visible, cpu: &P) -> Result<u32, u32> {
        let record = &self.tree.records[node as usize];
        cpu.touch(record);
        let verdict = self.test(node, record);
        found.plane_tests += u64::from(verdict.tests);
        if self.descent != Descent::NoWork {
            cpu.charge(self.costs.of(verdict.tests));
        }
        let whole = self.descent == Descent::WholeTree;
        match verdict.side {
            Side::Outside(_) => {}
            Side::Inside if !whole => found.ranges.push((node, record.end)),
            Side::Inside | Side::Intersecting => {
                if record.triangles > 0 {
                    found.ranges.push((node, node + 1));
                }
            }
        }
        if whole || verdict.side == Side::Intersecting { Ok(record.end) } else { Err(record.end) }
    }

    /// The child at `child`, whose parent's subtree ends at `end`, and where its subtree ends.
    #[inline]
    fn child<P: Processor>(&self, child: u32, cpu: &P) -> (u32, u32) {
        let end = &self.tree.records[child as usize].end;
        cpu.touch(end);
        (child, *end)
    }

    fn all(&self) -> Option<u32> {
        u32::try_from(self.tree.len()).ok().filter(|&nodes| nodes > 0)
    }
}

/// Tasks are (start, stop) ranges: a node and the end of its subtree (Paper II section 3.3).
pub struct RangeWork<'f, 'a, M: Machine>(pub(super) &'f Frame<'a, M>);

impl<M: Machine> TreeWork for RangeWork<'_, '_, M> {
    type Task = (u32, u32);
    type Found = Visible;

    fn root(&self) -> Option<(u32, u32)> {
        Some((0, self.0.all()?))
    }

    fn found(&self) -> Visible {
        Visible::default()
    }

    #[inline]
    fn visit<P: Processor>(
        &self,
        (node, _): (u32, u32),
        found: &mut Visible,
        cpu: &P,
        mut emit: impl FnMut((u32, u32)),
    ) {
        if let Ok(end) = self.0.visit_node(node, found, cpu) {
            let mut next = node + 1;
            while next < end {
                let child = self.0.child(next, cpu);
                emit(child);
                next = child.1;
            }
        }
    }

    /// The skip-pointer descent: a walk along the array, leaping over what is skipped.
    #[inline]
    fn descend<P: Processor>(
        &self,
        (mut node, stop): (u32, u32),
        found: &mut Visible,
        cpu: &P,
        _stack: &mut Vec<u64>,
    ) -> u64 {
        let mut visited = 0;
        while node < stop {
            visited += 1;
            node = match self.0.visit_node(node, found, cpu) {
                Ok(_) => node + 1,
                Err(end) => end,
            };
        }
        visited
    }

    fn size(&self, (start, stop): (u32, u32)) -> usize {
        (stop - start) as usize
    }
}

/// Tasks are nodes, as on a tree of pointers (Paper II sections 3.1 and 3.2).
pub struct NodeWork<'f, 'a, M: Machine>(pub(super) &'f Frame<'a, M>);

impl<M: Machine> TreeWork for NodeWork<'_, '_, M> {
    type Task = u32;
    type Found = Visible;

    fn root(&self) -> Option<u32> {
        self.0.all().map(|_| 0)
    }

    fn found(&self) -> Visible {
        Visible::default()
    }

    #[inline]
    fn visit<P: Processor>(&self, node: u32, found: &mut Visible, cpu: &P, mut emit: impl FnMut(u32)) {
        if let Ok(end) = self.0.visit_node(node, found, cpu) {
            let mut next = node + 1;
            while next < end {
                let child = self.0.child(next, cpu);
                emit(child.0);
                next = child.1;
            }
        }
    }
}
