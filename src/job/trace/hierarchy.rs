//! The fast answer for rays: hierarchies over the items.

use crate::geometry::hit::{Fast, TriangleTest, Watertight};
use crate::geometry::{Hit, Ray};
use crate::scene::Primitive;
use crate::structure::bvh::build::{BuildError, Builder, Input};
use crate::structure::bvh::{BinaryBvh, Instances, Intersector, RayCounts, WideBvh};

use super::flocks::{Flocks, Stand};
use super::{Items, World};

/// A hierarchy over the triangles, and one over the other shapes.
pub struct Hierarchy {
    triangles: Triangles,
    others: Flocks,
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

/// What a hierarchy over triangles is built over. Flocks always have two levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Levels {
    /// All triangles in the world: rays go through it fastest.
    #[default]
    One,
    /// Each mesh in its own space, and the places of meshes: a mesh is held once however often it stands, and what moves
    /// as it is costs no more than its place.
    Two,
}

impl Levels {
    /// Every choice with its name in settings.
    pub const ALL: &[(&str, Self)] = &[("one", Self::One), ("two", Self::Two)];
}

impl std::str::FromStr for Levels {
    type Err = &'static str;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        let known = Self::ALL.iter().find(|(name, _)| *name == word);
        known.map(|(_, levels)| *levels).ok_or("expected one or two")
    }
}

enum Triangles {
    Watertight(Meshes<Watertight>),
    Fast(Meshes<Fast>),
}

/// One level, or two.
enum Meshes<T: TriangleTest> {
    One(WideBvh<T>),
    Two(Instances<T>),
}

/// The same of each kind.
macro_rules! each {
    ($triangles:expr, $bvh:ident => $what:expr) => {
        match $triangles {
            Triangles::Watertight(Meshes::One($bvh)) => $what,
            Triangles::Watertight(Meshes::Two($bvh)) => $what,
            Triangles::Fast(Meshes::One($bvh)) => $what,
            Triangles::Fast(Meshes::Two($bvh)) => $what,
        }
    };
}

impl Hierarchy {
    /// Hierarchies over all items, of one level over the triangles.
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
            TriangleKind::Watertight => {
                Triangles::Watertight(Meshes::One(WideBvh::new(binary, &items.triangles)))
            }
            TriangleKind::Fast => Triangles::Fast(Meshes::One(WideBvh::new(binary, &items.triangles))),
        };
        let flocks: Vec<&[Primitive]> = items.flocks.iter().map(Vec::as_slice).collect();
        let mut next = items.triangles.len() + items.primitives.len();
        let places = items.places.iter().map(|(flock, transform)| {
            let first = next as u32;
            next += items.flocks[*flock as usize].len();
            Stand { flock: *flock, first, transform: Some(*transform) }
        });
        let others = others(&items.primitives, items.triangles.len(), &flocks, places, builder)?;
        Ok(Self { triangles, others })
    }

    /// Hierarchies over a world, of one level or of two. Of two, its items are not listed one by one.
    ///
    /// # Errors
    /// As [`Hierarchy::new`].
    pub fn of(
        world: &World,
        levels: Levels,
        builder: &mut Builder,
        kind: TriangleKind,
    ) -> Result<Self, BuildError> {
        if levels == Levels::One {
            return Self::new(world.items(), builder, kind);
        }
        let (meshes, places) = (&world.scene().meshes, world.placements());
        let triangles = match kind {
            TriangleKind::Watertight => {
                Triangles::Watertight(Meshes::Two(Instances::new(meshes, places, builder)?))
            }
            TriangleKind::Fast => Triangles::Fast(Meshes::Two(Instances::new(meshes, places, builder)?)),
        };
        Ok(Self { triangles, others: others_of(world, builder)? })
    }

    /// Follows a world that follows a pose ([`World::follow`]), in which those meshes `changed` shape: of two levels, only
    /// their hierarchies and the one over places are built anew; of one, all.
    ///
    /// # Errors
    /// As [`Hierarchy::new`]; then it is of no use.
    pub fn update(
        &mut self,
        world: &World,
        changed: &[u32],
        builder: &mut Builder,
    ) -> Result<(), BuildError> {
        let (meshes, places) = (&world.scene().meshes, world.placements());
        match &mut self.triangles {
            Triangles::Watertight(Meshes::Two(bvh)) => bvh.update(meshes, changed, places, builder)?,
            Triangles::Fast(Meshes::Two(bvh)) => bvh.update(meshes, changed, places, builder)?,
            Triangles::Watertight(Meshes::One(_)) => {
                *self = Self::new(world.items(), builder, TriangleKind::Watertight)?;
                return Ok(());
            }
            Triangles::Fast(Meshes::One(_)) => {
                *self = Self::new(world.items(), builder, TriangleKind::Fast)?;
                return Ok(());
            }
        }
        self.others = others_of(world, builder)?;
        Ok(())
    }

    /// The same, but hierarchies over triangles that have moved keep how they group them, and take in where they are.
    ///
    /// # Errors
    /// As [`Hierarchy::new`]; then it is of no use.
    ///
    /// # Panics
    /// Of one level, if there are fewer triangles than there were: [`Hierarchy::update`] takes in what comes and goes.
    pub fn refit(&mut self, world: &World, changed: &[u32], builder: &mut Builder) -> Result<(), BuildError> {
        let (meshes, places) = (&world.scene().meshes, world.placements());
        match &mut self.triangles {
            Triangles::Watertight(Meshes::Two(bvh)) => bvh.refit(meshes, changed, places, builder)?,
            Triangles::Fast(Meshes::Two(bvh)) => bvh.refit(meshes, changed, places, builder)?,
            Triangles::Watertight(Meshes::One(bvh)) => bvh.refit(&world.items().triangles),
            Triangles::Fast(Meshes::One(bvh)) => bvh.refit(&world.items().triangles),
        }
        self.others = others_of(world, builder)?;
        Ok(())
    }

    /// What a ray through the box around all triangles is expected to cost, in nodes and blocks.
    pub fn expected_cost(&self) -> f64 {
        each!(&self.triangles, bvh => bvh.expected_cost())
    }

    /// What a ray meets first among the triangles alone, and what it took to find it, which is added to `counts`.
    pub fn triangle_counted(&self, ray: &Ray, counts: &mut RayCounts) -> Option<Hit> {
        each!(&self.triangles, bvh => bvh.closest_counted(ray, counts))
    }

    /// How many bytes the hierarchies take.
    pub fn bytes(&self) -> usize {
        each!(&self.triangles, bvh => bvh.bytes()) + self.others.bytes()
    }
}

/// Hierarchies over what is no triangle: the world's own shapes are one more flock, numbered before the others.
fn others(
    primitives: &[Primitive],
    first: usize,
    flocks: &[&[Primitive]],
    places: impl Iterator<Item = Stand>,
    builder: &mut Builder,
) -> Result<Flocks, BuildError> {
    let flocks = [&[primitives], flocks].concat();
    let own = Stand { flock: 0, first: first as u32, transform: None };
    let places = places.map(|stand| Stand { flock: stand.flock + 1, ..stand });
    Flocks::new(&flocks, std::iter::once(own).chain(places), builder)
}

fn others_of(world: &World, builder: &mut Builder) -> Result<Flocks, BuildError> {
    let scene = world.scene();
    let flocks: Vec<&[Primitive]> = scene.flocks.iter().map(|flock| &flock.primitives[..]).collect();
    let places = world.flocks().iter();
    let places =
        places.map(|run| Stand { flock: run.flock, first: run.first, transform: Some(run.transform) });
    others(&scene.primitives, world.triangles(), &flocks, places, builder)
}

impl Intersector for Hierarchy {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        let triangle = each!(&self.triangles, bvh => bvh.closest(ray));
        if self.others.is_empty() { triangle } else { self.others.nearest(ray, triangle) }
    }

    fn occluded(&self, ray: &Ray) -> bool {
        each!(&self.triangles, bvh => bvh.occluded(ray))
            || !self.others.is_empty() && self.others.occluded(ray)
    }

    fn closest_coherent(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        each!(&self.triangles, bvh => bvh.closest_coherent(rays, hits));
        if !self.others.is_empty() {
            self.others.nearest_of_each(rays, hits);
        }
    }

    fn occluded_coherent(&self, rays: &[Ray], occluded: &mut [bool]) {
        each!(&self.triangles, bvh => bvh.occluded_coherent(rays, occluded));
        if !self.others.is_empty() {
            self.others.occluded_each(rays, occluded);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::List;
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
                let mut hidden = vec![false; rays.len()];
                hierarchy.occluded_coherent(&rays, &mut hidden);
                for ((ray, hit), hidden) in rays.iter().zip(&found).zip(hidden) {
                    assert_eq!(hierarchy.occluded(ray), hit.is_some(), "{} {ray:?}", about.name);
                    assert_eq!(hidden, hit.is_some(), "{} {ray:?} together with others", about.name);
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
