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
    rays: Vec<Ray>,
    /// The way of each ray.
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

/// From a surface to a light.
struct Way {
    /// By number among the surfaces.
    surface: usize,
    light: usize,
    /// Of unit length.
    direction: Vec3,
    /// Between it and the surface's normal.
    cosine: f32,
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
        for next in 0..asked {
            self.rays.clear();
            self.ways.clear();
            for (number, surface) in self.surfaces.iter().enumerate() {
                // Both are below the number of lights.
                let light = surface.first + next;
                let light = if light < lights.len() { light } else { light - lights.len() };
                let way = lights[light].position - surface.origin;
                let Some(direction) = way.try_normalize() else { continue };
                let cosine = direction.dot(surface.smooth);
                // Also where the light is behind the shape itself.
                if cosine <= 0.0 || direction.dot(surface.flat) <= 0.0 {
                    continue;
                }
                self.rays.push(Ray { far: 1.0, ..Ray::new(surface.origin, way) });
                self.ways.push(Way { surface: number, light, direction, cosine });
            }
            counts.shadow += self.rays.len() as u64;
            self.hidden.clear();
            self.hidden.resize(self.rays.len(), false);
            tracer.intersector.occluded_coherent(&self.rays, &mut self.hidden);
            for (way, _) in self.ways.iter().zip(&self.hidden).filter(|(_, is_hidden)| !**is_hidden) {
                let surface = &self.surfaces[way.surface];
                let shine = power(way.direction.dot(surface.mirrored).max(0.0), surface.exponent);
                let scattered = surface.diffuse * way.cosine + surface.highlight * shine;
                colours[surface.of] += lights[way.light].colour * scattered * share;
            }
        }
        self.surfaces.clear();
    }
}
