//! Simulated multiprocessors: virtual processors in virtual time, shared accesses billed by a
//! cache-coherence and bus model. Execution-driven and exact: the scheme's own code runs.
//!
//! What is modelled: MOESI coherence by line of the program's real layout, one split-transaction bus or nodes in
//! a network with a directory each, two direct-mapped cache levels, an in-order store buffer, atomics (at memory
//! too) and fences, busy waiting on cached copies, the time the operating system takes to wake a sleeper. What is
//! not: instruction fetch, branch prediction, TLBs, bank conflicts, links of the network that are busy, the
//! operating system otherwise. Private work takes what the job charges for it.

mod arena;
mod engine;
mod memory;
mod model;
mod monitor;
mod network;
mod trace;
mod word;

use crate::machine::{Activity, Layout, Machine, Processor, RunError, Shared, Trace, Word, panic_message};
use arena::Memory;
use corosensei::stack::DefaultStack;
use corosensei::{Coroutine, CoroutineResult};
pub use engine::Statistics;
use engine::{Engine, Installed};
pub use model::{Model, ModelError};
pub use monitor::SimulatedMonitor;
pub use network::{Home, Network, Topology};
use std::cell::UnsafeCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use trace::Tracing;
pub use word::{SimulatedSlot, SimulatedWord};

/// The most virtual processors a run may have.
pub(crate) const MOST: usize = 4096;

/// Bytes of a virtual processor's stack (committed by the system only as far as it is used).
const STACK: usize = 256 << 10;

/// A simulated multiprocessor. Its caches stay warm from run to run.
///
/// ```
/// use apportion::machine::{Layout, Machine, Simulated, Word, simulated::Model};
/// use std::sync::atomic::Ordering::Relaxed;
/// let machine = Simulated::new(Model::named("e4000")?);
/// let words = machine.alloc(1, Layout::Packed, |_| Word::new(0));
/// let sum = |w: &<Simulated as Machine>::Word| w.fetch_add(1, Relaxed);
/// machine.run(13, |_| sum(&words[0]))?;
/// assert_eq!(words[0].load(Relaxed), 13);
/// assert!(machine.now() > 13 * 100, "thirteen transfers of the line take their time");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Simulated {
    model: Model,
    memory: Arc<Memory>,
    state: Mutex<State>,
    /// Written by processor 0 to start a run; the others wait for it.
    start: Shared<SimulatedWord>,
    /// Counts those who have finished.
    finished: Shared<SimulatedWord>,
}

struct State {
    engine: Engine,
    stacks: Vec<DefaultStack>,
    now: u64,
}

// SAFETY: a stack is plain memory; it is used by one run at a time, under the mutex.
unsafe impl Send for State {}

impl Simulated {
    /// A machine after `model`, with cold caches.
    pub fn new(model: Model) -> Self {
        let memory = Arc::new(Memory::new());
        let word = || Shared::new(memory.clone(), 1, Layout::Padded, |_| SimulatedWord::new(0));
        Simulated {
            start: word(),
            finished: word(),
            state: Mutex::new(State { engine: Engine::new(model.clone()), stacks: Vec::new(), now: 0 }),
            memory,
            model,
        }
    }

    /// The same machine with random delays before shared accesses: each seed explores another
    /// schedule, and the same seed the same one.
    #[must_use]
    pub fn disturbed(self, seed: u64) -> Self {
        self.state.lock().unwrap_or_else(|e| e.into_inner()).engine.noise = Some(seed);
        self
    }

    /// The constants of this machine.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// What happened since the machine was made (`accesses`, `transactions`) and in the last run
    /// (`charged`).
    pub fn statistics(&self) -> Statistics {
        let state = self.lock();
        let mut statistics = state.engine.statistics.clone();
        statistics.transactions = state.engine.coherence.transactions;
        statistics
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(|e| e.into_inner())
    }

    /// The start and end of a run as each processor goes through them: processor 0 writes a word on
    /// which the others spin, and waits until all have counted themselves out.
    fn gated<L>(&self, cpu: &VirtualProcessor, body: impl FnOnce() -> L) -> L {
        let (start, finished) = (&self.start[0], &self.finished[0]);
        let body = || {
            cpu.enter(Activity::Sending);
            let result = body();
            cpu.enter(Activity::Barrier);
            result
        };
        if cpu.count == 1 {
            return body();
        }
        if cpu.id == 0 {
            // ORDERING: one host thread; on hardware a Release store and an Acquire load.
            start.store(1, Ordering::Release);
            let result = body();
            let others = cpu.count as u64 - 1;
            cpu.wait_until(&[finished], || finished.load(Ordering::Acquire) == others);
            engine::spend(self.model.finish, false);
            result
        } else {
            cpu.wait_until(&[start], || start.load(Ordering::Acquire) == 1);
            engine::spend(self.model.start, false);
            let result = body();
            finished.fetch_add(1, Ordering::Release);
            result
        }
    }
}

/// A worker's handle on [`Simulated`].
#[derive(Debug)]
pub struct VirtualProcessor {
    id: usize,
    count: usize,
}

impl Processor for VirtualProcessor {
    type Word = SimulatedWord;
    const MARKS_WITHIN: bool = true;

    fn id(&self) -> usize {
        self.id
    }

    fn count(&self) -> usize {
        self.count
    }

    fn charge(&self, cycles: u64) {
        engine::spend(cycles, true);
    }

    fn touch<T>(&self, data: &T) {
        engine::touch(std::ptr::from_ref(data).addr(), size_of::<T>());
    }

    fn keep_books(&self) {
        engine::keep_books();
    }

    fn spin(&self) {
        engine::pause();
    }

    fn wait_until(&self, words: &[&SimulatedWord], mut ready: impl FnMut() -> bool) {
        let mut before = None;
        engine::wait_until(words.iter().map(|w| std::ptr::from_ref(*w).addr()), || {
            let is_ready = ready();
            if !is_ready && before.is_none() {
                before = Some(trace::begin_wait(self.id));
            }
            is_ready
        });
        if let Some(before) = before {
            self.enter(before);
        }
    }

    fn enter(&self, activity: Activity) -> Activity {
        trace::enter(self.id, activity)
    }

    fn take_up(&self, _size: usize) -> bool {
        trace::take_up(self.id)
    }
}

impl Machine for Simulated {
    type Word = SimulatedWord;
    type Slot<T: Copy + Send> = SimulatedSlot<T>;
    type Monitor = SimulatedMonitor;
    type Processor = VirtualProcessor;

    fn name(&self) -> &str {
        &self.model.name
    }

    fn most_processors(&self) -> usize {
        MOST
    }

    fn alloc<T: Send + Sync>(&self, n: usize, layout: Layout, make: impl FnMut(usize) -> T) -> Shared<T> {
        Shared::new(self.memory.clone(), n, layout, make)
    }

    fn monitor(&self) -> Option<SimulatedMonitor> {
        let words = || self.alloc(3, Layout::Padded, |_| SimulatedWord::new(0));
        (self.model.wake > 0).then(|| SimulatedMonitor::new(words(), self.model.wake))
    }

    fn run<L: Send>(
        &self,
        processors: usize,
        body: impl Fn(&VirtualProcessor) -> L + Sync,
    ) -> Result<Vec<L>, RunError> {
        self.check_processors(processors)?;
        if engine::is_running() {
            return Err(RunError::Busy(self.model.name.clone()));
        }
        let mut state = match self.state.try_lock() {
            Ok(state) => state,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return Err(RunError::Busy(self.model.name.clone())),
        };
        let State { engine, stacks, now } = &mut *state;
        engine.begin(self.memory.extents(), processors, *now);
        self.start[0].store(0, Ordering::Relaxed);
        self.finished[0].store(0, Ordering::Relaxed);

        let results: Vec<UnsafeCell<Option<L>>> = (0..processors).map(|_| UnsafeCell::new(None)).collect();
        let mut coroutines = Vec::with_capacity(processors);
        for (id, result) in results.iter().enumerate() {
            let stack = match stacks.pop() {
                Some(stack) => stack,
                None => {
                    DefaultStack::new(STACK).map_err(|source| RunError::System { what: "a stack", source })?
                }
            };
            let (body, machine) = (&body, self);
            // SAFETY: what the closure borrows lives until the end of this function, and the
            // coroutines are finished or dropped before.
            coroutines.push(unsafe {
                Coroutine::<(), (), (), DefaultStack>::with_stack_unchecked(stack, move |yielder, ()| {
                    engine::register(id, yielder);
                    let cpu = VirtualProcessor { id, count: processors };
                    let value = machine.gated(&cpu, || body(&cpu));
                    // The coroutine alone writes its cell, on this one host thread.
                    *result.get() = Some(value);
                })
            });
        }

        let engine: *mut Engine = engine;
        let installed = Installed::new(engine);
        let mut finished = 0;
        let mut failure = None;
        // SAFETY: coroutines borrow the engine only while they run (see `engine`), not here.
        while let Some(p) = unsafe { (*engine).pick() } {
            match catch_unwind(AssertUnwindSafe(|| coroutines[p].resume(()))) {
                Ok(CoroutineResult::Yield(())) => {}
                Ok(CoroutineResult::Return(())) => finished += 1,
                Err(payload) => {
                    let message = panic_message(&*payload);
                    failure = Some(RunError::Panicked { processor: p, message });
                    break;
                }
            }
        }
        // From here on accesses are free again, also those of destructors on abandoned stacks.
        drop(installed);
        // SAFETY: no coroutine runs any more.
        let engine = unsafe { &mut *engine };
        if failure.is_none() && finished < processors {
            let mut waiting = engine.waiting();
            waiting.truncate(16);
            failure = Some(RunError::Deadlock { waiting, finished });
        }
        *now = if failure.is_some() {
            engine.clocks.iter().copied().max().unwrap_or(*now)
        } else {
            engine.clocks[0]
        };
        for coroutine in coroutines {
            if coroutine.done() {
                stacks.push(coroutine.into_stack());
            }
            // One that is not done is dropped here, which unwinds its stack.
        }
        match failure {
            Some(failure) => Err(failure),
            None => Ok(results.into_iter().map(|r| r.into_inner().expect("all have finished")).collect()),
        }
    }

    fn alone<L: Send>(&self, body: impl FnOnce(&VirtualProcessor) -> L + Send) -> Result<L, RunError> {
        let body = Mutex::new(Some(body));
        let once = |cpu: &VirtualProcessor| {
            let body = body.lock().unwrap_or_else(|e| e.into_inner()).take();
            body.expect("one processor calls it once")(cpu)
        };
        Ok(self.run(1, once)?.pop().expect("one result"))
    }

    fn start_ticks(&self, processors: usize) -> u64 {
        // Each processor's copy of the start word, and its turn at the finishing count.
        processors as u64 * 2 * self.model.cache_to_cache + self.model.start + self.model.finish
    }

    fn start_trace(&self) -> bool {
        let mut state = self.lock();
        state.engine.tracing = Some(Tracing::new(state.now));
        true
    }

    fn take_trace(&self) -> Option<Trace> {
        let mut state = self.lock();
        let tracing = state.engine.tracing.take()?;
        Some(tracing.end(state.now))
    }

    fn charged(&self) -> Option<u64> {
        Some(self.lock().engine.statistics.charged.iter().sum())
    }

    fn now(&self) -> u64 {
        self.lock().now
    }

    fn ticks_per_nanosecond(&self) -> f64 {
        self.model.clock_mhz / 1000.0
    }
}

#[cfg(test)]
mod tests;
