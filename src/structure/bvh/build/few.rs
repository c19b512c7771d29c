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
pub(super) unsafe fn weigh_few_with<L: Lanes>(items: &[Item]) -> Parting {
    let mut best = Parting { left: 0, bounds: [Box8::EMPTY; 2], cost: f32::INFINITY };
    // SAFETY: the unit is there.
    unsafe {
        let item = |i: usize| (L::load_item(&items[i]), items[i].weight());
        let join = |one: (L, u32), other: (L, u32)| (one.0.union(other.0), one.1 + other.1);
        let mut weigh = |left: usize, sides: [(L, u32); 2]| {
            let [one, other] = sides.map(|(bounds, weight)| bounds.half_area() * weight as f32);
            // The first way stands where no cost is a number, of boxes whose areas overflow.
            if best.left == 0 || one + other < best.cost || best.cost.is_nan() {
                (best.cost, best.left) = (one + other, left);
                sides.into_iter().zip(&mut best.bounds).for_each(|((side, _), bounds)| side.store(bounds));
            }
        };
        let (a, b) = (item(0), item(1));
        if items.len() == 2 {
            weigh(0b1, [a, b]);
            return best;
        }
        let c = item(2);
        let (ab, ac, bc) = (join(a, b), join(a, c), join(b, c));
        if items.len() == 3 {
            weigh(0b1, [a, bc]);
            weigh(0b11, [ab, c]);
            weigh(0b101, [ac, b]);
            return best;
        }
        let d = item(3);
        let (ad, bd, cd) = (join(a, d), join(b, d), join(c, d));
        weigh(0b1, [a, join(b, cd)]);
        weigh(0b11, [ab, cd]);
        weigh(0b101, [ac, bd]);
        weigh(0b111, [join(ab, c), d]);
        weigh(0b1001, [ad, bc]);
        weigh(0b1011, [join(ab, d), c]);
        weigh(0b1101, [join(ac, d), b]);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use crate::structure::bvh::build::lanes::Unit;
    use crate::structure::bvh::build::tests::scattered;

    #[test]
    fn no_other_way_is_cheaper() {
        for seed in 1..200 {
            let count = 2 + seed as usize % 3;
            let boxes: Vec<Aabb> =
                scattered(count, seed).iter().map(|corners| Aabb::of_points(*corners)).collect();
            let item =
                |i: usize| Item::new(&Box8::new(&boxes[i]), i as u32, 1 + seed as u32 % (3 + i as u32));
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
