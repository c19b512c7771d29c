//! A task queue behind one lock, as Paper II's section 3 uses it: "changing an array index and
//! reading the contents of the array element", that is, a last-in first-out array.
//!
//! Invariant: items, length and the count of tasks in work change only while the lock is held. The
//! length may be *read* at any time, as a hint.
//!
//! The words (lock, length, in work) are one allocation: with [`Layout::Packed`] the lock lies beside
//! what it guards, as in 1999.

use super::LockKind;
use super::lock::{Held, Words, hold};
use crate::machine::{Layout, Machine, Shared, Slot, Word};
use std::sync::atomic::Ordering;

/// A locked stack of packed tasks.
pub struct LockedQueue<M: Machine> {
    kind: LockKind,
    /// `kind.words()` words of the lock, then the length, then the number of tasks in work.
    words: Shared<M::Word>,
    items: Shared<M::Slot<u64>>,
}

impl<M: Machine> LockedQueue<M> {
    /// An empty queue with room for `capacity` tasks.
    pub fn new(machine: &M, kind: LockKind, layout: Layout, processors: usize, capacity: usize) -> Self {
        LockedQueue {
            kind,
            words: machine.alloc(kind.words(processors) + 2, layout, |_| Word::new(0)),
            items: machine.alloc(capacity, Layout::Packed, |_| Slot::new(0)),
        }
    }

    /// The word that holds the length: what an idle processor watches.
    pub fn length(&self) -> &M::Word {
        &self.words[self.words.len() - 2]
    }

    /// Takes the lock.
    pub fn lock<'a>(&'a self, cpu: &'a M::Processor) -> QueueGuard<'a, M> {
        let held = hold(self.kind, Words::new(&self.words, 0), cpu);
        QueueGuard { queue: self, _held: held }
    }
}

/// The queue, locked until this is dropped.
pub struct QueueGuard<'a, M: Machine> {
    queue: &'a LockedQueue<M>,
    _held: Held<'a, M::Processor>,
}

impl<M: Machine> QueueGuard<'_, M> {
    fn in_work_word(&self) -> &M::Word {
        &self.queue.words[self.queue.words.len() - 1]
    }

    /// How many tasks are queued.
    pub fn len(&self) -> usize {
        // ORDERING: Relaxed: the lock orders it.
        self.queue.length().load(Ordering::Relaxed) as usize
    }

    /// Whether no task is queued.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Queues a task; says whether there was room.
    pub fn push(&mut self, task: u64) -> bool {
        let len = self.len();
        if len == self.queue.items.len() {
            return false;
        }
        // SAFETY: the lock is held, so nobody else touches the items.
        unsafe { self.queue.items[len].write(task) };
        // ORDERING: Relaxed: the lock orders it; readers outside take it as a hint.
        self.queue.length().store(len as u64 + 1, Ordering::Relaxed);
        true
    }

    /// Takes the newest task.
    pub fn pop(&mut self) -> Option<u64> {
        let len = self.len().checked_sub(1)?;
        // ORDERING: Relaxed: as in `push`.
        self.queue.length().store(len as u64, Ordering::Relaxed);
        // SAFETY: the lock is held, so nobody else touches the items.
        Some(unsafe { self.queue.items[len].read() })
    }

    /// How many tasks are in work: taken, and not yet reported finished.
    pub fn in_work(&self) -> u64 {
        // ORDERING: Relaxed: the lock orders it.
        self.in_work_word().load(Ordering::Relaxed)
    }

    /// Sets the number of tasks in work.
    pub fn set_in_work(&mut self, tasks: u64) {
        // ORDERING: Relaxed: the lock orders it.
        self.in_work_word().store(tasks, Ordering::Relaxed);
    }
}
