//! A counter that every processor draws from: the heart of Paper II's global counter scheme.
//!
//! Invariant: each draw gives another number, and the numbers drawn are 0, 1, 2, ... without gaps.

use super::LockKind;
use super::lock::{Words, hold};
use crate::machine::{Layout, Machine, Shared, Word};
use std::sync::atomic::Ordering;

/// How a draw is made indivisible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CounterKind {
    /// Under a lock, as in the paper (section 3.2).
    Locked(LockKind),
    /// By one fetch-and-add, as its footnote 1 suggests: at memory where the machine can, as Parker et al. 1999
    /// (sec. 2.1) have it.
    FetchAdd,
}

/// A shared counter.
pub struct Counter<M: Machine> {
    kind: CounterKind,
    /// The lock's words if there is a lock, then the count.
    words: Shared<M::Word>,
}

impl<M: Machine> Counter<M> {
    /// A counter at zero.
    pub fn new(machine: &M, kind: CounterKind, layout: Layout, processors: usize) -> Self {
        let lock = match kind {
            CounterKind::Locked(kind) => kind.words(processors),
            CounterKind::FetchAdd => 0,
        };
        Counter { kind, words: machine.alloc(lock + 1, layout, |_| Word::new(0)) }
    }

    fn count(&self) -> &M::Word {
        &self.words[self.words.len() - 1]
    }

    /// Draws the next number.
    pub fn draw(&self, cpu: &M::Processor) -> u64 {
        match self.kind {
            CounterKind::Locked(kind) => {
                let _held = hold(kind, Words::new(&self.words, 0), cpu);
                // ORDERING: Relaxed: the lock orders both.
                let drawn = self.count().load(Ordering::Relaxed);
                self.count().store(drawn.wrapping_add(1), Ordering::Relaxed);
                drawn
            }
            // ORDERING: Relaxed: the number itself is all that is taken; tasks travel through queues.
            CounterKind::FetchAdd => self.count().fetch_add_at_memory(1, Ordering::Relaxed),
        }
    }

    /// Makes the counter as new between two runs, its lock too: whoever was ended while waiting for that stands
    /// in its queue for ever.
    pub fn reset(&self) {
        // ORDERING: Relaxed: between runs.
        self.words.iter().for_each(|word| word.store(0, Ordering::Relaxed));
    }

    /// Sets the count back to zero within a run, while something else keeps everybody from drawing.
    pub fn restart(&self) {
        // ORDERING: Relaxed: what keeps them from drawing orders it.
        self.count().store(0, Ordering::Relaxed);
    }
}
