//! One ray on its own.

use super::super::WideBvh;
use super::super::wide::{Block, TRIANGLES, Together};
use super::count::Count;
use super::nearest::Nearest;
use super::packet::Guess;
use super::waiting::{PLACES, Stack};
use super::walk::{Walker, walk};
use crate::geometry::hit::{Aim, Beam, TriangleTest, meet, slab};
use crate::geometry::lanes::Lanes;
use crate::geometry::{Hit, Ray};
use std::marker::PhantomData;
use std::mem::MaybeUninit;
use std::ops::ControlFlow;

/// Takes a ray through: the nearest hit, or with `ANY` whichever is found first; `None` if it hits nothing.
///
/// # Safety
/// The processor has the vector units of the lanes for nodes `N` and for blocks `B`.
#[inline(always)]
pub(super) unsafe fn through<'b, N: Lanes, B: Lanes, T: TriangleTest, C: Count, const ANY: bool>(
    bvh: &'b WideBvh<T>,
    count: &mut C,
    ray: &Ray,
    guess: &mut Guess<'b>,
) -> Option<Hit> {
    // Here, where the unit's own instructions make it and its numbers need not go through memory.
    let aim = &Aim::new(ray, bvh.scale)?;
    // SAFETY: the processor is the caller's.
    unsafe { go_on::<N, B, T, C, ANY>(bvh, count, aim, Nearest::none(aim.far), guess) }.hit(|t| aim.own_t(t))
}

/// Takes a ray through that may have a hit already: what is nearest then.
///
/// # Safety
/// The processor has the vector units of the lanes for nodes `N` and for blocks `B`.
#[inline(always)]
pub(super) unsafe fn go_on<'b, N: Lanes, B: Lanes, T: TriangleTest, C: Count, const ANY: bool>(
    bvh: &'b WideBvh<T>,
    count: &mut C,
    aim: &Aim,
    nearest: Nearest,
    guess: &mut Guess<'b>,
) -> Nearest {
    // SAFETY: the processor is the caller's.
    let mut one = unsafe {
        One::<N, B, T, ANY> {
            beam: Beam::one(aim),
            block_beam: Beam::one(aim),
            near: aim.near,
            nearest,
            hit: guess.0,
            test: PhantomData,
        }
    };
    if ANY && let Some(block) = guess.0 {
        count.block();
        // SAFETY: the processor is the caller's.
        if unsafe { one.block(block) }.is_break() {
            return one.nearest;
        }
    }
    let mut places = [const { MaybeUninit::uninit() }; PLACES];
    let mut many = Vec::new();
    let places = if bvh.waiting <= PLACES {
        &mut places[..]
    } else {
        many.resize_with(bvh.waiting, MaybeUninit::uninit);
        &mut many[..]
    };
    // Whether it broke off, at the first of any hits, is to be seen by there being one.
    // SAFETY: the processor is the caller's, and the places are enough.
    let _ = unsafe { walk::<N, T>(bvh, count, &mut one, Stack::of(places)) };
    guess.0 = one.hit;
    one.nearest
}

struct One<'b, N, B, T, const ANY: bool> {
    beam: Beam<N>,
    block_beam: Beam<B>,
    near: f32,
    nearest: Nearest,
    /// The block that a hit was last taken from.
    hit: Option<&'b Block>,
    test: PhantomData<T>,
}

impl<'b, N: Lanes, B: Lanes, T: TriangleTest, const ANY: bool> Walker<'b, N> for One<'b, N, B, T, ANY> {
    #[inline(always)]
    fn rows(&self) -> [usize; 3] {
        self.beam.rows()
    }

    #[inline(always)]
    fn far(&self) -> f32 {
        self.nearest.t
    }

    #[inline(always)]
    unsafe fn slab(&mut self, first: [N; 3], last: [N; 3]) -> [N; 2] {
        // SAFETY: the processor is the caller's.
        unsafe { slab(&self.beam, [N::splat(self.near), N::splat(self.nearest.t)], first, last) }
    }

    #[inline(always)]
    unsafe fn block(&mut self, block: &'b Block) -> ControlFlow<()> {
        for from in (0..TRIANGLES).step_by(B::LEN) {
            // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 4.
            unsafe {
                let Some(found) = meet::<B, T>(&self.block_beam, &Together { block, from }) else { continue };
                let in_reach =
                    found.t.at_least(B::splat(self.near)) & B::splat(self.nearest.t).at_least(found.t);
                let lanes = found.lanes & in_reach;
                if lanes != 0 {
                    self.nearest.take(&found, lanes, &block.items[from..]);
                    if ANY && self.nearest.is_hit() {
                        self.hit = Some(block);
                        return ControlFlow::Break(());
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }
}
