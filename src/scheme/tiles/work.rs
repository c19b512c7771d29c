//! What a tile scheme shares out.

use super::Share;
use crate::machine::{Activity, Machine, Processor, RunError};
use crate::sync::Barrier;
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

impl<W: TileWork> TileWork for &W {
    type Found = W::Found;

    fn pieces(&self) -> usize {
        (**self).pieces()
    }

    fn found(&self) -> W::Found {
        (**self).found()
    }

    #[inline]
    fn work_on<P: Processor>(&self, pieces: Range<usize>, found: &mut W::Found, cpu: &P) {
        (**self).work_on(pieces, found, cpu);
    }
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

/// The frames of a run: work of as many pieces each, one at least, and what keeps them apart where there are more.
pub(super) struct Frames<'a, M: Machine, W> {
    pub(super) works: &'a [W],
    pub(super) barrier: Option<&'a Barrier<M>>,
}

impl<M: Machine, W: TileWork> Frames<'_, M, W> {
    /// Pieces of each frame.
    pub(super) fn pieces(&self) -> usize {
        self.works[0].pieces()
    }

    /// The work of each frame in turn, its tiles billed.
    pub(super) fn works(&self) -> impl Iterator<Item = Billed<'_, W>> {
        self.works.iter().map(Billed)
    }

    /// A share of a processor that has done nothing yet.
    pub(super) fn share(&self) -> Share<W::Found> {
        Share { found: self.works[0].found(), visited: 0 }
    }

    /// Goes through the frames on every processor. `tile` gives a processor its next tile of a frame, told how many
    /// it has had of it, until it gives none; a tile lies within the pieces, and one without a piece is passed over.
    /// Between two frames, while no processor is taking tiles, one of them calls `again`.
    pub(super) fn run(
        &self,
        machine: &M,
        processors: usize,
        again: impl Fn() + Sync,
        tile: impl Fn(&M::Processor, usize) -> Option<Range<usize>> + Sync,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        machine.run(processors, |cpu| {
            let mut share = self.share();
            for (frame, work) in self.works().enumerate() {
                if frame > 0
                    && let Some(barrier) = self.barrier
                {
                    barrier.wait_then(cpu, &again);
                }
                let mut turn = 0;
                while let Some(tile) = tile(cpu, turn) {
                    turn += 1;
                    if !tile.is_empty() {
                        share.visited += tile.len() as u64;
                        work.work_on(tile, &mut share.found, cpu);
                    }
                }
            }
            share
        })
    }
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
