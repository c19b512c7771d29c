//! A ray as hierarchies of boxes see it whose items are in spaces of their own: bounds of where it is, so that what is
//! rounded on the way into those spaces loses no hit.

use super::Scale;
use super::aim::{LEAST_PART, rows, spread};
use super::span::{Seek, Slab};
use crate::geometry::FineRay;
use crate::geometry::lanes::Lanes;
use glam::{DVec3, Vec3, Vec3A};

/// By how much distances are rounded outwards: twice what the box test of triangles takes, so that a box around their
/// boxes is never passed over for its own rounding.
const SLACK: f32 = 1.0 / (1 << 19) as f32;
/// By how much farther than a hit boxes may begin and still be looked into: of hits equally near all are to be seen.
const BEYOND: f64 = 1.0 / (1 << 18) as f64;
/// What is at least taken for the rounding of an origin, as a share of the greatest coordinate there is.
pub(super) const LEAST: f64 = 1.0 / (1u64 << 48) as f64;

/// A ray in a scale's lengths, with room for error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    /// The origins that make planes seem nearest where they are come to first, and farthest where last.
    first_origin: Vec3,
    last_origin: Vec3,
    first_rate: Vec3,
    last_rate: Vec3,
    near: f32,
    /// By axis, whether it goes up.
    rises: [bool; 3],
    /// Lengths for each 1 of the ray's own `t`, and where that begins.
    lengths: f64,
    start: f64,
}

impl Probe {
    /// A ray that may be anywhere within `error` of where it is said to be, along each axis: a share of the sum of its
    /// origin's and the scale's greatest coordinates. `None` if it meets nothing whatever there is: it holds a NaN,
    /// leads nowhere, or starts beyond what can be told in the scale's lengths.
    pub(crate) fn new(ray: &FineRay, scale: Scale, error: f64) -> Option<Self> {
        let (near, far) = (f64::from(ray.near), f64::from(ray.far));
        let start = near.min(0.0);
        let factor = f64::from(scale.factor());
        let origin = (ray.origin + ray.direction * start) * factor;
        let greatest = ray.origin.abs().max((ray.direction * start).abs()).max_element() * factor;
        // No coordinate of the scale is above 2.
        let room = error.max(LEAST) * (greatest + 2.0);
        let (low, high) = (down(origin - room), up(origin + room));
        let longest = ray.direction.abs().max_element();
        let usable =
            low.is_finite() && high.is_finite() && ray.direction.is_finite() && longest > 0.0 && near <= far;
        if !usable {
            return None;
        }
        let direction = Vec3A::from((ray.direction / longest).as_vec3());
        // A lesser part comes to less than the room over the length of a ray.
        let small = direction.abs().cmplt(Vec3A::splat(LEAST_PART));
        // Wrong by 2^-23 at most, of which there are many in the slack.
        let rate = Vec3A::select(small, Vec3A::ZERO.copysign(direction), direction).recip();
        let falls = direction.is_negative_bitmask();
        let rises = [falls & 1 == 0, falls & 2 == 0, falls & 4 == 0];
        let pick = |up: Vec3, down: Vec3| Vec3::select(rises.into(), up, down);
        let lengths = longest * factor;
        Some(Self {
            first_origin: pick(high, low),
            last_origin: pick(low, high),
            first_rate: (rate * (1.0 - SLACK)).into(),
            last_rate: (rate * (1.0 + SLACK)).into(),
            near: ((near - start) * lengths * f64::from(1.0 - SLACK)) as f32,
            rises,
            lengths,
            start,
        })
    }

    /// How far a box may begin that has a point on the ray at `t`, in the ray's own lengths, or before.
    #[inline]
    pub(crate) fn reach(&self, t: f32) -> f32 {
        // Not infinite, which is where boxes begin that are met nowhere.
        (((f64::from(t) - self.start) * self.lengths * (1.0 + BEYOND)) as f32).min(f32::MAX)
    }
}

impl Seek for Probe {
    type In<L: Lanes> = Feeler<L>;

    #[inline]
    fn rows(&self) -> [usize; 3] {
        rows(self.rises)
    }

    #[inline(always)]
    unsafe fn spread<L: Lanes>(&self) -> Feeler<L> {
        // SAFETY: the processor is the caller's.
        unsafe {
            Feeler {
                first_origin: spread(self.first_origin.to_array()),
                last_origin: spread(self.last_origin.to_array()),
                first_rate: spread(self.first_rate.to_array()),
                last_rate: spread(self.last_rate.to_array()),
                near: L::splat(self.near),
            }
        }
    }
}

/// A probe in lanes.
#[derive(Clone, Copy)]
pub(crate) struct Feeler<L> {
    first_origin: [L; 3],
    last_origin: [L; 3],
    first_rate: [L; 3],
    last_rate: [L; 3],
    near: L,
}

impl<L: Lanes> Slab<L> for Feeler<L> {
    #[inline(always)]
    unsafe fn slab(&self, reach: L, first: [L; 3], last: [L; 3]) -> [L; 2] {
        // SAFETY: the processor is the caller's.
        unsafe {
            // A NaN among the first arguments is passed over.
            let enters =
                self.enters(first, 0).max(self.enters(first, 1).max(self.enters(first, 2).max(self.near)));
            let leaves = self.leaves(last, 0).min(self.leaves(last, 1).min(self.leaves(last, 2).min(reach)));
            [enters, leaves]
        }
    }
}

impl<L: Lanes> Feeler<L> {
    #[inline(always)]
    unsafe fn enters(&self, planes: [L; 3], axis: usize) -> L {
        // SAFETY: the processor is the caller's.
        unsafe { planes[axis].sub(self.first_origin[axis]).mul(self.first_rate[axis]) }
    }

    #[inline(always)]
    unsafe fn leaves(&self, planes: [L; 3], axis: usize) -> L {
        // SAFETY: the processor is the caller's.
        unsafe { planes[axis].sub(self.last_origin[axis]).mul(self.last_rate[axis]) }
    }
}

/// More than a number is changed by rounding it to f32: as a share of it, and however small it is.
const ROUNDED: [f64; 2] = [1.0 / (1 << 23) as f64, f32::MIN_POSITIVE as f64];

/// Not more than it is, by two places at most.
fn down(at: DVec3) -> Vec3 {
    (at - (at.abs() * ROUNDED[0] + ROUNDED[1])).as_vec3()
}

/// Not less than it is, by two places at most.
fn up(at: DVec3) -> Vec3 {
    (at + (at.abs() * ROUNDED[0] + ROUNDED[1])).as_vec3()
}
