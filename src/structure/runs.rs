//! A mesh's triangles by midpoint into leaves, many at a time.
//!
//! What follows each other in a mesh mostly lies side by side. So triangles are moved about in runs: those of
//! [`WINDOW`] that follow each other in the mesh which have been on the same sides so far. A run whose middles
//! all lie on one side of a plane goes there as a whole, and only one that the plane parts is looked into and
//! becomes two.
//! The boxes of triangles and of their middles are worked out once and, again, where a run is parted; all else
//! is comparisons of whole runs. The outcome is that of the rule applied to triangles one by one
//! ([`super::midpoint`]), to the bit; a mesh whose triangles follow each other in no order is divided no
//! worse, only slower, in runs of one.
//!
//! Each leaf is written to its place in the new order as soon as it is found, which is known
//! beforehand: the triangles of all parts before it.

use glam::{Vec3, Vec3A};
use rayon::prelude::*;

use super::Leaf;
use super::midpoint::{Bounds, most_midpoints};

/// Triangles of the mesh that a run is some of: as many as a mask has bits.
const WINDOW: usize = 32;
/// Parts below this many triangles are one thread's, and so many are brought into runs at a time.
const GRAIN: usize = 1 << 15;

/// Of the sum of three corners: the middle of a triangle.
const THIRD: f32 = 1.0 / 3.0;

/// Some triangles of a window of the mesh; a part has one run of each at most, but for singles of a median.
#[derive(Clone, Copy, Debug)]
struct Run {
    bounds: Bounds,
    /// The box around the points that decide on which side of a cut they go.
    middles: Bounds,
    /// The triangle that bit 0 stands for.
    start: u32,
    /// Which of them are in the run: at least one.
    mask: u32,
    /// How many.
    count: u32,
}

/// The bits set in a mask, the lowest first.
#[inline]
fn bits(mut mask: u32) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let bit = mask.trailing_zeros();
        mask &= mask.wrapping_sub(1);
        (bit < u32::BITS).then_some(bit)
    })
}

/// A part before it is divided.
#[derive(Clone, Copy, Debug)]
struct Part {
    bounds: Bounds,
    /// Its first triangle in the new order, and how many it has.
    start: u32,
    count: u32,
    /// How many midpoint cuts may still be made on the way down.
    midpoints: u32,
    /// Parts on the way to it, itself included.
    depth: u32,
}

/// What came of a part, or of several.
#[derive(Debug, Default)]
pub(super) struct Divided {
    /// Leaves in order, a list for each piece of the work.
    pub(super) leaves: Vec<Vec<Leaf>>,
    pub(super) medians: u32,
    pub(super) depth: u32,
}

impl Divided {
    fn and(mut self, mut other: Self) -> Self {
        self.leaves.append(&mut other.leaves);
        Self {
            leaves: self.leaves,
            medians: self.medians + other.medians,
            depth: self.depth.max(other.depth),
        }
    }
}

/// A cut part: runs of its halves and what is known of these.
struct Halves {
    bounds: [Bounds; 2],
    /// Triangles of the first.
    first: u32,
}

/// A mesh, its vertices finite.
pub(super) struct Runs<'a> {
    pub(super) vertices: &'a [Vec3],
    pub(super) triangles: &'a [[u32; 3]],
}

impl Runs<'_> {
    /// Divides the triangles, fewer than 2^32, into leaves of at most `most` (at least one) and writes them
    /// to `order`, which has as many places. `None` if a triangle names a vertex there is not.
    pub(super) fn divide(&self, most: usize, order: &mut [[u32; 3]]) -> Option<Divided> {
        let count = self.triangles.len();
        if count == 0 {
            return Some(Divided::default());
        }
        let chunk = if rayon::current_num_threads() == 1 { count.next_multiple_of(WINDOW) } else { GRAIN };
        let chunks = self.triangles.par_chunks(chunk).enumerate();
        let chunks = chunks.map(|(index, triangles)| self.runs(index * chunk, triangles));
        let (runs, bounds): (Vec<_>, Vec<_>) = chunks.collect::<Option<Vec<_>>>()?.into_iter().unzip();
        let bounds = bounds.into_iter().fold(Bounds::EMPTY, Bounds::union);
        let midpoints = most_midpoints(count, most);
        let whole = Part { bounds, start: 0, count: count as u32, midpoints, depth: 1 };
        let most = u32::try_from(most).unwrap_or(u32::MAX);
        Some(self.part(runs, whole, most, order))
    }

    /// Brings some triangles, the first of which is `start`, into runs.
    fn runs(&self, start: usize, triangles: &[[u32; 3]]) -> Option<(Vec<Run>, Bounds)> {
        let exists =
            |triangle: &[u32; 3]| triangle.iter().all(|vertex| (*vertex as usize) < self.vertices.len());
        let mut all = Bounds::EMPTY;
        let mut runs = Vec::with_capacity(triangles.len().div_ceil(WINDOW));
        for (index, triangles) in triangles.chunks(WINDOW).enumerate() {
            if !triangles.iter().all(exists) {
                return None;
            }
            let run = self.run((start + index * WINDOW) as u32, u32::MAX >> (WINDOW - triangles.len()));
            all = all.union(run.bounds);
            runs.push(run);
        }
        Some((runs, all))
    }

    /// The run of some triangles, at least one.
    #[inline]
    fn run(&self, start: u32, mask: u32) -> Run {
        let (mut bounds, mut middles) = (Bounds::EMPTY, Bounds::EMPTY);
        for bit in bits(mask) {
            let [a, b, c] = self.triangles[(start + bit) as usize];
            let [a, b, c] = [self.vertex(a), self.vertex(b), self.vertex(c)];
            bounds = bounds.union(Bounds { low: a.min(b).min(c), high: a.max(b).max(c) });
            middles = middles.with((a + b + c) * THIRD);
        }
        Run { bounds, middles, start, mask, count: mask.count_ones() }
    }

    #[inline]
    fn vertex(&self, vertex: u32) -> Vec3A {
        Vec3A::from(self.vertices[vertex as usize])
    }

    /// Divides a part that many threads may share, its runs in one or more lists.
    fn part(&self, mut lists: Vec<Vec<Run>>, part: Part, most: u32, order: &mut [[u32; 3]]) -> Divided {
        let is_shared = part.count > most && part.count as usize > GRAIN && rayon::current_num_threads() > 1;
        if !is_shared {
            let runs = if lists.len() == 1 { lists.remove(0) } else { lists.concat() };
            let mut alone =
                Alone { mesh: self, most, runs, spare: Vec::new(), leaves: Vec::new(), medians: 0, depth: 0 };
            alone.part(0, part, order);
            return Divided { leaves: vec![alone.leaves], medians: alone.medians, depth: alone.depth };
        }
        let cut = part.bounds.cut();
        let cut_list = |runs: &mut Vec<Run>| {
            let mut first = Vec::with_capacity(runs.len());
            (self.cut(cut, runs, 0, &mut first), first)
        };
        let halves = match part.midpoints {
            0 => None,
            _ => {
                let cuts: Vec<_> = lists.par_iter_mut().map(cut_list).collect();
                let bounds = cuts.iter().fold([Bounds::EMPTY; 2], |all, (cut, _)| {
                    [all[0].union(cut.bounds[0]), all[1].union(cut.bounds[1])]
                });
                let first = cuts.iter().map(|(cut, _)| cut.first).sum();
                Some((Halves { bounds, first }, cuts.into_iter().map(|(_, runs)| runs).collect::<Vec<_>>()))
            }
        };
        let (halves, first, second, medians) = match halves {
            Some((halves, first)) if (1..part.count).contains(&halves.first) => (halves, first, lists, 0),
            // The middle parted nothing: whichever half is there is the whole.
            parted => {
                let whole = match parted {
                    Some((halves, first)) if halves.first > 0 => first,
                    _ => lists,
                };
                let mut runs = whole.concat();
                let mut first = Vec::new();
                let halves = self.cut_at_median(&mut runs, 0, &mut first);
                (halves, vec![first], vec![runs], 1)
            }
        };
        let [half, other_half] = part.halves(&halves);
        let (order, other_order) = order.split_at_mut(halves.first as usize);
        let (one, other) = rayon::join(
            || self.part(first, half, most, order),
            || self.part(second, other_half, most, other_order),
        );
        let divided = one.and(other);
        Divided { medians: divided.medians + medians, ..divided }
    }

    /// Parts the runs from `from` on by a plane, each half in the order the runs had: the first half is
    /// appended to `first`, the second stays.
    #[inline]
    fn cut(
        &self,
        (axis, plane): (usize, f32),
        runs: &mut Vec<Run>,
        from: usize,
        first: &mut Vec<Run>,
    ) -> Halves {
        let [mut bounds, mut other_bounds] = [Bounds::EMPTY; 2];
        let (mut count, mut kept) = (0, from);
        for at in from..runs.len() {
            let run = &runs[at];
            if run.middles.low[axis] >= plane {
                other_bounds = other_bounds.union(run.bounds);
                runs[kept] = *run;
                kept += 1;
                continue;
            }
            if run.middles.high[axis] < plane {
                bounds = bounds.union(run.bounds);
                count += run.count;
                first.push(*run);
                continue;
            }
            let below = self.below(run, axis, plane);
            let [one, other] = [below, run.mask & !below].map(|mask| self.run(run.start, mask));
            bounds = bounds.union(one.bounds);
            count += one.count;
            first.push(one);
            other_bounds = other_bounds.union(other.bounds);
            runs[kept] = other;
            kept += 1;
        }
        runs.truncate(kept);
        Halves { bounds: [bounds, other_bounds], first: count }
    }

    /// Those triangles of a run whose middles lie below a plane.
    fn below(&self, run: &Run, axis: usize, plane: f32) -> u32 {
        let at = |vertex: u32| self.vertices[vertex as usize][axis];
        bits(run.mask).fold(0, |below, bit| {
            let [a, b, c] = self.triangles[(run.start + bit) as usize];
            below | u32::from((at(a) + at(b) + at(c)) * THIRD < plane) << bit
        })
    }

    /// Halves the runs from `from` on at the median of their middles, as [`Self::cut`] does at a plane.
    /// All become runs of one.
    fn cut_at_median(&self, runs: &mut Vec<Run>, from: usize, first: &mut Vec<Run>) -> Halves {
        // The box's longest axis may be one all middles agree on: what counts now is where they differ.
        let middles = runs[from..].iter().fold(Bounds::EMPTY, |all, run| all.union(run.middles));
        let axis = middles.longest();
        let mut singles = Vec::new();
        for Run { start, mask, .. } in runs[from..].iter().copied() {
            singles.extend(bits(mask).map(|bit| self.run(start, 1 << bit)));
        }
        runs.truncate(from);
        singles.sort_by(|one, other| one.middles.low[axis].total_cmp(&other.middles.low[axis]));
        runs.extend(singles.drain(singles.len() / 2..));
        let bounds = [&singles[..], &runs[from..]]
            .map(|half| half.iter().fold(Bounds::EMPTY, |all, run| all.union(run.bounds)));
        let halves = Halves { bounds, first: singles.len() as u32 };
        first.append(&mut singles);
        halves
    }
}

impl Part {
    /// The two halves of a cut part.
    fn halves(&self, cut: &Halves) -> [Self; 2] {
        let [first, second] = cut.bounds;
        let below = Self { midpoints: self.midpoints.saturating_sub(1), depth: self.depth + 1, ..*self };
        [
            Self { bounds: first, count: cut.first, ..below },
            Self { bounds: second, start: self.start + cut.first, count: self.count - cut.first, ..below },
        ]
    }
}

/// A part that one thread divides.
struct Alone<'a, 'b> {
    mesh: &'a Runs<'b>,
    most: u32,
    /// The parts not yet divided, the next one last.
    runs: Vec<Run>,
    /// For the half that is cut off; empty between cuts.
    spare: Vec<Run>,
    leaves: Vec<Leaf>,
    medians: u32,
    depth: u32,
}

impl Alone<'_, '_> {
    /// Divides the part whose runs are those from `from` on, and takes them away.
    fn part(&mut self, from: usize, part: Part, order: &mut [[u32; 3]]) {
        if part.count <= self.most {
            self.leaf(from, part, order);
            return;
        }
        let mut halves = None;
        if part.midpoints > 0 {
            let cut = self.mesh.cut(part.bounds.cut(), &mut self.runs, from, &mut self.spare);
            if (1..part.count).contains(&cut.first) {
                halves = Some(cut);
            } else {
                // Nothing is parted: whichever half is there is the whole.
                self.runs.append(&mut self.spare);
            }
        }
        let halves = halves.unwrap_or_else(|| {
            self.medians += 1;
            self.mesh.cut_at_median(&mut self.runs, from, &mut self.spare)
        });
        let first = self.runs.len();
        self.runs.append(&mut self.spare);
        let [half, other_half] = part.halves(&halves);
        let (order, other_order) = order.split_at_mut(halves.first as usize);
        self.part(first, half, order);
        self.part(from, other_half, other_order);
    }

    fn leaf(&mut self, from: usize, part: Part, mut order: &mut [[u32; 3]]) {
        for Run { start, mask, .. } in self.runs[from..].iter().copied() {
            let (places, rest) = order.split_at_mut(mask.count_ones() as usize);
            let start = start as usize;
            if mask.trailing_ones() as usize == places.len() {
                places.copy_from_slice(&self.mesh.triangles[start..start + places.len()]);
            } else {
                for (place, bit) in places.iter_mut().zip(bits(mask)) {
                    *place = self.mesh.triangles[start + bit as usize];
                }
            }
            order = rest;
        }
        self.runs.truncate(from);
        self.depth = self.depth.max(part.depth);
        let triangles = part.start..part.start + part.count;
        self.leaves.push(Leaf { triangles, bounds: part.bounds.aabb() });
    }
}
