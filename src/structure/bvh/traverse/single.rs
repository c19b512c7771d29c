//! One ray on its own.

use super::super::WideBvh;
use super::super::wide::{TRIANGLES, Together, WIDTH};
use super::count::Count;
use super::nearest::Nearest;
use super::waiting::{PLACES, Stack};
use crate::geometry::hit::{Aim, Beam, TriangleTest, meet, slab};
use crate::geometry::lanes::Lanes;
use std::mem::MaybeUninit;

/// Takes a ray through: the nearest hit, or with `ANY` whichever is found first.
///
/// # Safety
/// The processor has the vector units of the lanes for nodes `N` and for blocks `B`.
#[inline(always)]
pub(super) unsafe fn through<N: Lanes, B: Lanes, T: TriangleTest, C: Count, const ANY: bool>(
    bvh: &WideBvh<T>,
    count: &mut C,
    aim: &Aim,
) -> Nearest {
    let mut places = [const { MaybeUninit::uninit() }; PLACES];
    if bvh.waiting <= PLACES {
        // SAFETY: the processor is the caller's.
        return unsafe { walk::<N, B, T, C, ANY>(bvh, count, aim, Stack::of(&mut places)) };
    }
    let mut many = vec![MaybeUninit::uninit(); bvh.waiting];
    // SAFETY: as above.
    unsafe { walk::<N, B, T, C, ANY>(bvh, count, aim, Stack::of(&mut many)) }
}

/// The walk itself. In addition: `stack` has as many places as may wait.
#[inline(always)]
unsafe fn walk<N: Lanes, B: Lanes, T: TriangleTest, C: Count, const ANY: bool>(
    bvh: &WideBvh<T>,
    count: &mut C,
    aim: &Aim,
    mut stack: Stack<'_>,
) -> Nearest {
    let mut nearest = Nearest::none(aim);
    if bvh.nodes.is_empty() {
        return nearest;
    }
    // SAFETY: the processor is the caller's.
    let (beam, block_beam) = unsafe { (Beam::<N>::one(aim), Beam::<B>::one(aim)) };
    let rows = beam.rows();
    let mut at = bvh.root;
    'next: loop {
        while at.blocks() == 0 {
            count.node();
            // SAFETY: children are nodes that are there, and rows are below six.
            let node = unsafe { bvh.nodes.get_unchecked(at.index()) };
            let mut enters = [0.0f32; WIDTH];
            let mut hit = 0u64;
            for from in (0..WIDTH).step_by(N::LEN) {
                // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 8.
                unsafe {
                    let reach = [N::splat(aim.near), N::splat(nearest.t)];
                    let first = [node.row(rows[0], from), node.row(rows[1], from), node.row(rows[2], from)];
                    let last = [
                        node.row(rows[0] ^ 1, from),
                        node.row(rows[1] ^ 1, from),
                        node.row(rows[2] ^ 1, from),
                    ];
                    let [first, last] = slab(&beam, reach, first, last);
                    hit |= last.at_least(first) << from;
                    first.store(&mut enters, from);
                }
            }
            if hit == 0 {
                break;
            }
            // SAFETY: there is one, and no more wait than the collapse counted.
            at = unsafe { stack.nearest(hit, &enters, node) };
        }
        // A node none of whose boxes is met falls through with no blocks.
        for of in 0..at.blocks() {
            count.block();
            // SAFETY: children are blocks that are there.
            let block = unsafe { bvh.blocks.get_unchecked(at.index() + of) };
            for from in (0..TRIANGLES).step_by(B::LEN) {
                // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 4.
                unsafe {
                    let Some(found) = meet::<B, T>(&block_beam, &Together { block, from }) else { continue };
                    let in_reach =
                        found.t.at_least(B::splat(aim.near)) & B::splat(nearest.t).at_least(found.t);
                    let lanes = found.lanes & in_reach;
                    if lanes != 0 {
                        nearest.take(&found, lanes, &block.items[from..]);
                        if ANY && nearest.is_hit() {
                            return nearest;
                        }
                    }
                }
            }
        }
        loop {
            let Some(waiting) = stack.pop() else { return nearest };
            if waiting.enters() <= nearest.t {
                at = waiting.child();
                continue 'next;
            }
        }
    }
}
