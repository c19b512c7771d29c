//! Where the hits of a wave are, and the colours of their textures.
//!
//! The texels of all hits are asked for before the first is looked at: they lie apart in memory, and while what one hit
//! needs is on its way the processor asks for what others do.

use std::sync::LazyLock;

use glam::{Vec2, Vec3};

use crate::geometry::{Hit, Ray};
use crate::scene::Texture;

use super::World;
use super::facet::Facets;
use super::surface::Surface;

/// Where a hit is, and what its surface is tinted by.
#[derive(Clone, Copy)]
struct Spot {
    /// That of a triangle; else any.
    facet: u32,
    /// The colour of the texture; white where there is none.
    tint: Vec3,
}

/// The spots of a wave's hits, and room to find them.
#[derive(Default)]
pub(super) struct Spots {
    facets: Facets,
    all: Vec<Spot>,
    looks: Vec<Look>,
}

/// A look at a texture.
struct Look {
    /// By number among the spots.
    of: usize,
    texture: u32,
    square: Square,
}

impl Spots {
    /// Finds the spot of each hit, and any for what is none.
    #[inline(always)]
    pub(super) fn find(&mut self, world: &World, hits: &[Option<Hit>]) {
        self.facets.clear();
        self.all.clear();
        self.looks.clear();
        for (of, hit) in hits.iter().enumerate() {
            let triangle = hit.filter(|hit| (hit.item as usize) < world.triangles());
            let Some(hit) = triangle else {
                self.all.push(Spot { facet: 0, tint: Vec3::ONE });
                continue;
            };
            let facet = self.facets.find(world, hit.item);
            self.all.push(Spot { facet, tint: Vec3::ONE });
            if let Some((number, [a, b, c])) = self.facets.at(facet).texture {
                let at = a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v;
                let texture = &world.scene.textures[number as usize];
                self.looks.push(Look { of, texture: number, square: Square::about(at, texture) });
            }
        }
        // A load of each row and nothing else, so that many looks' are on their way at once.
        let touched = self.looks.iter().fold(0, |touched, look| {
            let pixels = &world.scene.textures[look.texture as usize].pixels;
            touched ^ pixels[look.square.pixels[0]][0] ^ pixels[look.square.pixels[2]][0]
        });
        std::hint::black_box(touched);
        let linear = &*LINEAR;
        for look in &self.looks {
            self.all[look.of].tint = look.square.colour(&world.scene.textures[look.texture as usize], linear);
        }
    }

    /// What is where a ray met something, by number among the hits that were found last.
    #[inline(always)]
    pub(super) fn surface<'w>(&self, world: &'w World, number: usize, ray: &Ray, hit: &Hit) -> Surface<'w> {
        if hit.item as usize >= world.triangles() {
            return world.on_primitive(ray, hit);
        }
        let Spot { facet, tint } = self.all[number];
        world.on_triangle(ray, hit, self.facets.at(facet), tint)
    }
}

/// Linear colours of the 256 codes of sRGB (IEC 61966-2-1).
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|code| {
        let coded = code as f64 / 255.0;
        let linear = if coded <= 0.04045 { coded / 12.92 } else { ((coded + 0.055) / 1.055).powf(2.4) };
        linear as f32
    })
});

/// The four pixels of a texture about a place, and how far the place is from the first to the others.
struct Square {
    /// By number: upper left, upper right, lower left, lower right.
    pixels: [usize; 4],
    share: Vec2,
}

impl Square {
    #[inline(always)]
    fn about(at: Vec2, texture: &Texture) -> Self {
        let size = Vec2::new(texture.width as f32, texture.height as f32);
        // Pixels count from their middles.
        let place = (at - at.floor()) * size - 0.5;
        let low = place.floor();
        // A place is less than a pixel outside, on either side, or by rounding two.
        let wrapped = |at: f32, count: u32| {
            let (at, count) = (at as i64, i64::from(count));
            let at = if at < 0 { at + count } else { at };
            (if at < count { at } else { at - count }) as usize
        };
        let [left, right] = [low.x, low.x + 1.0].map(|x| wrapped(x, texture.width));
        let rows = [low.y, low.y + 1.0].map(|y| wrapped(y, texture.height) * texture.width as usize);
        let pixels = [rows[0] + left, rows[0] + right, rows[1] + left, rows[1] + right];
        Self { pixels, share: place - low }
    }

    /// The colour between them; `linear` is [`LINEAR`].
    #[inline(always)]
    fn colour(&self, texture: &Texture, linear: &[f32; 256]) -> Vec3 {
        let colour = |pixel: usize| {
            let [r, g, b] = texture.pixels[pixel];
            Vec3::new(linear[usize::from(r)], linear[usize::from(g)], linear[usize::from(b)])
        };
        let [a, b, c, d] = self.pixels;
        let [a, b, c, d] = [colour(a), colour(b), colour(c), colour(d)];
        let share = self.share;
        let upper = a * (1.0 - share.x) + b * share.x;
        let lower = c * (1.0 - share.x) + d * share.x;
        upper * (1.0 - share.y) + lower * share.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_begin_at_their_upper_left_and_repeat() {
        let [r, g, b, w] = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]];
        let texture = Texture { name: "t".into(), width: 2, height: 2, pixels: vec![r, g, b, w] };
        for shift in [0.0, 1.0, -3.0] {
            let at = |u: f32, v: f32| {
                Square::about(Vec2::new(u + shift, v - shift), &texture).colour(&texture, &LINEAR)
            };
            assert_eq!(at(0.25, 0.25), Vec3::X);
            assert_eq!(at(0.75, 0.25), Vec3::Y);
            assert_eq!(at(0.25, 0.75), Vec3::Z);
            assert_eq!(at(0.5, 0.25), Vec3::new(0.5, 0.5, 0.0));
            assert_eq!(at(0.0, 0.25), Vec3::new(0.5, 0.5, 0.0), "over the edge");
        }
        let grey = Texture { name: "g".into(), width: 1, height: 1, pixels: vec![[188; 3]] };
        assert!(
            (Square::about(Vec2::splat(9.9), &grey).colour(&grey, &LINEAR).x - 0.503).abs() < 1e-3,
            "sRGB is decoded"
        );
    }

    /// Where no pixel is asked for by a number that is none.
    #[test]
    fn places_anywhere_are_within_the_texture() {
        let edge = [0.0, -1e-9, 1.0, 1.0 - f32::EPSILON, -1e30, f32::NAN, f32::INFINITY, 0.49999997];
        for (width, height) in [(1, 1), (1, 3), (2, 1), (3, 5), (640, 481)] {
            let count = (width * height) as usize;
            let texture = Texture { name: "t".into(), width, height, pixels: vec![[255; 3]; count] };
            for (u, v) in edge.iter().flat_map(|u| edge.map(|v| (*u, v))) {
                let square = Square::about(Vec2::new(u, v), &texture);
                assert!(square.pixels.iter().all(|pixel| *pixel < count), "{u} {v} of {width} x {height}");
                let is_place = u.is_finite() && v.is_finite();
                assert!(!is_place || square.colour(&texture, &LINEAR).distance(Vec3::ONE) < 1e-6);
            }
        }
    }
}
