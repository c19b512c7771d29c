//! A frame as work for tree schemes: by ranges of the depth-first array, or by nodes.

use super::{Descent, Frame};
use crate::geometry::culling::Side;
use crate::machine::{Machine, Processor};
use crate::scheme::tree::{Task, TreeWork};

/// The part of the visible set that one processor found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Visible {
    /// Ranges of nodes, disjoint, in the order found. A range is a single node that crosses the frustum,
    /// or a subtree that lies inside.
    pub ranges: Vec<(u32, u32)>,
    /// Planes tested.
    pub plane_tests: u64,
}

/// A node, the end of its subtree, and the planes that the nodes above it are inside of (six bits: masking,
/// Paper I section 3.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RangeTask {
    start: u32,
    stop: u32,
    mask: u8,
}

impl RangeTask {
    #[inline]
    pub(super) fn new(start: u32, stop: u32, mask: u8) -> Self {
        RangeTask { start, stop, mask }
    }
}

impl Task for RangeTask {
    #[inline]
    fn pack(self) -> u64 {
        u64::from(self.start) << 35 | u64::from(self.stop) << 6 | u64::from(self.mask)
    }
    #[inline]
    fn unpack(word: u64) -> Self {
        let number = |shift: u32| (word >> shift) as u32 & super::MOST_NODES as u32;
        RangeTask::new(number(35), number(6), (word & 63) as u8)
    }
}

/// A node, and the planes that the nodes above it are inside of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeTask {
    node: u32,
    mask: u8,
}

impl NodeTask {
    #[inline]
    pub(super) fn new(node: u32, mask: u8) -> Self {
        NodeTask { node, mask }
    }
}

impl Task for NodeTask {
    #[inline]
    fn pack(self) -> u64 {
        u64::from(self.node) << 6 | u64::from(self.mask)
    }
    #[inline]
    fn unpack(word: u64) -> Self {
        NodeTask::new((word >> 6) as u32, (word & 63) as u8)
    }
}

/// Where a descent goes on after a node.
enum Next {
    /// Below it: where its subtree ends, and the planes to be skipped there.
    Below(u32, u8),
    /// Here, after its subtree.
    After(u32),
}

impl<M: Machine> Frame<'_, M> {
    /// Visits a node.
    #[inline]
    fn visit_node<P: Processor>(&self, node: u32, mask: u8, found: &mut Visible, cpu: &P) -> Next {
        let record = &self.tree.records[node as usize];
        cpu.touch(record);
        self.tree.volumes.touch(node as usize, cpu);
        let verdict = self.test(node, record, mask);
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
        if whole || verdict.side == Side::Intersecting {
            Next::Below(record.end, if self.steps.masking { verdict.inside } else { 0 })
        } else {
            Next::After(record.end)
        }
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
    type Task = RangeTask;
    type Found = Visible;

    fn root(&self) -> Option<RangeTask> {
        Some(RangeTask::new(0, self.0.all()?, 0))
    }

    fn found(&self) -> Visible {
        Visible::default()
    }

    #[inline]
    fn visit<P: Processor>(
        &self,
        task: RangeTask,
        found: &mut Visible,
        cpu: &P,
        mut emit: impl FnMut(RangeTask),
    ) {
        if let Next::Below(end, mask) = self.0.visit_node(task.start, task.mask, found, cpu) {
            let mut next = task.start + 1;
            while next < end {
                let (start, stop) = self.0.child(next, cpu);
                emit(RangeTask::new(start, stop, mask));
                next = stop;
            }
        }
    }

    /// The skip-pointer descent: a walk along the array, leaping over what is skipped. Only with masking there
    /// is something to remember on the way: where each mask ends.
    #[inline]
    fn descend<P: Processor>(
        &self,
        task: RangeTask,
        found: &mut Visible,
        cpu: &P,
        stack: &mut Vec<u64>,
    ) -> u64 {
        let (mut visited, bottom) = (0, stack.len());
        let RangeTask { start: mut node, stop, mut mask } = task;
        // Where `mask` ends.
        let mut until = stop;
        while node < stop {
            while node >= until {
                let outer = stack.pop().map_or(task, RangeTask::unpack);
                (until, mask) = (outer.stop, outer.mask);
            }
            visited += 1;
            node = match self.0.visit_node(node, mask, found, cpu) {
                Next::Below(end, inner) => {
                    if inner != mask && node + 1 < end {
                        stack.push(RangeTask::new(0, until, mask).pack());
                        (until, mask) = (end, inner);
                    }
                    node + 1
                }
                Next::After(end) => end,
            };
        }
        stack.truncate(bottom);
        visited
    }

    fn size(&self, task: RangeTask) -> usize {
        (task.stop - task.start) as usize
    }
}

/// Tasks are nodes, as on a tree of pointers (Paper II sections 3.1 and 3.2).
pub struct NodeWork<'f, 'a, M: Machine>(pub(super) &'f Frame<'a, M>);

impl<M: Machine> TreeWork for NodeWork<'_, '_, M> {
    type Task = NodeTask;
    type Found = Visible;

    fn root(&self) -> Option<NodeTask> {
        self.0.all().map(|_| NodeTask::new(0, 0))
    }

    fn found(&self) -> Visible {
        Visible::default()
    }

    #[inline]
    fn visit<P: Processor>(
        &self,
        task: NodeTask,
        found: &mut Visible,
        cpu: &P,
        mut emit: impl FnMut(NodeTask),
    ) {
        if let Next::Below(end, mask) = self.0.visit_node(task.node, task.mask, found, cpu) {
            let mut next = task.node + 1;
            while next < end {
                let (node, stop) = self.0.child(next, cpu);
                emit(NodeTask::new(node, mask));
                next = stop;
            }
        }
    }
}
