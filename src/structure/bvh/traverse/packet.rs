//! Several rays that go much the same way, together: Boulos, Wald and Shirley's (2006) "Geometric and Arithmetic
//! Culling Methods for Entire Ray Packets", by intervals.
//!
//! A node's eight boxes are tested against all rays at once: distances of planes are taken at the ends of the intervals
//! that the rays' origins and rates span. Each step keeps the order of its arguments when it is rounded, so what one ray
//! meets on its own the packet meets. So are the boxes of a block's triangles; the triangles left over are tested against as
//! many rays at a time as there are lanes, by the same operations as one ray's, so every hit is the same. Rays to one
//! light are held against boxes from the light, where they are narrowest, with room for what that rounds. Rays that turn
//! out to have little in common go on one by one.

use super::super::WideBvh;
use super::super::wide::{Alone, Block, TRIANGLES, Together as Four, WIDTH};
use super::count::Count;
use super::nearest::Nearest;
use super::single::go_on;
use super::waiting::{PLACES, Stack};
use super::walk::{Walker, walk};
use crate::geometry::hit::{Aim, Beam, Columns, Seek, Slab, Span, Spread, TriangleTest, meet, sides};
use crate::geometry::lanes::Lanes;
use crate::geometry::{Hit, Ray};
use std::marker::PhantomData;
use std::mem::MaybeUninit;
use std::ops::ControlFlow;

/// Rays a packet.
pub(in crate::structure::bvh) const RAYS: usize = 16;

/// How many nodes and blocks a packet may test before its rays go on by themselves. Where triangles are so fine that no
/// two rays meet the same, 16 take some hundred and seventy of both by themselves; those worth keeping together take
/// fewer than this.
const MOST: usize = 64;

/// What is asked about first by who looks for any hit: where the last was that found one, as neighbours' shadows are
/// mostly of the same thing.
#[derive(Clone, Copy, Default)]
pub(super) struct Guess<'b>(pub(super) Option<&'b Block>);

/// What comes of a packet.
pub(super) struct Together {
    /// The nearest hit of each ray, or with `ANY` one it has.
    pub(super) hits: [Option<Hit>; RAYS],
    /// Whether they stayed together to the end.
    pub(super) stayed: bool,
}

/// Takes the rays through, not more than [`RAYS`]: each to its nearest hit, or with `ANY` until it has one. If they have
/// little in common after all, those that are still under way go on by themselves, from what they have met by then.
/// `None` if they do not go the same way ([`Columns::of`]), or one goes nowhere.
///
/// # Safety
/// The processor has the vector units of the lanes for nodes `N` and for blocks `B`.
#[inline(always)]
pub(super) unsafe fn together<'b, N: Lanes, B: Lanes, T: TriangleTest, C: Count, const ANY: bool>(
    bvh: &'b WideBvh<T>,
    count: &mut C,
    rays: &[Ray],
    guess: &mut Guess<'b>,
) -> Option<Together> {
    // SAFETY: the processor is the caller's.
    let (columns, span) = &unsafe { Columns::of::<N, ANY>(rays, bvh.scale) }?;
    // SAFETY: the processor is the caller's.
    let mut several = unsafe {
        Several::<N, B, T, ANY> {
            span,
            wide: span.spread(),
            narrow: span.spread(),
            columns,
            nearest: columns.far.map(Nearest::none),
            farthest: span.far,
            under_way: (1 << RAYS) - 1,
            vectors: 0,
            hit: guess.0,
            types: PhantomData,
        }
    };
    if ANY && let Some(block) = guess.0 {
        count.block();
        // SAFETY: the processor is the caller's.
        let _ = unsafe { several.block(block) };
    }
    let mut places = [const { MaybeUninit::uninit() }; PLACES];
    let mut stayed = bvh.waiting <= PLACES;
    if stayed && several.under_way != 0 {
        // SAFETY: the processor is the caller's, and the places are enough.
        let end = unsafe { walk::<N, T>(bvh, count, &mut several, Stack::of(&mut places)) };
        stayed = end.is_continue() || several.under_way == 0;
    }
    guess.0 = several.hit;
    let mut hits = [None; RAYS];
    for (number, (hit, nearest)) in hits.iter_mut().zip(several.nearest).enumerate() {
        *hit = nearest.hit(|t| columns.own_t(number, t));
    }
    if !stayed {
        for (number, (hit, ray)) in hits.iter_mut().zip(rays).enumerate() {
            if several.under_way >> number & 1 == 1 {
                let (aim, nearest) = (Aim::new(ray, bvh.scale), several.nearest[number]);
                let aim = &aim.expect("it was made ready before");
                // SAFETY: the processor is the caller's.
                let nearest = unsafe { go_on::<N, B, T, C, ANY>(bvh, count, aim, nearest, guess) };
                *hit = nearest.hit(|t| aim.own_t(t));
            }
        }
    }
    Some(Together { hits, stayed })
}

struct Several<'a, 'b, N, B, T, const ANY: bool> {
    span: &'a Span,
    wide: Spread<N>,
    narrow: Spread<B>,
    columns: &'a Columns,
    nearest: [Nearest; RAYS],
    farthest: f32,
    /// Bit `i` is set while ray `i` looks for hits: with `ANY`, until it has one.
    under_way: u64,
    /// Vectors of boxes and blocks tested.
    vectors: usize,
    /// The block that a hit was last taken from.
    hit: Option<&'b Block>,
    types: PhantomData<T>,
}

impl<'b, N: Lanes, B: Lanes, T: TriangleTest, const ANY: bool> Walker<'b, N>
    for Several<'_, 'b, N, B, T, ANY>
{
    #[inline(always)]
    fn rows(&self) -> [usize; 3] {
        self.span.rows()
    }

    #[inline(always)]
    fn far(&self) -> f32 {
        self.farthest
    }

    #[inline(always)]
    unsafe fn slab(&mut self, first: [N; 3], last: [N; 3]) -> [N; 2] {
        self.vectors += 1;
        // SAFETY: the processor is the caller's.
        unsafe { self.wide.slab(N::splat(self.farthest), first, last) }
    }

    #[inline(always)]
    unsafe fn block(&mut self, block: &'b Block) -> ControlFlow<()> {
        self.vectors += WIDTH / N::LEN;
        if self.vectors > MOST * (WIDTH / N::LEN) {
            return ControlFlow::Break(());
        }
        let rises = self.span.rises;
        let mut met = 0u64;
        for from in (0..TRIANGLES).step_by(B::LEN) {
            // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 4.
            unsafe {
                let some = Four { block, from };
                let (x, y, z) = (sides(rises, &some, 0), sides(rises, &some, 1), sides(rises, &some, 2));
                let [first, last] =
                    self.narrow.slab(B::splat(self.farthest), [x[0], y[0], z[0]], [x[1], y[1], z[1]]);
                met |= last.at_least(first) << from;
            }
        }
        let mut is_taken = false;
        while met != 0 {
            let lane = met.trailing_zeros() as usize & (TRIANGLES - 1);
            met &= met - 1;
            let item = block.items[lane];
            // As often as it takes: the fewer lanes a vector has, the more beams there are.
            for from in (0..RAYS).step_by(N::LEN) {
                let under_way = self.under_way >> from;
                if ANY && under_way.trailing_zeros() as usize >= N::LEN {
                    continue;
                }
                // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 16.
                unsafe {
                    let beam = Beam::several(self.columns, from);
                    let Some(found) = meet::<N, T>(&beam, &Alone { block, lane }) else { continue };
                    let lanes = found.lanes & under_way & found.t.at_least(N::splat(0.0));
                    if lanes != 0 {
                        let (nearest, near) = (&mut self.nearest[from..], &self.columns.near[from..]);
                        is_taken |= Nearest::take_each(nearest, near, &found, lanes, item);
                    }
                }
            }
        }
        if is_taken {
            self.hit = Some(block);
            let mut farthest = 0.0;
            for (ray, nearest) in self.nearest.iter().enumerate() {
                if ANY && nearest.is_hit() {
                    self.under_way &= !(1 << ray);
                } else if nearest.t > farthest {
                    farthest = nearest.t;
                }
            }
            self.farthest = farthest;
            if ANY && self.under_way == 0 {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    }
}
