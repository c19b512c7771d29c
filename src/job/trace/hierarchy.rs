//! The fast answer for rays: hierarchies over the items.

use crate::geometry::hit::{Fast, Watertight};
use crate::geometry::{Aabb, Hit, Ray};
use crate::scene::Primitive;
use crate::structure::bvh::build::{BuildError, Builder, Input};
use crate::structure::bvh::{BinaryBvh, Intersector, RayCounts, WideBvh};

use super::Items;
use super::list::primitive;

/// A wide hierarchy over the triangles, and a binary one over the other shapes.
pub struct Hierarchy {
    triangles: Triangles,
    others: BinaryBvh,
    primitives: Vec<Primitive>,
    /// The number of the first shape that is no triangle.
    first: u32,
}

/// By which test rays meet triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TriangleKind {
    /// No ray slips between two triangles that share an edge.
    #[default]
    Watertight,
    /// Quicker, but at an edge either triangle may think that the other is met.
    Fast,
}

impl TriangleKind {
    /// Every kind with its name in settings.
    pub const ALL: &[(&str, Self)] = &[("watertight", Self::Watertight), ("fast", Self::Fast)];
}

enum Triangles {
    Watertight(WideBvh<Watertight>),
    Fast(WideBvh<Fast>),
}

/// The same of either kind.
macro_rules! either {
    ($triangles:expr, $bvh:ident => $what:expr) => {
        match &$triangles {
            Triangles::Watertight($bvh) => $what,
            Triangles::Fast($bvh) => $what,
        }
    };
}

/// How much wider than a shape its box is taken, as a share of its greatest coordinate: the box is written in f32, and
/// the shape's own test rounds in f64.
const ROOM: f32 = 4.0 * f32::EPSILON;

impl Hierarchy {
    /// Hierarchies over all items.
    ///
    /// # Errors
    /// [`BuildError`]: an item has no box.
    pub fn new(items: &Items, builder: &mut Builder, kind: TriangleKind) -> Result<Self, BuildError> {
        let mut binary = BinaryBvh::default();
        let boxes = items.triangle_boxes();
        builder.build(&Input { boxes: &boxes, triangles: Some(&items.triangles) }, &mut binary)?;
        Self::over(items, &binary, builder, kind)
    }

    /// The same, the binary hierarchy over the triangles being there.
    ///
    /// # Errors
    /// [`BuildError`]: an item that is no triangle has no box.
    pub fn over(
        items: &Items,
        binary: &BinaryBvh,
        builder: &mut Builder,
        kind: TriangleKind,
    ) -> Result<Self, BuildError> {
        let triangles = match kind {
            TriangleKind::Watertight => Triangles::Watertight(WideBvh::new(binary, &items.triangles)),
            TriangleKind::Fast => Triangles::Fast(WideBvh::new(binary, &items.triangles)),
        };
        let boxes: Vec<Aabb> = items.primitives.iter().map(roomy).collect();
        let mut others = BinaryBvh::default();
        builder.build(&Input::of(&boxes), &mut others)?;
        let first = items.triangles.len() as u32;
        Ok(Self { triangles, others, primitives: items.primitives.clone(), first })
    }

    /// What a ray meets first among the triangles alone, and what it took to find it, which is added to `counts`.
    pub fn triangle_counted(&self, ray: &Ray, counts: &mut RayCounts) -> Option<Hit> {
        either!(self.triangles, bvh => bvh.closest_counted(ray, counts))
    }

    /// How many bytes the hierarchies take.
    pub fn bytes(&self) -> usize {
        either!(self.triangles, bvh => bvh.bytes()) + self.others.statistics().bytes
    }
}

/// A box around a shape, with room for rounding.
fn roomy(primitive: &Primitive) -> Aabb {
    let bounds = primitive.shape.bounds();
    let room = bounds.min.abs().max(bounds.max.abs()).max_element() * ROOM;
    Aabb { min: bounds.min - room, max: bounds.max + room }
}

impl Hierarchy {
    /// What is nearest, a triangle that is met being known.
    fn nearest(&self, ray: &Ray, triangle: Option<Hit>) -> Option<Hit> {
        let mut nearest = triangle;
        let ray = Ray { far: nearest.map_or(ray.far, |hit| hit.t), ..*ray };
        self.others.walk(&ray, |number, far| {
            let item = self.first + number;
            let Some([t, u, v]) = primitive(&Ray { far, ..ray }, &self.primitives[number as usize]) else {
                return far;
            };
            // Equally near, the lower number wins.
            if nearest.is_none_or(|hit| t < hit.t || t == hit.t && item < hit.item) {
                nearest = Some(Hit { t, u, v, item });
            }
            t
        });
        nearest
    }
}

impl Intersector for Hierarchy {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.nearest(ray, either!(self.triangles, bvh => bvh.closest(ray)))
    }

    fn occluded(&self, ray: &Ray) -> bool {
        if either!(self.triangles, bvh => bvh.occluded(ray)) {
            return true;
        }
        let mut met = false;
        self.others.walk(ray, |number, far| {
            met |= primitive(ray, &self.primitives[number as usize]).is_some();
            if met { f32::NEG_INFINITY } else { far }
        });
        met
    }

    fn closest_coherent(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        either!(self.triangles, bvh => bvh.closest_coherent(rays, hits));
        if !self.primitives.is_empty() {
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = self.nearest(ray, *hit);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{List, World};
    use super::*;
    use crate::geometry::Sphere;
    use crate::geometry::hit::Cone;
    use crate::scene::{Shape, SplitMix64, by_name};
    use crate::structure::bvh::build::{BUILDERS, Settings};
    use glam::Vec3;

    /// A robot among spheres and cones, and rays through all of them.
    fn world_and_rays() -> (World, Vec<Ray>) {
        let mut random = SplitMix64::new(9);
        let mut scene = by_name("robot").unwrap();
        let bounds = scene.bounds();
        let mut point = || {
            let share = Vec3::from_array(std::array::from_fn(|_| random.between(-0.3, 1.3) as f32));
            bounds.min + bounds.size() * share
        };
        for number in 0..60 {
            let shape = if number % 2 == 0 {
                Shape::Sphere(Sphere { centre: point(), radius: 0.02 * number as f32 })
            } else {
                Shape::Cone(Cone {
                    base: point(),
                    base_radius: 0.1,
                    tip: point(),
                    tip_radius: 0.01 * number as f32,
                })
            };
            scene.primitives.push(Primitive { shape, material: None });
        }
        let rays = (0..3000).map(|_| {
            let (from, to) = (point(), point());
            Ray::new(from, to - from)
        });
        let rays = rays.collect();
        (World::new(scene), rays)
    }

    #[test]
    fn every_builder_answers_the_same_and_as_the_list_does() {
        let (world, rays) = world_and_rays();
        let list = List(world.items());
        for (_, kind) in TriangleKind::ALL {
            let mut expected: Option<Vec<Option<Hit>>> = None;
            for about in BUILDERS {
                let mut builder = Builder::new(about.name, &Settings::default()).unwrap();
                let hierarchy = Hierarchy::new(world.items(), &mut builder, *kind).unwrap();
                let found: Vec<_> = rays.iter().map(|ray| hierarchy.closest(ray)).collect();
                let mut together = vec![None; rays.len()];
                hierarchy.closest_coherent(&rays, &mut together);
                assert_eq!(found, together, "{}", about.name);
                for (ray, hit) in rays.iter().zip(&found) {
                    assert_eq!(hierarchy.occluded(ray), hit.is_some(), "{} {ray:?}", about.name);
                }
                assert_eq!(*expected.get_or_insert_with(|| found.clone()), found, "{}", about.name);
            }
            let found = expected.unwrap();
            let triangles = world.items().triangles.len();
            let is_triangle = |hit: &&Hit| (hit.item as usize) < triangles;
            let (met, others): (Vec<&Hit>, Vec<&Hit>) = found.iter().flatten().partition(is_triangle);
            assert!(
                met.len() > 20 && others.len() > 20,
                "{} triangles, {} others are met",
                met.len(),
                others.len()
            );
            // The list's triangles are tested in f64: rays that pass an edge closely may differ.
            let differs = |(ray, found): &(&Ray, &Option<Hit>)| match (found, list.closest(ray)) {
                (Some(found), Some(hit)) => (found.t - hit.t).abs() > 1e-4 * hit.t.max(1e-2),
                (found, hit) => found.is_some() != hit.is_some(),
            };
            let other = rays.iter().zip(&found).filter(differs).count();
            assert!(other <= 3, "{other} of {} rays end elsewhere", rays.len());
        }
    }

    #[test]
    fn where_there_is_nothing_nothing_is_met() {
        let mut builder = Builder::new("binned_sah", &Settings::default()).unwrap();
        let hierarchy = Hierarchy::new(&Items::default(), &mut builder, TriangleKind::Fast).unwrap();
        let ray = Ray::new(Vec3::ZERO, Vec3::X);
        assert_eq!((hierarchy.closest(&ray), hierarchy.occluded(&ray)), (None, false));
    }
}
