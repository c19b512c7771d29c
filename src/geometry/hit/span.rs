//! What rays that go much the same way have in common.

use super::aim::{Aim, rises, rows, spread};
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

impl Span {
    /// What these rays span. `None` if they do not go much the same way.
    #[inline(always)]
    pub(crate) fn of(aims: &[Aim; 16]) -> Option<Self> {
        let first = &aims[0];
        let apart = APART * first.direction.abs().max_element();
        let like_first = |aim: &Aim| {
            aim.octant == first.octant
                && aim.axes == first.axes
                && (aim.direction - first.direction).abs().max_element() <= apart
                && aim.last_rate.is_finite()
        };
        if !aims.iter().all(like_first) {
            return None;
        }
        let over = |part: fn(&Aim) -> Vec3A| {
            aims.iter().fold([part(first); 2], |[least, greatest], aim| {
                [least.min(part(aim)), greatest.max(part(aim))]
            })
        };
        let [least, greatest] = over(|aim| aim.origin);
        let rises = rises(first);
        let pick = |up: Vec3A, down: Vec3A| {
            Vec3A::from_array([0, 1, 2].map(|i| if rises[i] { up[i] } else { down[i] }))
        };
        Some(Self {
            first_origin: pick(greatest, least),
            last_origin: pick(least, greatest),
            first_rate: over(|aim| aim.first_rate),
            last_rate: over(|aim| aim.last_rate),
            near: aims.iter().fold(f32::INFINITY, |least, aim| least.min(aim.near)),
            far: aims.iter().fold(0.0, |greatest, aim| aim.far.max(greatest)),
            rises,
        })
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
