//! Bins along the three axes: how many items have their middle in each, and the box around them.

use super::lanes::{Box8, Item, Lanes, on_unit};

/// The most bins there can be on an axis.
pub const MOST_BINS: usize = 64;
/// Middles that lie no further apart than this are taken to be in one place: bins could not be told apart. The
/// hierarchy is built in a range of numbers where this is far less than rounding.
const LEAST_EXTENT: f32 = 1e-30;

/// How the middles of a node's items fall into bins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grating {
    from: [f32; 3],
    /// Bins for each unit of length; 0 on an axis where all middles are in one place.
    scale: [f32; 3],
    bins: usize,
}

/// A plane between two bins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) axis: usize,
    from: f32,
    scale: f32,
    bin: f32,
}

impl Plane {
    /// The first bin on its right.
    pub(super) fn bin(&self) -> usize {
        self.bin as usize
    }

    /// Which side an item is on. The same two operations that gave it its bin, which is why the counts of the bins are
    /// those of the sides.
    #[inline(always)]
    pub(super) fn is_right(&self, item: &Item) -> bool {
        (item.middle(self.axis) - self.from) * self.scale >= self.bin
    }
}

/// A plane, and what comes to lie on its sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    pub(super) plane: Plane,
    /// Items on the left.
    pub(super) left: usize,
    pub(super) bounds: [Box8; 2],
    /// Half the areas of the sides, each times what weighs on it.
    pub(super) cost: f32,
}

impl Grating {
    /// Bins between the outermost middles, which are given twice their size.
    pub(super) fn new(middles: &Box8, bins: usize) -> Self {
        let scale = |axis| {
            let extent = middles.size(axis);
            if extent > LEAST_EXTENT { bins as f32 / extent } else { 0.0 }
        };
        Self { from: [0, 1, 2].map(|axis| -middles.0[axis]), scale: [0, 1, 2].map(scale), bins }
    }

    /// Bins one unit of length apart, from 0.
    pub(super) fn unit(bins: usize) -> Self {
        Self { from: [0.0; 3], scale: [1.0; 3], bins }
    }

    /// Bins on each axis.
    pub(super) fn bins(&self) -> usize {
        self.bins
    }

    /// Whether all middles are in one place.
    pub(super) fn is_point(&self) -> bool {
        self.scale == [0.0; 3]
    }

    /// The bin of an item on an axis.
    #[inline(always)]
    pub(super) fn bin(&self, item: &Item, axis: usize) -> u32 {
        let bin = (item.middle(axis) - self.from[axis]) * self.scale[axis];
        (bin as u32).min(self.bins as u32 - 1)
    }

    /// Where bins begin, how many there are for each unit of length, and the last.
    ///
    /// # Safety
    /// The processor has the unit.
    #[inline(always)]
    pub(super) unsafe fn lanes<L: Lanes>(&self) -> (L::Three, L::Three, i32) {
        // SAFETY: the unit is there.
        unsafe { (L::three(self.from), L::three(self.scale), self.bins as i32 - 1) }
    }

    /// Takes all axes out but the one of the greatest extent.
    pub(super) fn longest_only(mut self) -> Self {
        // Of equal extents the first; a scale is the less, the longer the axis.
        let there = (0..3).filter(|axis| self.scale[*axis] > 0.0);
        let longest = there.min_by(|a, b| self.scale[*a].total_cmp(&self.scale[*b]));
        for axis in 0..3 {
            if Some(axis) != longest {
                self.scale[axis] = 0.0;
            }
        }
        self
    }
}

/// The bins of a node.
#[derive(Clone)]
pub(super) struct Bins {
    boxes: [[Box8; MOST_BINS]; 3],
    /// How many items, and above bit 32 what they weigh.
    loads: [[u64; MOST_BINS]; 3],
}

impl Bins {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self { boxes: [[Box8::EMPTY; MOST_BINS]; 3], loads: [[0; MOST_BINS]; 3] })
    }

    /// Empties as many bins as a grating has.
    pub(super) fn clear(&mut self, grating: &Grating) {
        for axis in 0..3 {
            self.boxes[axis][..grating.bins].fill(Box8::EMPTY);
            self.loads[axis][..grating.bins].fill(0);
        }
    }

    /// Adds what another has in the bins of the same grating.
    pub(super) fn merge(&mut self, other: &Self, grating: &Grating) {
        for axis in 0..3 {
            for bin in 0..grating.bins {
                self.boxes[axis][bin] = self.boxes[axis][bin].union(&other.boxes[axis][bin]);
                self.loads[axis][bin] += other.loads[axis][bin];
            }
        }
    }

    /// How many items a plane of the same grating leaves on its left.
    pub(super) fn left_of(&self, plane: &Plane) -> usize {
        self.loads[plane.axis][..plane.bin as usize].iter().map(|load| *load as u32 as usize).sum()
    }

    /// Adds items to a bin of an axis, each of weight 1.
    pub(super) fn add(&mut self, axis: usize, bin: usize, bounds: &Box8, items: u32) {
        self.boxes[axis][bin] = self.boxes[axis][bin].union(bounds);
        self.loads[axis][bin] += u64::from(items) << 32 | u64::from(items);
    }

    /// The side left of a bin and the one right of it: box and items.
    fn sides(&self, axis: usize, bin: usize, bins: usize) -> ([Box8; 2], usize) {
        let join = |range: std::ops::Range<usize>| {
            self.boxes[axis][range].iter().fold(Box8::EMPTY, |all, one| all.union(one))
        };
        let left = self.loads[axis][..bin].iter().map(|load| *load as u32 as usize).sum();
        ([join(0..bin), join(bin..bins)], left)
    }
}

on_unit! {
    /// Adds items to the bins.
    fn fill(items: &[Item], grating: &Grating, bins: &mut Bins) -> () = fill_with
}

/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn fill_with<L: Lanes>(items: &[Item], grating: &Grating, bins: &mut Bins) {
    // SAFETY: the unit is there; middles lie between the outermost ones, which makes bins of at most `MOST_BINS`.
    unsafe {
        let (from, scale, last) = grating.lanes::<L>();
        for item in items {
            let bounds = L::load_item(item);
            // The outermost middle lies at the end of the last bin, not in it.
            let at = L::bins(bounds.middle(), from, scale, last);
            let load = 1 | u64::from(item.weight()) << 32;
            for (axis, bin) in at.into_iter().take(3).enumerate() {
                let bin = bin as usize % MOST_BINS;
                let into = &mut bins.boxes[axis][bin];
                L::load(into).union(bounds).store(into);
                bins.loads[axis][bin] += load;
            }
        }
    }
}

on_unit! {
    /// The plane of the least cost by the surface area heuristic; none if no plane has items on both sides. Of planes
    /// that cost the same the first, by axis and bin.
    fn best(bins: &Bins, grating: &Grating) -> Option<Split> = best_with
}

/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn best_with<L: Lanes>(bins: &Bins, grating: &Grating) -> Option<Split> {
    let mut best = (f32::INFINITY, 0, 0);
    let mut right = [0.0; MOST_BINS];
    for axis in 0..3 {
        if grating.scale[axis] == 0.0 {
            continue;
        }
        let (boxes, loads) = (&bins.boxes[axis][..grating.bins], &bins.loads[axis][..grating.bins]);
        // SAFETY: the unit is there.
        unsafe {
            // The area of nothing is infinite, times a weight of 0: no number, which is less than none.
            let (mut around, mut weight) = (L::load(&Box8::EMPTY), 0);
            for bin in (1..grating.bins).rev() {
                around = around.union(L::load(&boxes[bin]));
                weight += (loads[bin] >> 32) as u32;
                right[bin] = around.half_area() * weight as f32;
            }
            (around, weight) = (L::load(&Box8::EMPTY), 0);
            for bin in 1..grating.bins {
                around = around.union(L::load(&boxes[bin - 1]));
                weight += (loads[bin - 1] >> 32) as u32;
                let cost = around.half_area() * weight as f32 + right[bin];
                if cost < best.0 {
                    best = (cost, axis, bin);
                }
            }
        }
    }
    let (cost, axis, bin) = best;
    (bin > 0).then(|| {
        let (bounds, left) = bins.sides(axis, bin, grating.bins);
        let plane = Plane { axis, from: grating.from[axis], scale: grating.scale[axis], bin: bin as f32 };
        Split { plane, left, bounds, cost }
    })
}

on_unit! {
    /// Moves items to one of two places by the side they are on, each side keeping its order; returns the box around
    /// the middles, twice their size, of either side. Each place has room for at least what comes to it.
    fn part(items: &[Item], plane: &Plane, to: [&mut [Item]; 2]) -> [Box8; 2] = part_with
}

/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn part_with<L: Lanes>(items: &[Item], plane: &Plane, to: [&mut [Item]; 2]) -> [Box8; 2] {
    let mut middles = [Box8::EMPTY; 2];
    let mut at = [0; 2];
    for item in items {
        // Which side is a coin toss to the processor: an index, not a branch.
        let side = usize::from(plane.is_right(item));
        to[side][at[side]] = *item;
        at[side] += 1;
        // SAFETY: the unit is there.
        unsafe {
            let middle = L::of_point(L::load_item(item).middle());
            L::load(&middles[side]).union(middle).store(&mut middles[side]);
        }
    }
    middles
}

on_unit! {
    /// The box around items, and the one around their middles, twice their size.
    fn around(items: &[Item]) -> [Box8; 2] = around_with
}

/// # Safety
/// The processor has the unit.
#[inline(always)]
unsafe fn around_with<L: Lanes>(items: &[Item]) -> [Box8; 2] {
    let mut both = [Box8::EMPTY; 2];
    // SAFETY: the unit is there.
    unsafe {
        let (mut bounds, mut middles) = (L::load(&both[0]), L::load(&both[1]));
        for item in items {
            let one = L::load_item(item);
            bounds = bounds.union(one);
            middles = middles.union(L::of_point(one.middle()));
        }
        bounds.store(&mut both[0]);
        middles.store(&mut both[1]);
    }
    both
}
