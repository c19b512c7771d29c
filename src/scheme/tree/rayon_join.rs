//! `rayon::join` at every node, on rayon's own threads: what most Rust programs do today.
//!
//! The tasks below a node are halved until one is left. A worker that waits in a join runs what it stole on top
//! of it, so its stack grows with the depth of the tree and with its luck. From [`NESTED`] joins on tasks are
//! therefore spawned, which waits for nothing and keeps the stack bounded for every tree.
//!
//! Rayon's workers park on their own terms: a timeline
//! shows the visits, and all that rayon does between them, looking for work and sleeping too, as sending.

use super::{Share, Task, TreeWork};
use crate::machine::threads::{Thread, pin};
use crate::machine::{Machine, RunError, panic_message};
use crate::scheme::{SettingError, Settings};
use rayon::{Scope, ThreadPool, ThreadPoolBuilder};
use std::cell::Cell;
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;

pub(super) const SUMMARY: &str = "crate rayon, join at every node (rival; threads only)";
pub(super) const NATIVE_ONLY: bool = true;
pub(super) const LEARNS: bool = false;

/// Joins a worker may wait in at once: far more than a balanced tree needs, and some hundred kilobytes of the two
/// megabytes of stack that a thread has, also without optimisation.
const NESTED: usize = 200;

thread_local! {
    /// Joins this worker waits in.
    static JOINS: Cell<usize> = const { Cell::new(0) };
}

/// Counted out of [`JOINS`] when dropped, also by a panic.
struct Nested;

impl Nested {
    /// `None` where the stack is as deep as it may be.
    fn enter() -> Option<Self> {
        let joins = JOINS.get();
        (joins < NESTED).then(|| {
            JOINS.set(joins + 1);
            Nested
        })
    }
}

impl Drop for Nested {
    fn drop(&mut self) {
        JOINS.set(JOINS.get() - 1);
    }
}

pub(super) struct RayonJoin<M> {
    /// Made on the first run, so that a system that refuses threads is an error of the run.
    pool: Option<ThreadPool>,
    processors: usize,
    machine: PhantomData<fn(M)>,
}

/// One share and one handle a worker. Its lock is free whenever it is taken: a worker visits one task at a time.
type Shares<F> = Vec<Mutex<(Share<F>, Thread)>>;

impl<M: Machine> RayonJoin<M> {
    pub(super) fn new(machine: &M, processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        settings.native_only(machine)?;
        Ok(RayonJoin { pool: None, processors, machine: PhantomData })
    }

    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        let pool = match &mut self.pool {
            Some(pool) => pool,
            none => {
                let builder = ThreadPoolBuilder::new().num_threads(self.processors).start_handler(pin);
                let refused = |e| RunError::System { what: "a rayon pool", source: std::io::Error::other(e) };
                none.insert(builder.build().map_err(refused)?)
            }
        };
        let count = self.processors;
        let whole = || {
            let share = || Share { found: work.found(), visited: 0 };
            let shares: Shares<W::Found> =
                (0..count).map(|p| Mutex::new((share(), machine.outside(p, count)))).collect();
            pool.scope(|scope| work.root().into_iter().for_each(|root| down(work, &shares, scope, root)));
            shares
        };
        let shares = catch_unwind(AssertUnwindSafe(whole))
            .map_err(|payload| RunError::Panicked { processor: 0, message: panic_message(&*payload) })?;
        Ok(shares.into_iter().map(|share| share.into_inner().expect("no visit panicked").0).collect())
    }
}

fn down<'scope, W: TreeWork>(
    work: &'scope W,
    shares: &'scope Shares<W::Found>,
    scope: &Scope<'scope>,
    mut task: W::Task,
) {
    let mut below = Vec::new();
    // A chain is gone down without recursion.
    loop {
        let me = rayon::current_thread_index().unwrap_or(0);
        {
            let mut share = shares[me].lock().unwrap_or_else(|e| e.into_inner());
            let (share, cpu) = &mut *share;
            share.visited += 1;
            work.visit(task, &mut share.found, cpu, |task| below.push(task.pack()));
        }
        match *below {
            [] => return,
            [one] => task = W::Task::unpack(one),
            _ => return split(work, shares, scope, &below),
        }
        below.clear();
    }
}

fn split<'scope, W: TreeWork>(
    work: &'scope W,
    shares: &'scope Shares<W::Found>,
    scope: &Scope<'scope>,
    tasks: &[u64],
) {
    match tasks {
        [] => {}
        [one] => down(work, shares, scope, W::Task::unpack(*one)),
        more => match Nested::enter() {
            Some(_nested) => {
                let (left, right) = more.split_at(more.len() / 2);
                rayon::join(|| split(work, shares, scope, left), || split(work, shares, scope, right));
            }
            None => {
                for &task in more {
                    scope.spawn(move |scope| down(work, shares, scope, W::Task::unpack(task)));
                }
            }
        },
    }
}
