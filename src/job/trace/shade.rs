//! What is seen along a ray (Whitted 1980; Parker et al. 1999, eq. 1 and sec. 3.1; PK-08).
//!
//! At a surface the colours of these are added up, those that are black left out:
//! 1. ambient light, scattered;
//! 2. each light that nothing hides, scattered (Lambert), and its highlight about the mirrored direction (Phong;
//!    PK-Q04: the printed vector must be the mirrored eye direction);
//! 3. what is mirrored, and 4. what is let through, each by a ray of its own, until `depth` of them follow on one
//!    another: what lies beyond is taken as black.
//!
//! Of a surface with `fresnel` the mirrored share is `R0 + (1 - R0)(1 - cos)^5` (Schlick 1994), and the rest of the
//! light is scattered or let through. Whatever is not let through casts a full shadow; so does glass.
//!
//! [`super::waves`] follows the rays. Only arithmetic and square roots, which are the same everywhere; no function of a
//! system's library.

use glam::Vec3;

use crate::scene::Scene;
use crate::structure::bvh::Intersector;

use super::World;

/// The greatest depth: each level may double the rays.
pub const MOST_DEPTH: u32 = 64;

/// What does not belong to the scene. Colours are linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// How many bounces are followed, up to [`MOST_DEPTH`]; 0 sees surfaces alone.
    pub depth: u32,
    /// How many lights a point of a surface asks at most whether they are hidden; of more, it takes so many in a row,
    /// which ones hangs on the point, and counts each for as many as there are to one taken.
    pub most_lights: u32,
    /// Light from everywhere.
    pub ambient: Vec3,
    /// Seen where nothing is.
    pub background: Vec3,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            depth: 5,
            most_lights: u32::MAX,
            ambient: Vec3::splat(0.15),
            background: Vec3::new(0.35, 0.47, 0.65),
        }
    }
}

impl Look {
    /// That of a scene: its own background and ambient light, where it says any.
    pub fn of(scene: &Scene) -> Self {
        let unsaid = Self::default();
        let ambient = scene.ambient.unwrap_or(unsaid.ambient);
        Self { ambient, background: scene.background.unwrap_or(unsaid.background), ..unsaid }
    }
}

/// Follows rays through a world.
#[derive(Clone, Copy)]
pub struct Tracer<'a> {
    pub(super) world: &'a World,
    pub(super) intersector: &'a dyn Intersector,
    pub(super) look: Look,
}

impl<'a> Tracer<'a> {
    /// `intersector` answers for the items of `world`.
    pub fn new(world: &'a World, intersector: &'a dyn Intersector, look: Look) -> Self {
        Self { world, intersector, look: Look { depth: look.depth.min(MOST_DEPTH), ..look } }
    }
}

/// A number that hangs on a point, and on nothing else, as if drawn at random (the finaliser of MurmurHash3).
pub(super) fn some_number(point: Vec3) -> usize {
    let mixed = point.to_array().iter().fold(0, |mixed: u64, number| {
        let mixed = (mixed ^ u64::from(number.to_bits())).wrapping_mul(0xff51_afd7_ed55_8ccd);
        (mixed ^ mixed >> 33).wrapping_mul(0xc4ce_b9fe_1a85_ec53)
    });
    (mixed >> 33) as usize
}

/// A number to a whole power, by squaring.
#[inline(always)]
pub(super) fn power(base: f32, exponent: u32) -> f32 {
    let (mut result, mut square, mut left) = (1.0, base, exponent);
    while left > 0 {
        if left & 1 == 1 {
            result *= square;
        }
        square *= square;
        left >>= 1;
    }
    result
}

/// `exp(-x)` for `x` of at least 0: of the next power of 2 and a series, so that it is the same everywhere.
pub(super) fn faded(x: f32) -> f32 {
    let x = f64::from(x);
    let halvings = (x / std::f64::consts::LN_2).round();
    if halvings > 1000.0 {
        return 0.0;
    }
    let rest = halvings * std::f64::consts::LN_2 - x;
    // |rest| is at most 0.35, so the twelfth term is below 1e-14.
    let series = (1..12).rev().fold(1.0, |sum, n| 1.0 + sum * rest / f64::from(n));
    (series * f64::from_bits((1023 - halvings as u64) << 52)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_and_fading_are_those_of_the_library() {
        for base in [0.0_f32, 0.3, 0.99, 1.0] {
            for exponent in [1, 2, 3, 5, 64, 1000] {
                let expected = f64::from(base).powi(exponent as i32);
                assert!(
                    (f64::from(power(base, exponent)) - expected).abs() <= 1e-4 * expected,
                    "{base}^{exponent}"
                );
            }
        }
        for step in 0..4000 {
            let x = step as f32 * 0.02;
            let expected = (-f64::from(x)).exp();
            assert!((f64::from(faded(x)) - expected).abs() <= 1e-7 * expected, "exp(-{x})");
        }
        assert_eq!([faded(0.0), faded(1e9), faded(f32::INFINITY)], [1.0, 0.0, 0.0]);
    }
}
