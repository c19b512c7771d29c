//! What a tile scheme shares out.

use super::Share;
use crate::machine::{Activity, Machine, Processor, RunError};
use std::ops::Range;

/// Independent pieces.
pub trait TileWork: Sync {
    /// What one processor gathers.
    type Found: Send;

    /// How many pieces there are; their numbers are `0 .. pieces()`.
    fn pieces(&self) -> usize;

    /// An empty gathering, made once a run on each processor.
    fn found(&self) -> Self::Found;

    /// Works on some pieces that follow one another, at least one; gathers into `found`. No other call of the run
    /// gets any of them. `cpu` is where the work is charged and shared data is touched on a simulated
    /// machine.
    fn work_on<P: Processor>(&self, pieces: Range<usize>, found: &mut Self::Found, cpu: &P);
}

/// Work whose every tile is billed its bookkeeping, and marked on a timeline. Between its tiles a processor is
/// taken to be sending: it draws the next.
pub(super) struct Billed<'a, W>(pub(super) &'a W);

impl<W: TileWork> TileWork for Billed<'_, W> {
    type Found = W::Found;

    fn pieces(&self) -> usize {
        self.0.pieces()
    }

    fn found(&self) -> W::Found {
        self.0.found()
    }

    #[inline]
    fn work_on<P: Processor>(&self, pieces: Range<usize>, found: &mut W::Found, cpu: &P) {
        cpu.keep_books();
        let looked_into = cpu.take_up(pieces.len());
        self.0.work_on(pieces, found, cpu);
        if looked_into {
            cpu.enter(Activity::Sending);
        }
    }
}

/// Runs work on every processor: `tile` gives it its next one, told how many it has had, until it gives none. A tile
/// lies within the pieces; one without a piece is passed over.
pub(super) fn run<M: Machine, W: TileWork>(
    machine: &M,
    processors: usize,
    work: &W,
    tile: impl Fn(&M::Processor, usize) -> Option<Range<usize>> + Sync,
) -> Result<Vec<Share<W::Found>>, RunError> {
    machine.run(processors, |cpu| {
        let (mut share, mut turn) = (Share { found: work.found(), visited: 0 }, 0);
        while let Some(tile) = tile(cpu, turn) {
            turn += 1;
            if !tile.is_empty() {
                share.visited += tile.len() as u64;
                work.work_on(tile, &mut share.found, cpu);
            }
        }
        share
    })
}

/// Work made of closures: so many pieces, an empty gathering, and what to do with a range of pieces.
pub fn work<F: Send>(
    pieces: usize,
    found: impl Fn() -> F + Sync,
    work_on: impl Fn(Range<usize>, &mut F) + Sync,
) -> impl TileWork<Found = F> {
    Closures { pieces, found, work_on }
}

struct Closures<A, V> {
    pieces: usize,
    found: A,
    work_on: V,
}

impl<F, A, V> TileWork for Closures<A, V>
where
    F: Send,
    A: Fn() -> F + Sync,
    V: Fn(Range<usize>, &mut F) + Sync,
{
    type Found = F;

    fn pieces(&self) -> usize {
        self.pieces
    }

    fn found(&self) -> F {
        (self.found)()
    }

    fn work_on<P: Processor>(&self, pieces: Range<usize>, found: &mut F, _cpu: &P) {
        (self.work_on)(pieces, found);
    }
}
