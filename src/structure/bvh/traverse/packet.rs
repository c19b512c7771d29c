//! Several rays that go much the same way, together: Boulos, Wald and Shirley's (2006) "Geometric and Arithmetic
//! Culling Methods for Entire Ray Packets", by intervals.
//!
//! A node's eight boxes are tested against all rays at once: distances of planes are taken at the ends of the intervals
//! that the rays' origins and rates span. Each step keeps the order of its arguments when it is rounded, so what one ray
//! meets on its own the packet meets. So are the boxes of a block's triangles; the triangles left over are tested
//! against as many rays at a time as there are lanes, by the same operations as one ray's, so every hit is the same.

use super::super::WideBvh;
use super::super::wide::{Alone, Block, TRIANGLES, Together};
use super::count::Count;
use super::nearest::Nearest;
use super::single::test_block;
use super::waiting::{PLACES, Stack};
use super::walk::{Walker, walk};
use crate::geometry::hit::{Aim, Beam, Span, Spread, TriangleTest, meet, sides, slab};
use crate::geometry::lanes::Lanes;
use std::marker::PhantomData;
use std::mem::MaybeUninit;
use std::ops::ControlFlow;

/// Rays a packet.
pub(super) const RAYS: usize = 16;

/// How many blocks a packet may test before its rays go on their own: about as many as they would take if
/// they had nothing in common.
const BUDGET: usize = 160;

/// Takes the rays through, all of which go together ([`Span::of`]): the nearest hit of each. `None` if they have little
/// in common after all.
///
/// # Safety
/// The processor has the vector units of the lanes for nodes `N` and for blocks `B`.
#[inline(always)]
pub(super) unsafe fn together<N: Lanes, B: Lanes, T: TriangleTest, C: Count>(
    bvh: &WideBvh<T>,
    count: &mut C,
    aims: &[Aim; RAYS],
    span: &Span,
) -> Option<[Nearest; RAYS]> {
    if bvh.waiting > PLACES {
        return None;
    }
    // As many as it takes: the fewer lanes a vector has, the more beams there are.
    let mut beams = [const { MaybeUninit::<Beam<N>>::uninit() }; RAYS];
    for (beam, from) in beams.iter_mut().zip((0..RAYS).step_by(N::LEN)) {
        // SAFETY: the processor is the caller's; the lanes are below 16.
        beam.write(unsafe { Beam::several(aims, from) });
    }
    // SAFETY: the processor is the caller's.
    let mut several = unsafe {
        Several::<N, B, T> {
            aims,
            span,
            wide: span.spread(),
            narrow: span.spread(),
            beams,
            nearest: aims.each_ref().map(Nearest::none),
            reach: aims.each_ref().map(|aim| aim.far),
            farthest: span.far,
            budget: BUDGET,
            test: PhantomData,
        }
    };
    let mut places = [const { MaybeUninit::uninit() }; PLACES];
    // SAFETY: the processor is the caller's, and the places are enough.
    unsafe { walk::<N, T>(bvh, count, &mut several, Stack::of(&mut places)) };
    (several.budget > 0).then_some(several.nearest)
}

struct Several<'a, N, B, T> {
    aims: &'a [Aim; RAYS],
    span: &'a Span,
    wide: Spread<N>,
    narrow: Spread<B>,
    beams: [MaybeUninit<Beam<N>>; RAYS],
    nearest: [Nearest; RAYS],
    /// How far each still goes, as `nearest` has it.
    reach: [f32; RAYS],
    farthest: f32,
    budget: usize,
    test: PhantomData<T>,
}

impl<N: Lanes, B: Lanes, T: TriangleTest> Walker<N> for Several<'_, N, B, T> {
    #[inline(always)]
    fn rows(&self) -> [usize; 3] {
        self.span.rows()
    }

    #[inline(always)]
    fn far(&self) -> f32 {
        self.farthest
    }

    #[inline(always)]
    unsafe fn slab(&self, first: [N; 3], last: [N; 3]) -> [N; 2] {
        // SAFETY: the processor is the caller's.
        unsafe { self.wide.slab(N::splat(self.farthest), first, last) }
    }

    #[inline(always)]
    unsafe fn block(&mut self, block: &Block) -> ControlFlow<()> {
        self.budget -= 1;
        if self.budget == 0 {
            return ControlFlow::Break(());
        }
        let rises = self.span.rises;
        // By axis: the planes of the triangles' boxes that rays come to first, and last.
        let mut planes = [[[0.0f32; TRIANGLES]; 2]; 3];
        let mut met = 0u64;
        for from in (0..TRIANGLES).step_by(B::LEN) {
            // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 4.
            unsafe {
                let some = Together { block, from };
                let (x, y, z) = (sides(rises, &some, 0), sides(rises, &some, 1), sides(rises, &some, 2));
                let [first, last] =
                    self.narrow.slab(B::splat(self.farthest), [x[0], y[0], z[0]], [x[1], y[1], z[1]]);
                met |= last.at_least(first) << from;
                x[0].store(&mut planes[0][0], from);
                x[1].store(&mut planes[0][1], from);
                y[0].store(&mut planes[1][0], from);
                y[1].store(&mut planes[1][1], from);
                z[0].store(&mut planes[2][0], from);
                z[1].store(&mut planes[2][1], from);
            }
        }
        if met == 0 {
            return ControlFlow::Continue(());
        }
        // SAFETY: the processor is the caller's.
        let rays = unsafe { self.at_box_around(met, &planes) };
        let (alone, each) =
            (TRIANGLES / B::LEN * rays.count_ones() as usize, RAYS / N::LEN * met.count_ones() as usize);
        // SAFETY: as above.
        let is_nearer = unsafe {
            if alone < each { self.ray_by_ray(block, rays) } else { self.one_by_one(block, met, rays) }
        };
        if is_nearer {
            self.farthest =
                self.reach.iter().fold(0.0, |most, reach| if *reach > most { *reach } else { most });
        }
        ControlFlow::Continue(())
    }
}

impl<N: Lanes, B: Lanes, T: TriangleTest> Several<'_, N, B, T> {
    /// Which rays meet the box around some triangles of a block, one bit each: few, where triangles are finer than
    /// the rays.
    ///
    /// # Safety
    /// The processor has the lanes' vector units, and there is a triangle.
    #[inline(always)]
    unsafe fn at_box_around(&self, mut met: u64, planes: &[[[f32; TRIANGLES]; 2]; 3]) -> u64 {
        let pick = |lane: usize| planes.map(|[first, last]| [first[lane], last[lane]]);
        let mut next = || {
            let lane = met.trailing_zeros() as usize & (TRIANGLES - 1);
            met &= met - 1;
            (pick(lane), met)
        };
        let (mut around, mut left) = next();
        while left != 0 {
            let (other, rest) = next();
            left = rest;
            for ((around, other), rises) in around.iter_mut().zip(other).zip(self.span.rises) {
                let (least, greatest) =
                    (|a: f32, b: f32| if a < b { a } else { b }, |a: f32, b: f32| if a > b { a } else { b });
                *around = if rises {
                    [least(around[0], other[0]), greatest(around[1], other[1])]
                } else {
                    [greatest(around[0], other[0]), least(around[1], other[1])]
                };
            }
        }
        let mut rays = 0;
        for (beam, from) in self.beams.iter().zip((0..RAYS).step_by(N::LEN)) {
            // SAFETY: as many beams were written as there are steps; the processor is the caller's.
            unsafe {
                let [x, y, z] = around;
                let first = [N::splat(x[0]), N::splat(y[0]), N::splat(z[0])];
                let last = [N::splat(x[1]), N::splat(y[1]), N::splat(z[1])];
                let reach = [N::splat(self.span.near), N::load(&self.reach, from)];
                let [first, last] = slab(beam.assume_init_ref(), reach, first, last);
                rays |= last.at_least(first) << from;
            }
        }
        rays
    }

    /// Tests some rays, each with all triangles of a block. Tells whether any hit is nearer.
    ///
    /// # Safety
    /// The processor has the lanes' vector units.
    #[inline(always)]
    unsafe fn ray_by_ray(&mut self, block: &Block, mut rays: u64) -> bool {
        let mut is_nearer = false;
        while rays != 0 {
            let ray = rays.trailing_zeros() as usize & (RAYS - 1);
            rays &= rays - 1;
            // SAFETY: the processor is the caller's.
            unsafe {
                let beam = Beam::<B>::one(&self.aims[ray]);
                test_block::<B, T>(&beam, self.aims[ray].near, block, &mut self.nearest[ray]);
            }
            is_nearer |= self.nearest[ray].t < self.reach[ray];
            self.reach[ray] = self.nearest[ray].t;
        }
        is_nearer
    }

    /// Tests some triangles of a block, each with all rays of vectors that hold some of `rays`. Tells whether any hit is
    /// nearer.
    ///
    /// # Safety
    /// The processor has the lanes' vector units.
    #[inline(always)]
    unsafe fn one_by_one(&mut self, block: &Block, mut met: u64, rays: u64) -> bool {
        let mut is_nearer = false;
        while met != 0 {
            let lane = met.trailing_zeros() as usize & (TRIANGLES - 1);
            met &= met - 1;
            let item = block.items[lane];
            for (beam, from) in self.beams.iter().zip((0..RAYS).step_by(N::LEN)) {
                if rays >> from & ((1 << N::LEN) - 1) == 0 {
                    continue;
                }
                // SAFETY: as many beams were written as there are steps; the processor is the caller's.
                unsafe {
                    let beam = beam.assume_init_ref();
                    let Some(found) = meet::<N, T>(beam, &Alone { block, lane }) else { continue };
                    let lanes = found.lanes & found.t.at_least(N::splat(0.0));
                    if lanes != 0 {
                        is_nearer |= Nearest::take_each(
                            &mut self.nearest[from..],
                            &mut self.reach[from..],
                            &self.aims[from..],
                            &found,
                            lanes,
                            item,
                        );
                    }
                }
            }
        }
        is_nearer
    }
}
