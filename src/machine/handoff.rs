//! How a worker of the thread team learns of new work: spin for a while, then park.
//!
//! Invariant: a post is never lost. The poster writes the epoch, then looks whether the worker is
//! parked; the worker says that it is parked, then looks at the epoch once more. With a sequentially
//! consistent fence between the two steps on both sides, at least one sees the other (Dekker).
//!
//! Generic over the word, so that the model checker runs this very code (`tests/loom/handoff.rs`).

use crate::machine::Word;
use std::sync::atomic::Ordering;

/// One worker's mailbox.
#[derive(Debug)]
pub struct Handoff<W> {
    epoch: W,
    parked: W,
}

impl<W: Word> Default for Handoff<W> {
    fn default() -> Self {
        Handoff { epoch: W::new(0), parked: W::new(0) }
    }
}

impl<W: Word> Handoff<W> {
    /// Posts work number `epoch` (greater than any before) and wakes the worker if it sleeps.
    #[inline]
    pub fn post(&self, epoch: u64, unpark: impl FnOnce()) {
        // ORDERING: Release pairs with the Acquire load in `wait`: the job was written before.
        self.epoch.store(epoch, Ordering::Release);
        // ORDERING: pairs with the fence in `wait`; see the invariant above.
        W::fence(Ordering::SeqCst);
        // ORDERING: Relaxed, ordered by the two fences.
        if self.parked.load(Ordering::Relaxed) != 0 {
            unpark();
        }
    }

    /// Waits for work newer than `seen` and returns its number. `keep_spinning` is asked on each
    /// turn; once it says no, `park` is called until work has come (it may return for no reason).
    pub fn wait(&self, seen: u64, mut keep_spinning: impl FnMut() -> bool, mut park: impl FnMut()) -> u64 {
        loop {
            // ORDERING: Acquire pairs with the Release store in `post`.
            let epoch = self.epoch.load(Ordering::Acquire);
            if epoch != seen {
                return epoch;
            }
            if !keep_spinning() {
                break;
            }
        }
        // ORDERING: Relaxed, ordered by the fence below.
        self.parked.store(1, Ordering::Relaxed);
        // ORDERING: pairs with the fence in `post`; see the invariant above.
        W::fence(Ordering::SeqCst);
        let epoch = loop {
            // ORDERING: Acquire pairs with the Release store in `post`.
            let epoch = self.epoch.load(Ordering::Acquire);
            if epoch != seen {
                break epoch;
            }
            park();
        };
        // ORDERING: Relaxed: a stale 1 costs the poster one needless wake-up, nothing else.
        self.parked.store(0, Ordering::Relaxed);
        epoch
    }

    /// Whether the worker sleeps, as far as can be seen from here: then posting costs a system call.
    pub fn is_parked(&self) -> bool {
        // ORDERING: Relaxed: an estimate.
        self.parked.load(Ordering::Relaxed) != 0
    }
}
