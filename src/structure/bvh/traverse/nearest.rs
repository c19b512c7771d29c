//! The nearest hit so far.

use crate::geometry::Hit;
use crate::geometry::hit::{Aim, Found};
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
    pub(super) fn none(aim: &Aim) -> Self {
        Self { t: aim.far, u: 0.0, v: 0.0, item: u32::MAX }
    }

    #[inline(always)]
    pub(super) fn is_hit(&self) -> bool {
        self.item != u32::MAX
    }

    #[inline(always)]
    pub(super) fn hit(&self, aim: &Aim) -> Option<Hit> {
        self.is_hit().then(|| Hit { t: aim.own_t(self.t), u: self.u, v: self.v, item: self.item })
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
        let mut columns = [[0.0f32; 16]; 3];
        for (column, part) in columns.iter_mut().zip([found.t, found.u, found.v]) {
            // SAFETY: no vector has more than 16 lanes; the processor is the caller's.
            unsafe { part.store(column, 0) };
        }
        let [t, u, v] = &columns;
        let mut left = lanes;
        while left != 0 {
            let lane = left.trailing_zeros() as usize & 15;
            left &= left - 1;
            self.offer(t[lane], u[lane], v[lane], items[lane]);
        }
    }
}
