//! Mutual exclusion by busy waiting, in the four classic kinds. Which one is used is a setting that
//! an experiment can sweep (Mellor-Crummey and Scott, ACM TOCS 9(1), 1991).
//!
//! Invariant: between `acquire` and `release` by the same processor nobody else holds the lock, and
//! what the last holder wrote is visible to the next (Acquire pairs with Release in every kind).
//!
//! A lock's words lie where its owner puts them, so that "a lock beside its data" (1999) and "a lock
//! on a line of its own" are a matter of layout, not of code.

mod mcs;
mod test_and_set;
mod test_and_test_and_set;
mod ticket;

use crate::machine::{Layout, Machine, Processor, Shared, Word};
use std::sync::atomic::Ordering;

/// Declares the kinds: the list is the table of contents.
macro_rules! lock_kinds {
    ($($(#[$doc:meta])* $kind:ident => $file:ident),* $(,)?) => {
        /// How a lock waits.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
        pub enum LockKind { $($(#[$doc])* $kind),* }

        impl LockKind {
            /// Every kind with its name in settings.
            pub const ALL: &[(&str, LockKind)] = &[$((stringify!($file), LockKind::$kind)),*];

            /// Shared words a lock of this kind needs among `processors` processors.
            pub fn words(self, processors: usize) -> usize {
                match self { $(LockKind::$kind => $file::words(processors)),* }
            }

            fn acquire<P: Processor>(self, words: Words<'_, P::Word>, cpu: &P) {
                match self { $(LockKind::$kind => $file::acquire(words, cpu)),* }
            }

            fn release<P: Processor>(self, words: Words<'_, P::Word>, cpu: &P) {
                match self { $(LockKind::$kind => $file::release(words, cpu)),* }
            }
        }
    };
}

lock_kinds! {
    /// Tries to set the word until it succeeds: what Paper II builds from `ldstub`, read plainly.
    TestAndSet => test_and_set,
    /// Looks until the word is free, then tries: spins on a cached copy. The default.
    #[default]
    TestAndTestAndSet => test_and_test_and_set,
    /// First come, first served: draw a number, wait until it is called.
    Ticket => ticket,
    /// A queue of waiters, each spinning on a word of its own.
    Mcs => mcs,
}

/// A lock's words within the allocation of its owner.
pub(super) struct Words<'a, W> {
    all: &'a Shared<W>,
    first: usize,
}

impl<W> Clone for Words<'_, W> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<W> Copy for Words<'_, W> {}

impl<'a, W> Words<'a, W> {
    pub(super) fn new(all: &'a Shared<W>, first: usize) -> Self {
        Words { all, first }
    }

    fn at(&self, i: usize) -> &'a W {
        &self.all[self.first + i]
    }
}

/// A lock with words of its own.
pub struct Lock<M: Machine> {
    kind: LockKind,
    words: Shared<M::Word>,
}

impl<M: Machine> Lock<M> {
    /// A free lock for `processors` processors.
    pub fn new(machine: &M, kind: LockKind, layout: Layout, processors: usize) -> Self {
        Lock { kind, words: machine.alloc(kind.words(processors), layout, |_| Word::new(0)) }
    }

    /// Makes the lock as new; nobody may hold it or wait for it. After a failed run it must be called: whoever was
    /// ended while waiting stands in the queue for ever.
    pub fn reset(&self) {
        // ORDERING: Relaxed: between runs.
        self.words.iter().for_each(|word| word.store(0, Ordering::Relaxed));
    }

    /// Runs `body` while holding the lock.
    pub fn with<R>(&self, cpu: &M::Processor, body: impl FnOnce() -> R) -> R {
        let _held = hold(self.kind, Words::new(&self.words, 0), cpu);
        body()
    }
}

/// Takes a lock until the result is dropped.
pub(super) fn hold<'a, P: Processor>(kind: LockKind, words: Words<'a, P::Word>, cpu: &'a P) -> Held<'a, P> {
    kind.acquire(words, cpu);
    Held { kind, words, cpu }
}

/// A lock that is held; dropping releases it, also when a panic unwinds.
pub(super) struct Held<'a, P: Processor> {
    kind: LockKind,
    words: Words<'a, P::Word>,
    cpu: &'a P,
}

impl<P: Processor> Drop for Held<'_, P> {
    fn drop(&mut self) {
        self.kind.release(self.words, self.cpu);
    }
}
