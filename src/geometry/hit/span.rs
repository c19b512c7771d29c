//! What rays that go much the same way have in common.

use super::Scale;
use super::aim::{SLACK, rows, spread};
use super::probe::LEAST;
use crate::geometry::Ray;
use crate::geometry::lanes::Lanes;
use glam::Vec3A;

/// How far apart directions may be that go much the same way, as shares of their greatest part.
pub(super) const APART: f32 = 0.125;

/// The intervals that the parts of some rays span: of one octant, none parallel to a plane of an axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    /// The origins that make planes seem nearest where they are come to first, and farthest where last.
    pub(super) first_origin: Vec3A,
    pub(super) last_origin: Vec3A,
    /// Least and greatest.
    pub(super) first_rate: [Vec3A; 2],
    pub(super) last_rate: [Vec3A; 2],
    /// The nearest start of a ray.
    pub(crate) near: f32,
    /// The farthest end of a ray.
    pub(crate) far: f32,
    /// By axis, whether they go up.
    pub(crate) rises: [bool; 3],
}

/// How many times closer together rays end than they begin that are rather looked at from their ends.
const CLOSER: f32 = 4.0;
/// By how much an end may be beside where it is said to be: as a share of the way there, four times what the box test of
/// one ray rounds distances outwards, and of the greatest coordinate.
const END_ROUNDED: [f32; 2] = [4.0 * SLACK, 1.0 / (1 << 21) as f32];

/// By how much distances of rays that [`Span::about`] is told of are rounded outwards: four times as far as a probe's.
const ABOUT_SLACK: f32 = 1.0 / (1 << 17) as f32;
/// By how much farther than it reaches a ray is taken to reach.
const BEYOND: f32 = 1.0 / (1 << 16) as f32;
/// What is at least taken for the rounding of an origin, as a share of the greatest coordinate.
const ROUNDED: f32 = 1.0 / (1 << 22) as f32;
/// Rates beyond this, or below one over it, are of parts so small, or so great, that their own rounding tells.
const MOST_RATE: f32 = (1u128 << 100) as f32;

impl Span {
    /// What the same rays span on their way back, where they end between `low` and `high`, if that is closer together than
    /// they begin, as for those to one light: it is as narrow near the light as they are, and these intervals widen with
    /// distance. `way` is how far they go along any axis at most. A box, from a distance of 0 on, is met by it that is met
    /// by one of them.
    #[inline(always)]
    pub(super) fn back(&self, [low, high]: [Vec3A; 2], way: f32) -> Option<Self> {
        let origins = [self.first_origin, self.last_origin];
        let begin_apart = (origins[0] - origins[1]).abs().max_element();
        let greatest = origins[0].abs().max(origins[1].abs()).max(low.abs().max(high.abs())).max_element();
        let room = way * END_ROUNDED[0] + greatest * END_ROUNDED[1];
        let (low, high) = (low - room, high + room);
        // So that a NaN is none, too.
        let is_closer = (high - low).max_element() * CLOSER <= begin_apart;
        if !(is_closer && low.is_finite() && high.is_finite()) {
            return None;
        }
        let rises = self.rises.map(|rises| !rises);
        let up = rises.into();
        Some(Self {
            first_origin: Vec3A::select(up, high, low),
            last_origin: Vec3A::select(up, low, high),
            first_rate: [-self.first_rate[1], -self.first_rate[0]],
            last_rate: [-self.last_rate[1], -self.last_rate[0]],
            near: 0.0,
            far: self.far,
            rises,
        })
    }

    /// What rays span each of which may be anywhere within `error` of where it is said to be, along each axis: a share of
    /// the sum of its origin's and the scale's greatest coordinates. In the rays' own `t`, as [`Span::reach`] is.
    /// `None` if they do not go much the same way, one begins before its origin, is not finite or parallel to a plane of an
    /// axis, or has a part beyond what can be told in the scale's lengths.
    ///
    /// A box is met by it that is met by the [`Probe`](super::Probe) of any of them.
    #[inline]
    pub(crate) fn about(rays: &[Ray], scale: Scale, error: f32) -> Option<Self> {
        let first = rays.first()?;
        let way = Way::of(first);
        let is_like_first = |ray: &Ray| {
            ray.near >= 0.0
                && ray.origin.is_finite()
                && ray.direction.is_finite()
                && Way::of(ray).is_like(way)
        };
        if !rays.iter().all(is_like_first) {
            return None;
        }
        let over = |part: fn(&Ray) -> Vec3A| {
            rays.iter().fold([part(first); 2], |[least, greatest], ray| {
                [least.min(part(ray)), greatest.max(part(ray))]
            })
        };
        let lengths = scale.factor();
        let [low, high] = over(|ray| ray.origin.into()).map(|origin| origin * lengths);
        let greatest = low.abs().max(high.abs()).max_element();
        // No coordinate of the scale is above 2.
        let room = greatest * ROUNDED + (greatest + 2.0) * error.max(LEAST as f32) + f32::MIN_POSITIVE;
        let (low, high) = (low - room, high + room);
        let [least, greatest] = over(|ray| ray.direction.into()).map(|direction| direction * lengths);
        let rates = [greatest.recip(), least.recip()];
        let are_usable = |rate: Vec3A| {
            rate.abs().max_element() < MOST_RATE && rate.abs().min_element() > MOST_RATE.recip()
        };
        if !(low.is_finite() && high.is_finite() && rates.into_iter().all(are_usable)) {
            return None;
        }
        let rises = [0, 1, 2].map(|axis| way.octant >> axis & 1 == 0);
        let pick = |up: Vec3A, down: Vec3A| Vec3A::select(rises.into(), up, down);
        Some(Self {
            first_origin: pick(high, low),
            last_origin: pick(low, high),
            first_rate: rates.map(|rate| rate * (1.0 - ABOUT_SLACK)),
            last_rate: rates.map(|rate| rate * (1.0 + ABOUT_SLACK)),
            near: rays.iter().fold(f32::INFINITY, |least, ray| least.min(ray.near)) * (1.0 - ABOUT_SLACK),
            far: Self::reach(rays.iter().fold(0.0, |farthest, ray| ray.far.max(farthest))),
            rises,
        })
    }

    /// How far a box may begin that has a point at `t` on one of the rays that it is [`Span::about`], or before.
    #[inline]
    pub(crate) fn reach(t: f32) -> f32 {
        // Not infinite, which is where boxes begin that are met nowhere.
        (t * (1.0 + BEYOND)).min(f32::MAX)
    }
}

/// Which way a ray goes, to be held against others' before they are made ready.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Way {
    /// Its greatest part is 1.
    direction: Vec3A,
    octant: u32,
}

impl Way {
    /// That of a ray.
    #[inline]
    pub(crate) fn of(ray: &Ray) -> Self {
        let own = Vec3A::from(ray.direction);
        Self { direction: own / own.abs().max_element(), octant: own.is_negative_bitmask() }
    }

    /// Whether rays of equal length that go this way and that one, go much the same; not if one goes nowhere.
    #[inline]
    pub(crate) fn is_like(self, other: Self) -> bool {
        self.octant == other.octant && (self.direction - other.direction).abs().max_element() <= APART
    }
}

/// What seeks boxes: one ray or several that go together, made ready.
pub(crate) trait Seek {
    /// The same in lanes.
    type In<L: Lanes>: Slab<L>;

    /// As [`super::Beam::rows`].
    fn rows(&self) -> [usize; 3];

    /// The same in lanes.
    ///
    /// # Safety
    /// The processor has the lanes' vector unit.
    unsafe fn spread<L: Lanes>(&self) -> Self::In<L>;
}

/// The box test of what seeks.
pub(crate) trait Slab<L: Lanes> {
    /// From where to where a ray of it may be between the planes of boxes, those come to `first` and `last`, by axis: no
    /// later and no earlier than [`super::slab`] tells of each. The first exceeds the second if nowhere.
    ///
    /// # Safety
    /// The processor has the lanes' vector unit.
    unsafe fn slab(&self, far: L, first: [L; 3], last: [L; 3]) -> [L; 2];
}

impl Seek for Span {
    type In<L: Lanes> = Spread<L>;

    #[inline(always)]
    fn rows(&self) -> [usize; 3] {
        rows(self.rises)
    }

    #[inline(always)]
    unsafe fn spread<L: Lanes>(&self) -> Spread<L> {
        // SAFETY: the processor is the caller's.
        unsafe {
            Spread {
                first_origin: spread(self.first_origin.to_array()),
                last_origin: spread(self.last_origin.to_array()),
                first_rate: [spread(self.first_rate[0].to_array()), spread(self.first_rate[1].to_array())],
                last_rate: [spread(self.last_rate[0].to_array()), spread(self.last_rate[1].to_array())],
                near: L::splat(self.near),
            }
        }
    }
}

/// A span in lanes.
#[derive(Clone, Copy)]
pub(crate) struct Spread<L> {
    first_origin: [L; 3],
    last_origin: [L; 3],
    first_rate: [[L; 3]; 2],
    last_rate: [[L; 3]; 2],
    near: L,
}

impl<L: Lanes> Slab<L> for Spread<L> {
    #[inline(always)]
    unsafe fn slab(&self, far: L, first: [L; 3], last: [L; 3]) -> [L; 2] {
        // SAFETY: the processor is the caller's.
        unsafe {
            let enters =
                self.enters(first, 0).max(self.enters(first, 1).max(self.enters(first, 2).max(self.near)));
            let leaves = self.leaves(last, 0).min(self.leaves(last, 1).min(self.leaves(last, 2).min(far)));
            [enters, leaves]
        }
    }
}

impl<L: Lanes> Spread<L> {
    #[inline(always)]
    unsafe fn enters(&self, planes: [L; 3], axis: usize) -> L {
        // SAFETY: the processor is the caller's.
        unsafe {
            let from = planes[axis].sub(self.first_origin[axis]);
            from.mul(self.first_rate[0][axis]).min(from.mul(self.first_rate[1][axis]))
        }
    }

    #[inline(always)]
    unsafe fn leaves(&self, planes: [L; 3], axis: usize) -> L {
        // SAFETY: the processor is the caller's.
        unsafe {
            let from = planes[axis].sub(self.last_origin[axis]);
            from.mul(self.last_rate[0][axis]).max(from.mul(self.last_rate[1][axis]))
        }
    }
}
