//! The top of a hierarchy, cut from a grid (Ize ch. 7.5, I7-05 a): each processor fills a grid of cells with the middles
//! of its items, one joins the grids and cuts the cells by the heuristic, and all move their items to the pieces.

use super::binned_sah::SahRule;
use super::bins::{Bins, Grating, best};
use super::effort::Effort;
use super::grow::{DEEPEST_CUT, Extent, Rule};
use super::lanes::{Box8, Item};
use super::phased::{LEAST_CHUNK, Piece, Team, cut_off, into, lock};
use super::top::Top;
use std::ops::Range;
use std::sync::Mutex;

/// Cells along each axis.
const CELLS: usize = 32;
/// A piece is cut while it has more than one in so many of all items. Not a matter of how many processors there are:
/// the hierarchy depends on it.
const PIECES: usize = 128;

/// What the cells hold: how many items, and the box around them.
#[derive(Clone)]
struct Cells(Vec<(Box8, u32)>);

fn cell(grating: &Grating, item: &Item) -> usize {
    let at = |axis| grating.bin(item, axis) as usize;
    (at(2) * CELLS + at(1)) * CELLS + at(0)
}

/// Cells from a least to before a greatest on each axis.
#[derive(Clone, Debug)]
struct Block([Range<usize>; 3]);

impl Block {
    fn cells(&self) -> impl Iterator<Item = ([usize; 3], usize)> {
        let [x, y, z] = self.0.clone();
        z.flat_map(move |z| {
            let x = x.clone();
            y.clone().flat_map(move |y| x.clone().map(move |x| ([x, y, z], (z * CELLS + y) * CELLS + x)))
        })
    }
}

/// Cuts the top; its pieces have their items in the second place.
pub(super) fn cut<T: Team>(
    rule: &SahRule,
    items: &mut [Vec<Item>; 2],
    root: Piece,
    least: usize,
    top: &mut Top,
    team: &mut T,
) -> Result<(), T::Error> {
    let grating = Grating::new(&root.extent.middles, CELLS);
    let [from, to] = items;
    // A grid is as much to join as a few thousand items are to sort into it.
    let share = LEAST_CHUNK.max(from.len().div_ceil(team.processors()));
    let shares: Vec<&[Item]> = from.chunks(share).collect();
    let grids: Vec<_> = shares.iter().map(|_| Mutex::new(Cells(Vec::new()))).collect();
    team.each(shares.len(), |i| {
        let cells = &mut lock(&grids[i]).0;
        cells.resize(CELLS * CELLS * CELLS, (Box8::EMPTY, 0));
        for item in shares[i] {
            let (bounds, count) = &mut cells[cell(&grating, item)];
            *bounds = bounds.union(&item.bounds());
            *count += 1;
        }
        Effort { gridded: shares[i].len() as u64, cells: cells.len() as u64, ..Effort::default() }
    })?;
    let mut grids = grids.into_iter().map(into);
    let mut cells = grids.next().expect("there is at least one item");
    for other in grids {
        for (all, one) in cells.0.iter_mut().zip(&other.0) {
            *all = (all.0.union(&one.0), all.1 + one.1);
        }
    }
    let (blocks, piece_of, weighed) = blocks(rule, &cells, least.max(root.range.len() / PIECES), &root, top);
    let joined = (shares.len() - 1) * cells.0.len();
    team.alone(Effort { cells: weighed + joined as u64, nodes: blocks.len() as u64, ..Effort::default() })?;

    // Where the items of each share go in each piece: shares follow one another, so items keep their order.
    let counts: Vec<_> = shares.iter().map(|_| Mutex::new(vec![0_usize; blocks.len()])).collect();
    team.each(shares.len(), |i| {
        let counts = &mut *lock(&counts[i]);
        for item in shares[i] {
            counts[piece_of[cell(&grating, item)] as usize] += 1;
        }
        Effort { located: shares[i].len() as u64, ..Effort::default() }
    })?;
    let counts: Vec<_> = counts.into_iter().map(into).collect();
    let (mut rest, mut start) = (&mut to[..], 0);
    let mut moves: Vec<Vec<&mut [Item]>> = shares.iter().map(|_| Vec::with_capacity(blocks.len())).collect();
    let mut ranges = Vec::with_capacity(blocks.len());
    for piece in 0..blocks.len() {
        let first = start;
        for (moves, counts) in moves.iter_mut().zip(&counts) {
            moves.push(cut_off(&mut rest, counts[piece]));
            start += counts[piece];
        }
        ranges.push(first..start);
    }
    let moves: Vec<_> =
        moves.into_iter().map(|to| Mutex::new((to, vec![Extent::EMPTY; blocks.len()]))).collect();
    team.each(shares.len(), |i| {
        let (to, extents) = &mut *lock(&moves[i]);
        let mut at = vec![0; to.len()];
        for item in shares[i] {
            let piece = piece_of[cell(&grating, item)] as usize;
            to[piece][at[piece]] = *item;
            at[piece] += 1;
            let bounds = item.bounds();
            let middles = Box8::of_point(bounds.middles());
            extents[piece] = extents[piece].union(&Extent { bounds, middles });
        }
        let moved = shares[i].len() as u64;
        Effort { located: moved, moved, ..Effort::default() }
    })?;
    let mut extents = vec![Extent::EMPTY; blocks.len()];
    for (_, own) in moves.into_iter().map(into) {
        extents.iter_mut().zip(own).for_each(|(all, one)| *all = all.union(&one));
    }
    for (((in_top, depth), range), extent) in blocks.into_iter().zip(ranges).zip(extents) {
        top.end(in_top, Piece { range, extent, depth, place: 1 });
    }
    Ok(())
}

/// Cuts the grid into blocks of at most so many items, or one cell; returns the node in the top and the depth of each,
/// which of them each cell is in, and how many cells were weighed.
fn blocks(
    rule: &SahRule,
    cells: &Cells,
    most: usize,
    root: &Piece,
    top: &mut Top,
) -> (Vec<(usize, u32)>, Vec<u32>, u64) {
    let (mut blocks, mut piece_of, mut weighed) = (Vec::new(), vec![0; cells.0.len()], 0);
    let (grating, mut bins) = (Grating::unit(CELLS), Bins::new());
    let whole = Block([0..CELLS, 0..CELLS, 0..CELLS]);
    let mut open = vec![(0, whole, root.range.len(), root.extent.bounds, root.depth)];
    while let Some((in_top, block, items, bounds, depth)) = open.pop() {
        let split = if items > most && depth < DEEPEST_CUT {
            bins.clear(&grating);
            for (at, cell) in block.cells() {
                weighed += 1;
                let (bounds, count) = &cells.0[cell];
                if *count > 0 {
                    at.iter().enumerate().for_each(|(axis, bin)| bins.add(axis, *bin, bounds, *count));
                }
            }
            best(rule.unit(), &bins, &grating)
        } else {
            None
        };
        let Some(split) = split else {
            block.cells().for_each(|(_, cell)| piece_of[cell] = blocks.len() as u32);
            blocks.push((in_top, depth));
            continue;
        };
        let [left, right] = top.part(in_top, bounds);
        let (axis, bin) = (split.plane.axis, split.plane.bin());
        let (mut low, mut high) = (block.clone(), block);
        low.0[axis].end = bin;
        high.0[axis].start = bin;
        open.push((right, high, items - split.left, split.bounds[1], depth + 1));
        open.push((left, low, split.left, split.bounds[0], depth + 1));
    }
    (blocks, piece_of, weighed)
}
