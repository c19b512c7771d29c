//! Nodes of a few items: every way to part them in two is weighed, not only those that a plane makes. That is less work
//! than to fill bins, and most nodes are such.

use super::lanes::{Box8, Item, Lanes, on_unit};

/// The most items that are a few.
pub(super) const FEW: usize = 4;

/// The best way to part a few items.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parting {
    /// Which are on the left, by bit.
    pub(super) left: usize,
    pub(super) bounds: [Box8; 2],
    /// Half the areas of the sides, each times what weighs on it.
    pub(super) cost: f32,
}

impl Parting {
    /// How many items are on the left.
    pub(super) fn count(&self) -> usize {
        self.left.count_ones() as usize
    }

    /// Copies items to their sides, each side keeping its order. There are as many places as items.
    pub(super) fn part(&self, items: &[Item], to: &mut [Item]) {
        let mut at = [0, self.count()];
        for (i, item) in items.iter().enumerate() {
            let side = 1 - (self.left >> i & 1);
            to[at[side]] = *item;
            at[side] += 1;
        }
    }
}

on_unit! {
    /// The cheapest way by the surface area heuristic to part two to [`FEW`] items; of equal ones the first, the first item
    /// being on the left always.
    fn weigh_few(items: &[Item]) -> Parting = weigh_few_with
}

/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn weigh_few_with<L: Lanes>(items: &[Item]) -> Parting {
    // Of every set of items, told by its bits, the box and what it costs.
    let mut bounds = [Box8::EMPTY; 1 << FEW];
    let (mut weights, mut costs) = ([0; 1 << FEW], [0.0; 1 << FEW]);
    let all = (1 << items.len().min(FEW)) - 1;
    // SAFETY: the unit is there.
    unsafe {
        for (i, item) in items.iter().take(FEW).enumerate() {
            let (one, weight) = (L::load_item(item), item.weight());
            for set in 0..1 << i {
                let with = set | 1 << i;
                let around = L::load(&bounds[set]).union(one);
                around.store(&mut bounds[with]);
                weights[with] = weights[set] + weight;
                costs[with] = around.half_area() * weights[with] as f32;
            }
        }
    }
    let (mut cost, mut left) = (costs[1] + costs[all - 1], 1);
    for set in (3..all).step_by(2) {
        let both = costs[set] + costs[all - set];
        if both < cost {
            (cost, left) = (both, set);
        }
    }
    Parting { left, bounds: [bounds[left], bounds[all - left]], cost }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::bvh::build::lanes::Unit;
    use crate::structure::bvh::build::tests::scattered;
    use crate::geometry::Aabb;

    #[test]
    fn no_other_way_is_cheaper() {
        for seed in 1..200 {
            let count = 2 + seed as usize % 3;
            let boxes: Vec<Aabb> = scattered(count, seed).iter().map(|corners| Aabb::of_points(*corners)).collect();
            let item = |i: usize| Item::new(&Box8::new(&boxes[i]), i as u32, 1 + seed as u32 % (3 + i as u32));
            let items: Vec<Item> = (0..count).map(item).collect();
            let side = |set: usize| {
                let among = (0..count).filter(|i| set >> i & 1 == 1);
                let size = among.clone().fold(Aabb::EMPTY, |all, i| all.union(boxes[i])).size().as_dvec3();
                let weight: u32 = among.map(|i| items[i].weight()).sum();
                (size.x * size.y + size.y * size.z + size.z * size.x) * f64::from(weight)
            };
            let all = (1 << count) - 1;
            let best = (1..all).map(|set| side(set) + side(all - set)).fold(f64::INFINITY, f64::min);
            for unit in [Unit::best(), Unit::Plain] {
                let parting = weigh_few(unit, &items);
                let found = side(parting.left) + side(all - parting.left);
                assert!(found <= best * 1.000_01 && parting.left < all, "{seed}: {found} and not {best}");
                assert!((f64::from(parting.cost) / found - 1.0).abs() < 1e-5);
                let mut parted = items.clone();
                parting.part(&items, &mut parted);
                let (left, right) = parted.split_at(parting.count());
                for (side, bounds) in [left, right].into_iter().zip(parting.bounds) {
                    let around = side.iter().fold(Box8::EMPTY, |all, item| all.union(&item.bounds()));
                    assert_eq!(around, bounds);
                    assert!(side.is_sorted_by_key(Item::number), "each side keeps its order");
                }
            }
        }
    }
}
