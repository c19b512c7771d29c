//! The vector units of x86-64: 4 lanes everywhere, 8 with AVX2, 16 with AVX-512.

use super::Lanes;
use std::arch::x86_64::*;

/// One vector type as lanes, by the names of its instructions.
macro_rules! lanes {
    ($name:ident($vector:ty) of $len:literal:
     $splat:ident $load:ident $add:ident $sub:ident $mul:ident $max:ident $abs:ident $greater:ident
     $div:ident $min:ident $turned:ident $at_least:ident $store:ident) => {
        #[derive(Clone, Copy)]
        pub(crate) struct $name($vector);

        // SAFETY (all methods): whoever calls has the vector unit, which is all these instructions ask for;
        // `load` reads and `store` writes `$len` floats that the caller says are there, however they are aligned.
        impl Lanes for $name {
            const LEN: usize = $len;
            #[inline(always)]
            unsafe fn splat(value: f32) -> Self {
                // SAFETY: as said above.
                Self(unsafe { $splat(value) })
            }
            #[inline(always)]
            unsafe fn load(column: &[f32], from: usize) -> Self {
                // SAFETY: as said above.
                Self(unsafe { $load(column.as_ptr().add(from)) })
            }
            #[inline(always)]
            unsafe fn add(self, other: Self) -> Self {
                // SAFETY: as said above.
                Self(unsafe { $add(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn sub(self, other: Self) -> Self {
                // SAFETY: as said above.
                Self(unsafe { $sub(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn mul(self, other: Self) -> Self {
                // SAFETY: as said above.
                Self(unsafe { $mul(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn div(self, other: Self) -> Self {
                // SAFETY: as said above.
                Self(unsafe { $div(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn min(self, other: Self) -> Self {
                // SAFETY: as said above.
                Self(unsafe { $min(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn turned_by(self, other: Self) -> Self {
                // SAFETY: as said above.
                Self(unsafe { $turned(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn max(self, other: Self) -> Self {
                // SAFETY: as said above.
                Self(unsafe { $max(self.0, other.0) })
            }
            #[inline(always)]
            unsafe fn abs(self) -> Self {
                // SAFETY: as said above.
                Self(unsafe { $abs(self.0) })
            }
            #[inline(always)]
            fn prefetch(soon: &[f32]) {
                prefetch(soon);
            }
            #[inline(always)]
            unsafe fn greater(self, other: Self) -> u64 {
                // SAFETY: as said above.
                unsafe { $greater(self.0, other.0) }
            }
            #[inline(always)]
            unsafe fn at_least(self, other: Self) -> u64 {
                // SAFETY: as said above.
                unsafe { $at_least(self.0, other.0) }
            }
            #[inline(always)]
            unsafe fn store(self, column: &mut [f32], from: usize) {
                // SAFETY: as said above.
                unsafe { $store(column.as_mut_ptr().add(from), self.0) }
            }
        }
    };
}

lanes!(Lanes4(__m128) of 4:
    _mm_set1_ps _mm_loadu_ps _mm_add_ps _mm_sub_ps _mm_mul_ps _mm_max_ps abs4 greater4
    _mm_div_ps _mm_min_ps turned4 at_least4 _mm_storeu_ps);
lanes!(Lanes8(__m256) of 8:
    _mm256_set1_ps _mm256_loadu_ps _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_max_ps abs8 greater8
    _mm256_div_ps _mm256_min_ps turned8 at_least8 _mm256_storeu_ps);
lanes!(Lanes16(__m512) of 16:
    _mm512_set1_ps _mm512_loadu_ps _mm512_add_ps _mm512_sub_ps _mm512_mul_ps _mm512_max_ps _mm512_abs_ps greater16
    _mm512_div_ps _mm512_min_ps turned16 at_least16 _mm512_storeu_ps);

#[inline(always)]
fn prefetch(soon: &[f32]) {
    // 16 floats are a line of 64 bytes.
    for line in soon.chunks(16) {
        // SAFETY: every x86-64 processor has the instruction, which reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(line.as_ptr().cast()) };
    }
}

#[inline]
#[target_feature(enable = "sse2")]
fn abs4(x: __m128) -> __m128 {
    _mm_andnot_ps(_mm_set1_ps(-0.0), x)
}

#[inline]
#[target_feature(enable = "sse2")]
fn greater4(a: __m128, b: __m128) -> u64 {
    u64::from(_mm_movemask_ps(_mm_cmpgt_ps(a, b)).cast_unsigned())
}

#[inline]
#[target_feature(enable = "avx2")]
fn abs8(x: __m256) -> __m256 {
    _mm256_andnot_ps(_mm256_set1_ps(-0.0), x)
}

#[inline]
#[target_feature(enable = "avx2")]
fn greater8(a: __m256, b: __m256) -> u64 {
    u64::from(_mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(a, b)).cast_unsigned())
}

#[inline]
#[target_feature(enable = "avx512f")]
fn greater16(a: __m512, b: __m512) -> u64 {
    u64::from(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(a, b))
}

#[inline]
#[target_feature(enable = "sse2")]
fn turned4(x: __m128, by: __m128) -> __m128 {
    _mm_xor_ps(x, _mm_and_ps(by, _mm_set1_ps(-0.0)))
}

#[inline]
#[target_feature(enable = "sse2")]
fn at_least4(a: __m128, b: __m128) -> u64 {
    u64::from(_mm_movemask_ps(_mm_cmpge_ps(a, b)).cast_unsigned())
}

#[inline]
#[target_feature(enable = "avx2")]
fn turned8(x: __m256, by: __m256) -> __m256 {
    _mm256_xor_ps(x, _mm256_and_ps(by, _mm256_set1_ps(-0.0)))
}

#[inline]
#[target_feature(enable = "avx2")]
fn at_least8(a: __m256, b: __m256) -> u64 {
    u64::from(_mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(a, b)).cast_unsigned())
}

#[inline]
#[target_feature(enable = "avx512f")]
fn turned16(x: __m512, by: __m512) -> __m512 {
    let sign = _mm512_and_si512(_mm512_castps_si512(by), _mm512_set1_epi32(i32::MIN));
    _mm512_castsi512_ps(_mm512_xor_si512(_mm512_castps_si512(x), sign))
}

#[inline]
#[target_feature(enable = "avx512f")]
fn at_least16(a: __m512, b: __m512) -> u64 {
    u64::from(_mm512_cmp_ps_mask::<_CMP_GE_OQ>(a, b))
}
