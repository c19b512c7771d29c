//! The way through a hierarchy, whoever goes.

use super::super::WideBvh;
use super::super::wide::{Block, Node, WIDTH};
use super::count::Count;
use super::waiting::Stack;
use crate::geometry::hit::TriangleTest;
use crate::geometry::lanes::Lanes;
use std::ops::ControlFlow;

/// Who goes: a ray, or rays that go much the same way. All methods are to be inlined always: what is not has not the
/// unit's target feature, and costs ten times as much.
///
/// # Safety of the methods
/// The processor has the vector unit of the lanes.
pub(super) trait Walker<'b, N: Lanes> {
    /// By axis, of six rows of planes, least and greatest of each axis, the one come to first; the other of its pair
    /// differs in the last bit.
    fn rows(&self) -> [usize; 3];

    /// How far it still goes.
    fn far(&self) -> f32;

    /// From where to where it may be between planes: by axis, those come to first and last. The first exceeds the
    /// second if nowhere.
    unsafe fn slab(&mut self, first: [N; 3], last: [N; 3]) -> [N; 2];

    /// Tests the triangles of a block. A break ends the way.
    unsafe fn block(&mut self, block: &'b Block) -> ControlFlow<()>;
}

/// Takes a walker through, nearer boxes first. Tells whether it came to the end or broke off.
///
/// # Safety
/// The processor has the lanes' vector unit, and `stack` as many places as may wait.
#[inline(always)]
pub(super) unsafe fn walk<'b, N: Lanes, T: TriangleTest>(
    bvh: &'b WideBvh<T>,
    count: &mut impl Count,
    walker: &mut impl Walker<'b, N>,
    mut stack: Stack<'_>,
) -> ControlFlow<()> {
    if bvh.nodes.is_empty() {
        return ControlFlow::Continue(());
    }
    let rows = walker.rows();
    let mut at = bvh.root;
    loop {
        while at.blocks() == 0 {
            count.node();
            // SAFETY: children are nodes that are there.
            let node = unsafe { bvh.nodes.get_unchecked(at.index()) };
            let mut enters = [0.0f32; WIDTH];
            // SAFETY: the processor is the caller's, and rows are below six.
            let met = unsafe { met(node, rows, walker, &mut enters) };
            if met == 0 {
                break;
            }
            // SAFETY: there is one, and no more wait than the collapse counted.
            at = unsafe { stack.nearest(met, &enters, node) };
        }
        // A node none of whose boxes is met falls through with no blocks.
        for of in 0..at.blocks() {
            count.block();
            // SAFETY: children are blocks that are there; the processor is the caller's.
            unsafe { walker.block(bvh.blocks.get_unchecked(at.index() + of)) }?;
        }
        at = loop {
            let Some(waiting) = stack.pop() else { return ControlFlow::Continue(()) };
            if waiting.enters() <= walker.far() {
                break waiting.child();
            }
        };
    }
}

/// Which of a node's boxes are met, one bit each, and where they are entered.
///
/// # Safety
/// The processor has the lanes' vector unit, and rows are below six.
#[inline(always)]
unsafe fn met<'b, N: Lanes>(
    node: &Node,
    rows: [usize; 3],
    walker: &mut impl Walker<'b, N>,
    enters: &mut [f32; WIDTH],
) -> u64 {
    let mut met = 0;
    for from in (0..WIDTH).step_by(N::LEN) {
        // SAFETY: the processor and the rows are the caller's; `from` steps by the lanes' number below 8.
        unsafe {
            let first = [node.row(rows[0], from), node.row(rows[1], from), node.row(rows[2], from)];
            let last =
                [node.row(rows[0] ^ 1, from), node.row(rows[1] ^ 1, from), node.row(rows[2] ^ 1, from)];
            let [first, last] = walker.slab(first, last);
            met |= last.at_least(first) << from;
            first.store(enters, from);
        }
    }
    met
}
