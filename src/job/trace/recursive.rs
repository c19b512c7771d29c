//! The slow answer for colours: ray by ray, each followed to its end before the next. What waves are held against, bit
//! for bit.

use glam::Vec3;

use crate::geometry::{Hit, Ray};

use super::bounce::Bounce;
use super::shade::{faded, power, some_number};
use super::spots::Spots;
use super::surface::Surface;
use super::{Counts, Tracer};

impl Tracer<'_> {
    /// The colour a ray from the eye sees, its nearest hit known.
    pub(super) fn seen(&self, ray: &Ray, hit: Option<Hit>, counts: &mut Counts) -> Vec3 {
        self.colour(ray, hit, 0, counts)
    }

    fn colour(&self, ray: &Ray, hit: Option<Hit>, depth: u32, counts: &mut Counts) -> Vec3 {
        let Some(hit) = hit else { return self.look.background };
        counts.deepest = counts.deepest.max(depth);
        let mut spots = Spots::default();
        spots.find(self.world, &[Some(hit)]);
        let surface = spots.surface(self.world, 0, ray, &hit);
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
            // Where the light is not behind the shape itself.
            if !(way.dot(bounce.smooth) > 0.0 && way.dot(bounce.flat) > 0.0) {
                continue;
            }
            counts.shadow += 1;
            if self.intersector.occluded(&Ray { far: 1.0, ..Ray::new(origin, way) }) {
                continue;
            }
            let Some(direction) = way.try_normalize() else { continue };
            let cosine = direction.dot(bounce.smooth);
            let shine = power(direction.dot(mirrored).clamp(0.0, 1.0), surface.material.exponent);
            colour += light.colour * (diffuse * cosine + highlight * shine) * share;
        }
        colour
    }
}
