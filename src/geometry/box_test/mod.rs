//! Many boxes against a frustum: the basic plane test of Paper I sec. 3.1 on blocks of 64, by the widest
//! vector unit there is.
//!
//! The promise is that of [`super::culling`]: boxes are taken relative to the eye, each comparison is
//! against a bound on its own rounding, a box is never called outside that is not, an empty box is outside, a
//! box with a NaN or an infinity is not. Two things differ. The bound is over the farther coordinate of each
//! axis, not over both, so a few boxes more are certainly outside. And it grows with the box: whatever
//! is called outside, all boxes within it are called outside too, rounding and all, because every step
//! (subtracting the eye, three products by fixed factors, three sums) keeps the order of its
//! arguments when it is rounded. A hierarchy of boxes therefore gives the same mask as all of them one by one.
//!
//! All kernels do the same operations in the same order, without fused ones, so their masks are the
//! same bit for bit. Which corner of a box a plane asks for depends on the plane alone, so it is picked
//! by address and not by a blend; there is no early out, as memory is what a flat array waits for.

#[cfg(target_arch = "aarch64")]
mod arm;
mod kernels;
#[cfg(target_arch = "x86_64")]
mod x86;

use super::{Aabb, BoxBlock, Frustum, PLANE_COUNT, Volume};

/// A frustum made ready for tests of many boxes, once a frame, and the kernel to do them.
#[derive(Clone, Copy, Debug)]
pub struct BoxTest {
    view: View,
    kernel: Kernel,
}

/// Two bits for each box of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockSides {
    /// Bit `i` is set when box `i` is not certainly outside.
    pub visible: u64,
    /// Bit `i` is set when box `i` is certainly inside, and not empty.
    pub inside: u64,
}

impl BoxTest {
    /// The test for a frustum by the best kernel this processor has.
    pub fn new(frustum: &Frustum) -> Self {
        Self::with_kernel(frustum, Kernel::best())
    }

    /// The test for a frustum by a kernel of one's choice.
    pub fn with_kernel(frustum: &Frustum, kernel: Kernel) -> Self {
        Self { view: View::new(frustum), kernel }
    }

    /// Tests blocks of boxes: bit `i` of `words[b]` is set when box `i` of block `b` is not certainly
    /// outside.
    ///
    /// # Panics
    /// If there are not as many words as blocks.
    #[inline]
    pub fn visible(&self, blocks: &[BoxBlock], words: &mut [u64]) {
        assert_eq!(blocks.len(), words.len(), "a mask word for each block");
        // SAFETY: a `Kernel` is only made where its processor features are there.
        unsafe { (self.kernel.0.visible)(&self.view, blocks, words) }
    }

    /// Tests one block, also for boxes that lie inside.
    #[inline]
    pub fn sides(&self, block: &BoxBlock) -> BlockSides {
        // SAFETY: as above.
        unsafe { (self.kernel.0.sides)(&self.view, block) }
    }
}

/// One plane as a kernel reads it.
#[derive(Clone, Copy, Debug)]
struct PlaneView {
    normal: [f32; 3],
    low: f32,
    high: f32,
    /// By axis: whether the corner deepest inside has the greatest coordinate (1) or the least (0).
    deepest: [usize; 3],
}

/// A frustum as a kernel reads it.
#[derive(Clone, Copy, Debug)]
struct View {
    eye: [f32; 3],
    planes: [PlaneView; PLANE_COUNT],
}

impl View {
    fn new(frustum: &Frustum) -> Self {
        let planes = frustum.kernel.map(|plane| {
            let signs = Aabb::field(plane.normal);
            PlaneView {
                normal: plane.normal.to_array(),
                low: plane.low,
                high: plane.high,
                deepest: [0, 1, 2].map(|axis| usize::from(signs >> axis & 1)),
            }
        });
        Self { eye: frustum.eye.to_array(), planes }
    }
}

/// A kernel's code.
struct Code {
    name: &'static str,
    is_there: fn() -> bool,
    visible: unsafe fn(&View, &[BoxBlock], &mut [u64]),
    sides: unsafe fn(&View, &BoxBlock) -> BlockSides,
}

/// The same test for another vector unit.
#[derive(Clone, Copy)]
pub struct Kernel(&'static Code);

/// Every kernel of this architecture, the widest first; the last is everywhere.
const ALL: &[Code] = &[
    #[cfg(target_arch = "x86_64")]
    x86::AVX512,
    #[cfg(target_arch = "x86_64")]
    x86::AVX2,
    #[cfg(target_arch = "x86_64")]
    x86::SSE2,
    #[cfg(target_arch = "aarch64")]
    arm::NEON,
    kernels::SCALAR,
];

impl Kernel {
    /// The kernels this processor can run, the widest first: `avx512`, `avx2`, `sse2`, `neon`, `scalar`.
    pub fn all() -> impl Iterator<Item = Self> {
        ALL.iter().filter(|code| (code.is_there)()).map(Self)
    }

    /// The widest.
    pub fn best() -> Self {
        Self::all().next().unwrap_or(Self(&kernels::SCALAR))
    }

    /// The one of that name; `None` if this processor has none.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|kernel| kernel.name() == name)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        self.0.name
    }
}

impl std::fmt::Debug for Kernel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl PartialEq for Kernel {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
