//! Vectors of numbers, as wide as the processor has them: what the kernels of [`super::box_test`], [`super::overlap`]
//! and [`super::hit`] are written with, once for all vector units. All units do the same operations in the same order,
//! without fused ones, so their results are the same bit for bit.

#[cfg(target_arch = "aarch64")]
pub(crate) mod arm;
#[cfg(target_arch = "x86_64")]
pub(crate) mod x86;

/// A vector unit that kernels of up to eight lanes run on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit(pub(crate) Kind);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Sse2,
    #[cfg(target_arch = "aarch64")]
    Neon,
    Scalar,
}

impl Unit {
    /// The units this processor has, the widest first; the last is everywhere.
    pub fn all() -> impl Iterator<Item = Self> {
        [
            #[cfg(target_arch = "x86_64")]
            (Kind::Avx2, has_avx2()),
            #[cfg(target_arch = "x86_64")]
            (Kind::Sse2, true),
            #[cfg(target_arch = "aarch64")]
            (Kind::Neon, true),
            (Kind::Scalar, true),
        ]
        .into_iter()
        .filter_map(|(kind, is_there)| is_there.then_some(Self(kind)))
    }

    /// The widest.
    pub fn best() -> Self {
        Self::all().next().unwrap_or(Self(Kind::Scalar))
    }
}

/// Whether there is AVX2, with the bit instructions that every processor has that has it, but that a virtual machine
/// may hide.
#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt")
}

/// Declares a function that runs a kernel on the unit it is told: a generic function over [`Lanes`], unsafe because
/// its caller answers for the unit. Its generics beside the lanes, if it has such, stand in brackets: those the function
/// has, and those the kernel is given.
macro_rules! on_unit {
    (
        $(#[$doc:meta])*
        fn $name:ident $([$($generics:tt)*])? ($($argument:ident: $type:ty),*) -> $result:ty
            = $kernel:ident $([$($given:ident),*])?
    ) => {
        $(#[$doc])*
        #[inline]
        fn $name<$($($generics)*)?>(unit: $crate::geometry::lanes::Unit, $($argument: $type),*) -> $result {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn avx2<$($($generics)*)?>($($argument: $type),*) -> $result {
                // SAFETY: this function has the feature.
                unsafe { $kernel::<$crate::geometry::lanes::x86::Lanes8, $($($given),*)?>($($argument),*) }
            }
            match unit.0 {
                // SAFETY: a `Unit` is only made where it is there.
                #[cfg(target_arch = "x86_64")]
                $crate::geometry::lanes::Kind::Avx2 => unsafe { avx2::<$($($given),*)?>($($argument),*) },
                // SAFETY: every x86-64 processor has the unit.
                #[cfg(target_arch = "x86_64")]
                $crate::geometry::lanes::Kind::Sse2 => unsafe {
                    $kernel::<$crate::geometry::lanes::x86::Lanes4, $($($given),*)?>($($argument),*)
                },
                // SAFETY: every 64-bit ARM processor with an operating system has the unit.
                #[cfg(target_arch = "aarch64")]
                $crate::geometry::lanes::Kind::Neon => unsafe {
                    $kernel::<$crate::geometry::lanes::arm::Lanes4, $($($given),*)?>($($argument),*)
                },
                // SAFETY: one lane needs no unit.
                $crate::geometry::lanes::Kind::Scalar => unsafe { $kernel::<f32, $($($given),*)?>($($argument),*) },
            }
        }
    };
}
pub(super) use on_unit;

/// A vector of f32 lanes.
///
/// # Safety of the methods
/// The processor has the vector unit. Each comes down to one or two instructions once it is inlined into a
/// function that has the unit's target feature.
pub(crate) trait Lanes: Copy {
    /// How many lanes: 1, 4, 8 or 16.
    const LEN: usize;
    /// All lanes alike.
    unsafe fn splat(value: f32) -> Self;
    /// Lanes from memory. In addition: `column` holds `from` and as many more as there are lanes.
    unsafe fn load(column: &[f32], from: usize) -> Self;
    unsafe fn add(self, other: Self) -> Self;
    unsafe fn sub(self, other: Self) -> Self;
    unsafe fn mul(self, other: Self) -> Self;
    unsafe fn div(self, other: Self) -> Self;
    /// The greater of each pair; `other`'s if one is NaN.
    unsafe fn max(self, other: Self) -> Self;
    /// The lesser of each pair; `other`'s if one is NaN.
    unsafe fn min(self, other: Self) -> Self;
    unsafe fn abs(self) -> Self;
    /// Asks for the lines that hold some numbers which will be read soon, where the processor can be asked.
    fn prefetch(_soon: &[f32]) {}
    /// Each lane, its sign turned where `other`'s sign bit is set.
    unsafe fn turned_by(self, other: Self) -> Self;
    /// Bit `i` is set when lane `i` is greater than `other`'s.
    unsafe fn greater(self, other: Self) -> u64;
    /// Bit `i` is set when lane `i` is `other`'s or greater.
    unsafe fn at_least(self, other: Self) -> u64;
    /// Puts the lanes into memory. In addition: `column` holds `from` and as many more as there are lanes.
    unsafe fn store(self, column: &mut [f32], from: usize);
}

impl Lanes for f32 {
    const LEN: usize = 1;
    #[inline(always)]
    unsafe fn splat(value: f32) -> Self {
        value
    }
    #[inline(always)]
    unsafe fn load(column: &[f32], from: usize) -> Self {
        column[from]
    }
    #[inline(always)]
    unsafe fn add(self, other: Self) -> Self {
        self + other
    }
    #[inline(always)]
    unsafe fn sub(self, other: Self) -> Self {
        self - other
    }
    #[inline(always)]
    unsafe fn mul(self, other: Self) -> Self {
        self * other
    }
    #[inline(always)]
    unsafe fn div(self, other: Self) -> Self {
        self / other
    }
    #[inline(always)]
    unsafe fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    unsafe fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    unsafe fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline(always)]
    unsafe fn turned_by(self, other: Self) -> Self {
        f32::from_bits(self.to_bits() ^ (other.to_bits() & 1 << 31))
    }
    #[inline(always)]
    unsafe fn greater(self, other: Self) -> u64 {
        u64::from(self > other)
    }
    #[inline(always)]
    unsafe fn at_least(self, other: Self) -> u64 {
        u64::from(self >= other)
    }
    #[inline(always)]
    unsafe fn store(self, column: &mut [f32], from: usize) {
        column[from] = self;
    }
}
