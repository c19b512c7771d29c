//! Building by many processors (Ize ch. 7.5, I7-05): the same work in phases, each of independent pieces, which a
//! [`Team`] does in whatever order and on as many processors as it has. Two ways to the top of the hierarchy, and two
//! to what is below it; a hierarchy is the same whatever the team.
//!
//! 1. All copy boxes. 2. The top: either all fill the bins of each cut, one weighs them, and all move the items
//!    ([`Way::SahSah`], the same hierarchy as `binned_sah` builds alone); or all fill grids of middles, one joins them
//!    and cuts the grid, and all move the items once. 3. Each piece of the top is one piece of work, the largest first.
//!    4. All copy what they have built to where it belongs.

use super::binned_sah::SahRule;
use super::grow::{Extent, Plot, Rule, Shed, grow};
use super::lanes::{Box8, Item};
use super::spatial_median::MedianRule;
use super::top::Top;
use super::yard::{View, Yard, load, make_room};
use super::{BuildError, Effort, Input, Settings, grid, histograms};
use crate::structure::bvh::{BinaryBvh, BinaryNode};
use std::sync::{Mutex, PoisonError};

/// What does pieces of work.
pub trait Team {
    /// Why it could not.
    type Error: From<BuildError>;

    /// How many processors there are.
    fn processors(&self) -> usize;

    /// Does pieces `0 .. pieces` once each, in any order, and returns when all are done. Each tells what it did.
    ///
    /// # Errors
    /// The team's own: some pieces may not be done then.
    fn each(&mut self, pieces: usize, work: impl Fn(usize) -> Effort + Sync) -> Result<(), Self::Error>;

    /// Takes note of what was done between two phases, by the caller alone.
    ///
    /// # Errors
    /// The team's own.
    fn alone(&mut self, _effort: Effort) -> Result<(), Self::Error> {
        Ok(())
    }
}

/// A team of one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Team for Alone {
    type Error = BuildError;

    fn processors(&self) -> usize {
        1
    }

    fn each(&mut self, pieces: usize, work: impl Fn(usize) -> Effort + Sync) -> Result<(), BuildError> {
        (0..pieces).for_each(|piece| {
            work(piece);
        });
        Ok(())
    }
}

/// How the top is cut, and how what is below (Ize Table 7.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// The heuristic over bins for both.
    SahSah,
    /// The heuristic over a grid of middles, then over bins.
    GridSah,
    /// The heuristic over a grid of middles, then cuts in the middle of space.
    GridBih,
}

impl Way {
    /// All of them, with their names.
    pub const ALL: [(&'static str, Self); 3] =
        [("sah_sah", Self::SahSah), ("grid_sah", Self::GridSah), ("grid_bih", Self::GridBih)];
}

/// A builder in phases; it keeps its buffers.
pub struct Phased {
    way: Way,
    sah: SahRule,
    median: MedianRule,
    yard: Yard,
    /// What was grown below each piece of the top, kept for its memory.
    grown: Vec<Vec<BinaryNode>>,
    bins: histograms::Pool,
}

/// A piece of the hierarchy that one processor grows.
pub(super) struct Piece {
    pub(super) range: std::ops::Range<usize>,
    pub(super) extent: Extent,
    pub(super) depth: u32,
    /// Which of the two places its items are in.
    pub(super) place: usize,
}

/// The least items of a piece of the top: fewer cost more to hand out than to do.
const LEAST_PIECE: usize = 1024;
/// And of a piece of work on a level of it.
pub(super) const LEAST_CHUNK: usize = 4096;
/// Pieces for each processor: some are longer than others.
const PIECES: usize = 16;

impl Phased {
    /// A builder with these settings.
    ///
    /// # Errors
    /// [`BuildError::Setting`].
    pub fn new(way: Way, settings: &Settings) -> Result<Self, BuildError> {
        settings.check()?;
        Ok(Self {
            way,
            sah: SahRule::new(settings),
            median: MedianRule::new(settings),
            yard: Yard::default(),
            grown: Vec::new(),
            bins: Default::default(),
        })
    }

    /// Builds over some items, in place of what `bvh` held, whose memory is used again.
    ///
    /// # Errors
    /// [`BuildError`] and the team's own; what `bvh` holds then is of no use.
    pub fn build<T: Team>(
        &mut self,
        input: &Input<'_>,
        bvh: &mut BinaryBvh,
        team: &mut T,
    ) -> Result<(), T::Error> {
        input.check()?;
        let boxes = input.boxes;
        make_room(&mut bvh.order, boxes.len(), 0);
        if boxes.is_empty() {
            bvh.nodes.clear();
            return Ok(());
        }
        for place in &mut self.yard.items {
            make_room(place, boxes.len(), Item::new(&Box8::EMPTY, 0, 0));
        }
        let mut extent = self.load(input, View::PLAIN, team)?;
        let view = View::of(&extent.bounds.aabb(), boxes);
        if view != View::PLAIN {
            extent = self.load(input, view, team)?;
        }
        let root = Piece { range: 0..boxes.len(), extent, depth: 0, place: 0 };
        let mut top = Top::new();
        let items = &mut self.yard.items;
        match self.way {
            Way::SahSah => {
                let least = LEAST_PIECE.max(boxes.len() / (PIECES * team.processors()));
                histograms::cut(&self.sah, items, root, least, &mut self.bins, &mut top, team)?;
            }
            Way::GridSah | Way::GridBih => {
                grid::cut(&self.sah, items, root, LEAST_PIECE, &mut top, team)?;
            }
        }
        match self.way {
            Way::SahSah | Way::GridSah => below(&self.sah, items, &top, &mut self.grown, bvh, team)?,
            Way::GridBih => below(&self.median, items, &top, &mut self.grown, bvh, team)?,
        }
        top.assemble(&self.grown, bvh, team)?;
        view.restore(bvh, boxes);
        Ok(())
    }

    /// Builds serially, in one piece, what a way is held against: all of it by the rule that the way has for what is below
    /// the top. Returns what that took.
    ///
    /// # Errors
    /// [`BuildError`]; what `bvh` holds then is of no use.
    pub fn build_alone(&mut self, input: &Input<'_>, bvh: &mut BinaryBvh) -> Result<Effort, BuildError> {
        input.check()?;
        match self.way {
            Way::SahSah | Way::GridSah => self.yard.build(&self.sah, input.boxes, bvh),
            Way::GridBih => self.yard.build(&self.median, input.boxes, bvh),
        }
    }

    fn load<T: Team>(&mut self, input: &Input<'_>, view: View, team: &mut T) -> Result<Extent, T::Error> {
        let chunk = chunk_of(input.boxes.len());
        let chunks = input.boxes.chunks(chunk).zip(self.yard.items[0].chunks_mut(chunk));
        let chunks: Vec<_> =
            chunks.map(|(boxes, items)| Mutex::new((boxes, items, Ok(Extent::EMPTY)))).collect();
        team.each(chunks.len(), |i| {
            let (boxes, items, told) = &mut *lock(&chunks[i]);
            *told = load(boxes, i * chunk, view, items);
            Effort { loaded: boxes.len() as u64, ..Effort::default() }
        })?;
        let mut all = Extent::EMPTY;
        for chunk in chunks {
            // The first bad item is told, whoever came upon another before.
            all = all.union(&into(chunk).2?);
        }
        Ok(all)
    }
}

/// Grows the pieces of a top, the largest first.
fn below<T: Team>(
    rule: &impl Rule,
    items: &mut [Vec<Item>; 2],
    top: &Top,
    grown: &mut Vec<Vec<BinaryNode>>,
    bvh: &mut BinaryBvh,
    team: &mut T,
) -> Result<(), T::Error> {
    let count = top.pieces.len();
    grown.resize_with(count.max(grown.len()), Vec::new);
    let mut by_place: Vec<usize> = (0..count).collect();
    by_place.sort_by_key(|piece| top.pieces[*piece].range.start);
    let [one, other] = items;
    let (mut one, mut other, mut order) = (&mut one[..], &mut other[..], &mut bvh.order[..]);
    let mut kept: Vec<Option<&mut Vec<BinaryNode>>> = grown.iter_mut().map(Some).collect();
    let mut work = Vec::with_capacity(count);
    for number in by_place {
        let piece = &top.pieces[number];
        let length = piece.range.len();
        let mut items = [cut_off(&mut one, length), cut_off(&mut other, length)];
        if piece.place == 1 {
            items.reverse();
        }
        let plot = Plot { items, order: cut_off(&mut order, length), first: piece.range.start };
        let nodes = kept[number].take().expect("each piece is in the list once");
        work.push((number, Mutex::new(Some((plot, nodes)))));
    }
    work.sort_by_key(|(number, _)| std::cmp::Reverse(top.pieces[*number].range.len()));
    team.each(count, |i| {
        let (number, work) = &work[i];
        let (plot, nodes) = lock(work).take().expect("each piece is done once");
        let Piece { extent, depth, .. } = top.pieces[*number];
        grow(rule, plot, extent, depth, nodes, &mut Shed::new())
    })
}

/// How many items a piece of work on all of them has.
pub(super) fn chunk_of(items: usize) -> usize {
    LEAST_CHUNK.max(items / 256)
}

/// Cuts off the first of a slice.
pub(super) fn cut_off<'a, T>(slice: &mut &'a mut [T], length: usize) -> &'a mut [T] {
    let (first, rest) = std::mem::take(slice).split_at_mut(length);
    *slice = rest;
    first
}

/// Each piece has a lock of its own, which nobody waits for.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a lock held.
pub(super) fn into<T>(mutex: Mutex<T>) -> T {
    mutex.into_inner().unwrap_or_else(PoisonError::into_inner)
}
