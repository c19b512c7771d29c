//! A query as work for tree schemes: by pairs of boxes that are tested one at a time, as Paper II did, or by pairs
//! that overlap, whose boxes below are tested eight at a time.

use super::{Costs, Pair, is_over};
use crate::geometry::Overlap;
use crate::machine::{Processor, Word};
use crate::scheme::tree::TreeWork;
use crate::structure::volume_tree::Link;
use std::sync::atomic::Ordering;

/// What one processor found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// Contacts: items of the first and of the second body, by number.
    pub pairs: Vec<(u32, u32)>,
    /// Overlap tests of boxes.
    pub box_tests: u64,
    /// Pairs of triangles tested.
    pub triangle_tests: u64,
    /// Pairs of leaves that overlapped though none of their triangles touch.
    pub false_overlaps: u64,
}

/// What both ways of working have.
struct Common<'a, W, V: Overlap> {
    pair: &'a Pair<'a, V>,
    /// Set when any one contact is enough and has been found.
    stop: Option<&'a W>,
    costs: Costs,
}

/// Which body's box is descended.
enum Down {
    First,
    Second,
    Leaves,
}

impl<W: Word, V: Overlap> Common<'_, W, V> {
    /// The links of a pair of boxes, as read from shared memory.
    #[inline]
    fn links<P: Processor>(&self, (a, b): (u32, u32), cpu: &P) -> (Link, Link) {
        let (a, b) = (&self.pair.a.links[a as usize], &self.pair.b.links[b as usize]);
        cpu.touch(a);
        cpu.touch(b);
        (*a, *b)
    }

    /// The larger is descended, or the one that is no leaf.
    #[inline]
    fn down(a: &Link, b: &Link) -> Down {
        match (a.is_leaf(), b.is_leaf()) {
            (true, true) => Down::Leaves,
            (false, true) => Down::First,
            (true, false) => Down::Second,
            (false, false) if a.surface >= b.surface => Down::First,
            (false, false) => Down::Second,
        }
    }

    /// Two leaves that overlap.
    fn leaves<P: Processor>(&self, a: Link, b: Link, same: bool, found: &mut Found, cpu: &P) {
        let pair = self.pair;
        let items = |link: Link| link.first..link.first + link.count();
        let number = |order: &[u32], place: u32| order[place as usize];
        if pair.a.triangles.is_empty() || pair.b.triangles.is_empty() {
            // Of scene nodes no more is known than their boxes (Paper II sec. 5). One is not its own contact.
            let before = found.pairs.len();
            for i in items(a) {
                let others = items(b).filter(|&j| !(pair.own && same && i >= j));
                found.pairs.extend(others.map(|j| (number(pair.a.order, i), number(pair.b.order, j))));
            }
            if found.pairs.len() > before {
                self.found_one();
            }
            return;
        }
        items(a).for_each(|i| cpu.touch(&pair.a.triangles[i as usize]));
        let before = found.pairs.len();
        for j in items(b) {
            cpu.touch(&pair.b.triangles[j as usize]);
            let moved = pair.moved_triangle(j);
            for i in items(a) {
                if pair.own && ((same && i >= j) || pair.are_neighbours(i, j)) {
                    continue;
                }
                found.triangle_tests += 1;
                cpu.charge(self.costs.triangles());
                if pair.touch(i, &moved) {
                    found.pairs.push((number(pair.a.order, i), number(pair.b.order, j)));
                    self.found_one();
                    if self.stop.is_some() {
                        return;
                    }
                }
            }
        }
        found.false_overlaps += u64::from(found.pairs.len() == before && !same);
    }

    /// Lets the others know, where one contact is enough (P2-F18): see [`is_over`].
    fn found_one(&self) {
        if let Some(stop) = self.stop {
            stop.store(1, Ordering::Relaxed);
        }
    }

    /// The two roots, unless there is nothing in a body.
    fn roots(&self) -> Option<(u32, u32)> {
        (!self.pair.a.links.is_empty() && !self.pair.b.links.is_empty()).then_some((0, 0))
    }
}

/// Tasks are pairs of boxes that overlap; a visit tests the boxes below the larger one, eight at a time.
pub struct BatchWork<'a, W, V: Overlap>(Common<'a, W, V>);

impl<'a, W: Word, V: Overlap> BatchWork<'a, W, V> {
    /// A query; with `stop`, which holds 0, it ends when one contact is found.
    pub fn new(pair: &'a Pair<'a, V>, stop: Option<&'a W>) -> Self {
        Self(Common { pair, stop, costs: Costs::default() })
    }

    /// Sets what a visit costs on a simulated machine.
    #[must_use]
    pub fn costs(mut self, costs: Costs) -> Self {
        self.0.costs = costs;
        self
    }

    /// The boxes below one against each other, in one body.
    fn own<P: Processor>(&self, link: Link, found: &mut Found, cpu: &P, emit: &mut impl FnMut((u32, u32))) {
        let Common { pair, costs, .. } = &self.0;
        for child in link.first..link.first + link.count() {
            emit((child, child));
            cpu.touch(&pair.a.volumes[child as usize]);
            let moved = pair.at_b(child);
            for (block, used) in link.blocks() {
                // Each pair once: only boxes behind it.
                let behind = (child + 1).saturating_sub(block * 8).min(8);
                let later = (0xff_u32 << behind) as u8 & used;
                if later == 0 {
                    continue;
                }
                cpu.touch(&pair.b.blocks[block as usize]);
                found.box_tests += u64::from(later.count_ones());
                cpu.charge(costs.batch());
                let near = pair.near(&pair.b.blocks[block as usize], &moved) & later;
                lanes(block, near).for_each(|other| emit((child, other)));
            }
        }
    }
}

/// The boxes of a block whose bit is set.
#[inline]
fn lanes(block: u32, mut bits: u8) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (lane < 8).then_some(block * 8 + lane)
    })
}

impl<W: Word, V: Overlap> TreeWork for BatchWork<'_, W, V> {
    type Task = (u32, u32);
    type Found = Found;

    /// The pair of roots, if they overlap.
    fn root(&self) -> Option<(u32, u32)> {
        self.0.roots().filter(|&(a, b)| self.0.pair.own || !self.0.pair.apart(a, b))
    }

    fn found(&self) -> Found {
        Found::default()
    }

    #[inline]
    fn visit<P: Processor>(
        &self,
        task: (u32, u32),
        found: &mut Found,
        cpu: &P,
        mut emit: impl FnMut((u32, u32)),
    ) {
        let Common { pair, stop, costs } = &self.0;
        if is_over(*stop) {
            return;
        }
        let (a, b) = self.0.links(task, cpu);
        let same = pair.own && task.0 == task.1;
        let (below, moved, blocks, first) = match Common::<W, V>::down(&a, &b) {
            Down::Leaves => return self.0.leaves(a, b, same, found, cpu),
            _ if same => return self.own(a, found, cpu, &mut emit),
            Down::First => {
                cpu.touch(&pair.b.volumes[task.1 as usize]);
                (a, pair.at_a(task.1), pair.a.blocks, true)
            }
            Down::Second => {
                cpu.touch(&pair.a.volumes[task.0 as usize]);
                (b, pair.at_b(task.0), pair.b.blocks, false)
            }
        };
        for (block, used) in below.blocks() {
            cpu.touch(&blocks[block as usize]);
            cpu.charge(costs.batch());
            found.box_tests += u64::from(used.count_ones());
            let near = pair.near(&blocks[block as usize], &moved) & used;
            lanes(block, near).for_each(|lane| emit(if first { (lane, task.1) } else { (task.0, lane) }));
        }
    }
}

/// Tasks are pairs of boxes that are yet to be tested, one a visit (Paper II sec. 5).
pub struct PairWork<'a, W, V: Overlap>(Common<'a, W, V>);

impl<'a, W: Word, V: Overlap> PairWork<'a, W, V> {
    /// A query about two bodies; with `stop`, which holds 0, it ends when one contact is found.
    ///
    /// # Panics
    /// If both are one body, whose pairs are not all to be tested.
    pub fn new(pair: &'a Pair<'a, V>, stop: Option<&'a W>) -> Self {
        assert!(!pair.own, "one body is tested against itself in batches");
        Self(Common { pair, stop, costs: Costs::default() })
    }

    /// Sets what a visit costs on a simulated machine.
    #[must_use]
    pub fn costs(mut self, costs: Costs) -> Self {
        self.0.costs = costs;
        self
    }
}

impl<W: Word, V: Overlap> TreeWork for PairWork<'_, W, V> {
    type Task = (u32, u32);
    type Found = Found;

    fn root(&self) -> Option<(u32, u32)> {
        self.0.roots()
    }

    fn found(&self) -> Found {
        Found::default()
    }

    #[inline]
    fn visit<P: Processor>(
        &self,
        task: (u32, u32),
        found: &mut Found,
        cpu: &P,
        mut emit: impl FnMut((u32, u32)),
    ) {
        let Common { pair, stop, costs } = &self.0;
        if is_over(*stop) {
            return;
        }
        cpu.touch(&pair.a.volumes[task.0 as usize]);
        cpu.touch(&pair.b.volumes[task.1 as usize]);
        cpu.charge(costs.pair());
        found.box_tests += 1;
        if pair.apart(task.0, task.1) {
            return;
        }
        let (a, b) = self.0.links(task, cpu);
        let below = |link: Link| link.first..link.first + link.count();
        match Common::<W, V>::down(&a, &b) {
            Down::Leaves => self.0.leaves(a, b, false, found, cpu),
            Down::First => below(a).for_each(|child| emit((child, task.1))),
            Down::Second => below(b).for_each(|child| emit((task.0, child))),
        }
    }
}
