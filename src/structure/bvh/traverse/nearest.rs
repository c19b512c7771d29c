//! The nearest hit so far.

use crate::geometry::Hit;
use crate::geometry::hit::Found;
use crate::geometry::lanes::Lanes;

/// The nearest hit so far, in an aim's lengths; before there is one, the end of the ray.
#[derive(Clone, Copy)]
pub(super) struct Nearest {
    pub(super) t: f32,
    u: f32,
    v: f32,
    /// `u32::MAX` if there is none: no triangle has that number.
    item: u32,
}

impl Nearest {
    #[inline(always)]
    pub(super) fn none(far: f32) -> Self {
        Self { t: far, u: 0.0, v: 0.0, item: u32::MAX }
    }

    #[inline(always)]
    pub(super) fn is_hit(&self) -> bool {
        self.item != u32::MAX
    }

    #[inline(always)]
    pub(super) fn hit(&self, own_t: impl Fn(f32) -> f32) -> Option<Hit> {
        self.is_hit().then(|| Hit { t: own_t(self.t), u: self.u, v: self.v, item: self.item })
    }

    /// Takes what one lane found if that is nearer, or as near and of a lower number.
    #[inline(always)]
    pub(super) fn offer(&mut self, t: f32, u: f32, v: f32, item: u32) {
        if t < self.t || t == self.t && item < self.item {
            *self = Self { t, u, v, item };
        }
    }

    /// Takes the best of what a block's lanes, from `from` on, found; all are at or beyond the ray's start.
    ///
    /// # Safety
    /// The processor has the lanes' vector unit.
    #[inline(always)]
    pub(super) unsafe fn take<L: Lanes>(&mut self, found: &Found<L>, lanes: u64, items: &[u32]) {
        let (mut t, mut u, mut v) = ([0.0f32; 16], [0.0f32; 16], [0.0f32; 16]);
        // SAFETY: no vector has more than 16 lanes; the processor is the caller's.
        unsafe {
            found.t.store(&mut t, 0);
            found.u.store(&mut u, 0);
            found.v.store(&mut v, 0);
        }
        let mut left = lanes;
        while left != 0 {
            let lane = left.trailing_zeros() as usize & 15;
            left &= left - 1;
            self.offer(t[lane], u[lane], v[lane], items[lane]);
        }
    }

    /// Takes for each of some rays what its lane found of one triangle, unless that lies before the ray's start. Tells
    /// whether any is as near as what was, or nearer.
    ///
    /// # Safety
    /// The processor has the lanes' vector unit, and there are as many rays as lanes.
    #[inline(always)]
    pub(super) unsafe fn take_each<L: Lanes>(
        rays: &mut [Self],
        near: &[f32],
        found: &Found<L>,
        lanes: u64,
        item: u32,
    ) -> bool {
        let (mut t, mut u, mut v) = ([0.0f32; 16], [0.0f32; 16], [0.0f32; 16]);
        // SAFETY: no vector has more than 16 lanes; the processor is the caller's.
        unsafe {
            found.t.store(&mut t, 0);
            found.u.store(&mut u, 0);
            found.v.store(&mut v, 0);
        }
        let mut left = lanes;
        let mut is_taken = false;
        while left != 0 {
            let lane = left.trailing_zeros() as usize & 15;
            left &= left - 1;
            if t[lane] >= near[lane] {
                is_taken |= t[lane] <= rays[lane].t;
                rays[lane].offer(t[lane], u[lane], v[lane], item);
            }
        }
        is_taken
    }
}
