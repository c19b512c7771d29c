//! The deques of the crate `crossbeam-deque`, on real threads only: a rival to measure against.
//!
//! Idle workers spin, stealing from the others in turn; an idle count ends the run, as in
//! `work_stealing`.

use super::{Share, Task, TreeWork};
use crate::machine::{Activity, Layout, Machine, Processor, RunError, Seats, Shared, Word};
use crate::scheme::{SettingError, Settings};
use crossbeam::deque::{Steal, Stealer, Worker};
use std::sync::atomic::Ordering;

pub(super) const SUMMARY: &str = "crate crossbeam-deque, idle workers spin (rival; threads only)";
pub(super) const NATIVE_ONLY: bool = true;
pub(super) const LEARNS: bool = false;

pub(super) struct CrossbeamDeque<M: Machine> {
    workers: Seats<Worker<u64>>,
    stealers: Vec<Stealer<u64>>,
    idle: Shared<M::Word>,
}

impl<M: Machine> CrossbeamDeque<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        settings.native_only(machine)?;
        let mut stealers = Vec::new();
        let workers = Seats::new(machine, processors, |_| {
            let worker = Worker::new_lifo();
            stealers.push(worker.stealer());
            worker
        });
        Ok(CrossbeamDeque { workers, stealers, idle: machine.alloc(1, Layout::Padded, |_| Word::new(0)) })
    }

    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        // ORDERING: Relaxed: between runs.
        self.idle[0].store(0, Ordering::Relaxed);
        machine.run(self.stealers.len(), |cpu| self.share(work, cpu))
    }

    fn share<W: TreeWork>(&self, work: &W, cpu: &M::Processor) -> Share<W::Found> {
        let worker = self.workers.claim(cpu);
        let mut share = Share { found: work.found(), visited: 0 };
        let (me, count, idle) = (cpu.id(), cpu.count(), &self.idle[0]);
        if me == 0 {
            work.root().into_iter().for_each(|root| worker.push(root.pack()));
        }
        loop {
            while let Some(task) = worker.pop() {
                share.visited += 1;
                work.visit(W::Task::unpack(task), &mut share.found, cpu, |below| worker.push(below.pack()));
            }
            let victims = || (1..count).map(|i| &self.stealers[(me + i) % count]);
            // ORDERING: AcqRel, as in `work_stealing`.
            idle.fetch_add(1, Ordering::AcqRel);
            loop {
                cpu.during(Activity::Idle, || {
                    cpu.wait_until(&[], || {
                        // ORDERING: Acquire pairs with the counts.
                        idle.load(Ordering::Acquire) == count as u64 || victims().any(|v| !v.is_empty())
                    });
                });
                // ORDERING: Acquire, as above.
                if idle.load(Ordering::Acquire) == count as u64 {
                    return share;
                }
                idle.fetch_sub(1, Ordering::AcqRel);
                if let Some(task) = victims().find_map(|v| steal(v, &worker)) {
                    worker.push(task);
                    break;
                }
                idle.fetch_add(1, Ordering::AcqRel);
            }
        }
    }
}

fn steal(victim: &Stealer<u64>, worker: &Worker<u64>) -> Option<u64> {
    loop {
        match victim.steal_batch_and_pop(worker) {
            Steal::Success(task) => return Some(task),
            Steal::Empty => return None,
            Steal::Retry => {}
        }
    }
}
