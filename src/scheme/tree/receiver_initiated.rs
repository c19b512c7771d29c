//! Receiver-initiated distribution (P2-13): whoever is dry asks another processor for tasks, and gets
//! half of its local queue. Paper II tried work on demand for its locked schemes only and found it
//! inferior; this is the same idea without locks.
//!
//! Invariant: a task is in one local queue, in one mailbox, or in work. A mailbox belongs to the asker;
//! it is written by the processor whose request word holds the asker's number, and by nobody else.
//!
//! Protocol: 1. a dry processor writes its number + 1 into another's request word (compare-exchange from
//! 0); 2. that one looks at its word after each visit, fills the asker's mailbox, publishes the number
//! of tasks (or [`REFUSED`]) in the asker's answer word, then frees its request word; 3. the asker,
//! waiting on its answer word, takes the tasks, or asks the next. While it waits it refuses requests
//! that reach it. When everybody is dry nobody has anything to give: `sync::Quiescence` ends the run; 4. an
//! asker gives up when the run is over: going by an old hint, it may have asked one who has left.
//!
//! Settings: `mailbox` (tasks handed over at most), `grain` as in `lock_free`.

use super::neighbours::neighbours;
use super::{Share, Task, TreeWork};
use crate::machine::{Layout, Machine, Processor, RunError, Seats, Shared, Slot, Word};
use crate::scheme::{SettingError, Settings};
use crate::sync::Quiescence;
use std::sync::atomic::Ordering;

pub(super) const SUMMARY: &str =
    "the idle ask, the busy hand over half (Paper II sec. 4.1, receiver-induced)";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

/// An answer: nothing to give. Other answers are numbers of tasks; 0 means none yet.
const REFUSED: u64 = u64::MAX;

pub(super) struct ReceiverInitiated<M: Machine> {
    seats: Seats<Vec<u64>>,
    requests: Shared<M::Word>,
    answers: Shared<M::Word>,
    mailboxes: Vec<Shared<M::Slot<u64>>>,
    /// How many processors have tasks, as far as they have said: the dry ask only then.
    rich: Shared<M::Word>,
    quiescence: Quiescence<M>,
    grain: usize,
}

impl<M: Machine> ReceiverInitiated<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let mailbox = settings.number("mailbox", 16, 1..=1 << 16)?;
        let grain = settings.number("grain", 1, 1..=1 << 30)?;
        let words = || machine.alloc(processors, Layout::Padded, |_| Word::new(0));
        let slots = |_| machine.alloc(mailbox, Layout::Packed, |_| Slot::new(0));
        Ok(ReceiverInitiated {
            seats: Seats::new(machine, processors, |_| Vec::new()),
            requests: words(),
            answers: words(),
            mailboxes: (0..processors).map(slots).collect(),
            rich: words(),
            quiescence: Quiescence::new(machine, processors),
            grain,
        })
    }

    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        self.quiescence.reset();
        for words in [&self.requests, &self.answers, &self.rich] {
            // ORDERING: Relaxed: between runs.
            words.iter().for_each(|word| word.store(0, Ordering::Relaxed));
        }
        machine.run(self.requests.len(), |cpu| self.share(work, cpu))
    }

    fn share<W: TreeWork>(&self, work: &W, cpu: &M::Processor) -> Share<W::Found> {
        let mut local = self.seats.claim(cpu);
        let mut share = Share { found: work.found(), visited: 0 };
        let (mut stack, mut sent, mut received) = (Vec::new(), 0, 0);
        let mut rich = false;
        if cpu.id() == 0 {
            local.extend(work.root().map(Task::pack));
        }
        loop {
            while let Some(task) = local.pop() {
                let task = W::Task::unpack(task);
                if work.size(task) <= self.grain {
                    share.visited += work.descend(task, &mut share.found, cpu, &mut stack);
                } else {
                    share.visited += 1;
                    work.visit(task, &mut share.found, cpu, |below| local.push(below.pack()));
                }
                // One task is kept: handing over the last would only turn the tables.
                if (local.len() > 1) != rich {
                    rich = !rich;
                    // ORDERING: Relaxed: a hint of where asking may pay.
                    self.rich[cpu.id()].store(u64::from(rich), Ordering::Relaxed);
                }
                sent += self.answer(cpu, &mut local);
            }
            match self.ask(cpu, &mut local) {
                0 => {
                    let others: Vec<&M::Word> = self.watched(cpu).collect();
                    let over = self.quiescence.wait(cpu, sent, received, &others, || {
                        self.someone_rich(cpu).is_some() || self.is_asked(cpu)
                    });
                    if over {
                        return share;
                    }
                    self.answer(cpu, &mut local);
                }
                tasks => received += tasks,
            }
        }
    }

    fn watched<'a>(&'a self, cpu: &M::Processor) -> impl Iterator<Item = &'a M::Word> {
        let others = neighbours(cpu.id(), cpu.count()).map(|other| &self.rich[other]);
        others.chain([&self.requests[cpu.id()]])
    }

    fn is_asked(&self, cpu: &M::Processor) -> bool {
        // ORDERING: Relaxed: a hint; `answer` looks again.
        self.requests[cpu.id()].load(Ordering::Relaxed) != 0
    }

    /// A neighbour that says it has tasks to give.
    fn someone_rich(&self, cpu: &M::Processor) -> Option<usize> {
        // ORDERING: Relaxed: a hint.
        neighbours(cpu.id(), cpu.count()).find(|&p| self.rich[p].load(Ordering::Relaxed) != 0)
    }

    /// Answers a request, if there is one, with half of the local queue; returns the tasks handed over.
    fn answer(&self, cpu: &M::Processor, local: &mut Vec<u64>) -> u64 {
        let request = &self.requests[cpu.id()];
        // ORDERING: Acquire pairs with the asker's Release compare-exchange: its mailbox is empty.
        let asker = request.load(Ordering::Acquire);
        if asker == 0 {
            return 0;
        }
        let asker = asker as usize - 1;
        let mailbox = &self.mailboxes[asker];
        let tasks = (local.len() / 2).min(mailbox.len());
        for (slot, task) in mailbox.iter().zip(local.drain(..tasks)) {
            // SAFETY: the asker waits for the answer below before it looks, and it has asked only us.
            unsafe { slot.write(task) };
        }
        // ORDERING: Relaxed: published to the next asker by the Release store of the answer only in
        // part; the asker itself never asks again before it has the answer.
        request.store(0, Ordering::Relaxed);
        let answer = if tasks == 0 { REFUSED } else { tasks as u64 };
        // ORDERING: Release pairs with the Acquire load in `ask`: the mailbox is filled.
        self.answers[asker].store(answer, Ordering::Release);
        tasks as u64
    }

    /// Asks somebody who says he has tasks; returns how many came.
    fn ask(&self, cpu: &M::Processor, local: &mut Vec<u64>) -> u64 {
        let Some(other) = self.someone_rich(cpu) else { return 0 };
        let (me, answer) = (cpu.id(), &self.answers[cpu.id()]);
        // ORDERING: Release pairs with the Acquire load in `answer`: our mailbox has been emptied.
        let asked =
            self.requests[other].compare_exchange(0, me as u64 + 1, Ordering::Release, Ordering::Relaxed);
        if asked.is_err() {
            cpu.spin();
            self.answer(cpu, local);
            return 0;
        }
        let over = self.quiescence.over();
        loop {
            // ORDERING: Acquire pairs with the Release store in `answer`.
            let ready =
                || answer.load(Ordering::Acquire) != 0 || self.is_asked(cpu) || self.quiescence.is_over();
            cpu.wait_until(&[answer, &self.requests[me], over], ready);
            let tasks = answer.load(Ordering::Acquire);
            if tasks == 0 {
                if self.quiescence.is_over() {
                    return 0;
                }
                // Two that ask each other must both answer.
                self.answer(cpu, local);
                continue;
            }
            // ORDERING: Relaxed: only an answer to our next request writes it again.
            answer.store(0, Ordering::Relaxed);
            if tasks == REFUSED {
                return 0;
            }
            let mailbox = self.mailboxes[me].iter().take(tasks as usize);
            // SAFETY: the answer says that the first `tasks` slots are written, and that it is done.
            local.extend(mailbox.map(|slot| unsafe { slot.read() }));
            return tasks;
        }
    }
}
