//! What a builder keeps from build to build, and how boxes come in: fresh memory costs more than the build itself.

use super::grow::{Extent, Plot, Rule, Shed, grow};
use super::lanes::{Box8, Item, Lanes, Unit, on_unit};
use super::{BuildError, Effort};
use crate::geometry::Aabb;
use crate::structure::bvh::{BinaryBvh, refit};
use glam::Vec3;

/// The most items: nodes are numbered in 32 bits, and there can be twice as many.
pub(super) const MOST_ITEMS: usize = 1 << 31;
/// Builders compute in a range where areas, times how many there are, neither overflow nor vanish: coordinates up to
/// this, in metres.
const FARTHEST: f32 = (1_u64 << 40) as f32;
/// And extents from this, in metres.
const LEAST: f32 = 1.0 / FARTHEST;

/// The buffers of a builder that grows downwards.
pub(super) struct Yard {
    pub(super) items: [Vec<Item>; 2],
    pub(super) shed: Shed,
}

impl Default for Yard {
    fn default() -> Self {
        Self { items: [Vec::new(), Vec::new()], shed: Shed::new() }
    }
}

impl Yard {
    /// Builds serially by a rule; returns what it did.
    pub(super) fn build<R: Rule>(
        &mut self,
        rule: &R,
        boxes: &[Aabb],
        bvh: &mut BinaryBvh,
    ) -> Result<Effort, BuildError> {
        bvh.nodes.clear();
        make_room(&mut bvh.order, boxes.len(), 0);
        if boxes.is_empty() {
            return Ok(Effort::default());
        }
        for place in &mut self.items {
            make_room(place, boxes.len(), Item::new(&Box8::EMPTY, 0, 0));
        }
        let (extent, view) = load_all(boxes, &mut self.items[0])?;
        let [one, other] = &mut self.items;
        let plot = Plot { items: [one, other], order: &mut bvh.order, first: 0 };
        let mut effort = grow(rule, plot, extent, 0, &mut bvh.nodes, &mut self.shed);
        view.restore(bvh, boxes);
        effort.loaded = boxes.len() as u64;
        Ok(effort)
    }
}

/// Brings a buffer to a length; what is in it is to be written over.
pub(super) fn make_room<T: Clone>(buffer: &mut Vec<T>, length: usize, value: T) {
    buffer.truncate(length);
    buffer.resize(length, value);
}

/// How boxes are brought into the range that builders compute in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    /// Coordinates are cut off here, in metres.
    limit: f32,
    /// And are multiplied by this power of two.
    scale: f32,
}

impl View {
    /// Boxes as they are: nearly always.
    pub(super) const PLAIN: Self = Self { limit: f32::INFINITY, scale: 1.0 };

    /// What boxes within these bounds need.
    pub(super) fn of(bounds: &Aabb, boxes: &[Aabb]) -> Self {
        let far = |bounds: &Aabb| bounds.min.abs().max(bounds.max.abs()).max_element();
        let extent = bounds.size().max_element();
        if far(bounds) <= FARTHEST && (extent >= LEAST || extent == 0.0) {
            return Self::PLAIN;
        }
        // What is infinite is taken to end at twice the distance of all that is not.
        let numbers = boxes.iter().flat_map(|one| one.min.to_array().into_iter().chain(one.max.to_array()));
        let farthest =
            numbers.filter(|number| number.is_finite()).fold(0.0, |far: f32, one| far.max(one.abs()));
        let limit = if farthest > 0.0 { farthest.min(f32::MAX / 2.0) * 2.0 } else { 1.0 };
        let size = if extent < LEAST { extent } else { limit };
        let power = size.log2().round().clamp(-126.0, 126.0);
        Self { limit, scale: (-power).exp2() }
    }

    /// Looks at all boxes, at least one: the first bad one is told.
    pub(super) fn look(unit: Unit, boxes: &[Aabb]) -> Result<(Extent, Self), BuildError> {
        let bad = |item: usize| BuildError::NoBox { item, bounds: boxes[item] };
        let extent = survey(unit, boxes, Self::PLAIN).map_err(bad)?;
        let view = Self::of(&extent.bounds.aabb(), boxes);
        let extent = if view == Self::PLAIN { extent } else { survey(unit, boxes, view).map_err(bad)? };
        Ok((extent, view))
    }

    /// A box in that range.
    #[inline(always)]
    fn bring(&self, bounds: &Aabb) -> Box8 {
        Box8::new(&if *self == Self::PLAIN { *bounds } else { self.apply(bounds) })
    }

    /// The same in registers.
    ///
    /// # Safety
    /// The processor has the unit.
    #[inline(always)]
    pub(super) unsafe fn load<L: Lanes>(&self, bounds: &Aabb) -> L {
        // SAFETY: the unit is there.
        unsafe { if *self == Self::PLAIN { L::of(bounds) } else { L::of(&self.apply(bounds)) } }
    }

    fn apply(&self, bounds: &Aabb) -> Aabb {
        let bring = |at: Vec3| at.clamp(Vec3::splat(-self.limit), Vec3::splat(self.limit)) * self.scale;
        Aabb { min: bring(bounds.min), max: bring(bounds.max) }
    }

    /// Gives the hierarchy its true boxes, if these were not.
    pub(super) fn restore(&self, bvh: &mut BinaryBvh, boxes: &[Aabb]) {
        if *self != Self::PLAIN {
            refit::refit(bvh, boxes);
        }
    }
}

on_unit! {
    /// The extent of boxes, or the number of the first bad one.
    fn survey(boxes: &[Aabb], view: View) -> Result<Extent, usize> = survey_with
}

/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn survey_with<L: Lanes>(boxes: &[Aabb], view: View) -> Result<Extent, usize> {
    let mut extent = Extent::EMPTY;
    // SAFETY: the unit is there.
    unsafe {
        let (mut all, mut middles) = (L::load(&extent.bounds), L::load(&extent.middles));
        for (i, bounds) in boxes.iter().enumerate() {
            if !holds_a_point(bounds) {
                return Err(i);
            }
            let bounds = view.load::<L>(bounds);
            all = all.union(bounds);
            middles = middles.union(L::of_point(bounds.middle()));
        }
        all.store(&mut extent.bounds);
        middles.store(&mut extent.middles);
    }
    Ok(extent)
}

/// Also not where one of its numbers is none.
fn holds_a_point(bounds: &Aabb) -> bool {
    bounds.min.cmple(bounds.max).all()
}

/// Copies some of the boxes, the first of them item `first`; an error tells the first bad one.
///
/// # Panics
/// If there are fewer `items` than boxes.
pub(super) fn load(
    boxes: &[Aabb],
    first: usize,
    view: View,
    items: &mut [Item],
) -> Result<Extent, BuildError> {
    let mut extent = Extent::EMPTY;
    for (i, (bounds, item)) in boxes.iter().zip(&mut items[..boxes.len()]).enumerate() {
        if !holds_a_point(bounds) {
            return Err(BuildError::NoBox { item: first + i, bounds: *bounds });
        }
        let bounds = view.bring(bounds);
        *item = Item::new(&bounds, (first + i) as u32, 1);
        let middles = Box8::of_point(bounds.middles());
        extent = extent.union(&Extent { bounds, middles });
    }
    Ok(extent)
}

/// Copies all boxes, at least one, in the range they need.
pub(super) fn load_all(boxes: &[Aabb], items: &mut [Item]) -> Result<(Extent, View), BuildError> {
    let extent = load(boxes, 0, View::PLAIN, items)?;
    let view = View::of(&extent.bounds.aabb(), boxes);
    let extent = if view == View::PLAIN { extent } else { load(boxes, 0, view, items)? };
    Ok((extent, view))
}
