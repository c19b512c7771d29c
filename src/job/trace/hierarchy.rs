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
