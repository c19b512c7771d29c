//! The kernel of 64-bit ARM.

use super::{BlockSides, Code, View, kernels};
use crate::geometry::BoxBlock;
use crate::geometry::lanes::arm::Lanes4;

pub(super) const NEON: Code = {
    #[target_feature(enable = "neon")]
    fn visible(view: &View, blocks: &[BoxBlock], words: &mut [u64]) {
        // SAFETY: this function has the feature.
        unsafe { kernels::visible::<Lanes4>(view, blocks, words) }
    }
    #[target_feature(enable = "neon")]
    fn sides(view: &View, block: &BoxBlock) -> BlockSides {
        // SAFETY: this function has the feature.
        unsafe { kernels::sides::<Lanes4>(view, block) }
    }
    Code { name: "neon", is_there: || true, visible, sides }
};
