//! The vector unit of 64-bit ARM: 4 lanes.

use super::Lanes;
use std::arch::aarch64::*;

#[derive(Clone, Copy)]
pub(crate) struct Lanes4(float32x4_t);

// SAFETY (all methods): every 64-bit ARM processor with an operating system has the unit; `load` reads and `store` writes 4 floats
// that the caller says are there.
impl Lanes for Lanes4 {
    const LEN: usize = 4;
    #[inline(always)]
    unsafe fn splat(value: f32) -> Self {
        // SAFETY: as said above.
        Self(unsafe { vdupq_n_f32(value) })
    }
    #[inline(always)]
    unsafe fn load(column: &[f32], from: usize) -> Self {
        // SAFETY: as said above.
        Self(unsafe { vld1q_f32(column.as_ptr().add(from)) })
    }
    #[inline(always)]
    unsafe fn add(self, other: Self) -> Self {
        // SAFETY: as said above.
        Self(unsafe { vaddq_f32(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn sub(self, other: Self) -> Self {
        // SAFETY: as said above.
        Self(unsafe { vsubq_f32(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn mul(self, other: Self) -> Self {
        // SAFETY: as said above.
        Self(unsafe { vmulq_f32(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn div(self, other: Self) -> Self {
        // SAFETY: as said above.
        Self(unsafe { vdivq_f32(self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn min(self, other: Self) -> Self {
        // Not `vminq_f32`, as for the greater.
        // SAFETY: as said above.
        Self(unsafe { vbslq_f32(vcltq_f32(self.0, other.0), self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn turned_by(self, other: Self) -> Self {
        // SAFETY: as said above.
        unsafe {
            let sign = vandq_u32(vreinterpretq_u32_f32(other.0), vdupq_n_u32(1 << 31));
            Self(vreinterpretq_f32_u32(veorq_u32(vreinterpretq_u32_f32(self.0), sign)))
        }
    }
    #[inline(always)]
    unsafe fn max(self, other: Self) -> Self {
        // Not `vmaxq_f32`, which makes a NaN of one NaN.
        // SAFETY: as said above.
        Self(unsafe { vbslq_f32(vcgtq_f32(self.0, other.0), self.0, other.0) })
    }
    #[inline(always)]
    unsafe fn abs(self) -> Self {
        // SAFETY: as said above.
        Self(unsafe { vabsq_f32(self.0) })
    }
    #[inline(always)]
    unsafe fn greater(self, other: Self) -> u64 {
        // SAFETY: as said above.
        unsafe { bits(vcgtq_f32(self.0, other.0)) }
    }
    #[inline(always)]
    unsafe fn at_least(self, other: Self) -> u64 {
        // SAFETY: as said above.
        unsafe { bits(vcgeq_f32(self.0, other.0)) }
    }
    #[inline(always)]
    unsafe fn store(self, column: &mut [f32], from: usize) {
        // SAFETY: as said above.
        unsafe { vst1q_f32(column.as_mut_ptr().add(from), self.0) }
    }
}

/// One bit of each lane.
#[inline]
#[target_feature(enable = "neon")]
fn bits(mask: uint32x4_t) -> u64 {
    const BITS: [u32; 4] = [1, 2, 4, 8];
    // SAFETY: there are four.
    let each = unsafe { vld1q_u32(BITS.as_ptr()) };
    u64::from(vaddvq_u32(vandq_u32(mask, each)))
}
