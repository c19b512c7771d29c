//! Built for speed: items along a Z-order curve (Morton 1966; Lauterbach et al. 2009), in clusters of a few that are
//! neighbours on it, and the surface area heuristic over the clusters (after Pantaleoni and Luebke 2010, "HLBVH").
//!
//! Steps: 1. the middles' places on the curve, 10 bits an axis; 2. sort by them; 3. cut at the highest bit in which the
//! ends of a run differ until runs are clusters; 4. grow a hierarchy over the clusters as `binned_sah` does;
//! 5. within a cluster, cut the curve where it is cheapest, and a few items whichever way is.
//!
//! Departs from the paper in that clusters are small, a setting, and not all that share a cell of a coarse grid: the
//! curve alone makes a hierarchy that costs rays more than the few cuts by cost save.

use super::binned_sah::SahRule;
use super::few::{FEW, weigh_few_with};
use super::grow::{Extent, Plot, budding, grow};
use super::lanes::{Box8, Item, Lanes, on_unit};
use super::yard::{View, Yard, make_room};
use super::{BuildError, Input, MOST_IN_CLUSTER, Settings, curve};
use crate::geometry::Aabb;
use crate::structure::bvh::{BinaryBvh, BinaryNode};

pub(super) const SUMMARY: &str = "clusters along a Z-order curve, the heuristic above them (after HLBVH)";

/// Builds so, and keeps its buffers.
pub(super) struct Morton {
    cluster: usize,
    /// Cuts between clusters, each a leaf.
    above: SahRule,
    /// Cuts within a cluster.
    within: SahRule,
    /// Items in the order of the curve.
    items: Vec<Item>,
    codes: [Vec<u64>; 2],
    /// Where each cluster begins on the curve, and the end of it.
    starts: Vec<u32>,
    clusters: Yard,
    top: BinaryBvh,
    room: Vec<(Box8, f32)>,
}

impl Morton {
    pub(super) fn new(settings: &Settings) -> Self {
        Self {
            cluster: settings.cluster,
            above: SahRule::new(&Settings { most_in_leaf: 1, ..settings.clone() }),
            within: SahRule::new(settings),
            items: Vec::new(),
            codes: Default::default(),
            starts: Vec::new(),
            clusters: Yard::default(),
            top: BinaryBvh::default(),
            room: Vec::new(),
        }
    }

    pub(super) fn build(&mut self, input: &Input<'_>, bvh: &mut BinaryBvh) -> Result<(), BuildError> {
        let count = input.boxes.len();
        bvh.nodes.clear();
        make_room(&mut bvh.order, count, 0);
        if count == 0 {
            return Ok(());
        }
        let nothing = Item::new(&Box8::EMPTY, 0, 0);
        make_room(&mut self.items, count, nothing);
        let unit = self.above.unit;
        let (extent, view) = View::look(unit, input.boxes)?;
        curve::sort(unit, input.boxes, &view, &extent.middles, &mut self.codes);
        let codes = &self.codes[0];
        gather(unit, input.boxes, &view, codes, &mut self.items);
        self.starts.clear();
        curve::clusters(codes, self.cluster, &mut self.starts);
        self.grow_above();
        self.expand(bvh);
        view.restore(bvh, input.boxes);
        Ok(())
    }

    /// Grows the hierarchy over the clusters.
    fn grow_above(&mut self) {
        let count = self.starts.len() - 1;
        let [clusters, room] = &mut self.clusters.items;
        for place in [&mut *clusters, &mut *room] {
            make_room(place, count, Item::new(&Box8::EMPTY, 0, 0));
        }
        let extent = wrap(self.above.unit, &self.items, &self.starts, clusters);
        make_room(&mut self.top.order, count, 0);
        let plot = Plot { items: [clusters, room], order: &mut self.top.order, first: 0 };
        grow(&self.above, plot, extent, 0, &mut self.top.nodes, &mut self.clusters.shed);
    }

    /// Copies that hierarchy with one for each cluster in place of its leaves.
    fn expand(&mut self, bvh: &mut BinaryBvh) {
        let BinaryBvh { nodes, order } = bvh;
        nodes.push(self.top.nodes[0]);
        let mut filled = 0;
        let mut open = vec![(0, 0)];
        while let Some((from, to)) = open.pop() {
            let node = self.top.nodes[from];
            if !node.is_leaf() {
                let pair = nodes.len();
                nodes[to].first = pair as u32;
                for (side, child) in node.children().into_iter().enumerate() {
                    nodes.push(self.top.nodes[child]);
                    open.push((node.children()[1 - side], pair + 1 - side));
                }
                continue;
            }
            let cluster = self.top.order[node.first as usize] as usize;
            let items = &mut self.items[self.starts[cluster] as usize..self.starts[cluster + 1] as usize];
            self.room.resize(items.len().max(self.room.len()), (Box8::EMPTY, 0.0));
            let end = filled + items.len();
            nodes[to].count = 0;
            cut(self.within.unit, &self.within, items, filled, to, nodes, &mut self.room);
            for (place, item) in order[filled..end].iter_mut().zip(items) {
                *place = item.number();
            }
            filled = end;
        }
    }
}

on_unit! {
    /// Copies boxes in the order of the curve.
    fn gather(boxes: &[Aabb], view: &View, codes: &[u64], items: &mut [Item]) -> () = gather_with
}

/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn gather_with<L: Lanes>(boxes: &[Aabb], view: &View, codes: &[u64], items: &mut [Item]) {
    let mut bounds = Box8::EMPTY;
    for (item, code) in items.iter_mut().zip(codes) {
        let number = curve::item(*code);
        // SAFETY: the unit is there.
        unsafe { view.load::<L>(&boxes[number]).store(&mut bounds) };
        *item = Item::new(&bounds, number as u32, 1);
    }
}

on_unit! {
    /// Makes an item of each cluster; returns their extent.
    fn wrap(items: &[Item], starts: &[u32], clusters: &mut [Item]) -> Extent = wrap_with
}

/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn wrap_with<L: Lanes>(items: &[Item], starts: &[u32], clusters: &mut [Item]) -> Extent {
    let mut extent = Extent::EMPTY;
    let mut bounds = Box8::EMPTY;
    // SAFETY: the unit is there.
    unsafe {
        let (mut all, mut middles) = (L::load(&extent.bounds), L::load(&extent.middles));
        for (number, (ends, cluster)) in starts.windows(2).zip(clusters).enumerate() {
            let mut around = L::load(&Box8::EMPTY);
            let items = &items[ends[0] as usize..ends[1] as usize];
            for item in items {
                around = around.union(L::load_item(item));
            }
            around.store(&mut bounds);
            *cluster = Item::new(&bounds, number as u32, items.len() as u32);
            all = all.union(around);
            middles = middles.union(L::of_point(around.middle()));
        }
        all.store(&mut extent.bounds);
        middles.store(&mut extent.middles);
    }
    extent
}

on_unit! {
    /// Cuts a run of the curve where it is cheapest, again and again; a few items are parted whichever way is best. Its
    /// node, `at`, which has its box, is there; the items begin at `first` of the order. Room is as long as the run.
    fn cut(
        rule: &SahRule,
        items: &mut [Item],
        first: usize,
        at: usize,
        nodes: &mut Vec<BinaryNode>,
        room: &mut [(Box8, f32)],
    ) -> () = cut_with
}

/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn cut_with<L: Lanes>(
    rule: &SahRule,
    items: &mut [Item],
    first: usize,
    at: usize,
    nodes: &mut Vec<BinaryNode>,
    room: &mut [(Box8, f32)],
) {
    // Runs of which only the second half is left to do: no more than there are items.
    let mut open = [(0, 0, 0); MOST_IN_CLUSTER];
    let mut waiting = 0;
    let (mut node, mut start, mut end) = (at, 0, items.len());
    loop {
        let run = &mut items[start..end];
        let count = run.len();
        let parting = match count {
            1 => None,
            2..=FEW => {
                // SAFETY: the unit is there.
                let parting = unsafe { weigh_few_with::<L>(run) };
                let mut before = [run[0]; FEW];
                before[..count].copy_from_slice(run);
                parting.part(&before[..count], run);
                Some((parting.count(), parting.bounds, parting.cost))
            }
            // SAFETY: the unit is there.
            _ => Some(unsafe { sweep_with::<L>(run, room) }),
        };
        let bounds = Box8::new(&nodes[node].bounds);
        match parting.filter(|(.., cost)| !rule.is_leaf(count, &bounds, *cost)) {
            Some((left, sides, _)) => {
                let pair = nodes.len();
                nodes[node].first = pair as u32;
                nodes.extend(sides.each_ref().map(budding));
                open[waiting] = (pair + 1, start + left, end);
                waiting += 1;
                (node, end) = (pair, start + left);
            }
            None => {
                nodes[node].first = (first + start) as u32;
                nodes[node].count = count as u32;
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                (node, start, end) = open[waiting];
            }
        }
    }
}

/// Where cutting a run of at least two items costs least: how many items are left of it, the boxes of both sides, and
/// half their areas, each times its items. Room is as long as the run at least.
///
/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn sweep_with<L: Lanes>(items: &[Item], room: &mut [(Box8, f32)]) -> (usize, [Box8; 2], f32) {
    let mut best = (1, [Box8::EMPTY; 2], f32::INFINITY);
    // SAFETY: the unit is there.
    unsafe {
        let mut around = L::load(&Box8::EMPTY);
        for at in (1..items.len()).rev() {
            around = around.union(L::load_item(&items[at]));
            let (right, cost) = &mut room[at];
            around.store(right);
            *cost = around.half_area() * (items.len() - at) as f32;
        }
        around = L::load(&Box8::EMPTY);
        for at in 1..items.len() {
            around = around.union(L::load_item(&items[at - 1]));
            let (right, cost) = &room[at];
            let cost = around.half_area() * at as f32 + cost;
            // The first cut stands where no cost is a number, of boxes whose areas overflow.
            if at == 1 || cost < best.2 || best.2.is_nan() {
                around.store(&mut best.1[0]);
                (best.0, best.1[1], best.2) = (at, *right, cost);
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::bvh::build::lanes::Unit;
    use crate::structure::bvh::build::tests::{nasty, scattered};

    #[test]
    fn every_vector_unit_builds_the_same() {
        let many: Vec<Aabb> = scattered(5000, 9).iter().map(|corners| Aabb::of_points(*corners)).collect();
        for cluster in [1, 8, 32] {
            for (what, boxes) in nasty().into_iter().chain([("many", many.clone())]) {
                let built = [Unit::best(), Unit::Plain].map(|unit| {
                    let mut builder = Morton::new(&Settings { cluster, ..Settings::default() });
                    (builder.above.unit, builder.within.unit) = (unit, unit);
                    let mut bvh = BinaryBvh::default();
                    builder.build(&Input::of(&boxes), &mut bvh).expect("they are fine");
                    bvh
                });
                // As text, which tells -0 from 0.
                assert_eq!(
                    format!("{:?}", built[0]),
                    format!("{:?}", built[1]),
                    "{what}, {cluster} a cluster"
                );
            }
        }
    }
}
