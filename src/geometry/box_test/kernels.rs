//! The test itself, over as many boxes at a time as a vector has lanes.

use super::{BlockSides, Code, View};
use crate::geometry::culling::ROUNDING;
use crate::geometry::lanes::Lanes;
use crate::geometry::{BoxBlock, PLANE_COUNT};

/// Coordinates relative to the eye of the boxes from `from` on: by axis, then least and greatest.
#[inline(always)]
unsafe fn relative<L: Lanes>(view: &View, block: &BoxBlock, from: usize) -> [[L; 2]; 3] {
    // SAFETY: `from` and the processor are the caller's.
    std::array::from_fn(|axis| unsafe {
        let eye = L::splat(view.eye[axis]);
        block.coordinates[axis].each_ref().map(|column| L::load(column, from).sub(eye))
    })
}

/// The bound on the rounding of a plane test of these boxes, infinite or NaN if a coordinate is. The last
/// term covers underflow.
#[inline(always)]
unsafe fn slack<L: Lanes>(relative: &[[L; 2]; 3]) -> L {
    // SAFETY: the processor is the caller's.
    unsafe {
        let [x, y, z] = relative.each_ref().map(|[least, greatest]| least.abs().max(greatest.abs()));
        x.add(y).add(z).mul(L::splat(ROUNDING)).add(L::splat(f32::MIN_POSITIVE))
    }
}

/// The greatest distance term over all planes, at the corners deepest inside (`FARTHEST` false) or farthest
/// outside. With a finite slack no term is NaN; with another it does not matter what this is.
#[inline(always)]
unsafe fn worst<L: Lanes, const FARTHEST: bool>(view: &View, relative: &[[L; 2]; 3]) -> L {
    // SAFETY: the processor is the caller's.
    unsafe {
        let mut worst = L::splat(f32::NEG_INFINITY);
        for plane in &view.planes {
            let corner = |axis: usize| {
                let side = plane.deepest[axis] ^ usize::from(FARTHEST);
                relative[axis][side & 1].mul(L::splat(plane.normal[axis]))
            };
            let d = if FARTHEST { plane.high } else { plane.low };
            worst = corner(0).add(corner(1)).add(corner(2)).add(L::splat(d)).max(worst);
        }
        worst
    }
}

/// How many blocks ahead memory is asked for: 3 KB, some hundred nanoseconds.
const AHEAD: usize = 2;

/// Tests every block.
///
/// # Safety
/// The processor has the lanes' vector unit, and there are as many words as blocks.
#[inline(always)]
pub(super) unsafe fn visible<L: Lanes>(view: &View, blocks: &[BoxBlock], words: &mut [u64]) {
    const { assert!(BoxBlock::LEN.is_multiple_of(L::LEN) && PLANE_COUNT > 0) };
    for (i, (block, word)) in blocks.iter().zip(words).enumerate() {
        // Six columns at a time are too many short streams for the processor to foresee.
        if let Some(soon) = blocks.get(i + AHEAD) {
            soon.columns().for_each(|column| L::prefetch(column));
        }
        let mut hidden = 0;
        for from in (0..BoxBlock::LEN).step_by(L::LEN) {
            // SAFETY: `from` steps by the lanes' number below 64; the processor is the caller's.
            let bits = unsafe {
                let relative = relative::<L>(view, block, from);
                let outside = worst::<L, false>(view, &relative).greater(slack(&relative));
                let [least, greatest] = relative[0];
                outside | least.greater(greatest)
            };
            hidden |= bits << from;
        }
        *word = !hidden;
    }
}

/// Tests one block, also for boxes inside.
///
/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
pub(super) unsafe fn sides<L: Lanes>(view: &View, block: &BoxBlock) -> BlockSides {
    let (mut hidden, mut inside) = (0, 0);
    for from in (0..BoxBlock::LEN).step_by(L::LEN) {
        // SAFETY: as above.
        unsafe {
            let relative = relative::<L>(view, block, from);
            let slack = slack(&relative);
            let [least, greatest] = relative[0];
            let outside = worst::<L, false>(view, &relative).greater(slack);
            hidden |= (outside | least.greater(greatest)) << from;
            // Inside: however far out the rounding put the farthest corner, it is not beyond a plane.
            let bound = L::splat(0.0).sub(slack);
            let within = bound.greater(worst::<L, true>(view, &relative));
            inside |= (within & L::splat(f32::INFINITY).greater(slack)) << from;
        }
    }
    BlockSides { visible: !hidden, inside: inside & !hidden }
}

pub(super) const SCALAR: Code = Code {
    name: "scalar",
    is_there: || true,
    // Written as vectors are, but the compiler is left to make of it what it can.
    visible: visible::<f32>,
    sides: sides::<f32>,
};
