//! What the global counter scheme and the hybrid scheme have in common: a locked queue a processor,
//! and a counter that says which one gets the next task (Paper II, section 3.2).

use crate::machine::{Machine, Processor, Word};
use crate::scheme::{SettingError, Settings};
use crate::sync::{Counter, LockedQueue, Quiescence};
use std::sync::atomic::Ordering;

pub(super) struct CounterQueues<M: Machine> {
    queues: Vec<LockedQueue<M>>,
    counter: Counter<M>,
    quiescence: Quiescence<M>,
}

/// A processor's side of it: how many tasks it put into queues and took from its own.
pub(super) struct Side<'a, M: Machine> {
    queues: &'a CounterQueues<M>,
    cpu: &'a M::Processor,
    /// Tasks for which a queue had no room; this processor keeps them.
    kept: Vec<u64>,
    sent: u64,
    received: u64,
}

impl<M: Machine> CounterQueues<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let capacity = settings.number("capacity", 1 << 10, 1..=1 << 24)?;
        let (lock, layout, counter) = (settings.lock()?, settings.layout()?, settings.counter()?);
        let queue = |_| LockedQueue::new(machine, lock, layout, processors, capacity);
        Ok(CounterQueues {
            queues: (0..processors).map(queue).collect(),
            counter: Counter::new(machine, counter, layout, processors),
            quiescence: Quiescence::new(machine, processors),
        })
    }

    pub(super) fn processors(&self) -> usize {
        self.queues.len()
    }

    /// Readies everything for a run.
    pub(super) fn reset(&self) {
        self.counter.reset();
        self.quiescence.reset();
    }

    pub(super) fn side<'a>(&'a self, cpu: &'a M::Processor) -> Side<'a, M> {
        Side { queues: self, cpu, kept: Vec::new(), sent: 0, received: 0 }
    }
}

impl<M: Machine> Side<'_, M> {
    /// Keeps a task here, past all queues.
    pub(super) fn keep(&mut self, task: u64) {
        self.kept.push(task);
    }

    /// Inserts a task into the queue whose turn it is; returns the number drawn.
    pub(super) fn insert(&mut self, task: u64) -> u64 {
        let drawn = self.queues.counter.draw(self.cpu);
        let queue = &self.queues.queues[(drawn % self.queues.queues.len() as u64) as usize];
        if queue.lock(self.cpu).push(task) {
            self.sent += 1;
        } else {
            self.kept.push(task);
        }
        drawn
    }

    /// Takes a task from this processor's own queue, waiting for one; `None` when all is over.
    pub(super) fn take(&mut self) -> Option<u64> {
        let own = &self.queues.queues[self.cpu.id()];
        // ORDERING: Relaxed: a hint; the lock decides. Only this processor takes from the queue, so
        // what is there stays there.
        let has_work = || own.length().load(Ordering::Relaxed) != 0;
        loop {
            if let Some(task) = self.kept.pop() {
                return Some(task);
            }
            if has_work()
                && let Some(task) = own.lock(self.cpu).pop()
            {
                self.received += 1;
                return Some(task);
            }
            let over =
                self.queues.quiescence.wait(self.cpu, self.sent, self.received, &[own.length()], has_work);
            if over {
                return None;
            }
        }
    }
}
