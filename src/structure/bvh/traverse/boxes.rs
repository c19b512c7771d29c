//! One ray, or several that go the same way, through boxes, whatever is in them.

use super::super::BoxBvh;
use super::super::wide::WIDTH;
use super::count::{Count, Uncounted};
use super::waiting::{PLACES, Stack};
use crate::geometry::hit::{Probe, Seek, Slab, Span};
use crate::geometry::lanes::{Kind, Lanes};
use crate::geometry::{FineRay, Ray};
use std::mem::MaybeUninit;

impl BoxBvh {
    /// Goes through the items in whose boxes a ray may end, nearer ones first. `item` is told an item's place in the
    /// order and how far the ray still reaches, in its `t`, and answers how far it reaches from then on; below the ray's
    /// `near`, no further item is asked about.
    ///
    /// `error` is by how much the ray may be beside where it is said to be, along each axis: a share of the sum of its
    /// origin's and the boxes' greatest coordinates. No box is passed over that it meets so, nor one that begins as far
    /// off as it reaches: of hits equally near all are seen. Where the ray goes through a box may be told wrong by
    /// 2^-19 of how far off that is, so an item's own test may be.
    #[inline]
    pub fn walk(&self, ray: &FineRay, error: f64, item: impl FnMut(usize, f32) -> f32) {
        self.walk_counted(ray, error, &mut Uncounted, item);
    }

    /// The same, counted.
    #[inline]
    pub(in crate::structure::bvh) fn walk_counted(
        &self,
        ray: &FineRay,
        error: f64,
        count: &mut impl Count,
        mut item: impl FnMut(usize, f32) -> f32,
    ) {
        let Some(probe) = Probe::new(ray, self.scale, error) else { return };
        let mut far = ray.far;
        on_unit(self, &probe, probe.reach(far), count, |place| {
            far = item(place, far);
            (far >= ray.near).then(|| probe.reach(far))
        });
    }

    /// Goes with several rays through the items in whose boxes one of them may end, nearer ones first; `error` as for one.
    /// `item` is told an item's place in the order, and shortens in `fars` how far each ray still reaches, below its
    /// `near` if it is over; it answers whether to go on. Tells whether the rays go the same way: if not, nothing is
    /// asked.
    pub(in crate::structure::bvh) fn walk_together(
        &self,
        rays: &[Ray],
        fars: &mut [f32],
        error: f64,
        mut item: impl FnMut(usize, &mut [f32]) -> bool,
    ) -> bool {
        let Some(span) = Span::about(rays, self.scale, error as f32) else { return false };
        let reach = |fars: &[f32]| {
            let under_way = rays.iter().zip(fars).filter(|(ray, far)| **far >= ray.near);
            under_way.map(|(_, far)| Span::reach(*far)).reduce(f32::max)
        };
        if let Some(farthest) = reach(fars) {
            let mut item = |place| if item(place, fars) { reach(fars) } else { None };
            on_unit(self, &span, farthest, &mut Uncounted, &mut item);
        }
        true
    }

    /// Whether it can be told of several rays together that none of them ends in an item's box; `error` as for one.
    pub fn is_missed_by(&self, rays: &[Ray], error: f64) -> bool {
        let Some(span) = Span::about(rays, self.scale, error as f32) else { return false };
        let mut is_missed = true;
        on_unit(self, &span, span.far, &mut Uncounted, |_| {
            is_missed = false;
            None
        });
        is_missed
    }
}

#[inline]
fn on_unit<S: Seek, C: Count>(
    bvh: &BoxBvh,
    probe: &S,
    reach: f32,
    count: &mut C,
    item: impl FnMut(usize) -> Option<f32>,
) {
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
    fn avx2<S: Seek, C: Count>(
        bvh: &BoxBvh,
        probe: &S,
        reach: f32,
        count: &mut C,
        item: impl FnMut(usize) -> Option<f32>,
    ) {
        // SAFETY: this function has the feature.
        unsafe { through::<crate::geometry::lanes::x86::Lanes8, S, C>(bvh, probe, reach, count, item) }
    }
    match bvh.unit.0 {
        // SAFETY: a `Unit` is only made where it is there, this one where the bit instructions are too.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx2 => unsafe { avx2(bvh, probe, reach, count, item) },
        // SAFETY: every x86-64 processor has the unit.
        #[cfg(target_arch = "x86_64")]
        Kind::Sse2 => unsafe {
            through::<crate::geometry::lanes::x86::Lanes4, S, C>(bvh, probe, reach, count, item)
        },
        // SAFETY: every 64-bit ARM processor with an operating system has the unit.
        #[cfg(target_arch = "aarch64")]
        Kind::Neon => unsafe {
            through::<crate::geometry::lanes::arm::Lanes4, S, C>(bvh, probe, reach, count, item)
        },
        // SAFETY: one lane needs no unit.
        Kind::Scalar => unsafe { through::<f32, S, C>(bvh, probe, reach, count, item) },
    }
}

/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn through<L: Lanes, S: Seek, C: Count>(
    bvh: &BoxBvh,
    probe: &S,
    reach: f32,
    count: &mut C,
    item: impl FnMut(usize) -> Option<f32>,
) {
    let mut places = [const { MaybeUninit::uninit() }; PLACES];
    if bvh.waiting <= PLACES {
        // SAFETY: the processor is the caller's.
        return unsafe { walk::<L, S, C>(bvh, probe, reach, count, Stack::of(&mut places), item) };
    }
    let mut many = vec![MaybeUninit::uninit(); bvh.waiting];
    // SAFETY: as above.
    unsafe { walk::<L, S, C>(bvh, probe, reach, count, Stack::of(&mut many), item) }
}

/// The walk itself: each item answers how far boxes may begin from then on, or that it is over. In addition: `stack` has
/// as many places as may wait.
#[inline(always)]
unsafe fn walk<L: Lanes, S: Seek, C: Count>(
    bvh: &BoxBvh,
    probe: &S,
    mut reach: f32,
    count: &mut C,
    mut stack: Stack<'_>,
    mut item: impl FnMut(usize) -> Option<f32>,
) {
    if bvh.nodes.is_empty() {
        return;
    }
    // SAFETY: the processor is the caller's.
    let feeler = unsafe { probe.spread::<L>() };
    let rows = probe.rows();
    let mut at = bvh.root;
    'next: loop {
        while at.blocks() == 0 {
            count.node();
            // SAFETY: children are nodes that are there, and rows are below six.
            let node = unsafe { bvh.nodes.get_unchecked(at.index()) };
            let mut enters = [0.0f32; WIDTH];
            let mut hit = 0u64;
            for from in (0..WIDTH).step_by(L::LEN) {
                // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 8.
                unsafe {
                    let first = [node.row(rows[0], from), node.row(rows[1], from), node.row(rows[2], from)];
                    let last = [
                        node.row(rows[0] ^ 1, from),
                        node.row(rows[1] ^ 1, from),
                        node.row(rows[2] ^ 1, from),
                    ];
                    let [first, last] = feeler.slab(L::splat(reach), first, last);
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
        // A node none of whose boxes is met falls through with no items.
        for of in 0..at.blocks() {
            match item(at.index() + of) {
                Some(further) => reach = further,
                None => return,
            }
        }
        loop {
            let Some(waiting) = stack.pop() else { return };
            if waiting.enters() <= reach {
                at = waiting.child();
                continue 'next;
            }
        }
    }
}

#[cfg(test)]
mod tests;
