//! Boxes as eight numbers, and the vector units that work on them. All units do the same operations in the same
//! order, none of them fused, so every unit builds the same hierarchy.

use crate::geometry::Aabb;
use glam::Vec3;

/// A box turned so that one greatest-of-each-pair joins two: `-x, -y, -z`, something else, `x, y, z`, something else;
/// the first three of the least corner, the others of the greatest.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Box8(pub(super) [f32; 8]);

impl Box8 {
    pub(super) const EMPTY: Self = {
        let e = f32::NEG_INFINITY;
        Self([e, e, e, 0.0, e, e, e, 0.0])
    };

    /// Adding zero turns -0 to 0, so that it never matters which of two zeros is met first.
    #[inline(always)]
    pub(super) fn new(bounds: &Aabb) -> Self {
        let (low, high) = (-(bounds.min + 0.0), bounds.max + 0.0);
        Self([low.x, low.y, low.z, 0.0, high.x, high.y, high.z, 0.0])
    }

    pub(super) fn aabb(&self) -> Aabb {
        let [x, y, z, _, u, v, w, _] = self.0;
        Aabb { min: -Vec3::new(x, y, z), max: Vec3::new(u, v, w) }
    }

    #[inline(always)]
    pub(super) fn union(&self, other: &Self) -> Self {
        let mut lanes = other.0;
        for (lane, own) in lanes.iter_mut().zip(self.0) {
            *lane = if own > *lane { own } else { *lane };
        }
        Self(lanes)
    }

    /// Twice the middle on an axis.
    #[inline(always)]
    pub(super) fn middle(&self, axis: usize) -> f32 {
        self.0[axis + 4] - self.0[axis]
    }

    /// Twice the middle.
    #[inline(always)]
    pub(super) fn middles(&self) -> [f32; 3] {
        [self.middle(0), self.middle(1), self.middle(2)]
    }

    /// The box of one point.
    #[inline(always)]
    pub(super) fn of_point(at: [f32; 3]) -> Self {
        Self([-at[0], -at[1], -at[2], 0.0, at[0], at[1], at[2], 0.0])
    }

    #[inline(always)]
    pub(super) fn size(&self, axis: usize) -> f32 {
        self.0[axis + 4] + self.0[axis]
    }

    /// Half the surface; as [`Lanes::half_area`] has it.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        let (x, y, z) = (self.size(0), self.size(1), self.size(2));
        (x * y + y * z) + z * x
    }
}

/// A box with the number of what is in it, and how much that weighs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub(super) struct Item(Box8);

impl Item {
    #[inline(always)]
    pub(super) fn new(bounds: &Box8, number: u32, weight: u32) -> Self {
        let mut lanes = bounds.0;
        lanes[3] = f32::from_bits(number);
        lanes[7] = f32::from_bits(weight);
        Self(Box8(lanes))
    }

    #[inline(always)]
    pub(super) fn number(&self) -> u32 {
        self.0.0[3].to_bits()
    }

    /// How many items it stands for.
    #[inline(always)]
    pub(super) fn weight(&self) -> u32 {
        self.0.0[7].to_bits()
    }

    /// Its box, cleared of the rest: numbers read as if they were floats are slow to compute with.
    #[inline(always)]
    pub(super) fn bounds(&self) -> Box8 {
        let mut lanes = self.0.0;
        lanes[3] = 0.0;
        lanes[7] = 0.0;
        Box8(lanes)
    }

    /// Twice the middle of its box.
    #[inline(always)]
    pub(super) fn middle(&self, axis: usize) -> f32 {
        self.0.middle(axis)
    }
}

/// A box in the registers of a vector unit.
///
/// # Safety of the methods
/// The processor has the unit.
pub(super) trait Lanes: Copy {
    /// Three numbers and a zero.
    type Three: Copy;
    unsafe fn load(from: &Box8) -> Self;
    /// As [`Box8::new`].
    unsafe fn of(bounds: &Aabb) -> Self;
    /// The box of an item.
    unsafe fn load_item(from: &Item) -> Self;
    unsafe fn store(self, to: &mut Box8);
    /// The box around both.
    unsafe fn union(self, other: Self) -> Self;
    /// Twice the middle.
    unsafe fn middle(self) -> Self::Three;
    /// The box of one point.
    unsafe fn of_point(at: Self::Three) -> Self;
    /// Half the surface: `(x * y + y * z) + z * x`.
    unsafe fn half_area(self) -> f32;
    unsafe fn three(of: [f32; 3]) -> Self::Three;
    /// `(at - from) * scale`, cut to whole numbers of at most `last`. In addition: they are within i32.
    unsafe fn bins(at: Self::Three, from: Self::Three, scale: Self::Three, last: i32) -> [i32; 4];
}

/// What every processor can do.
#[derive(Clone, Copy)]
pub(super) struct Plain(Box8);

impl Lanes for Plain {
    type Three = [f32; 3];
    #[inline(always)]
    unsafe fn load(from: &Box8) -> Self {
        Self(*from)
    }
    #[inline(always)]
    unsafe fn of(bounds: &Aabb) -> Self {
        Self(Box8::new(bounds))
    }
    #[inline(always)]
    unsafe fn load_item(from: &Item) -> Self {
        Self(from.bounds())
    }
    #[inline(always)]
    unsafe fn store(self, to: &mut Box8) {
        *to = self.0;
    }
    #[inline(always)]
    unsafe fn union(self, other: Self) -> Self {
        Self(self.0.union(&other.0))
    }
    #[inline(always)]
    unsafe fn middle(self) -> [f32; 3] {
        self.0.middles()
    }
    #[inline(always)]
    unsafe fn of_point(at: [f32; 3]) -> Self {
        Self(Box8::of_point(at))
    }
    #[inline(always)]
    unsafe fn half_area(self) -> f32 {
        self.0.half_area()
    }
    #[inline(always)]
    unsafe fn three(of: [f32; 3]) -> [f32; 3] {
        of
    }
    #[inline(always)]
    unsafe fn bins(at: [f32; 3], from: [f32; 3], scale: [f32; 3], last: i32) -> [i32; 4] {
        let bin = |axis: usize| (((at[axis] - from[axis]) * scale[axis]) as i32).min(last);
        [bin(0), bin(1), bin(2), 0]
    }
}

/// AVX2.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(super) struct Avx2(std::arch::x86_64::__m256);

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{Aabb, Avx2, Box8, Item, Lanes};
    use std::arch::x86_64::*;

    // SAFETY of all blocks: the caller says that the unit is there; a `Box8` and an `Item` are 32 bytes on a 32-byte
    // line, an `[i32; 4]` is 16 bytes.
    impl Lanes for Avx2 {
        type Three = __m128;
        #[inline(always)]
        unsafe fn load(from: &Box8) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_load_ps(from.0.as_ptr()) })
        }
        #[inline(always)]
        unsafe fn of(bounds: &Aabb) -> Self {
            let Aabb { min, max } = bounds;
            // SAFETY: as above.
            unsafe {
                let zero = _mm_setzero_ps();
                let low = _mm_add_ps(_mm_set_ps(0.0, min.z, min.y, min.x), zero);
                let high = _mm_add_ps(_mm_set_ps(0.0, max.z, max.y, max.x), zero);
                Self(_mm256_set_m128(high, _mm_xor_ps(low, _mm_set_ps(0.0, -0.0, -0.0, -0.0))))
            }
        }
        #[inline(always)]
        unsafe fn load_item(from: &Item) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_blend_ps::<0x88>(_mm256_load_ps(from.0.0.as_ptr()), _mm256_setzero_ps()) })
        }
        #[inline(always)]
        unsafe fn store(self, to: &mut Box8) {
            // SAFETY: as above.
            unsafe { _mm256_store_ps(to.0.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        unsafe fn union(self, other: Self) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_max_ps(self.0, other.0) })
        }
        #[inline(always)]
        unsafe fn middle(self) -> __m128 {
            // SAFETY: as above.
            unsafe { _mm_sub_ps(_mm256_extractf128_ps::<1>(self.0), _mm256_castps256_ps128(self.0)) }
        }
        #[inline(always)]
        unsafe fn of_point(at: __m128) -> Self {
            // SAFETY: as above.
            Self(unsafe { _mm256_set_m128(at, _mm_xor_ps(at, _mm_set_ps(0.0, -0.0, -0.0, -0.0))) })
        }
        #[inline(always)]
        unsafe fn half_area(self) -> f32 {
            // SAFETY: as above.
            unsafe {
                let size = _mm_add_ps(_mm256_extractf128_ps::<1>(self.0), _mm256_castps256_ps128(self.0));
                let turned = _mm_shuffle_ps::<0b11_00_10_01>(size, size);
                let faces = _mm_mul_ps(size, turned);
                let two = _mm_add_ss(faces, _mm_movehdup_ps(faces));
                _mm_cvtss_f32(_mm_add_ss(two, _mm_movehl_ps(faces, faces)))
            }
        }
        #[inline(always)]
        unsafe fn three(of: [f32; 3]) -> __m128 {
            // SAFETY: as above.
            unsafe { _mm_set_ps(0.0, of[2], of[1], of[0]) }
        }
        #[inline(always)]
        unsafe fn bins(at: __m128, from: __m128, scale: __m128, last: i32) -> [i32; 4] {
            let mut bins = [0; 4];
            // SAFETY: as above.
            unsafe {
                let whole = _mm_cvttps_epi32(_mm_mul_ps(_mm_sub_ps(at, from), scale));
                let within = _mm_min_epi32(whole, _mm_set1_epi32(last));
                _mm_storeu_si128(bins.as_mut_ptr().cast(), within);
            }
            bins
        }
    }
}

/// A vector unit this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    Plain,
    #[cfg(target_arch = "x86_64")]
    Avx2,
}

impl Unit {
    /// The widest there is; a test builds by the others too.
    pub(super) fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") {
            return Self::Avx2;
        }
        Self::Plain
    }
}

/// Declares a function that runs a kernel on the unit it is told: a generic function over [`Lanes`], unsafe because its
/// caller answers for the unit.
macro_rules! on_unit {
    ($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),* $(,)?) -> $result:ty = $kernel:ident) => {
        $(#[$doc])*
        pub(super) fn $name(unit: $crate::structure::bvh::build::lanes::Unit, $($argument: $type),*) -> $result {
            use $crate::structure::bvh::build::lanes;
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn avx2($($argument: $type),*) -> $result {
                // SAFETY: this function has the feature.
                unsafe { $kernel::<lanes::Avx2>($($argument),*) }
            }
            match unit {
                // SAFETY: this unit is only told where it is there.
                #[cfg(target_arch = "x86_64")]
                lanes::Unit::Avx2 => unsafe { avx2($($argument),*) },
                // SAFETY: every processor can do it.
                lanes::Unit::Plain => unsafe { $kernel::<lanes::Plain>($($argument),*) },
            }
        }
    };
}
pub(super) use on_unit;
