//! Rays followed wave by wave, so that what they ask is asked of many at once.
//!
//! A wave is rays that came about the same way: those of some pixels, or, of what a wave met, all that are mirrored, or
//! all that are let through. Neighbours stay neighbours from wave to wave, so the nearest hits of a wave, and which of its
//! surfaces are hidden from a light, are asked of many rays in one call, which an
//! [`Intersector`](crate::structure::bvh::Intersector) may answer faster than one by one.
//!
//! A wave's own waves are followed to their end before it ends: first that of mirrored rays, then the other. So no wave
//! is larger than the first, as many wait as rays have bounced, and each colour is added up in the order in which
//! [`super::shade`] lists its parts, as if its rays were followed one by one.

use std::cell::Cell;

use glam::Vec3;

use crate::geometry::lanes::Kind;
use crate::geometry::{Hit, Ray, Unit};

use super::bounce::Bounce;
use super::lighting::Lighting;
use super::shade::faded;
use super::spots::Spots;
use super::{Counts, Tracer};

/// Room for waves, to be used again and again: nothing is allocated but where more rays are asked about, or bounce more
/// often, than before.
pub(super) struct Waves {
    unit: Unit,
    first: Wave,
    /// Waves that nobody follows now, all of them empty.
    idle: Vec<Wave>,
    spots: Spots,
    lighting: Lighting,
}

impl Default for Waves {
    fn default() -> Self {
        Self {
            unit: Unit::best(),
            first: Wave::default(),
            idle: Vec::new(),
            spots: Spots::default(),
            lighting: Lighting::default(),
        }
    }
}

thread_local! {
    static WAVES: Cell<Waves> = Cell::default();
}

impl Waves {
    /// Lends the room of this thread. Who asks while it is lent, as another virtual processor may, gets new room, and of
    /// all the one that came back last is kept; if `with` panics, none.
    pub(super) fn lent<R>(with: impl FnOnce(&mut Self) -> R) -> R {
        let mut waves = WAVES.take();
        let result = with(&mut waves);
        WAVES.set(waves);
        result
    }

    /// What rays from the eye see, one after the other: the colour, and how far off, in metres, infinitely if that is
    /// nothing. Rays that follow one another should be near one another.
    pub(super) fn seen(
        &mut self,
        tracer: &Tracer<'_>,
        rays: impl Iterator<Item = Ray>,
        counts: &mut Counts,
    ) -> impl Iterator<Item = (Vec3, f32)> {
        let mut first = std::mem::take(&mut self.first);
        first.clear();
        first.rays.extend(rays);
        counts.eye += first.rays.len() as u64;
        self.follow(tracer, &mut first, 0, counts);
        self.first = first;
        let far = |hit: &Option<Hit>| hit.map_or(f32::INFINITY, |hit| hit.t);
        self.first.colours.iter().copied().zip(self.first.hits.iter().map(far))
    }

    /// Finds the colours of a wave that so many bounces came before.
    fn follow(&mut self, tracer: &Tracer<'_>, wave: &mut Wave, depth: u32, counts: &mut Counts) {
        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
        fn avx2(waves: &mut Waves, tracer: &Tracer<'_>, wave: &mut Wave, depth: u32, counts: &mut Counts) {
            waves.follow_here(tracer, wave, depth, counts);
        }
        match self.unit.0 {
            // SAFETY: a `Unit` is only made where it is there, this one where the bit instructions are too.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => unsafe { avx2(self, tracer, wave, depth, counts) },
            _ => self.follow_here(tracer, wave, depth, counts),
        }
    }

    /// The same, by the instructions of whoever it is inlined into, with all that it asks: no sum is made in another
    /// order for it.
    #[inline(always)]
    fn follow_here(&mut self, tracer: &Tracer<'_>, wave: &mut Wave, depth: u32, counts: &mut Counts) {
        wave.hits.resize(wave.rays.len(), None);
        tracer.intersector.closest_coherent(&wave.rays, &mut wave.hits);
        let mut mirrored = self.idle.pop().unwrap_or_default();
        let mut through = self.idle.pop().unwrap_or_default();
        self.spots.find(tracer.world, &wave.hits);
        for (number, (ray, hit)) in wave.rays.iter().zip(&wave.hits).enumerate() {
            let Some(hit) = hit else {
                wave.colours.push(tracer.look.background);
                continue;
            };
            counts.deepest = counts.deepest.max(depth);
            let surface = self.spots.surface(tracer.world, number, ray, hit);
            let bounce = Bounce::new(ray.direction, &surface);
            let mirrors = bounce.mirrored_share(&surface);
            let way = bounce.mirrored();
            let kept = if surface.material.fresnel { Vec3::ONE - mirrors } else { Vec3::ONE };
            wave.colours.push(surface.ambient * kept * tracer.look.ambient);
            self.lighting.add(tracer, number, &surface, kept, &bounce, way);
            if depth < tracer.look.depth {
                if mirrors != Vec3::ZERO {
                    mirrored.add(number, mirrors, Ray::new(bounce.above(&surface), way));
                }
                let lets = surface.material.transmission * kept;
                if lets != Vec3::ZERO
                    && let Some(direction) = bounce.through(&surface)
                {
                    through.add(number, lets, Ray::new(bounce.below(&surface), direction));
                }
            }
            let absorption = surface.material.absorption;
            if !bounce.outside && absorption != Vec3::ZERO {
                let left = (absorption * hit.t * ray.direction.length()).map(faded);
                wave.fades.push((number, left));
            }
        }
        self.lighting.light(tracer, &mut wave.colours, counts);
        counts.reflection += mirrored.rays.len() as u64;
        counts.refraction += through.rays.len() as u64;
        for mut next in [mirrored, through] {
            if !next.rays.is_empty() {
                self.follow(tracer, &mut next, depth + 1, counts);
                for ((of, share), colour) in next.of.iter().zip(&next.colours) {
                    wave.colours[*of] += *share * *colour;
                }
                next.clear();
            }
            self.idle.push(next);
        }
        for (of, left) in &wave.fades {
            wave.colours[*of] *= *left;
        }
    }
}

/// Rays that are followed together, and what came of each.
#[derive(Default)]
struct Wave {
    rays: Vec<Ray>,
    /// Of which ray of the wave before each is, and what share of its colour it gives; none in the first wave.
    of: Vec<(usize, Vec3)>,
    hits: Vec<Option<Hit>>,
    colours: Vec<Vec3>,
    /// Rays that come from within matter in which light fades, and how much of it is left.
    fades: Vec<(usize, Vec3)>,
}

impl Wave {
    fn add(&mut self, of: usize, share: Vec3, ray: Ray) {
        self.of.push((of, share));
        self.rays.push(ray);
    }

    fn clear(&mut self) {
        self.rays.clear();
        self.of.clear();
        self.hits.clear();
        self.colours.clear();
        self.fades.clear();
    }
}
