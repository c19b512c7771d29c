//! Hybrid (Paper II, section 3.3; P2-04): deals tasks out by the global counter until enough have been
//! handled, then everybody descends its own tasks alone.
//!
//! Invariant: as for the global counter; in the second phase a task stands for all that is below it.
//!
//! Steps: 1. phase one is the global counter scheme; 2. whoever draws number `threshold * P` says so in
//! a word that everybody reads before each task; 3. in phase two a task is descended whole, without
//! inserting anything. The paper counts nodes handled; as each node handled was inserted once, the
//! number drawn serves as that count and costs nothing more.
//!
//! Settings: `threshold` (the paper's 6), and those of `global_counter`.

use super::counter_queues::CounterQueues;
use super::{Share, Task, TreeWork};
use crate::machine::{Layout, Machine, Processor, RunError, Shared, Word};
use crate::scheme::{SettingError, Settings};
use std::sync::atomic::Ordering;

pub(super) const SUMMARY: &str =
    "global counter for the first 6 P tasks, then each alone (Paper II sec. 3.3)";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct Hybrid<M: Machine> {
    queues: CounterQueues<M>,
    /// Set when phase two has begun.
    alone: Shared<M::Word>,
    threshold: u64,
}

impl<M: Machine> Hybrid<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let threshold = settings.number("threshold", 6, 0..=1 << 20)?;
        Ok(Hybrid {
            queues: CounterQueues::new(machine, processors, settings)?,
            alone: machine.alloc(1, Layout::Padded, |_| Word::new(0)),
            threshold: (threshold * processors) as u64,
        })
    }

    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        self.queues.reset();
        // ORDERING: Relaxed: between runs.
        self.alone[0].store(u64::from(self.threshold == 0), Ordering::Relaxed);
        machine.run(self.queues.processors(), |cpu| self.share(work, cpu))
    }

    fn share<W: TreeWork>(&self, work: &W, cpu: &M::Processor) -> Share<W::Found> {
        let mut share = Share { found: work.found(), visited: 0 };
        let mut side = self.queues.side(cpu);
        if cpu.id() == 0 {
            work.root().into_iter().for_each(|root| side.keep(root.pack()));
        }
        let (mut below, mut stack) = (Vec::new(), Vec::new());
        while let Some(task) = side.take() {
            let task = W::Task::unpack(task);
            // ORDERING: Relaxed: whether a task is dealt out or descended is a matter of speed only.
            if self.alone[0].load(Ordering::Relaxed) != 0 {
                share.visited += work.descend(task, &mut share.found, cpu, &mut stack);
                continue;
            }
            share.visited += 1;
            work.visit(task, &mut share.found, cpu, |task| below.push(task.pack()));
            for task in below.drain(..) {
                if side.insert(task) + 1 == self.threshold {
                    // ORDERING: Relaxed, as above.
                    self.alone[0].store(1, Ordering::Relaxed);
                }
            }
        }
        share
    }
}
