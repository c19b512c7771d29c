//! The top of a hierarchy, cut by the heuristic with all processors on each level (Ize ch. 7.5, I7-05 b): all fill bins,
//! one joins and weighs them, all move the items. Departs from the thesis in that all nodes of a level are cut in one
//! go, which takes two phases a level and not two a node.

use super::binned_sah::SahRule;
use super::bins::{Bins, Grating, Split, fill, part};
use super::effort::Effort;
use super::grow::{AXES, Cut, DEEPEST_CUT, Extent, Rule};
use super::lanes::{Box8, Item};
use super::phased::{Piece, Team, chunk_of, cut_off, into, lock};
use super::top::Top;
use std::ops::Range;
use std::sync::Mutex;

/// Bins for each piece of work, kept from build to build.
pub(super) type Pool = Vec<Mutex<Box<Bins>>>;

/// A node of the level.
struct Node {
    in_top: usize,
    piece: Piece,
    grating: Grating,
    /// Its pieces of work.
    chunks: Range<usize>,
}

/// Cuts nodes of more than `least` items, level by level; what is left becomes pieces of the top.
pub(super) fn cut<T: Team>(
    rule: &SahRule,
    items: &mut [Vec<Item>; 2],
    root: Piece,
    least: usize,
    pool: &mut Pool,
    top: &mut Top,
    team: &mut T,
) -> Result<(), T::Error> {
    let chunk = chunk_of(root.range.len());
    let mut level = vec![(0, root)];
    while !level.is_empty() {
        // All nodes of a level have their items in the same place.
        let place = level[0].1.place;
        let (mut nodes, mut chunks) = (Vec::new(), Vec::new());
        for (in_top, piece) in level.drain(..) {
            let count = piece.range.len();
            let grating = rule.grating(&piece.extent.middles, count);
            let whole = count <= least.max(rule.most_in_leaf()) || piece.depth >= DEEPEST_CUT;
            if whole || grating.is_point() {
                top.end(in_top, piece);
                continue;
            }
            let first = chunks.len();
            let starts = piece.range.clone().step_by(chunk);
            chunks.extend(starts.map(|start| (nodes.len(), start..(start + chunk).min(piece.range.end))));
            nodes.push(Node { in_top, piece, grating, chunks: first..chunks.len() });
        }
        pool.resize_with(chunks.len().max(pool.len()), || Mutex::new(Bins::new()));
        let from = &items[place];
        team.each(chunks.len(), |i| {
            let (node, range) = &chunks[i];
            let (grating, bins) = (&nodes[*node].grating, &mut *lock(&pool[i]));
            bins.clear(grating);
            fill(rule.unit(), &from[range.clone()], grating, bins);
            let binned = range.len() as u64;
            Effort { binned, bins: AXES * grating.bins() as u64, ..Effort::default() }
        })?;
        level = divide(rule, items, place, nodes, &chunks, pool, top, team)?;
    }
    Ok(())
}

/// Weighs the bins and moves the items of a level; returns the next.
#[expect(clippy::too_many_arguments, reason = "the second half of one function")]
fn divide<T: Team>(
    rule: &SahRule,
    items: &mut [Vec<Item>; 2],
    place: usize,
    nodes: Vec<Node>,
    chunks: &[(usize, Range<usize>)],
    pool: &Pool,
    top: &mut Top,
    team: &mut T,
) -> Result<Vec<(usize, Piece)>, T::Error> {
    let [one, other] = items;
    let (from, to) = if place == 0 { (&*one, &mut other[..]) } else { (&*other, &mut one[..]) };
    let (mut rest, mut at) = (to, 0);
    let mut divided: Vec<(usize, Piece, Split)> = Vec::new();
    let mut moves = Vec::with_capacity(chunks.len());
    let mut merged = Bins::new();
    let mut effort = Effort::default();
    for Node { in_top, piece, grating, chunks: own } in nodes {
        merged.clear(&grating);
        for bins in &pool[own.clone()] {
            merged.merge(&lock(bins), &grating);
        }
        effort.bins += AXES * (grating.bins() * (own.len() + 1)) as u64;
        effort.nodes += 1;
        let Cut::Plane(split) = rule.weigh(&merged, &grating, piece.range.len(), &piece.extent.bounds) else {
            top.end(in_top, piece);
            continue;
        };
        // The nodes of a level lie in the order of their items.
        cut_off(&mut rest, piece.range.start - at);
        at = piece.range.end;
        let mut left = cut_off(&mut rest, split.left);
        let mut right = cut_off(&mut rest, piece.range.len() - split.left);
        for i in own {
            let range = chunks[i].1.clone();
            let lefts = lock(&pool[i]).left_of(&split.plane);
            let to = [cut_off(&mut left, lefts), cut_off(&mut right, range.len() - lefts)];
            moves.push(Mutex::new((divided.len(), split.plane, &from[range], to, [Box8::EMPTY; 2])));
        }
        divided.push((in_top, piece, split));
    }
    team.alone(effort)?;
    team.each(moves.len(), |i| {
        let (_, plane, from, to, middles) = &mut *lock(&moves[i]);
        let [left, right] = to;
        *middles = part(rule.unit(), from, plane, [left, right]);
        Effort { moved: from.len() as u64, ..Effort::default() }
    })?;
    let mut middles = vec![[Box8::EMPTY; 2]; divided.len()];
    for (node, .., part) in moves.into_iter().map(into) {
        middles[node] = [0, 1].map(|side| middles[node][side].union(&part[side]));
    }
    let mut level = Vec::with_capacity(2 * divided.len());
    for ((in_top, piece, split), middles) in divided.into_iter().zip(middles) {
        let middle = piece.range.start + split.left;
        let pair = top.part(in_top, piece.extent.bounds);
        for (side, range) in [piece.range.start..middle, middle..piece.range.end].into_iter().enumerate() {
            let extent = Extent { bounds: split.bounds[side], middles: middles[side] };
            let (depth, place) = (piece.depth + 1, 1 - place);
            level.push((pair[side], Piece { range, extent, depth, place }));
        }
    }
    Ok(level)
}
