//! Lock-free scheme (Paper II, section 4; P2-06 to P2-10): a private local queue and single-sender
//! single-receiver in-queues a processor; tasks are sent without looking, round robin.
//!
//! Invariant: a task is in one local queue, in one in-queue, or in work. Only the owner touches a local
//! queue; an in-queue has one sender and one receiver (`sync::in_queue`).
//!
//! Steps of a processor: 1. take the newest local task, or else one from the in-queue being emptied, or
//! else from the next that holds any (P2-10); 2. visit it; 3. deal the tasks below round robin to
//! {local queue, receivers} (P2-08); a full ring leaves the task local; 4. with `balance`, if as many
//! tasks have been visited as were sent last time, send the ring successor half the difference of the
//! loads (P2-09). When dry: `sync::Quiescence`.
//!
//! Topology (P2-07): processor p sends to p + 1 + floor(i P / n) for i in 0 .. n, modulo P. The paper's
//! "(p/n + 1):th successor", read literally, gives self-links; its figure 1h (P = 6, n = 3) fits this.
//!
//! Deviations: a task whose known size is at most `grain`, and at most an eighth of an even share, is
//! descended on the spot (`grain` = 1: never, as in the paper). Loads are read without synchronisation:
//! own = local + seen in in-queues; the successor's = its published local queue + what is known to be in
//! the ring to it (P2-Q04).
//!
//! Settings: `receivers` (n), `balance` (`off`, or `half_difference` as in the paper), `capacity` of a
//! ring, `ring` (`remember` or `1999`: look at the other's index every time), `layout`, `grain`. With
//! P = 2 and `balance = off` it is the paper's two-processor policy: keep every second child (P2-15).

use super::{Share, Task, TreeWork};
use crate::machine::{Layout, Machine, Processor, RunError, Seats, Shared, Word};
use crate::scheme::{SettingError, Settings};
use crate::sync::{Quiescence, Receiver, RingSettings, Sender, in_queue};
use std::sync::atomic::Ordering;

pub(super) const SUMMARY: &str = "rings between neighbours, sent blindly round robin (Paper II sec. 4)";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct LockFree<M: Machine> {
    seats: Seats<Seat<M>>,
    /// A processor's local queue length, published when balancing.
    loads: Shared<M::Word>,
    quiescence: Quiescence<M>,
    processors: usize,
    balance: bool,
    grain: usize,
}

/// Pieces of an even share that are dealt out at least: they even out what blind sending does not.
const PIECES: usize = 8;

/// What a processor keeps from run to run.
struct Seat<M: Machine> {
    local: Vec<u64>,
    stack: Vec<u64>,
    to: Vec<Sender<M>>,
    from: Vec<Receiver<M>>,
}

/// The receivers of processor `p` of `processors`, `n` of them, the ring successor first.
fn receivers(p: usize, processors: usize, n: usize) -> impl Iterator<Item = usize> {
    let n = n.min(processors - 1);
    (0..n).map(move |i| (p + 1 + i * processors / n) % processors)
}

impl<M: Machine> LockFree<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let n = settings.number("receivers", 8, 1..=4096)?;
        let modes = [("off", false), ("half_difference", true)];
        let balance = settings.choice("balance", false, &modes)?;
        let grain = settings.number("grain", 32, 1..=1 << 30)?;
        let ring = RingSettings {
            capacity: settings.number("capacity", 4, 1..=1 << 20)?,
            layout: settings.layout()?,
            remember_index: settings.choice("ring", true, &[("remember", true), ("1999", false)])?,
        };
        let seat = || Seat { local: Vec::new(), stack: Vec::new(), to: Vec::new(), from: Vec::new() };
        let mut seats: Vec<Seat<M>> = (0..processors).map(|_| seat()).collect();
        for p in 0..processors {
            for receiver in receivers(p, processors, n) {
                let (to, from) = in_queue(machine, ring);
                seats[p].to.push(to);
                seats[receiver].from.push(from);
            }
        }
        let mut seats = seats.into_iter();
        Ok(LockFree {
            seats: Seats::new(machine, processors, |_| seats.next().expect("one a processor")),
            loads: machine.alloc(processors, Layout::Padded, |_| Word::new(0)),
            quiescence: Quiescence::new(machine, processors),
            processors,
            balance: balance && processors > 1,
            grain,
        })
    }

    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        self.quiescence.reset();
        machine.run(self.processors, |cpu| self.share(work, cpu))
    }

    fn share<W: TreeWork>(&self, work: &W, cpu: &M::Processor) -> Share<W::Found> {
        let mut seat = self.seats.claim(cpu);
        let Seat { local, stack, to, from } = &mut *seat;
        let mut share = Share { found: work.found(), visited: 0 };
        let (mut sent, mut received) = (0, 0);
        let even = work.root().map_or(0, |root| work.size(root)) / self.processors;
        let grain = self.grain.min(even / PIECES);
        // Whose turn it is to get the next task: a receiver, or at `to.len()` the local queue.
        let mut turn = to.len();
        // The in-queue being emptied, and the visits until loads are compared again.
        let (mut reading, mut patience) = (0, 0);
        if cpu.id() == 0 {
            local.extend(work.root().map(Task::pack));
        }
        loop {
            let task = match local.pop() {
                Some(task) => task,
                None => match receive(from, &mut reading) {
                    Some(task) => {
                        received += 1;
                        task
                    }
                    None => {
                        if self.balance {
                            // ORDERING: Relaxed: a load is an estimate.
                            self.loads[cpu.id()].store(0, Ordering::Relaxed);
                        }
                        if self.wait(cpu, sent, received, from) {
                            return share;
                        }
                        continue;
                    }
                },
            };
            let task = W::Task::unpack(task);
            if grain > 1 && work.size(task) <= grain {
                share.visited += work.descend(task, &mut share.found, cpu, stack);
                continue;
            }
            share.visited += 1;
            let first = local.len();
            work.visit(task, &mut share.found, cpu, |below| local.push(below.pack()));
            sent += deal(local, first, to, &mut turn);
            if self.balance {
                sent += self.balance(cpu, local, to, from, &mut patience);
            }
        }
    }

    /// Sends the successor half the difference of the loads, unless it was done a short while ago.
    fn balance(
        &self,
        cpu: &M::Processor,
        local: &mut Vec<u64>,
        to: &mut [Sender<M>],
        from: &[Receiver<M>],
        patience: &mut usize,
    ) -> u64 {
        // ORDERING: Relaxed: a load is an estimate.
        self.loads[cpu.id()].store(local.len() as u64, Ordering::Relaxed);
        if *patience > 0 {
            *patience -= 1;
            return 0;
        }
        let mine = local.len() + from.iter().map(Receiver::len).sum::<usize>();
        // ORDERING: Relaxed, as above.
        let there = self.loads[(cpu.id() + 1) % self.processors].load(Ordering::Relaxed);
        let half = mine.saturating_sub(there as usize + to[0].len()) / 2;
        // The oldest tasks are nearest the root: they stand for the most work.
        let sent = to[0].push_all(&local[..half.min(local.len())]);
        local.drain(..sent);
        *patience = sent;
        sent as u64
    }

    /// Waits for work; says whether all is over.
    fn wait(&self, cpu: &M::Processor, sent: u64, received: u64, from: &[Receiver<M>]) -> bool {
        let arrivals: Vec<&M::Word> = from.iter().map(Receiver::arrivals).collect();
        let has_work = || from.iter().any(Receiver::has_arrivals);
        self.quiescence.wait(cpu, sent, received, &arrivals, has_work)
    }
}

/// Deals the tasks from `first` on round robin to the receivers and the local queue; returns how many
/// were sent.
#[inline]
fn deal<M: Machine>(local: &mut Vec<u64>, first: usize, to: &mut [Sender<M>], turn: &mut usize) -> u64 {
    let mut kept = first;
    for i in first..local.len() {
        let task = local[i];
        let to_local = *turn == to.len() || !to[*turn].push(task);
        *turn = if *turn == to.len() { 0 } else { *turn + 1 };
        if to_local {
            local[kept] = task;
            kept += 1;
        }
    }
    let sent = local.len() - kept;
    local.truncate(kept);
    sent as u64
}

/// Takes a task from the in-queue being emptied, or from the next that holds any.
#[inline]
fn receive<M: Machine>(from: &mut [Receiver<M>], reading: &mut usize) -> Option<u64> {
    for _ in 0..from.len() {
        if let Some(task) = from[*reading].pop() {
            return Some(task);
        }
        *reading = (*reading + 1) % from.len();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::receivers;

    #[test]
    fn the_topology_is_the_papers() {
        let of = |p, n| receivers(0, p, n).collect::<Vec<_>>();
        assert_eq!(of(6, 3), [1, 3, 5], "figure 1h");
        assert_eq!(of(2, 1), [1]);
        assert_eq!(of(13, 1), [1]);
        assert!(of(1, 4).is_empty());
        for processors in 1..40 {
            for n in 1..50 {
                let mut found = of(processors, n);
                assert!(!found.contains(&0), "no self-link");
                found.dedup();
                assert_eq!(found.len(), n.min(processors - 1), "P = {processors}, n = {n}");
            }
        }
    }
}
