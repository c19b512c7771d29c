//! Decreasing tiles from a counter (Parker et al. 1999, sec. 2.1; PK-03): a static list of jobs whose sizes fall
//! linearly, handed out by one fetch-and-add. Large tiles first spare the counter; small ones last even
//! out who ends when.
//!
//! Invariant: the tiles of the list follow one another without gap from piece 0 to the last, and each draw
//! from the counter gives another number, 0, 1, 2 and so on, which is a place in the list.
//!
//! Steps of a processor: 1. draw; 2. if there is no such place, end; 3. read start and end of the tile; 4. work
//! on it.
//!
//! The paper gives neither the first size nor how many there are. Read here as a trapezoid (PK-Q01): the first
//! tile is the P-th part of half the pieces, the last one piece, their number 2 pieces / (first + last). What the
//! rounding to whole pieces leaves over becomes tiles of the last size. The list is made anew when there
//! are more or fewer pieces than in the run before.
//!
//! Settings: `first`, `last` (pieces in the first and the last tile; the former is worked out as said unless it is
//! set). `layout`.

use super::work::Frames;
use super::{MOST_PIECES, Share, TileWork};
use crate::machine::{Layout, Machine, Processor, RunError, Shared};
use crate::scheme::{SettingError, Settings};
use crate::sync::{Counter, CounterKind};

pub(super) const SUMMARY: &str = "tiles that get smaller, by fetch-and-add (Parker et al. sec. 2.1)";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct DecreasingTiles<M: Machine> {
    processors: usize,
    /// 0 where it is to be worked out.
    first: usize,
    last: usize,
    counter: Counter<M>,
    /// Where each tile starts, and the number of pieces.
    starts: Shared<usize>,
}

impl<M: Machine> DecreasingTiles<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let first = settings.number("first", 0, 1..=MOST_PIECES)?;
        let last = settings.number("last", 1, 1..=MOST_PIECES)?;
        let counter = Counter::new(machine, CounterKind::FetchAdd, settings.layout()?, processors);
        let starts = machine.alloc(1, Layout::Packed, |_| 0);
        Ok(DecreasingTiles { processors, first, last, counter, starts })
    }

    pub(super) fn run<W: TileWork>(
        &mut self,
        machine: &M,
        frames: &Frames<'_, M, W>,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        let pieces = frames.pieces();
        if self.starts[self.starts.len() - 1] != pieces {
            let first = if self.first > 0 { self.first } else { pieces / (2 * self.processors) };
            let starts = starts(pieces, first, self.last);
            self.starts = machine.alloc(starts.len(), Layout::Packed, |i| starts[i]);
        }
        self.counter.reset();
        let (counter, starts) = (&self.counter, self.starts.as_slice());
        frames.run(
            machine,
            self.processors,
            || counter.restart(),
            |cpu, _| {
                let at = counter.draw(cpu) as usize;
                let (start, end) = (starts.get(at)?, starts.get(at + 1)?);
                cpu.touch(start);
                cpu.touch(end);
                Some(*start..*end)
            },
        )
    }
}

/// Where each tile starts, and the number of pieces at the end.
fn starts(pieces: usize, first: usize, last: usize) -> Vec<usize> {
    let last = last.min(pieces).max(1);
    let first = first.min(pieces).max(last);
    let count = (2 * pieces).div_ceil(first + last);
    let step = (first - last) as f64 / count.saturating_sub(1).max(1) as f64;
    let mut starts = vec![0];
    let mut end = 0;
    while end < pieces {
        let size = (first as f64 - step * (starts.len() - 1) as f64).round().max(last as f64);
        end = pieces.min(end + size as usize);
        starts.push(end);
    }
    starts
}

#[cfg(test)]
mod tests {
    use super::starts;

    fn sizes(pieces: usize, first: usize, last: usize) -> Vec<usize> {
        starts(pieces, first, last).windows(2).map(|pair| pair[1] - pair[0]).collect()
    }

    #[test]
    fn sizes_fall_linearly() {
        assert_eq!(sizes(36, 8, 1), [8, 7, 6, 5, 4, 3, 2, 1]);
        assert_eq!(sizes(10, 4, 4), [4, 4, 2]);
        assert_eq!(sizes(3, 0, 1), [1, 1, 1]);
        assert_eq!(sizes(5, 9, 2), [5]);
        assert!(sizes(0, 7, 1).is_empty());
        for (pieces, first, last) in [(1, 1, 1), (4097, 128, 1), (1000, 125, 3), (65_536, 2048, 1)] {
            let sizes = sizes(pieces, first, last);
            assert_eq!(sizes.iter().sum::<usize>(), pieces);
            assert!(sizes.is_sorted_by(|a, b| a >= b), "{sizes:?}");
            assert!(sizes.len() <= (2 * pieces).div_ceil(first + last) + last, "{sizes:?}");
        }
    }
}
