//! Global task queue (Paper II, section 3.1; P2-02): one locked queue of tasks for all processors.
//!
//! Invariant: a task is either in the queue, or in work by exactly one processor, which counts for one
//! in `in_work`. Work is over when the queue is empty and nothing is in work; both are known inside
//! the lock that guards the queue anyway.
//!
//! Steps of a processor: 1. lock; report the last task finished; take one; unlock; 2. visit it;
//! 3. lock, insert and unlock for each task below (`insert = batch`: once for all of them).
//!
//! Deviation: a full queue refuses, and the processor keeps the task for itself.
//!
//! Settings: `lock`, `layout`, `insert` (`each`, the paper's reading, or `batch`), `capacity`.

use super::{Share, Task, TreeWork};
use crate::machine::{Activity, Layout, Machine, Processor, RunError, Shared, Word};
use crate::scheme::{SettingError, Settings};
use crate::sync::LockedQueue;
use std::sync::atomic::Ordering;

pub(super) const SUMMARY: &str = "one locked queue for all (Paper II sec. 3.1)";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct GlobalQueue<M: Machine> {
    queue: LockedQueue<M>,
    over: Shared<M::Word>,
    batch: bool,
    processors: usize,
}

impl<M: Machine> GlobalQueue<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let capacity = settings.number("capacity", 1 << 14, 1..=1 << 24)?;
        let batch = settings.choice("insert", false, &[("each", false), ("batch", true)])?;
        let (lock, layout) = (settings.lock()?, settings.layout()?);
        Ok(GlobalQueue {
            queue: LockedQueue::new(machine, lock, layout, processors, capacity),
            over: machine.alloc(1, Layout::Padded, |_| Word::new(0)),
            batch,
            processors,
        })
    }

    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        // ORDERING: Relaxed: between runs.
        self.over[0].store(0, Ordering::Relaxed);
        machine.run(self.processors, |cpu| self.share(work, cpu))
    }

    fn share<W: TreeWork>(&self, work: &W, cpu: &M::Processor) -> Share<W::Found> {
        let mut share = Share { found: work.found(), visited: 0 };
        let (mut below, mut kept) = (Vec::new(), Vec::new());
        let mut finished = 0;
        if cpu.id() == 0 {
            // The root starts out as a task that processor 0 has in work.
            self.queue.lock(cpu).set_in_work(1);
            finished = 1;
            kept.extend(work.root().map(Task::pack));
        }
        loop {
            let task = match kept.pop() {
                Some(task) => task,
                None => match self.take(cpu, &mut finished) {
                    Some(task) => task,
                    None => return share,
                },
            };
            share.visited += 1;
            work.visit(W::Task::unpack(task), &mut share.found, cpu, |task| below.push(task.pack()));
            if self.batch && !below.is_empty() {
                let mut queue = self.queue.lock(cpu);
                kept.extend(below.drain(..).filter(|&task| !queue.push(task)));
            } else {
                kept.extend(below.drain(..).filter(|&task| !self.queue.lock(cpu).push(task)));
            }
        }
    }

    /// Reports `finished` tasks (0 or 1) and takes another, waiting for one; `None` when all is over.
    fn take(&self, cpu: &M::Processor, finished: &mut u64) -> Option<u64> {
        let (length, over) = (self.queue.length(), &self.over[0]);
        loop {
            {
                let mut queue = self.queue.lock(cpu);
                let in_work = queue.in_work() - std::mem::take(finished);
                let task = queue.pop();
                queue.set_in_work(in_work + u64::from(task.is_some()));
                if task.is_some() {
                    *finished = 1;
                    return task;
                }
                if in_work == 0 {
                    // ORDERING: Relaxed: results travel through the end of the run, not through this.
                    over.store(1, Ordering::Relaxed);
                }
            }
            // ORDERING: Relaxed: hints; the lock decides about tasks.
            cpu.during(Activity::Idle, || {
                cpu.wait_until(&[length, over], || {
                    over.load(Ordering::Relaxed) != 0 || length.load(Ordering::Relaxed) != 0
                });
            });
            if over.load(Ordering::Relaxed) != 0 {
                return None;
            }
        }
    }
}
