//! Real threads: a persistent team that spins, then parks, between runs.
//!
//! The calling thread is processor 0, so a run on one processor involves nobody else, and a run on
//! two wakes one helper. Helpers are pinned to cores of their own where the system allows it.

mod team;
mod word;

use crate::machine::shared::Heap;
use crate::machine::{Ended, Layout, Machine, Processor, RunError, Shared, panic_message};
use core_affinity::CoreId;
use std::cell::UnsafeCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};
use team::Team;
pub use word::{NativeSlot, NativeWord};

/// The most threads a team may have: far beyond any sensible oversubscription of one host.
const MOST: usize = 256;

/// How a [`Threads`] team is set up.
#[derive(Clone, Debug)]
pub struct TeamSettings {
    /// How long a helper without work spins before it parks. Spinning keeps the next run's start
    /// under a microsecond but occupies the core; a parked helper costs tens of microseconds to wake.
    pub spin: Duration,
    /// Whether helpers are pinned to cores (helper `p` to core `p` modulo the cores there are).
    pub pin: bool,
    /// Whether the calling thread is pinned too, to core 0. It stays so after the team is gone.
    pub pin_caller: bool,
}

impl Default for TeamSettings {
    fn default() -> Self {
        TeamSettings { spin: Duration::from_millis(5), pin: true, pin_caller: false }
    }
}

/// A team of real threads.
///
/// ```
/// use apportion::machine::{Machine, Processor, Threads};
/// let team = Threads::new(2)?;
/// let ids = team.run(2, |cpu| cpu.id())?;
/// assert_eq!(ids, [0, 1]);
/// # Ok::<(), apportion::machine::RunError>(())
/// ```
pub struct Threads {
    team: Team,
    started: Instant,
    /// The calling thread's handle when it runs alone.
    alone: Thread,
}

impl Threads {
    /// A team of up to `processors` threads (this one among them) with the default settings.
    ///
    /// # Errors
    /// [`RunError::Processors`] for 0 or more than 256; [`RunError::System`] if a thread is refused.
    pub fn new(processors: usize) -> Result<Self, RunError> {
        Self::with_settings(processors, &TeamSettings::default())
    }

    /// A team with its settings.
    ///
    /// # Errors
    /// As [`Threads::new`].
    pub fn with_settings(processors: usize, settings: &TeamSettings) -> Result<Self, RunError> {
        if processors == 0 || processors > MOST {
            return Err(RunError::Processors {
                asked: processors,
                most: MOST,
                machine: "threads".to_owned(),
            });
        }
        Ok(Threads { team: Team::start(processors, settings)?, started: now(), alone: Thread::outside(0, 1) })
    }

    /// Whether a run on `processors` would have to wake a sleeping helper.
    pub fn is_parked(&self, processors: usize) -> bool {
        self.team.is_parked(processors)
    }

    /// How many cores this host offers.
    pub fn cores() -> usize {
        cores().len().max(1)
    }
}

/// The cores this process may use, as they were when first asked for: a thread that has been pinned since
/// is told of its own core alone, and a team started from it would crowd there.
fn cores() -> &'static [CoreId] {
    static CORES: OnceLock<Vec<CoreId>> = OnceLock::new();
    CORES.get_or_init(|| core_affinity::get_core_ids().unwrap_or_default())
}

/// Pins the calling thread to a core of its own, number `index` modulo the cores there are, where the
/// system allows it. Threads inherit the pinning of who starts them; a rival's must not.
pub(crate) fn pin(index: usize) {
    if let Some(&core) = cores().get(index % cores().len().max(1)) {
        core_affinity::set_for_current(core);
    }
}

/// The monotonic clock.
#[expect(clippy::disallowed_methods, reason = "the thread machine is where native time comes from")]
fn now() -> Instant {
    Instant::now()
}

/// A worker's handle on [`Threads`].
#[derive(Debug)]
pub struct Thread {
    id: usize,
    count: usize,
    /// Busy-wait turns before the core is offered to somebody else.
    patience: u32,
    ended: Arc<AtomicBool>,
}

impl Thread {
    /// A handle for code that runs outside a team, such as a rival library's own pool.
    pub(crate) fn outside(id: usize, count: usize) -> Self {
        Thread { id, count, patience: 0, ended: Arc::new(AtomicBool::new(false)) }
    }

    #[inline]
    fn end_if_told(&self) {
        // ORDERING: Relaxed: the flag carries no data; the payload travels through the team's mutex.
        if self.ended.load(Ordering::Relaxed) {
            std::panic::resume_unwind(Box::new(Ended));
        }
    }
}

impl Processor for Thread {
    type Word = NativeWord;

    #[inline]
    fn id(&self) -> usize {
        self.id
    }

    #[inline]
    fn count(&self) -> usize {
        self.count
    }

    #[inline(always)]
    fn charge(&self, _cycles: u64) {}

    #[inline(always)]
    fn touch<T>(&self, _data: &T) {}

    #[inline]
    fn spin(&self) {
        self.end_if_told();
        std::hint::spin_loop();
        if self.patience < 1024 {
            // More workers than cores: whoever we wait for may need this very core.
            std::thread::yield_now();
        }
    }

    #[inline]
    fn wait_until(&self, _words: &[&NativeWord], mut ready: impl FnMut() -> bool) {
        let mut turns = 0;
        while !ready() {
            self.end_if_told();
            turns += 1;
            if turns < self.patience {
                std::hint::spin_loop();
            } else {
                turns = 0;
                std::thread::yield_now();
            }
        }
    }
}

/// One result cell a processor, written by it alone.
struct Results<L>(Vec<UnsafeCell<Option<L>>>);

// SAFETY: processor `p` alone writes cell `p`; the caller reads after all have finished.
unsafe impl<L: Send> Sync for Results<L> {}

impl Machine for Threads {
    type Word = NativeWord;
    type Slot<T: Copy + Send> = NativeSlot<T>;
    type Processor = Thread;

    fn name(&self) -> &str {
        "threads"
    }

    fn is_native(&self) -> bool {
        true
    }

    fn most_processors(&self) -> usize {
        self.team.processors()
    }

    fn alloc<T: Send + Sync>(&self, n: usize, layout: Layout, make: impl FnMut(usize) -> T) -> Shared<T> {
        Shared::new(Arc::new(Heap), n, layout, make)
    }

    fn run<L: Send>(
        &self,
        processors: usize,
        body: impl Fn(&Thread) -> L + Sync,
    ) -> Result<Vec<L>, RunError> {
        self.check_processors(processors)?;
        let results = Results((0..processors).map(|_| UnsafeCell::new(None)).collect());
        let results_ref = &results;
        self.team.run(processors, &|thread: &Thread| {
            let value = body(thread);
            // SAFETY: this processor alone writes its cell, and the caller is still waiting.
            unsafe { *results_ref.0[thread.id].get() = Some(value) };
        })?;
        Ok(results.0.into_iter().map(|cell| cell.into_inner().expect("every worker finished")).collect())
    }

    #[inline]
    fn alone<L: Send>(&self, body: impl FnOnce(&Thread) -> L + Send) -> Result<L, RunError> {
        catch_unwind(AssertUnwindSafe(|| body(&self.alone)))
            .map_err(|payload| RunError::Panicked { processor: 0, message: panic_message(&*payload) })
    }

    fn start_ticks(&self, processors: usize) -> u64 {
        // A spinning helper sees a post within a few line transfers; waking a parked one takes a system
        // call here and a scheduler's decision there.
        if processors > 1 && self.is_parked(processors) { 50_000 } else { 500 }
    }

    fn now(&self) -> u64 {
        u64::try_from(self.started.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }
}

#[cfg(test)]
mod tests;
