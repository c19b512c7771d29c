//! A ray made ready for tests.

use super::scale::{Scale, inverse, to_one};
use crate::geometry::Ray;
use crate::geometry::lanes::Lanes;
use glam::Vec3A;

/// By how much distances of planes are rounded outwards, relative to themselves: 16 roundings.
pub(super) const SLACK: f32 = 1.0 / (1 << 20) as f32;
/// A part of the direction below this, as a share of the greatest, counts as none: over the length of a ray it comes
/// to less than the rounding of its origin.
pub(super) const LEAST_PART: f32 = 1.0 / (1u128 << 100) as f32;

/// Between these lengths in the scale's, directions are taken as they are: rays from here and there to one light then
/// all come to it at the same `t`, and go through a hierarchy together.
pub(super) const AS_THEY_ARE: std::ops::Range<f32> = 1.0 / 1024.0..1024.0;

/// For the axis where a ray goes most: those that the watertight test calls x, y and z.
pub(super) const AXES: [[u8; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

/// A ray in a scale's lengths, and what tests ask of it. Its direction's greatest part is as it is within
/// [`AS_THEY_ARE`], or else brought to between 1 and 2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    pub(super) origin: Vec3A,
    pub(super) direction: Vec3A,
    /// One over the direction, lessened and enlarged by the slack.
    pub(super) first_rate: Vec3A,
    pub(super) last_rate: Vec3A,
    pub(crate) near: f32,
    pub(crate) far: f32,
    /// What the watertight test takes from x and y for each z, and one over the direction's part along z, by its axes.
    shear: [f32; 3],
    /// The origin by that test's axes.
    from: [f32; 3],
    /// Lengths of the ray's own direction in each of this one's, and where its `t` begins.
    pub(super) stretch: f32,
    pub(super) start: f32,
    /// The axes that test calls x, y and z: z is where the ray goes most.
    pub(super) axes: [u8; 3],
    /// Bit `axis` is set if the ray goes down that axis.
    pub(super) octant: u8,
}

impl Aim {
    /// The ray in a scale's lengths. `None` if it hits nothing whatever there is: its origin or its direction is not
    /// finite, its direction is zero, its ends are NaN, or no number of its lengths leads through the scene.
    ///
    /// A `near` below 0 moves the origin, for what is before it is looked for as everything is: from the start on.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray, scale: Scale) -> Option<Self> {
        let start = ray.near.min(0.0);
        let from = if start < 0.0 { ray.at(start) } else { ray.origin };
        // Adding zero takes the sign from a zero.
        let (near, far) = (ray.near - start + 0.0, ray.far - start);
        let own = Vec3A::from(ray.direction);
        let longest = own.abs().max_element();
        let is_tame = AS_THEY_ARE.contains(&(longest * scale.factor()));
        let lengthen = if is_tame { scale.factor() } else { to_one(longest) };
        let origin = Vec3A::from(from) * scale.factor();
        let direction = own * lengthen;
        let sizes = direction.abs();
        let small = sizes.cmplt(Vec3A::splat(LEAST_PART));
        let direction = Vec3A::select(small, Vec3A::ZERO.copysign(direction), direction);
        // All are powers of two: beyond the numbers' range if the ray's lengths do not lead through the scene.
        let (lengths, stretch) = (scale.factor() * inverse(lengthen), scale.inverse() * lengthen);
        let usable = origin.is_finite()
            && own.is_finite()
            && longest > 0.0
            && near <= far
            && lengths.is_normal()
            && stretch.is_normal();
        if !usable {
            return None;
        }
        let rate = direction.recip();
        let sizes = sizes.to_array();
        let z = usize::from(sizes[1] > sizes[0]);
        let z = if sizes[2] > sizes[z] { 2 } else { z };
        let axes = AXES[z];
        let [x, y] = [usize::from(axes[0]), usize::from(axes[1])];
        let (starts, parts, rates) = (origin.to_array(), direction.to_array(), rate.to_array());
        Some(Self {
            origin,
            direction,
            first_rate: rate * (1.0 - SLACK),
            last_rate: rate * (1.0 + SLACK),
            near: near * lengths,
            far: (far * lengths).min(f32::MAX),
            shear: [parts[x] * rates[z], parts[y] * rates[z], rates[z]],
            from: [starts[x], starts[y], starts[z]],
            stretch,
            start,
            axes,
            octant: direction.is_negative_bitmask() as u8,
        })
    }

    /// A distance along it as the ray it was made of counts.
    #[inline]
    pub(crate) fn own_t(&self, t: f32) -> f32 {
        t * self.stretch + self.start
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
    /// The origins by the axes of the watertight test.
    pub(super) from: [L; 3],
    pub(super) axes: [usize; 3],
    /// By axis: whether it goes up, so that the plane it comes to last is the greatest.
    pub(super) rises: [bool; 3],
}

impl<L> Beam<L> {
    /// By axis: of six rows of planes, least and greatest of each axis, the one it comes to first; the other of its
    /// pair differs in the last bit.
    #[inline(always)]
    pub(crate) fn rows(&self) -> [usize; 3] {
        rows(self.rises)
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
                from: spread(aim.from),
                axes: axes(aim),
                rises: rises(aim),
            }
        }
    }
}

/// By axis, which of six rows of planes rays come to first.
#[inline(always)]
pub(super) fn rows([x, y, z]: [bool; 3]) -> [usize; 3] {
    [usize::from(!x), 2 + usize::from(!y), 4 + usize::from(!z)]
}

#[inline(always)]
pub(super) unsafe fn spread<L: Lanes>([x, y, z]: [f32; 3]) -> [L; 3] {
    // SAFETY: the processor is the caller's.
    unsafe { [L::splat(x), L::splat(y), L::splat(z)] }
}

#[inline(always)]
fn axes(aim: &Aim) -> [usize; 3] {
    let [x, y, z] = aim.axes;
    [usize::from(x), usize::from(y), usize::from(z)]
}

/// By axis, whether a ray goes up it.
#[inline(always)]
pub(super) fn rises(aim: &Aim) -> [bool; 3] {
    [aim.octant & 1 == 0, aim.octant & 2 == 0, aim.octant & 4 == 0]
}
