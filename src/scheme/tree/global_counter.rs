//! Global counter (Paper II, section 3.2; P2-03): a locked queue a processor; every task goes to the
//! queue that a shared counter names, so tasks are dealt out like cards.
//!
//! Invariant: a task is in one queue, or in work by the queue's owner; only the owner takes from it.
//!
//! Steps of a processor: 1. lock its own queue, take a task, unlock; 2. visit it; 3. for each task
//! below: draw a number, lock that queue, insert, unlock. When dry: `sync::Quiescence`.
//!
//! Settings: `counter` (`locked` as in the paper, or `fetch_add`, its footnote 1), `lock`, `layout`,
//! `capacity` (tasks a queue; a full one leaves the task with its sender).

use super::counter_queues::CounterQueues;
use super::{Share, Task, TreeWork};
use crate::machine::{Machine, Processor, RunError};
use crate::scheme::{SettingError, Settings};

pub(super) const SUMMARY: &str = "a locked queue each, dealt to by a shared counter (Paper II sec. 3.2)";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct GlobalCounter<M: Machine> {
    queues: CounterQueues<M>,
}

impl<M: Machine> GlobalCounter<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        Ok(GlobalCounter { queues: CounterQueues::new(machine, processors, settings)? })
    }

    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        self.queues.reset();
        machine.run(self.queues.processors(), |cpu| {
            let mut share = Share { found: work.found(), visited: 0 };
            let mut side = self.queues.side(cpu);
            if cpu.id() == 0 {
                work.root().into_iter().for_each(|root| side.keep(root.pack()));
            }
            let mut below = Vec::new();
            while let Some(task) = side.take() {
                share.visited += 1;
                work.visit(W::Task::unpack(task), &mut share.found, cpu, |task| below.push(task.pack()));
                below.drain(..).for_each(|task| {
                    side.insert(task);
                });
            }
            share
        })
    }
}
