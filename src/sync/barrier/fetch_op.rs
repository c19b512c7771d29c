//! The barrier of Parker et al. 1999, sec. 2.1, read as one counter and one flag (PK-Q02): whoever comes adds one
//! to the counter, where the machine can at memory; the last one turns the flag, on which the others spin in their
//! caches. Sense-reversing barrier: Hensgen, Finkel and Manber 1988; Mellor-Crummey and Scott 1991, sec. 3.1.
//!
//! Invariant: in turn t the counter goes from t P to (t + 1) P, and the flag holds t until it is over.

use super::Turns;
use crate::machine::{Layout, Machine, Processor, Shared, Word};
use std::sync::atomic::Ordering;

pub(super) struct FetchOp<M: Machine> {
    processors: u64,
    /// How many have come since the barrier was new, then the turn it is.
    words: Shared<M::Word>,
}

impl<M: Machine> Turns<M> for FetchOp<M> {
    fn new(machine: &M, layout: Layout, processors: usize) -> Option<Self> {
        let words = machine.alloc(2, layout, |_| Word::new(0));
        Some(FetchOp { processors: processors as u64, words })
    }

    #[inline]
    fn wait_then(&self, cpu: &M::Processor, last: impl FnOnce()) {
        let (come, turn) = (&self.words[0], &self.words[1]);
        // ORDERING: AcqRel: each one's Release half pairs with the Acquire half of the last one, which so sees
        // what all wrote before.
        let before = come.fetch_add_at_memory(1, Ordering::AcqRel);
        let mine = before / self.processors;
        if before % self.processors == self.processors - 1 {
            last();
            // ORDERING: Release pairs with the Acquire load below.
            turn.store(mine + 1, Ordering::Release);
        } else {
            // ORDERING: Acquire pairs with the Release store above.
            cpu.wait_until(&[turn], || turn.load(Ordering::Acquire) > mine);
        }
    }

    fn reset(&self) {
        // ORDERING: Relaxed: between runs.
        self.words.iter().for_each(|word| word.store(0, Ordering::Relaxed));
    }
}
