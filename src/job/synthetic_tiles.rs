//! Pieces of a set work each, as a picture has whose pixels cost what one says: it shows what sharing out costs, and
//! what it makes of uneven costs, apart from what any job does.
//!
//! A piece natively turns a loop of dependent arithmetic for its nanoseconds, and on a simulated machine charges them in
//! cycles, as the nodes of [`synthetic`](super::synthetic) do.

use super::synthetic::{draw, mix, turn, turns_per_ns};
use crate::machine::{Layout, Machine, Processor, Shared};
use crate::scheme::tiles::TileWork;
use std::hint::black_box;
use std::ops::{Range, RangeInclusive};

/// Where the work is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cost {
    /// Everywhere.
    Spread,
    /// In the last quarter of the rows and columns of a square picture, whose pieces are numbered row by row: all of it,
    /// so that a piece there costs sixteen times as much and one elsewhere nothing (Parker et al. 1999, sec. 2.1; PK-F04).
    Corner,
}

/// Pieces with a set work each.
#[derive(Debug)]
pub struct SyntheticTiles {
    pieces: Shared<Piece>,
    /// A 1 that the compiler does not know of.
    one: u64,
}

#[derive(Debug)]
struct Piece {
    /// Turns of the loop, natively; 0 on a simulated machine.
    turns: u32,
    /// Cycles charged on a simulated machine; nobody looks at it natively.
    cycles: u32,
    /// What finding this piece contributes.
    mark: u64,
}

impl SyntheticTiles {
    /// So many pieces in the shared memory of `machine`, each of which takes a time drawn evenly from `work_ns`
    /// nanoseconds, on average over all if the work is in one place. Equal arguments give equal pieces.
    pub fn new<M: Machine>(
        machine: &M,
        pieces: usize,
        work_ns: RangeInclusive<u32>,
        cost: Cost,
        seed: u64,
    ) -> Self {
        let turns_per_ns = if machine.is_native() { turns_per_ns(machine) } else { 0.0 };
        let cycles_per_ns = machine.ticks_per_nanosecond();
        let dear = (0..pieces).filter(|&piece| is_dear(cost, piece, pieces)).count();
        let make = |piece: usize| {
            let hash = mix(seed ^ mix(piece as u64));
            let times = if is_dear(cost, piece, pieces) { pieces as f64 / dear as f64 } else { 0.0 };
            let ns = f64::from(draw(hash, &work_ns)) * times;
            Piece {
                turns: (ns * turns_per_ns).round() as u32,
                cycles: (ns * cycles_per_ns).round() as u32,
                mark: mix(hash),
            }
        };
        SyntheticTiles { pieces: machine.alloc(pieces, Layout::Packed, make), one: black_box(1) }
    }

    /// What the found values of a run's shares must add up to, wrapping, if each piece was worked on once.
    pub fn expected(&self) -> u64 {
        self.pieces.iter().fold(0, |sum, piece| sum.wrapping_add(piece.mark))
    }

    /// Work of all pieces on a simulated machine, cycles, without what reading them costs.
    pub fn cycles(&self) -> u64 {
        self.pieces.iter().map(|piece| u64::from(piece.cycles)).sum()
    }
}

/// Whether a piece has any work.
fn is_dear(cost: Cost, piece: usize, pieces: usize) -> bool {
    let side = (pieces as f64).sqrt().ceil().max(1.0) as usize;
    let is_last = |at: usize, of: usize| 4 * (at + 1) > 3 * of;
    cost == Cost::Spread || is_last(piece / side, pieces.div_ceil(side)) && is_last(piece % side, side)
}

impl TileWork for SyntheticTiles {
    type Found = u64;

    fn pieces(&self) -> usize {
        self.pieces.len()
    }

    fn found(&self) -> u64 {
        0
    }

    #[inline]
    fn work_on<P: Processor>(&self, pieces: Range<usize>, found: &mut u64, cpu: &P) {
        for piece in pieces {
            let piece = &self.pieces[piece];
            cpu.touch(piece);
            cpu.charge(u64::from(piece.cycles));
            *found = found.wrapping_add(piece.mark);
            turn(piece.turns, self.one);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::simulated::{Model, Simulated};
    use crate::scheme::tiles::share;

    fn machine() -> Simulated {
        Simulated::new(Model::named("origin2000").unwrap())
    }

    #[test]
    fn the_work_is_where_it_should_be_and_as_much() {
        let machine = machine();
        for (cost, pieces) in
            [(Cost::Spread, 1024), (Cost::Corner, 1024), (Cost::Corner, 1000), (Cost::Corner, 1)]
        {
            let tiles = SyntheticTiles::new(&machine, pieces, 900..=1100, cost, 3);
            let mean = tiles.cycles() as f64 / pieces as f64 / machine.ticks_per_nanosecond();
            assert!((890.0..1110.0).contains(&mean), "{cost:?}, {pieces} pieces: {mean} ns");
            let dear = tiles.pieces.iter().filter(|piece| piece.cycles > 0).count();
            let expected = if cost == Cost::Spread {
                pieces..=pieces
            } else {
                pieces.div_ceil(20)..=pieces.div_ceil(12)
            };
            assert!(expected.contains(&dear), "{cost:?}, {pieces} pieces: {dear} dear ones");
        }
    }

    #[test]
    fn charges_are_exact_on_a_simulated_machine() {
        for pieces in [0, 1, 777] {
            let machine = machine();
            let tiles = SyntheticTiles::new(&machine, pieces, 100..=300, Cost::Corner, 5);
            let shares = share("decreasing_tiles", &machine, 7, &tiles).unwrap();
            assert_eq!(machine.statistics().charged.iter().sum::<u64>(), tiles.cycles());
            assert_eq!(shares.iter().fold(0_u64, |sum, s| sum.wrapping_add(s.found)), tiles.expected());
        }
    }
}
