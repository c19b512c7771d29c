//! Work stealing (P2-14, P2-X01): a double-ended queue a processor; the owner works at its young end, the
//! idle steal from the old end. Chase and Lev, SPAA 2005, with the fences of Le, Pop, Cohen and
//! Zappa Nardelli, PPoPP 2013, on this project's words, so that it runs on every machine.
//!
//! Invariant: tasks `top .. bottom` of a deque wait; only the owner writes `bottom`; `top` only grows, by
//! compare-exchange, and whoever moves it owns the task that was there.
//!
//! Termination: a count of idle processors. One that finds its own deque empty counts itself idle, and
//! counts itself out again before it tries to steal; when all are idle nobody holds a task.
//!
//! Deviation: deques do not grow; what does not fit stays in a private stack that nobody can steal from.
//!
//! Settings: `capacity` of a deque, `layout`, `grain` as in `lock_free`.

use super::neighbours::neighbours;
use super::{Share, Task, TreeWork};
use crate::machine::{Activity, Layout, Machine, Processor, RunError, Seats, Shared, Word};
use crate::scheme::{SettingError, Settings};
use std::sync::atomic::Ordering;

pub(super) const SUMMARY: &str = "Chase-Lev deques, the idle steal (rival; Cilk-5 in Paper II sec. 6)";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct WorkStealing<M: Machine> {
    deques: Vec<Deque<M>>,
    idle: Shared<M::Word>,
    /// The private stacks.
    seats: Seats<Vec<u64>>,
    grain: usize,
}

struct Deque<M: Machine> {
    /// Word 0: `top`, moved by thieves and the owner. Word 1: `bottom`, written by the owner.
    ends: Shared<M::Word>,
    tasks: Shared<M::Word>,
    capacity: u64,
    mask: u64,
}

impl<M: Machine> Deque<M> {
    fn new(machine: &M, capacity: usize, layout: Layout) -> Self {
        let size = capacity.next_power_of_two();
        // Indices start at 1: the owner may step below `top` by one for a moment.
        Deque {
            ends: machine.alloc(2, layout, |_| Word::new(1)),
            tasks: machine.alloc(size, Layout::Packed, |_| Word::new(0)),
            capacity: capacity as u64,
            mask: size as u64 - 1,
        }
    }

    fn top(&self) -> &M::Word {
        &self.ends[0]
    }

    fn bottom(&self) -> &M::Word {
        &self.ends[1]
    }

    fn task(&self, index: u64) -> &M::Word {
        &self.tasks[(index & self.mask) as usize]
    }

    /// Whether the deque seems to hold anything.
    fn is_empty(&self) -> bool {
        // ORDERING: Relaxed: a hint.
        self.top().load(Ordering::Relaxed) >= self.bottom().load(Ordering::Relaxed)
    }

    /// Owner: adds a task at the young end; says whether there was room.
    #[inline]
    fn push(&self, task: u64) -> bool {
        // ORDERING: Relaxed: only the owner writes `bottom`.
        let bottom = self.bottom().load(Ordering::Relaxed);
        // ORDERING: Acquire pairs with a thief's Release half on `top`: it has read the slot we reuse.
        let top = self.top().load(Ordering::Acquire);
        if bottom - top >= self.capacity {
            return false;
        }
        // ORDERING: Relaxed: published by the Release store below.
        self.task(bottom).store(task, Ordering::Relaxed);
        // ORDERING: Release pairs with the thief's Acquire load of `bottom`.
        self.bottom().store(bottom + 1, Ordering::Release);
        true
    }

    /// Owner: takes the youngest task.
    #[inline]
    fn pop(&self) -> Option<u64> {
        // ORDERING: Relaxed: only the owner writes `bottom`.
        let bottom = self.bottom().load(Ordering::Relaxed) - 1;
        // ORDERING: Release pairs with the thief's Acquire load of `bottom`, as in `push`: a thief that
        // sees this value takes an older task, whose slot was written before. The fence orders the
        // store against the load of `top` and pairs with the fence in `steal`: of owner and thief at
        // the last task, at least one sees the other.
        self.bottom().store(bottom, Ordering::Release);
        M::Word::fence(Ordering::SeqCst);
        let top = self.top().load(Ordering::Relaxed);
        if top > bottom {
            self.bottom().store(bottom + 1, Ordering::Relaxed);
            return None;
        }
        // ORDERING: Relaxed: the owner wrote it.
        let task = self.task(bottom).load(Ordering::Relaxed);
        if top < bottom {
            return Some(task);
        }
        // The last one: race the thieves for it.
        // ORDERING: SeqCst orders this exchange with those of thieves; Relaxed on failure, as a thief
        // then has it.
        let won = self.top().compare_exchange(top, top + 1, Ordering::SeqCst, Ordering::Relaxed);
        self.bottom().store(bottom + 1, Ordering::Relaxed);
        won.is_ok().then_some(task)
    }

    /// Thief: takes the oldest task.
    fn steal(&self) -> Option<u64> {
        // ORDERING: Acquire pairs with the exchanges on `top`.
        let top = self.top().load(Ordering::Acquire);
        // ORDERING: pairs with the fence in `pop`.
        M::Word::fence(Ordering::SeqCst);
        // ORDERING: Acquire pairs with the Release store in `push`: the task is written.
        let bottom = self.bottom().load(Ordering::Acquire);
        if top >= bottom {
            return None;
        }
        // ORDERING: Relaxed: it counts only if `top` has not moved, which the exchange below decides.
        let task = self.task(top).load(Ordering::Relaxed);
        // ORDERING: SeqCst, as in `pop`; its Release half tells the owner that the slot has been read.
        let won = self.top().compare_exchange(top, top + 1, Ordering::SeqCst, Ordering::Relaxed);
        won.is_ok().then_some(task)
    }
}

impl<M: Machine> WorkStealing<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let capacity = settings.number("capacity", 1 << 9, 1..=1 << 20)?;
        let (layout, grain) = (settings.layout()?, settings.number("grain", 1, 1..=1 << 30)?);
        Ok(WorkStealing {
            deques: (0..processors).map(|_| Deque::new(machine, capacity, layout)).collect(),
            idle: machine.alloc(1, Layout::Padded, |_| Word::new(0)),
            seats: Seats::new(machine, processors, |_| Vec::new()),
            grain,
        })
    }

    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        // ORDERING: Relaxed: between runs.
        self.idle[0].store(0, Ordering::Relaxed);
        machine.run(self.deques.len(), |cpu| self.share(work, cpu))
    }

    fn share<W: TreeWork>(&self, work: &W, cpu: &M::Processor) -> Share<W::Found> {
        let mut private = self.seats.claim(cpu);
        let mut share = Share { found: work.found(), visited: 0 };
        let mut stack = Vec::new();
        let own = &self.deques[cpu.id()];
        let mut next = if cpu.id() == 0 { work.root().map(Task::pack) } else { None };
        loop {
            let Some(task) = next.take().or_else(|| own.pop()).or_else(|| private.pop()) else {
                match self.find(cpu) {
                    Some(task) => next = Some(task),
                    None => return share,
                }
                continue;
            };
            let task = W::Task::unpack(task);
            if self.grain > 1 && work.size(task) <= self.grain {
                share.visited += work.descend(task, &mut share.found, cpu, &mut stack);
                continue;
            }
            share.visited += 1;
            work.visit(task, &mut share.found, cpu, |below| {
                // The newest task below is kept in hand, so it needs no trip through the deque.
                if let Some(older) = next.replace(below.pack())
                    && !own.push(older)
                {
                    private.push(older);
                }
            });
        }
    }

    /// Steals from somebody, waiting for a chance; `None` when all is over.
    fn find(&self, cpu: &M::Processor) -> Option<u64> {
        let (me, count, idle) = (cpu.id(), cpu.count(), &self.idle[0]);
        let victims = || neighbours(me, count).map(|victim| &self.deques[victim]);
        let mut watched: Vec<&M::Word> = victims().map(Deque::bottom).collect();
        watched.push(idle);
        // ORDERING: AcqRel here and below: whoever sees everybody idle comes after all their work.
        idle.fetch_add(1, Ordering::AcqRel);
        let everybody = count as u64;
        loop {
            cpu.during(Activity::Idle, || {
                cpu.wait_until(&watched, || {
                    // ORDERING: Acquire pairs with the counts above and below.
                    idle.load(Ordering::Acquire) == everybody || victims().any(|d| !d.is_empty())
                });
            });
            // ORDERING: Acquire, as above.
            if idle.load(Ordering::Acquire) == everybody {
                return None;
            }
            idle.fetch_sub(1, Ordering::AcqRel);
            if let Some(task) = victims().find_map(Deque::steal) {
                return Some(task);
            }
            idle.fetch_add(1, Ordering::AcqRel);
        }
    }
}
