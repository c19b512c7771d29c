//! What lights make of the surfaces that a wave met.

use glam::Vec3;

use crate::geometry::Ray;

use super::bounce::Bounce;
use super::shade::{power, some_number};
use super::surface::Surface;
use super::{Counts, Tracer};

/// Surfaces to be lit, and room for the rays from them to one light after the other.
#[derive(Default)]
pub(super) struct Lighting {
    surfaces: Vec<Lit>,
    /// As many as there ever were surfaces; to a light go the first of them.
    rays: Vec<Ray>,
    ways: Vec<Way>,
    hidden: Vec<bool>,
}

/// A surface that lights may reach.
struct Lit {
    /// Which colour of the wave is to have its light.
    of: usize,
    /// Where rays to the lights start.
    origin: Vec3,
    flat: Vec3,
    smooth: Vec3,
    mirrored: Vec3,
    diffuse: Vec3,
    highlight: Vec3,
    exponent: u32,
    /// Which light is asked first.
    first: usize,
}

/// From which surface a ray goes to which light, by number.
#[derive(Clone, Copy, Default)]
struct Way {
    surface: usize,
    light: usize,
}

impl Lighting {
    /// Adds a surface whose light `of` is to have, unless light makes nothing of it; `mirrored` is the mirrored way.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        tracer: &Tracer<'_>,
        of: usize,
        surface: &Surface<'_>,
        kept: Vec3,
        bounce: &Bounce,
        mirrored: Vec3,
    ) {
        let (diffuse, highlight) = (surface.diffuse * kept, surface.material.highlight);
        let lights = tracer.world.lights().len();
        if lights == 0 || diffuse == Vec3::ZERO && highlight == Vec3::ZERO {
            return;
        }
        let is_choice = lights > tracer.look.most_lights as usize;
        self.surfaces.push(Lit {
            of,
            origin: bounce.above(surface),
            flat: bounce.flat,
            smooth: bounce.smooth,
            mirrored,
            diffuse,
            highlight,
            exponent: surface.material.exponent,
            first: if is_choice { some_number(surface.point) % lights } else { 0 },
        });
    }

    /// Adds to each surface's colour what the lights make of it, light after light, and forgets the surfaces. The rays to
    /// one light are asked about together; where surfaces take lights of their choice, those to the next light of each.
    #[inline(always)]
    pub(super) fn light(&mut self, tracer: &Tracer<'_>, colours: &mut [Vec3], counts: &mut Counts) {
        let lights = tracer.world.lights();
        let asked = lights.len().min(tracer.look.most_lights as usize);
        let share = if asked < lights.len() { lights.len() as f32 / asked as f32 } else { 1.0 };
        if self.rays.len() < self.surfaces.len() {
            self.rays.resize(self.surfaces.len(), Ray::new(Vec3::ZERO, Vec3::ZERO));
            self.ways.resize(self.surfaces.len(), Way::default());
        }
        for next in 0..asked {
            let mut count = 0;
            for (number, surface) in self.surfaces.iter().enumerate() {
                // Both are below the number of lights.
                let light = surface.first + next;
                let light = if light < lights.len() { light } else { light - lights.len() };
                let way = lights[light].position - surface.origin;
                self.rays[count] = Ray { far: 1.0, ..Ray::new(surface.origin, way) };
                self.ways[count] = Way { surface: number, light };
                // Not where the light is behind the shape itself. Counted, for nobody could foresee a branch.
                count += usize::from((way.dot(surface.smooth) > 0.0) & (way.dot(surface.flat) > 0.0));
            }
            let (rays, ways) = (&self.rays[..count], &self.ways[..count]);
            counts.shadow += count as u64;
            self.hidden.clear();
            self.hidden.resize(count, false);
            tracer.intersector.occluded_coherent(rays, &mut self.hidden);
            for ((ray, way), is_hidden) in rays.iter().zip(ways).zip(&self.hidden) {
                let Some(direction) = (!is_hidden).then(|| ray.direction.try_normalize()).flatten() else {
                    continue;
                };
                let surface = &self.surfaces[way.surface];
                let shine = power(direction.dot(surface.mirrored).clamp(0.0, 1.0), surface.exponent);
                let cosine = direction.dot(surface.smooth);
                let scattered = surface.diffuse * cosine + surface.highlight * shine;
                colours[surface.of] += lights[way.light].colour * scattered * share;
            }
        }
        self.surfaces.clear();
    }
}
