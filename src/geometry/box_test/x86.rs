//! The kernels of x86-64.

use super::{BlockSides, Code, View, kernels};
use crate::geometry::BoxBlock;
use crate::geometry::lanes::x86::{Lanes4, Lanes8, Lanes16};

/// A kernel for a processor feature.
macro_rules! kernel {
    ($CODE:ident $name:literal $lanes:ident: $feature:tt) => {
        pub(super) const $CODE: Code = {
            #[target_feature(enable = $feature)]
            fn visible(view: &View, blocks: &[BoxBlock], words: &mut [u64]) {
                // SAFETY: this function has the feature.
                unsafe { kernels::visible::<$lanes>(view, blocks, words) }
            }
            #[target_feature(enable = $feature)]
            fn sides(view: &View, block: &BoxBlock) -> BlockSides {
                // SAFETY: this function has the feature.
                unsafe { kernels::sides::<$lanes>(view, block) }
            }
            Code { name: $name, is_there: || is_x86_feature_detected!($feature), visible, sides }
        };
    };
}

kernel!(AVX512 "avx512" Lanes16: "avx512f");
kernel!(AVX2 "avx2" Lanes8: "avx2");
kernel!(SSE2 "sse2" Lanes4: "sse2");
