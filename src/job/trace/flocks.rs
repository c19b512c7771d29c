//! Hierarchies over spheres and cones, and one over the places where flocks of them stand.
//!
//! Boxes are tested in f32 by the widest vector unit there is, shapes in f64, as they are without a hierarchy; into a
//! flock's space a ray is taken in f64 too, so what is told is what [`super::List`] tells, bit for bit.

use glam::{Affine3A, Vec3};

use crate::geometry::{Aabb, FineRay, Hit, Ray};
use crate::scene::{Primitive, Shape};
use crate::structure::bvh::build::{BuildError, Builder, Input};
use crate::structure::bvh::{BinaryBvh, BoxBvh, Place, placed_box};

use super::list::shape;

/// How much wider than a shape its box is taken, as a share of its greatest coordinate: the box is written in f32, and
/// the shape's own test rounds in f64.
const ROOM: f32 = 4.0 * f32::EPSILON;
/// How far a ray may be off in a flock's space, as a share of all distances, for each 1 of the place's skew.
const ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;
/// Beyond this skew a place counts as flat, and what stands there is not met.
const MOST_SKEW: f64 = (1 << 20) as f64;

/// Of how many rays in a row it is asked at once whether they miss all there is.
const TOGETHER: usize = 16;

/// Where a flock stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stand {
    /// Which, among the flocks.
    pub(super) flock: u32,
    /// Number of its first item.
    pub(super) first: u32,
    /// From its space to the world's; none where they are the same.
    pub(super) transform: Option<Affine3A>,
}

/// What answers for the spheres and cones of a scene.
pub(super) struct Flocks {
    clouds: Vec<Cloud>,
    /// In the order of the top's leaves.
    stand: Vec<Standing>,
    top: BoxBvh,
    error: f64,
}

/// Spheres and cones in a space of their own.
struct Cloud {
    bvh: BoxBvh,
    /// In the order of its leaves, with their numbers.
    shapes: Vec<(Shape, u32)>,
}

struct Standing {
    cloud: u32,
    first: u32,
    place: Option<Place>,
}

/// The way into a flock's space; none if there is none, with the skew.
pub(super) fn way_in(transform: &Affine3A) -> Option<(Place, f64)> {
    Place::new(transform).filter(|(_, skew)| *skew <= MOST_SKEW)
}

impl Flocks {
    /// Hierarchies over some flocks where they stand.
    ///
    /// # Errors
    /// [`BuildError`]: a shape has no box.
    pub(super) fn new(
        flocks: &[&[Primitive]],
        stands: impl Iterator<Item = Stand>,
        builder: &mut Builder,
    ) -> Result<Self, BuildError> {
        let mut bounds = Vec::with_capacity(flocks.len());
        let mut clouds = Vec::with_capacity(flocks.len());
        for primitives in flocks {
            let boxes: Vec<Aabb> = primitives.iter().map(|primitive| roomy(&primitive.shape)).collect();
            let (bvh, order) = over(&boxes, builder)?;
            let shapes = order.into_iter().map(|number| (primitives[number as usize].shape, number));
            clouds.push(Cloud { bvh, shapes: shapes.collect() });
            bounds.push(boxes.into_iter().fold(Aabb::EMPTY, Aabb::union));
        }
        let (mut all, mut boxes, mut error) = (Vec::new(), Vec::new(), 0.0_f64);
        for Stand { flock, first, transform } in stands {
            let own = bounds[flock as usize];
            let (place, around) = match &transform {
                None => (None, own),
                Some(transform) => {
                    let Some((place, skew)) = way_in(transform) else { continue };
                    error = error.max(skew * ROUNDING);
                    (Some(place), placed_box(&own, transform))
                }
            };
            if !around.is_empty() {
                all.push(Some(Standing { cloud: flock, first, place }));
                boxes.push(around);
            }
        }
        let (top, order) = over(&boxes, builder)?;
        let stand = order.into_iter().filter_map(|item| all[item as usize].take()).collect();
        Ok(Self { clouds, stand, top, error })
    }

    /// How many bytes the hierarchies take, and the shapes in them.
    pub(super) fn bytes(&self) -> usize {
        let clouds = self.clouds.iter().map(|cloud| cloud.bvh.bytes() + size_of_val(&cloud.shapes[..]));
        clouds.sum::<usize>() + self.top.bytes() + size_of_val(&self.stand[..])
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.stand.is_empty()
    }

    /// What is nearest, something that is met being known.
    pub(super) fn nearest(&self, ray: &Ray, known: Option<Hit>) -> Option<Hit> {
        let mut nearest = known;
        let ray = Ray { far: nearest.map_or(ray.far, |hit| hit.t), ..*ray };
        self.walk(&ray, |item, t| {
            // Equally near, the lower number wins.
            if nearest.is_none_or(|hit| t < hit.t || t == hit.t && item < hit.item) {
                nearest = Some(Hit { t, u: 0.0, v: 0.0, item });
            }
            t
        });
        nearest
    }

    /// Whether anything is met.
    pub(super) fn occluded(&self, ray: &Ray) -> bool {
        let mut met = false;
        self.walk(ray, |_, _| {
            met = true;
            f32::NEG_INFINITY
        });
        met
    }

    /// What is nearest to each ray, what it meets so far being known.
    pub(super) fn nearest_of_each(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        let mut known = [Ray::new(Vec3::ZERO, Vec3::ZERO); TOGETHER];
        for (rays, hits) in rays.chunks(TOGETHER).zip(hits.chunks_mut(TOGETHER)) {
            for ((known, ray), hit) in known.iter_mut().zip(rays).zip(&*hits) {
                *known = Ray { far: hit.map_or(ray.far, |hit| hit.t), ..*ray };
            }
            if !self.are_missed_by(&known[..rays.len()]) {
                hits.iter_mut().zip(rays).for_each(|(hit, ray)| *hit = self.nearest(ray, *hit));
            }
        }
    }

    /// Adds which rays meet anything to those that do already.
    pub(super) fn occluded_each(&self, rays: &[Ray], occluded: &mut [bool]) {
        for (rays, occluded) in rays.chunks(TOGETHER).zip(occluded.chunks_mut(TOGETHER)) {
            if !occluded.iter().all(|occluded| *occluded) && !self.are_missed_by(rays) {
                let others = occluded.iter_mut().zip(rays).filter(|(occluded, _)| !**occluded);
                others.for_each(|(occluded, ray)| *occluded = self.occluded(ray));
            }
        }
    }

    /// Whether it can be told at once that no ray meets anything.
    fn are_missed_by(&self, rays: &[Ray]) -> bool {
        match &self.stand[..] {
            [Standing { cloud, place: None, .. }] => self.clouds[*cloud as usize].bvh.is_missed_by(rays, 0.0),
            _ => self.top.is_missed_by(rays, self.error),
        }
    }

    /// Tells each hit on the way, and is told how far the ray reaches from then on.
    fn walk(&self, ray: &Ray, mut hit: impl FnMut(u32, f32) -> f32) {
        // Of one place the hierarchy over places tells no more than the flock's own.
        if let [only] = &self.stand[..] {
            self.walk_in(only, ray, ray.far, &mut hit);
            return;
        }
        self.top.walk(&FineRay::from(ray), self.error, |place, far| {
            self.walk_in(&self.stand[place], ray, far, &mut hit)
        });
    }

    /// The same in one place, the ray reaching so far; tells how far it reaches then.
    fn walk_in(&self, standing: &Standing, ray: &Ray, far: f32, mut hit: impl FnMut(u32, f32) -> f32) -> f32 {
        let own = standing.place.as_ref().map_or_else(|| FineRay::from(ray), |place| place.take_in(ray));
        let cloud = &self.clouds[standing.cloud as usize];
        let mut reach = far;
        cloud.bvh.walk(&FineRay { far, ..own }, 0.0, |place, far| {
            let (is, number) = &cloud.shapes[place];
            if let Some(t) = shape(FineRay { far, ..own }, is) {
                reach = hit(standing.first + number, t);
            }
            reach
        });
        reach
    }
}

/// The hierarchy over some boxes, and its order.
fn over(boxes: &[Aabb], builder: &mut Builder) -> Result<(BoxBvh, Vec<u32>), BuildError> {
    let mut binary = BinaryBvh::default();
    builder.build(&Input::of(boxes), &mut binary)?;
    Ok(BoxBvh::new(&binary, boxes))
}

/// A box around a shape, with room for rounding.
fn roomy(shape: &Shape) -> Aabb {
    let bounds = shape.bounds();
    let room = bounds.min.abs().max(bounds.max.abs()).max_element() * ROOM;
    Aabb { min: bounds.min - room, max: bounds.max + room }
}
