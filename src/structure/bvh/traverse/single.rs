//! One ray on its own.

use super::super::WideBvh;
use super::super::wide::{Child, TRIANGLES, Together, WIDTH};
use super::count::Count;
use super::nearest::Nearest;
use crate::geometry::hit::{Aim, Beam, TriangleTest, meet, slab};
use crate::geometry::lanes::Lanes;
use std::mem::MaybeUninit;

/// A child that waits, and where the ray enters its box.
#[derive(Clone, Copy)]
struct Waiting {
    child: Child,
    enters: f32,
}

/// How many children wait at most in a hierarchy that is not much out of balance.
const PLACES: usize = 256;

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
        return unsafe { walk::<N, B, T, C, ANY>(bvh, count, aim, &mut places) };
    }
    let mut many = vec![MaybeUninit::uninit(); bvh.waiting];
    // SAFETY: as above.
    unsafe { walk::<N, B, T, C, ANY>(bvh, count, aim, &mut many) }
}

/// The walk itself. In addition: `stack` has as many places as may wait.
#[inline(always)]
unsafe fn walk<N: Lanes, B: Lanes, T: TriangleTest, C: Count, const ANY: bool>(
    bvh: &WideBvh<T>,
    count: &mut C,
    aim: &Aim,
    stack: &mut [MaybeUninit<Waiting>],
) -> Nearest {
    let mut nearest = Nearest::none(aim);
    if bvh.nodes.is_empty() {
        return nearest;
    }
    // SAFETY: the processor is the caller's.
    let (beam, block_beam) = unsafe { (Beam::<N>::one(aim), Beam::<B>::one(aim)) };
    let rows = beam.rows();
    let mut top = 0;
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
            let lane = hit.trailing_zeros() as usize;
            hit &= hit - 1;
            let mut best = Waiting { child: node.children[lane & 7], enters: enters[lane & 7] };
            if hit == 0 {
                at = best.child;
                continue;
            }
            let below = top;
            while hit != 0 {
                let lane = hit.trailing_zeros() as usize;
                hit &= hit - 1;
                let mut other = Waiting { child: node.children[lane & 7], enters: enters[lane & 7] };
                if other.enters < best.enters {
                    std::mem::swap(&mut other, &mut best);
                }
                // SAFETY: no more wait than the collapse counted.
                unsafe { stack.get_unchecked_mut(top).write(other) };
                top += 1;
            }
            if !ANY && top - below > 1 {
                // SAFETY: these were just written.
                unsafe { sort(stack.get_unchecked_mut(below..top)) };
            }
            at = best.child;
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
            if top == 0 {
                return nearest;
            }
            top -= 1;
            // SAFETY: what is below the top was written.
            let waiting = unsafe { stack.get_unchecked(top).assume_init() };
            if waiting.enters <= nearest.t {
                at = waiting.child;
                continue 'next;
            }
        }
    }
}

/// Puts what waits in order, the nearest last.
///
/// # Safety
/// All were written.
#[inline(always)]
unsafe fn sort(waiting: &mut [MaybeUninit<Waiting>]) {
    for end in 1..waiting.len() {
        let mut at = end;
        // SAFETY: all were written, and `at` is above 0.
        while at > 0 && unsafe { waiting[at - 1].assume_init().enters < waiting[at].assume_init().enters } {
            waiting.swap(at - 1, at);
            at -= 1;
        }
    }
}
