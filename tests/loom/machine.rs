//! A machine of loom's words and threads.

use crate::mutant::{self, Mutant};
use apportion::machine::{Arena, Layout, Machine, Monitor, Processor, RunError, Shared, Slot, Word};
use loom::cell::UnsafeCell;
use loom::sync::atomic::AtomicU64;
use loom::sync::{Condvar, Mutex};
use std::alloc::{Layout as Bytes, alloc, dealloc, handle_alloc_error};
use std::cell::Cell;
use std::ptr::NonNull;
use std::sync::Arc;
use std::sync::atomic::Ordering;

thread_local! {
    /// Whether a run is going on, as opposed to its preparation.
    static RUNNING: Cell<bool> = const { Cell::new(false) };
    /// Whether the word being made is the first of two.
    static FIRST_OF_TWO: Cell<bool> = const { Cell::new(false) };
    /// The machine's clock.
    static NOW: Cell<u64> = const { Cell::new(0) };
    /// Runs on more than one processor in this execution.
    static SHARED_RUNS: Cell<u32> = const { Cell::new(0) };
}

/// The machine. Its time goes by a thousand ticks from look to look.
#[derive(Debug)]
pub(crate) struct Loom;

impl Loom {
    /// The machine at the start of an execution.
    pub(crate) fn new() -> Self {
        RUNNING.set(false);
        NOW.set(0);
        SHARED_RUNS.set(0);
        Loom
    }

    /// Runs on more than one processor since the execution began.
    pub(crate) fn shared_runs(&self) -> u32 {
        SHARED_RUNS.get()
    }
}

/// An atomic word under loom.
#[derive(Debug)]
pub(crate) struct LoomWord {
    word: AtomicU64,
    first_of_two: bool,
}

/// What the machine makes of an ordering.
fn access(order: Ordering) -> Ordering {
    if mutant::is(Mutant::Relaxed) { Ordering::Relaxed } else { order }
}

/// Whether a failed execution is being unwound: then loom is not to be called any more.
fn is_failing() -> bool {
    std::thread::panicking()
}

impl LoomWord {
    fn modify(&self, order: Ordering, new: impl Fn(u64) -> Option<u64>) -> Result<u64, u64> {
        if is_failing() {
            return Ok(0);
        }
        // ORDERING: what the caller asks for, or what the mutant makes of it.
        if mutant::is(Mutant::Torn) {
            let old = self.word.load(Ordering::Acquire);
            let new = new(old).ok_or(old)?;
            self.word.store(new, Ordering::Release);
            return Ok(old);
        }
        self.word.fetch_update(access(order), Ordering::Acquire, new)
    }
}

impl Word for LoomWord {
    fn new(value: u64) -> Self {
        LoomWord { word: AtomicU64::new(value), first_of_two: FIRST_OF_TWO.get() }
    }

    // ORDERING: each method takes its ordering from the caller, who names the partner.
    fn load(&self, order: Ordering) -> u64 {
        if is_failing() { 0 } else { self.word.load(access(order)) }
    }

    fn store(&self, value: u64, order: Ordering) {
        let lost = RUNNING.get()
            && (mutant::is(Mutant::NeverBusy) && value == u64::MAX
                || mutant::is(Mutant::LostHead) && self.first_of_two);
        if !lost && !is_failing() {
            self.word.store(value, access(order));
        }
    }

    fn swap(&self, value: u64, order: Ordering) -> u64 {
        if mutant::is(Mutant::Torn) || is_failing() {
            return self.modify(order, |_| Some(value)).unwrap_or(0);
        }
        self.word.swap(value, access(order))
    }

    fn fetch_add(&self, value: u64, order: Ordering) -> u64 {
        if mutant::is(Mutant::Torn) || is_failing() {
            return self.modify(order, |old| Some(old.wrapping_add(value))).unwrap_or(0);
        }
        self.word.fetch_add(value, access(order))
    }

    fn compare_exchange(
        &self,
        current: u64,
        new: u64,
        success: Ordering,
        failure: Ordering,
    ) -> Result<u64, u64> {
        if mutant::is(Mutant::Torn) || is_failing() {
            return self.modify(success, |old| (old == current).then_some(new));
        }
        self.word.compare_exchange(current, new, access(success), access(failure))
    }

    /// By compare-exchange: waiters that keep writing never let loom come to an end.
    fn test_and_set(&self, order: Ordering) -> bool {
        let was_set = self.compare_exchange(0, 1, order, Ordering::Relaxed).is_err();
        was_set && !mutant::is(Mutant::AlwaysFree)
    }

    fn fence(order: Ordering) {
        if !mutant::is(Mutant::NoFence) && !is_failing() {
            loom::sync::atomic::fence(order);
        }
    }
}

/// Plain storage on which loom reports races.
#[derive(Debug)]
pub(crate) struct LoomSlot<T>(UnsafeCell<T>);

// SAFETY: loom watches that nobody races on the cell, which is what these tests are about.
unsafe impl<T: Send> Sync for LoomSlot<T> {}

impl<T: Copy + Send> Slot<T> for LoomSlot<T> {
    fn new(value: T) -> Self {
        LoomSlot(UnsafeCell::new(value))
    }

    unsafe fn read(&self) -> T {
        // SAFETY: loom's threads share one thread of the system, and loom reports races.
        self.0.with(|value| unsafe { *value })
    }

    unsafe fn write(&self, value: T) {
        // SAFETY: as in `read`.
        self.0.with_mut(|place| unsafe { *place = value });
    }
}

/// A worker's handle.
#[derive(Debug)]
pub(crate) struct LoomProcessor {
    id: usize,
    count: usize,
    /// Turns it has waited in this run.
    turns: Cell<u32>,
}

impl LoomProcessor {
    fn new(id: usize, count: usize) -> Self {
        LoomProcessor { id, count, turns: Cell::new(0) }
    }

    /// A turn of a wait. After a number of them an execution is only run to its end, and not varied any
    /// more: loom would vary the turns of two waiters without end while a third could go on.
    fn turn(&self) {
        self.turns.set(self.turns.get() + 1);
        if self.turns.get() > if self.count > 2 { 4 } else { 20 } {
            loom::skip_branch();
        }
        loom::thread::yield_now();
    }
}

impl Processor for LoomProcessor {
    type Word = LoomWord;

    fn id(&self) -> usize {
        self.id
    }

    fn count(&self) -> usize {
        self.count
    }

    fn charge(&self, _cycles: u64) {}

    fn touch<T>(&self, _data: &T) {}

    fn spin(&self) {
        self.turn();
    }

    fn wait_until(&self, words: &[&LoomWord], mut ready: impl FnMut() -> bool) {
        if mutant::is(Mutant::NoWait) {
            return;
        }
        loop {
            let before = if mutant::is(Mutant::FirstWordOnly) { words.first() } else { None }
                .map(|word| (word, word.load(Ordering::Acquire)));
            if ready() {
                return;
            }
            self.turn();
            if let Some((word, before)) = before {
                while word.load(Ordering::Acquire) == before {
                    self.turn();
                }
            }
        }
    }
}

/// A value under loom's mutex, with its condition variable.
#[derive(Debug)]
pub(crate) struct LoomMonitor {
    value: Mutex<u64>,
    changed: Condvar,
}

impl Monitor<LoomProcessor> for LoomMonitor {
    fn pass(&self, _: &LoomProcessor, change: impl FnOnce(u64) -> u64, may_go: impl Fn(u64, u64) -> bool) {
        if is_failing() {
            return;
        }
        let mut value = self.value.lock().expect("a panic ends the model");
        let before = *value;
        *value = change(before);
        if may_go(before, *value) {
            self.changed.notify_all();
            return;
        }
        while !mutant::is(Mutant::NoWait) && !may_go(before, *value) {
            value = self.changed.wait(value).expect("a panic ends the model");
        }
    }

    fn reset(&self) {
        *self.value.lock().expect("a panic ends the model") = 0;
    }
}

struct Heap;

impl Arena for Heap {
    fn take(&self, bytes: Bytes) -> NonNull<u8> {
        // SAFETY: a shared allocation never has size zero.
        NonNull::new(unsafe { alloc(bytes) }).unwrap_or_else(|| handle_alloc_error(bytes))
    }

    unsafe fn give_back(&self, block: NonNull<u8>, bytes: Bytes) {
        // SAFETY: the caller hands back what `take` gave, with its layout.
        unsafe { dealloc(block.as_ptr(), bytes) }
    }
}

type Body<'a> = Box<dyn FnOnce() + Send + 'a>;

/// One result cell a processor, written by it alone.
struct Results<L>(Vec<std::cell::UnsafeCell<Option<L>>>);

// SAFETY: processor `p` alone writes cell `p`; the caller reads after all have been joined.
unsafe impl<L: Send> Sync for Results<L> {}

impl<L> Results<L> {
    fn set(&self, p: usize, value: L) {
        // SAFETY: processor `p` alone writes cell `p`.
        unsafe { *self.0[p].get() = Some(value) };
    }
}

impl Machine for Loom {
    type Word = LoomWord;
    type Slot<T: Copy + Send> = LoomSlot<T>;
    type Monitor = LoomMonitor;
    type Processor = LoomProcessor;

    fn name(&self) -> &str {
        "loom"
    }

    fn most_processors(&self) -> usize {
        4
    }

    fn alloc<T: Send + Sync>(&self, n: usize, layout: Layout, mut make: impl FnMut(usize) -> T) -> Shared<T> {
        let shared = Shared::new(Arc::new(Heap), n, layout, |i| {
            FIRST_OF_TWO.set(n == 2 && i == 0);
            make(i)
        });
        FIRST_OF_TWO.set(false);
        shared
    }

    fn monitor(&self) -> Option<LoomMonitor> {
        Some(LoomMonitor { value: Mutex::new(0), changed: Condvar::new() })
    }

    fn run<L: Send>(
        &self,
        processors: usize,
        body: impl Fn(&LoomProcessor) -> L + Sync,
    ) -> Result<Vec<L>, RunError> {
        self.check_processors(processors)?;
        SHARED_RUNS.set(SHARED_RUNS.get() + u32::from(processors > 1));
        RUNNING.set(true);
        let results = Results((0..processors).map(|_| std::cell::UnsafeCell::new(None)).collect());
        let one = |id| results.set(id, body(&LoomProcessor::new(id, processors)));
        let helpers: Vec<_> = (1..processors)
            .map(|id| {
                let one = &one;
                let helper: Body<'_> = Box::new(move || one(id));
                // SAFETY: this only erases the lifetime. All helpers are joined before this function
                // returns; if it unwinds, loom has given up the execution and resumes none of them.
                let helper = unsafe { std::mem::transmute::<Body<'_>, Body<'static>>(helper) };
                loom::thread::spawn(helper)
            })
            .collect();
        one(0);
        for helper in helpers {
            helper.join().expect("a panic ends the model");
        }
        RUNNING.set(false);
        Ok(results.0.into_iter().map(|cell| cell.into_inner().expect("all have finished")).collect())
    }

    fn alone<L: Send>(&self, body: impl FnOnce(&LoomProcessor) -> L + Send) -> Result<L, RunError> {
        Ok(body(&LoomProcessor::new(0, 1)))
    }

    fn now(&self) -> u64 {
        NOW.set(NOW.get() + 1000);
        NOW.get()
    }

    fn start_ticks(&self, _processors: usize) -> u64 {
        0
    }
}
