//! Termination by counting: when nobody works and nothing is on its way (Mattern, Distributed
//! Computing 2, 1987, the four-counter method). The papers do not say how they stop (P2-Q01).
//!
//! Each processor counts, in registers, the tasks it has put into queues and taken out of them. When
//! it runs dry it publishes both counts in a word of its own line; nothing happens on the hot path.
//!
//! Protocol: 1. a dry processor publishes its counts; 2. when it sees work it takes its word back
//! ([`BUSY`]) *before* it takes a task; 3. processor 0, when dry, adds up all published counts twice;
//! if nobody was busy, both rounds gave the same words, and as much was received as sent, it tells all.
//!
//! Why it is sound: a processor leaves the dry state only by taking a task, which changes its received
//! count for good; so a word that reads the same in both rounds belongs to a processor that was dry from
//! its first reading to its second. Hence at the end of the first round all were dry at once, the
//! counts were exact, and equal sums say that nothing was on its way. Were step 2 left out, a busy
//! processor's old counts could balance a task it has passed on since.

use crate::machine::{Activity, Layout, Machine, Processor, Shared, Word};
use std::sync::atomic::Ordering;

/// Bits of a published word that hold the received count; those above hold the sent count.
const HALF: u32 = 32;

/// Detects that a run's work is finished.
pub struct Quiescence<M: Machine> {
    /// One word a processor: the tasks it has sent and received when it was last dry, packed. A
    /// processor that has never been dry shows [`BUSY`].
    published: Shared<M::Word>,
    over: Shared<M::Word>,
}

/// No counts yet: more sent than can be received.
const BUSY: u64 = u64::MAX;

impl<M: Machine> Quiescence<M> {
    /// A detector for `processors` processors.
    pub fn new(machine: &M, processors: usize) -> Self {
        Quiescence {
            published: machine.alloc(processors, Layout::Padded, |_| Word::new(BUSY)),
            over: machine.alloc(1, Layout::Padded, |_| Word::new(0)),
        }
    }

    /// Readies the detector for a run; nobody may be in one.
    pub fn reset(&self) {
        for word in self.published.iter() {
            // ORDERING: Relaxed: between runs.
            word.store(BUSY, Ordering::Relaxed);
        }
        self.over.iter().for_each(|word| word.store(0, Ordering::Relaxed));
    }

    /// Waits, being dry, until work may have come or all is over; says whether it is over.
    ///
    /// `sent` and `received` are this processor's counts so far in this run, `arrivals` the words
    /// whose change can mean work for it, and `has_work` looks for it.
    ///
    /// # Panics
    /// If a processor handles more than 2^32 - 2 tasks in a run.
    pub fn wait(
        &self,
        cpu: &M::Processor,
        sent: u64,
        received: u64,
        arrivals: &[&M::Word],
        has_work: impl FnMut() -> bool,
    ) -> bool {
        cpu.during(Activity::Idle, || self.wait_dry(cpu, (sent, received), arrivals, has_work))
    }

    fn wait_dry(
        &self,
        cpu: &M::Processor,
        (sent, received): (u64, u64),
        arrivals: &[&M::Word],
        mut has_work: impl FnMut() -> bool,
    ) -> bool {
        assert!(sent < BUSY >> HALF && received < BUSY >> HALF, "more than 2^32 tasks in one run");
        // ORDERING: Release pairs with the Acquire loads in `sum`: whoever sees these counts also
        // sees the tasks that were sent before.
        self.published[cpu.id()].store(sent << HALF | received, Ordering::Release);
        let over = &self.over[0];
        let mut watched: Vec<&M::Word> = arrivals.to_vec();
        if cpu.id() > 0 {
            watched.push(over);
            // ORDERING: Acquire pairs with the Release store below.
            cpu.wait_until(&watched, || has_work() || over.load(Ordering::Acquire) != 0);
            let finished = over.load(Ordering::Acquire) != 0;
            if !finished {
                self.leave(cpu);
            }
            return finished;
        }
        let finished = self.wait_for_all(cpu, &watched, &mut has_work);
        if finished {
            // ORDERING: Release pairs with the Acquire load above.
            over.store(1, Ordering::Release);
        } else {
            self.leave(cpu);
        }
        finished
    }

    /// Processor 0's wait: for work (`false`), or until all is over (`true`). As long as it knows of one
    /// that is busy it watches that one alone, so that a thousand processors running dry one after the
    /// other do not each wake it to look at all the others.
    fn wait_for_all(
        &self,
        cpu: &M::Processor,
        arrivals: &[&M::Word],
        has_work: &mut impl FnMut() -> bool,
    ) -> bool {
        let (mut suspect, mut work, mut finished) = (0, false, false);
        while !work && !finished {
            if let Some(busy) = self.someone_busy(suspect) {
                suspect = busy;
                let word = &self.published[busy];
                let watched: Vec<&M::Word> = arrivals.iter().copied().chain([word]).collect();
                cpu.wait_until(&watched, || {
                    work = has_work();
                    // ORDERING: Relaxed: a hint; `sum` decides.
                    work || word.load(Ordering::Relaxed) != BUSY
                });
                continue;
            }
            let watched: Vec<&M::Word> = arrivals.iter().copied().chain(self.published.iter()).collect();
            cpu.wait_until(&watched, || {
                work = has_work();
                if work || self.someone_busy(suspect).is_some() {
                    return true;
                }
                finished = match self.sum() {
                    Some(first) => self.sum() == Some(first),
                    None => false,
                };
                finished
            });
        }
        finished
    }

    /// A processor that shows no counts, from `first` on.
    fn someone_busy(&self, first: usize) -> Option<usize> {
        let count = self.published.len();
        // ORDERING: Relaxed: a hint; `sum` decides.
        (first..count).chain(0..first).find(|&p| self.published[p].load(Ordering::Relaxed) == BUSY)
    }

    /// The word that changes when all is over, for waits other than [`Quiescence::wait`]: a processor
    /// that shows its last counts may believe an old hint of work, and wait for one who has left.
    pub fn over(&self) -> &M::Word {
        &self.over[0]
    }

    /// Whether all is over.
    pub fn is_over(&self) -> bool {
        // ORDERING: Acquire pairs with the Release store in `wait`.
        self.over().load(Ordering::Acquire) != 0
    }

    /// Takes the published counts back, before a task is taken.
    fn leave(&self, cpu: &M::Processor) {
        // ORDERING: Relaxed: whoever receives a task that this processor sends later, and publishes
        // that, has this store before it, by the queue's Release and Acquire.
        self.published[cpu.id()].store(BUSY, Ordering::Relaxed);
    }

    /// The total received, if everybody is dry and as much was received as sent. Received counts only
    /// grow, so equal totals of two rounds mean equal counts of each.
    fn sum(&self) -> Option<u64> {
        let (mut sent, mut received) = (0, 0);
        for word in self.published.iter() {
            // ORDERING: Acquire pairs with the Release store in `wait`.
            let counts = word.load(Ordering::Acquire);
            if counts == BUSY {
                return None;
            }
            sent += counts >> HALF;
            received += counts & (BUSY >> HALF);
        }
        (sent == received).then_some(received)
    }
}
