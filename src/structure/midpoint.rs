//! Midpoint subdivision of anything that has a box and a middle: Bubenicek 2020, sec. 2 and 3.
//!
//! A part is cut across its longest axis in the middle of its box, and what is in it goes where its own
//! middle lies, until at most so many are left. The thesis leaves axis, plane and side open; this is the
//! usual reading.
//!
//! Where that cuts nothing off, since all middles lie on one side (all equal, or one far outlier that
//! stretches the box), the part is halved at its median instead; so is one below a chain of midpoints
//! longer than a balanced tree would want. No side is ever empty and the depth is bounded.
//!
//! Parts keep the order their items had. They are worked on by the threads of the current rayon pool;
//! the result does not depend on how many there are.

use glam::Vec3A;
use rayon::prelude::*;

use crate::geometry::Aabb;

/// Parts below this many items are one thread's: a join costs as much as some hundreds of them.
const GRAIN: usize = 4096;

/// What is divided.
pub(super) trait Items: Sync {
    /// Stands for one of them, small enough to be moved about.
    type Item: Copy + Send + Sync;

    /// Where one is.
    fn place(&self, item: Self::Item) -> Place;
}

/// Where an item is; finite, in metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Least corner of its box.
    pub(super) low: Vec3A,
    /// Greatest corner of its box.
    pub(super) high: Vec3A,
    /// The point that decides on which side of a cut it goes.
    pub(super) middle: Vec3A,
}

/// A box in registers.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: Vec3A,
    high: Vec3A,
}

impl Bounds {
    const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    fn of<I: Items>(what: &I, items: &[I::Item]) -> Self {
        items.iter().fold(Self::EMPTY, |all, item| {
            let place = what.place(*item);
            all.union(Self { low: place.low, high: place.high })
        })
    }

    fn union(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    fn aabb(self) -> Aabb {
        Aabb { min: self.low.into(), max: self.high.into() }
    }
}

/// A node of the tree of parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) bounds: Aabb,
    /// Its items: those from here ...
    pub(super) start: u32,
    /// ... to before here.
    pub(super) stop: u32,
    /// Index after the last node of its subtree.
    pub(super) end: u32,
}

/// The parts, depth-first.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) nodes: Vec<Part>,
    /// How many cuts were made at the median.
    pub(super) medians: u32,
    /// Nodes on the longest way down.
    pub(super) depth: u32,
}

/// How many midpoint cuts may lie one below the other: twice what a balanced tree has, and some for
/// small ones, so that only chains of outliers are cut short.
pub(super) fn most_midpoints(count: usize, most: usize) -> u32 {
    2 * count.div_ceil(most.max(1)).next_power_of_two().trailing_zeros() + 8
}

/// Divides items into parts of at most `most` (at least one); reorders them so that each part is a range.
pub(super) fn divide<I: Items>(what: &I, items: &mut [I::Item], most: usize) -> Parts {
    if items.is_empty() {
        return Parts::default();
    }
    let midpoints = most_midpoints(items.len(), most);
    let division = Division { what, most: most.max(1) };
    let chunks = items.par_chunks(GRAIN).map(|chunk| Bounds::of(what, chunk));
    let bounds = chunks.reduce(|| Bounds::EMPTY, Bounds::union);
    let mut spare = items.to_vec();
    division.part(items, &mut spare, Root { bounds, start: 0, midpoints }).joined()
}

/// What is known of a part before it is looked into.
#[derive(Clone, Copy)]
struct Root {
    bounds: Bounds,
    /// Its first item.
    start: u32,
    /// How many midpoint cuts may still be made on the way down.
    midpoints: u32,
}

impl Root {
    /// The two halves of a cut part.
    fn halves(&self, cut: &Cut) -> [Self; 2] {
        let midpoints = self.midpoints.saturating_sub(1);
        let [first, second] = cut.bounds;
        [
            Self { bounds: first, start: self.start, midpoints },
            Self { bounds: second, start: self.start + cut.first as u32, midpoints },
        ]
    }

    fn node(&self, count: usize, end: u32) -> Part {
        Part { bounds: self.bounds.aabb(), start: self.start, stop: self.start + count as u32, end }
    }
}

struct Division<'a, I> {
    what: &'a I,
    most: usize,
}

/// Nodes of a subtree in pieces, one after the other; ends are counted from the piece's own start, so that
/// pieces of different threads need not know of each other.
struct Segments {
    pieces: Vec<Vec<Part>>,
    nodes: u32,
    medians: u32,
    depth: u32,
}

impl Segments {
    fn joined(mut self) -> Parts {
        let (medians, depth) = (self.medians, self.depth);
        if self.pieces.len() == 1 {
            return Parts { nodes: self.pieces.remove(0), medians, depth };
        }
        let mut nodes = Vec::with_capacity(self.nodes as usize);
        for piece in self.pieces {
            let base = nodes.len() as u32;
            nodes.extend(piece.into_iter().map(|part| Part { end: part.end + base, ..part }));
        }
        Parts { nodes, medians, depth }
    }
}

impl<I: Items> Division<'_, I> {
    /// Divides a part that many threads may share.
    fn part(&self, items: &mut [I::Item], spare: &mut [I::Item], root: Root) -> Segments {
        if items.len() <= GRAIN.max(self.most) || rayon::current_num_threads() == 1 {
            // As many as parts of three quarters of the limit make; there may be more.
            let nodes = Vec::with_capacity(3 * (items.len() / self.most) + 1);
            let mut alone = Alone { division: self, nodes, medians: 0, depth: 0 };
            alone.part(items, spare, root, 1);
            let Alone { nodes, medians, depth, .. } = alone;
            return Segments { nodes: nodes.len() as u32, pieces: vec![nodes], medians, depth };
        }
        let cut = self.cut(items, spare, &root);
        let (first, second) = items.split_at_mut(cut.first);
        let (spare_first, spare_second) = spare.split_at_mut(cut.first);
        let [half, other_half] = root.halves(&cut);
        let (mut one, mut other) = rayon::join(
            || self.part(first, spare_first, half),
            || self.part(second, spare_second, other_half),
        );
        let nodes = 1 + one.nodes + other.nodes;
        let mut pieces = vec![vec![root.node(items.len(), nodes)]];
        pieces.append(&mut one.pieces);
        pieces.append(&mut other.pieces);
        Segments {
            pieces,
            nodes,
            medians: one.medians + other.medians + u32::from(cut.by_median),
            depth: one.depth.max(other.depth) + 1,
        }
    }

    /// Cuts a part of two items or more in two, neither of them empty.
    fn cut(&self, items: &mut [I::Item], spare: &mut [I::Item], root: &Root) -> Cut {
        if root.midpoints > 0 {
            let cut = self.cut_at_middle(items, spare, root.bounds);
            if (1..items.len()).contains(&cut.first) {
                return cut;
            }
        }
        // The box's longest axis may be one all middles agree on: what counts now is where they differ.
        let middle = |item: &I::Item| self.what.place(*item).middle;
        let middles = items
            .iter()
            .map(middle)
            .fold(Bounds::EMPTY, |all, middle| all.union(Bounds { low: middle, high: middle }));
        let axis = longest(middles);
        items.sort_by(|one, other| middle(one)[axis].total_cmp(&middle(other)[axis]));
        let first = items.len() / 2;
        let (one, other) = items.split_at(first);
        Cut { first, bounds: [one, other].map(|half| Bounds::of(self.what, half)), by_median: true }
    }

    /// Brings the items whose middle lies below that of the box before the others, both in the order they
    /// had, and takes the boxes of the two on the way.
    fn cut_at_middle(&self, items: &mut [I::Item], spare: &mut [I::Item], bounds: Bounds) -> Cut {
        let mut plane = Vec3A::NEG_INFINITY;
        let axis = longest(bounds);
        plane[axis] = bounds.low[axis] * 0.5 + bounds.high[axis] * 0.5;
        let (mut first, mut second) = (0, 0);
        let mut halves = [Bounds::EMPTY; 2];
        // Each item is written to both sides and counted on one, and its box is added to one and, moved out
        // of the way, to the other: the side may be as good as random, and a branch that is guessed wrong
        // costs more than all this.
        let away = [Vec3A::ZERO, Vec3A::INFINITY];
        for at in 0..items.len() {
            let item = items[at];
            let place = self.what.place(item);
            let is_first = place.middle.cmplt(plane).any();
            items[first] = item;
            spare[second] = item;
            first += usize::from(is_first);
            second += usize::from(!is_first);
            for (half, away) in
                halves.iter_mut().zip([away[usize::from(!is_first)], away[usize::from(is_first)]])
            {
                half.low = half.low.min(place.low + away);
                half.high = half.high.max(place.high - away);
            }
        }
        items[first..].copy_from_slice(&spare[..second]);
        Cut { first, bounds: halves, by_median: false }
    }
}

/// A part cut in two.
struct Cut {
    /// How many items the first half has.
    first: usize,
    bounds: [Bounds; 2],
    by_median: bool,
}

/// A subtree that one thread divides.
struct Alone<'a, 'b, I> {
    division: &'a Division<'b, I>,
    nodes: Vec<Part>,
    medians: u32,
    depth: u32,
}

impl<I: Items> Alone<'_, '_, I> {
    fn part(&mut self, items: &mut [I::Item], spare: &mut [I::Item], root: Root, depth: u32) {
        let here = self.nodes.len();
        self.nodes.push(root.node(items.len(), here as u32 + 1));
        self.depth = self.depth.max(depth);
        if items.len() <= self.division.most {
            return;
        }
        let cut = self.division.cut(items, spare, &root);
        self.medians += u32::from(cut.by_median);
        let (first, second) = items.split_at_mut(cut.first);
        let [half, other_half] = root.halves(&cut);
        self.part(first, spare, half, depth + 1);
        self.part(second, spare, other_half, depth + 1);
        self.nodes[here].end = self.nodes.len() as u32;
    }
}

/// The axis a box is longest on; the first of equals.
fn longest(bounds: Bounds) -> usize {
    // Halved before they are subtracted, so that boxes near the end of the number range do not overflow.
    let size = bounds.high * 0.5 - bounds.low * 0.5;
    if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    }
}
