//! A ray made ready for tests.

use super::scale::{Scale, to_one};
use crate::geometry::Ray;
use crate::geometry::lanes::Lanes;
use glam::Vec3;

/// By how much distances of planes are rounded outwards, relative to themselves: 16 roundings.
pub(super) const SLACK: f32 = 1.0 / (1 << 20) as f32;
/// A part of the direction below this, as a share of the greatest, counts as none: over the length of a ray it comes
/// to less than the rounding of its origin.
const LEAST_PART: f32 = 1.0 / (1u128 << 100) as f32;

/// A ray in a scale's lengths, its direction's greatest part between 1 and 2, and what tests ask of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    origin: Vec3,
    direction: Vec3,
    /// One over the direction, lessened and enlarged by the slack.
    first_rate: Vec3,
    last_rate: Vec3,
    pub(crate) near: f32,
    pub(crate) far: f32,
    /// What the watertight test takes from x and y for each z, and one over the direction's part along z, by its axes.
    shear: [f32; 3],
    /// The axes that test calls x, y and z: z is where the ray goes most.
    axes: [u8; 3],
    /// Bit `axis` is set if the ray goes down that axis.
    pub(crate) octant: u8,
    /// Lengths of the ray's own direction in each of this one's, and where its `t` begins.
    stretch: f32,
    start: f32,
}

impl Aim {
    /// The ray in a scale's lengths. `None` if it hits nothing whatever there is: its origin or its direction is not
    /// finite, its direction is zero, its ends are NaN, or no number of its lengths leads through the scene.
    ///
    /// A `near` below 0 moves the origin, for what is before it is looked for as everything is: from the start on.
    #[inline]
    pub(crate) fn new(ray: &Ray, scale: Scale) -> Option<Self> {
        let start = ray.near.min(0.0);
        let from = if start < 0.0 { ray.at(start) } else { ray.origin };
        let (near, far) = (ray.near - start, ray.far - start);
        let longest = ray.direction.abs().max_element();
        let lengthen = to_one(longest);
        let origin = scale.point(from);
        let direction = ray.direction * lengthen;
        let small = direction.abs().cmplt(Vec3::splat(LEAST_PART));
        let direction = Vec3::select(small, Vec3::ZERO.copysign(direction), direction);
        // Both are powers of two, so but for those far from 1 are product and inverse.
        let lengths = scale.factor() / lengthen;
        let stretch = 1.0 / lengths;
        let usable = origin.is_finite()
            && ray.direction.is_finite()
            && longest > 0.0
            && near <= far
            && lengths.is_normal()
            && stretch.is_normal();
        if !usable {
            return None;
        }
        let rate = direction.recip();
        let z = direction.abs().max_position();
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        Some(Self {
            origin,
            direction,
            first_rate: rate * (1.0 - SLACK),
            last_rate: rate * (1.0 + SLACK),
            near: near * lengths,
            far: (far * lengths).min(f32::MAX),
            shear: [direction[x] * rate[z], direction[y] * rate[z], rate[z]],
            axes: [x, y, z].map(|axis| axis as u8),
            octant: direction.is_negative_bitmask() as u8,
            stretch,
            start,
        })
    }

    /// A distance along it as the ray it was made of counts.
    #[inline]
    pub(crate) fn own_t(&self, t: f32) -> f32 {
        t * self.stretch + self.start
    }

    /// Whether one beam can take this one and the other.
    pub(crate) fn goes_with(&self, other: &Self) -> bool {
        self.octant == other.octant && self.axes == other.axes
    }
}

/// Rays of one octant, or one ray, as many as there are lanes.
#[derive(Clone, Copy)]
pub(crate) struct Beam<L> {
    pub(super) origin: [L; 3],
    pub(super) direction: [L; 3],
    pub(super) first_rate: [L; 3],
    pub(super) last_rate: [L; 3],
    pub(super) shear: [L; 3],
    pub(super) axes: [usize; 3],
    /// By axis: whether it goes up, so that the plane it comes to last is the greatest.
    pub(super) rises: [bool; 3],
}

impl<L> Beam<L> {
    /// By axis: of six rows of planes, least and greatest of each axis, the one it comes to first; the other of its
    /// pair differs in the last bit.
    #[inline(always)]
    pub(crate) fn rows(&self) -> [usize; 3] {
        let [x, y, z] = self.rises;
        [usize::from(!x), 2 + usize::from(!y), 4 + usize::from(!z)]
    }
}

impl<L: Lanes> Beam<L> {
    /// One ray in all lanes.
    ///
    /// # Safety
    /// The processor has the lanes' vector unit.
    #[inline(always)]
    pub(crate) unsafe fn one(aim: &Aim) -> Self {
        // SAFETY: the processor is the caller's.
        unsafe {
            Self {
                origin: spread(aim.origin.to_array()),
                direction: spread(aim.direction.to_array()),
                first_rate: spread(aim.first_rate.to_array()),
                last_rate: spread(aim.last_rate.to_array()),
                shear: spread(aim.shear),
                axes: axes(aim),
                rises: rises(aim),
            }
        }
    }
}

#[inline(always)]
unsafe fn spread<L: Lanes>([x, y, z]: [f32; 3]) -> [L; 3] {
    // SAFETY: the processor is the caller's.
    unsafe { [L::splat(x), L::splat(y), L::splat(z)] }
}

#[inline(always)]
fn axes(aim: &Aim) -> [usize; 3] {
    let [x, y, z] = aim.axes;
    [usize::from(x), usize::from(y), usize::from(z)]
}

#[inline(always)]
fn rises(aim: &Aim) -> [bool; 3] {
    [aim.octant & 1 == 0, aim.octant & 2 == 0, aim.octant & 4 == 0]
}
