//! Real threads: a persistent team that spins, then parks, between runs.
//!
//! The calling thread is processor 0, so a run on one processor involves nobody else, and a run on
//! two wakes one helper. Helpers are pinned to cores of their own where the system allows it.

mod monitor;
mod team;
mod track;
mod word;

use crate::machine::shared::Heap;
use crate::machine::{Activity, Ended, Layout, Machine, Processor, RunError, Shared, Trace, panic_message};
use core_affinity::CoreId;
pub use monitor::NativeMonitor;
use std::cell::{Cell, RefCell, UnsafeCell};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};
use team::Team;
use track::{LARGE, Lent};
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
        Ok(Threads { team: Team::start(processors, settings)?, started: now() })
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
    /// Whether the run has failed; none for one who is in no team.
    ended: Option<Arc<AtomicBool>>,
    /// Tasks until the next one that is looked into for a trace, itself included; 0 without a trace.
    left: Cell<u32>,
    track: RefCell<Option<Lent>>,
}

impl Thread {
    fn new(id: usize, count: usize, patience: u32, ended: Option<Arc<AtomicBool>>) -> Self {
        Thread { id, count, patience, ended, left: Cell::new(0), track: RefCell::new(None) }
    }

    /// A handle for code that runs outside a team, such as a rival library's own pool.
    pub(crate) fn outside(id: usize, count: usize) -> Self {
        Thread::new(id, count, 0, None)
    }

    #[inline]
    fn end_if_told(&self) {
        // ORDERING: Relaxed: the flag carries no data; the payload travels through the team's mutex.
        if self.ended.as_ref().is_some_and(|ended| ended.load(Ordering::Relaxed)) {
            std::panic::resume_unwind(Box::new(Ended));
        }
    }

    /// Marks on this track from now on, or sends the one in hand home.
    fn follow(&mut self, track: Option<Lent>) {
        self.left.set(u32::from(track.is_some()));
        *self.track.get_mut() = track;
    }

    /// Marks that this worker waits, unless it is idle or at a barrier; returns what it did before.
    #[inline]
    fn begin_wait(&self) -> Activity {
        let now = if self.left.get() == 0 { Activity::Idle } else { self.now() };
        if matches!(now, Activity::Idle | Activity::Barrier) { now } else { self.enter(Activity::Waiting) }
    }

    #[cold]
    #[inline(never)]
    fn now(&self) -> Activity {
        self.track.borrow().as_ref().map_or(Activity::Idle, Lent::now)
    }

    #[cold]
    #[inline(never)]
    fn mark(&self, activity: Activity) -> Activity {
        self.track.borrow_mut().as_mut().map_or(activity, |track| track.enter(activity))
    }

    #[cold]
    #[inline(never)]
    fn look_into(&self, size: usize) -> bool {
        let pass = self.track.borrow_mut().as_mut().map_or(0, |track| track.take_up(size));
        self.left.set(pass.max(1));
        pass == 0
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
        let (mut before, mut turns) = (None, 0);
        while !ready() {
            self.end_if_told();
            if before.is_none() {
                before = Some(self.begin_wait());
            }
            turns += 1;
            if turns < self.patience {
                std::hint::spin_loop();
            } else {
                turns = 0;
                std::thread::yield_now();
            }
        }
        if let Some(before) = before {
            self.enter(before);
        }
    }

    #[inline]
    fn enter(&self, activity: Activity) -> Activity {
        if self.left.get() == 0 { activity } else { self.mark(activity) }
    }

    #[inline]
    fn take_up(&self, size: usize) -> bool {
        match self.left.get() {
            0 => false,
            left if left == 1 || size > LARGE => self.look_into(size),
            left => {
                self.left.set(left - 1);
                false
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
    type Monitor = NativeMonitor;
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

    fn monitor(&self) -> Option<NativeMonitor> {
        Some(NativeMonitor::default())
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
        let mut alone = Thread::outside(0, 1);
        alone.follow(self.team.tracks().lend(0, Activity::Sending));
        catch_unwind(AssertUnwindSafe(|| body(&alone)))
            .map_err(|payload| RunError::Panicked { processor: 0, message: panic_message(&*payload) })
    }

    fn start_trace(&self) -> bool {
        self.team.tracks().start(self.team.processors());
        true
    }

    fn take_trace(&self) -> Option<Trace> {
        self.team.tracks().take()
    }

    fn outside(&self, processor: usize, processors: usize) -> Thread {
        let mut thread = Thread::outside(processor, processors);
        thread.follow(self.team.tracks().lend(processor, Activity::Idle));
        thread
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
