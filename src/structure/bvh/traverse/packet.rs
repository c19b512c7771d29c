//! Several rays that go much the same way, together: Boulos, Wald and Shirley's (2006) "Geometric and Arithmetic
//! Culling Methods for Entire Ray Packets", by intervals.
//!
//! A node's eight boxes are tested against all rays at once: distances of planes are taken at the ends of the intervals
//! that the rays' origins and rates span. Each step keeps the order of its arguments when it is rounded, so what one ray
//! meets on its own the packet meets. So are the boxes of a block's triangles; the triangles left over are tested
//! against as many rays at a time as there are lanes, by the same operations as one ray's, so every hit is the same.

use super::super::WideBvh;
use super::super::wide::{Alone, TRIANGLES, Together, WIDTH};
use super::count::Count;
use super::nearest::Nearest;
use super::waiting::{PLACES, Stack};
use crate::geometry::hit::{Aim, Beam, Span, TriangleTest, meet, sides};
use crate::geometry::lanes::Lanes;
use std::mem::MaybeUninit;

/// Rays a packet.
pub(super) const RAYS: usize = 16;

/// How many nodes and blocks a packet may test before its rays go on their own: about as many as they would take if
/// they had nothing in common.
const BUDGET: usize = 160;

/// Takes the rays through, all of which go together ([`Span::of`]): the nearest hit of each. `None` if they have little
/// in common after all.
///
/// # Safety
/// The processor has the vector units of the lanes for nodes `N` and for blocks `B`.
#[inline(always)]
pub(super) unsafe fn together<N: Lanes, B: Lanes, T: TriangleTest, C: Count>(
    bvh: &WideBvh<T>,
    count: &mut C,
    aims: &[Aim; RAYS],
    span: &Span,
) -> Option<[Nearest; RAYS]> {
    let mut nearest = aims.each_ref().map(Nearest::none);
    if bvh.nodes.is_empty() {
        return Some(nearest);
    }
    if bvh.waiting > PLACES {
        return None;
    }
    let mut places = [const { MaybeUninit::uninit() }; PLACES];
    let mut stack = Stack::of(&mut places);
    let mut farthest = span.far;
    let mut steps = 0;
    // SAFETY: the processor is the caller's.
    let (wide, narrow) = unsafe { (span.spread::<N>(), span.spread::<B>()) };
    let rows = span.rows();
    // As many as it takes: the fewer lanes a vector has, the more beams there are.
    let mut beams = [const { MaybeUninit::<Beam<N>>::uninit() }; RAYS];
    for (beam, from) in beams.iter_mut().zip((0..RAYS).step_by(N::LEN)) {
        // SAFETY: as above; the lanes are below 16.
        beam.write(unsafe { Beam::several(aims, from) });
    }
    let mut at = bvh.root;
    'next: loop {
        while at.blocks() == 0 {
            count.node();
            steps += 1;
            // SAFETY: children are nodes that are there, and rows are below six.
            let node = unsafe { bvh.nodes.get_unchecked(at.index()) };
            let mut enters = [0.0f32; WIDTH];
            let mut hit = 0u64;
            for from in (0..WIDTH).step_by(N::LEN) {
                // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 8.
                unsafe {
                    let first = [node.row(rows[0], from), node.row(rows[1], from), node.row(rows[2], from)];
                    let last = [
                        node.row(rows[0] ^ 1, from),
                        node.row(rows[1] ^ 1, from),
                        node.row(rows[2] ^ 1, from),
                    ];
                    let [first, last] = wide.slab(N::splat(farthest), first, last);
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
        for of in 0..at.blocks() {
            count.block();
            steps += 1;
            // SAFETY: children are blocks that are there.
            let block = unsafe { bvh.blocks.get_unchecked(at.index() + of) };
            let mut met = 0u64;
            for from in (0..TRIANGLES).step_by(B::LEN) {
                // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 4.
                unsafe {
                    let some = Together { block, from };
                    let (x, y, z) = (
                        sides(span.rises, &some, 0),
                        sides(span.rises, &some, 1),
                        sides(span.rises, &some, 2),
                    );
                    let [first, last] =
                        narrow.slab(B::splat(farthest), [x[0], y[0], z[0]], [x[1], y[1], z[1]]);
                    met |= last.at_least(first) << from;
                }
            }
            let mut is_nearer = false;
            while met != 0 {
                let lane = met.trailing_zeros() as usize & (TRIANGLES - 1);
                met &= met - 1;
                let item = block.items[lane];
                for (beam, from) in beams.iter().zip((0..RAYS).step_by(N::LEN)) {
                    // SAFETY: as many beams were written as there are steps; the processor is the caller's.
                    unsafe {
                        let beam = beam.assume_init_ref();
                        let Some(found) = meet::<N, T>(beam, &Alone { block, lane }) else { continue };
                        let lanes = found.lanes & found.t.at_least(N::splat(0.0));
                        if lanes != 0 {
                            is_nearer |=
                                Nearest::take_each(&mut nearest[from..], &aims[from..], &found, lanes, item);
                        }
                    }
                }
            }
            if is_nearer {
                farthest = nearest.iter().fold(0.0, |most, ray| if ray.t > most { ray.t } else { most });
            }
        }
        if steps > BUDGET {
            return None;
        }
        loop {
            let Some(waiting) = stack.pop() else { return Some(nearest) };
            if waiting.enters() <= farthest {
                at = waiting.child();
                continue 'next;
            }
        }
    }
}
