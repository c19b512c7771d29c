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
//! Only arithmetic and square roots, which are the same everywhere; no function of a system's library.

use glam::Vec3;

use crate::geometry::{Hit, Ray};
use crate::scene::Scene;
use crate::structure::bvh::Intersector;

use super::surface::Surface;
use super::{Counts, World};

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
    world: &'a World,
    intersector: &'a dyn Intersector,
    look: Look,
}

impl<'a> Tracer<'a> {
    /// `intersector` answers for the items of `world`.
    pub fn new(world: &'a World, intersector: &'a dyn Intersector, look: Look) -> Self {
        Self { world, intersector, look: Look { depth: look.depth.min(MOST_DEPTH), ..look } }
    }

    pub(super) fn intersector(&self) -> &'a dyn Intersector {
        self.intersector
    }

    /// The colour a ray from the eye sees, its nearest hit known.
    pub(super) fn seen(&self, ray: &Ray, hit: Option<Hit>, counts: &mut Counts) -> Vec3 {
        self.colour(ray, hit, 0, counts)
    }

    fn colour(&self, ray: &Ray, hit: Option<Hit>, depth: u32, counts: &mut Counts) -> Vec3 {
        let Some(hit) = hit else { return self.look.background };
        counts.deepest = counts.deepest.max(depth);
        let surface = self.world.surface(ray, &hit);
        let bounce = Bounce::new(ray.direction, &surface);
        let (through, mirrored) = (bounce.through(&surface), bounce.mirrored_share(&surface));
        let kept = if surface.material.fresnel { Vec3::ONE - mirrored } else { Vec3::ONE };
        let mut colour = self.local(&bounce, &surface, kept, counts);
        if depth < self.look.depth {
            if mirrored != Vec3::ZERO {
                counts.reflection += 1;
                colour += mirrored * self.follow(bounce.above(&surface), bounce.mirrored(), depth, counts);
            }
            let share = surface.material.transmission * kept;
            if let Some(direction) = through.filter(|_| share != Vec3::ZERO) {
                counts.refraction += 1;
                colour += share * self.follow(bounce.below(&surface), direction, depth, counts);
            }
        }
        let absorption = surface.material.absorption;
        if !bounce.outside && absorption != Vec3::ZERO {
            colour *= (absorption * hit.t * ray.direction.length()).map(faded);
        }
        colour
    }

    /// What is seen from a surface, one bounce further.
    fn follow(&self, origin: Vec3, direction: Vec3, depth: u32, counts: &mut Counts) -> Vec3 {
        let ray = Ray::new(origin, direction);
        self.colour(&ray, self.intersector.closest(&ray), depth + 1, counts)
    }

    /// What ambient light and the lights make of a surface.
    fn local(&self, bounce: &Bounce, surface: &Surface<'_>, kept: Vec3, counts: &mut Counts) -> Vec3 {
        let (diffuse, highlight) = (surface.diffuse * kept, surface.material.highlight);
        let mut colour = surface.ambient * kept * self.look.ambient;
        if diffuse == Vec3::ZERO && highlight == Vec3::ZERO {
            return colour;
        }
        let origin = bounce.above(surface);
        let mirrored = bounce.mirrored();
        let lights = self.world.lights();
        let asked = lights.len().min(self.look.most_lights as usize);
        let share = if asked < lights.len() { lights.len() as f32 / asked as f32 } else { 1.0 };
        let first = if asked < lights.len() { some_number(surface.point) } else { 0 };
        for light in (0..asked).map(|next| &lights[(first + next) % lights.len()]) {
            let way = light.position - origin;
            let Some(direction) = way.try_normalize() else { continue };
            let cosine = direction.dot(bounce.smooth);
            // Also where the light is behind the shape itself.
            if cosine <= 0.0 || direction.dot(bounce.flat) <= 0.0 {
                continue;
            }
            counts.shadow += 1;
            if self.intersector.occluded(&Ray { far: 1.0, ..Ray::new(origin, way) }) {
                continue;
            }
            let shine = power(direction.dot(mirrored).max(0.0), surface.material.exponent);
            colour += light.colour * (diffuse * cosine + highlight * shine) * share;
        }
        colour
    }
}

/// A ray that comes to a surface, both seen from the side it comes from.
struct Bounce {
    /// Where it goes, of unit length.
    direction: Vec3,
    flat: Vec3,
    smooth: Vec3,
    /// Whether it comes from the side of the surface's own normal.
    outside: bool,
}

impl Bounce {
    fn new(direction: Vec3, surface: &Surface<'_>) -> Self {
        let outside = direction.dot(surface.flat) <= 0.0;
        let side = |normal: Vec3| if outside { normal } else { -normal };
        let (flat, smooth) = (side(surface.flat), side(surface.smooth));
        // An interpolated normal that points into the shape, or away from who looks at it, tells nothing here.
        let usable = smooth.dot(flat) > 0.0 && smooth.dot(direction) < 0.0;
        Self { direction: direction.normalize(), flat, smooth: if usable { smooth } else { flat }, outside }
    }

    /// Where rays start that leave on this side.
    fn above(&self, surface: &Surface<'_>) -> Vec3 {
        surface.point + self.flat * surface.apart
    }

    /// Where rays start that leave on the other side.
    fn below(&self, surface: &Surface<'_>) -> Vec3 {
        surface.point - self.flat * surface.apart
    }

    /// The mirrored direction; about the flat normal where the other would send it into the shape.
    fn mirrored(&self) -> Vec3 {
        let about = |normal: Vec3| (self.direction - normal * (2.0 * self.direction.dot(normal))).normalize();
        let mirrored = about(self.smooth);
        if mirrored.dot(self.flat) > 0.0 { mirrored } else { about(self.flat) }
    }

    /// The direction in which light goes on through the surface (Snell); none if it is wholly mirrored inside.
    fn through(&self, surface: &Surface<'_>) -> Option<Vec3> {
        let index = surface.material.index;
        if index == 1.0 {
            return Some(self.direction);
        }
        let ratio = if self.outside { 1.0 / index } else { index };
        let cosine = -self.direction.dot(self.smooth);
        let square = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
        // So that NaN is none, too.
        if square >= 0.0 {
            let bent = self.direction * ratio + self.smooth * (ratio * cosine - square.sqrt());
            return bent.try_normalize();
        }
        None
    }

    /// The share of light that is mirrored.
    fn mirrored_share(&self, surface: &Surface<'_>) -> Vec3 {
        let material = surface.material;
        if !material.fresnel {
            return material.mirror;
        }
        let through = self.through(surface);
        let cosine = match through {
            None => return Vec3::ONE,
            // Schlick's angle is the one in the thinner matter.
            Some(through) if !self.outside && material.index > 1.0 => -through.dot(self.smooth),
            Some(_) => -self.direction.dot(self.smooth),
        };
        material.mirror + (Vec3::ONE - material.mirror) * power((1.0 - cosine).clamp(0.0, 1.0), 5)
    }
}

/// A number that hangs on a point, and on nothing else, as if drawn at random (the finaliser of MurmurHash3).
fn some_number(point: Vec3) -> usize {
    let mixed = point.to_array().iter().fold(0, |mixed: u64, number| {
        let mixed = (mixed ^ u64::from(number.to_bits())).wrapping_mul(0xff51_afd7_ed55_8ccd);
        (mixed ^ mixed >> 33).wrapping_mul(0xc4ce_b9fe_1a85_ec53)
    });
    (mixed >> 33) as usize
}

/// A number to a whole power, by squaring.
fn power(base: f32, exponent: u32) -> f32 {
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
fn faded(x: f32) -> f32 {
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
