//! What code runs on: real threads, simulated multiprocessors, and (in `tests/loom`) a model checker.
//!
//! A scheme is written once against the traits here. Words read like std's atomics; the worker of a
//! [`Machine::run`] holds a [`Processor`]. On [`threads`] every call here compiles to what one would
//! have written by hand; on [`simulated`] each shared access is billed by a cache-coherence model.
//!
//! | machine | words are | time is |
//! |---|---|---|
//! | [`threads::Threads`] | `std` atomics | nanoseconds of the monotonic clock |
//! | [`simulated::Simulated`] | cells billed by line | cycles of the simulated clock |
//! | loom (tests only) | loom's atomics | not kept |

use std::fmt;
use std::sync::atomic::Ordering;

pub mod handoff;
mod monitor;
mod seats;
mod shared;
pub mod simulated;
pub mod threads;
mod trace;

pub use monitor::Monitor;
pub use seats::{Claim, Seats};
pub use shared::{Arena, Layout, Shared};
pub use simulated::Simulated;
pub use threads::Threads;
pub use trace::{Activity, Span, Trace};

/// A 64-bit atomic word in memory shared by the processors of one machine.
pub trait Word: Send + Sync + Sized {
    /// A word that holds `value`.
    fn new(value: u64) -> Self;
    /// Reads the word.
    fn load(&self, order: Ordering) -> u64;
    /// Writes the word.
    fn store(&self, value: u64, order: Ordering);
    /// Writes the word and returns what it held.
    fn swap(&self, value: u64, order: Ordering) -> u64;
    /// Adds to the word, wrapping, and returns what it held.
    fn fetch_add(&self, value: u64, order: Ordering) -> u64;
    /// Subtracts from the word, wrapping, and returns what it held.
    fn fetch_sub(&self, value: u64, order: Ordering) -> u64 {
        self.fetch_add(value.wrapping_neg(), order)
    }
    /// As [`Word::fetch_add`], carried out by the memory that holds the word where the machine can do that: no
    /// copy of its line travels, so a word that everybody draws from is not handed from cache to cache. Such a word
    /// should lie on lines of its own and be read seldom.
    #[inline]
    fn fetch_add_at_memory(&self, value: u64, order: Ordering) -> u64 {
        self.fetch_add(value, order)
    }
    /// Writes `new` if the word holds `current`.
    ///
    /// # Errors
    /// What the word held, if that was not `current`.
    fn compare_exchange(
        &self,
        current: u64,
        new: u64,
        success: Ordering,
        failure: Ordering,
    ) -> Result<u64, u64>;
    /// Sets the word to 1 and says whether it was set before: the `ldstub` of SPARC, on which
    /// Paper II builds its locks.
    fn test_and_set(&self, order: Ordering) -> bool {
        self.swap(1, order) != 0
    }
    /// A memory fence of this machine.
    fn fence(order: Ordering);
}

/// Plain shared storage: whoever uses it has arranged that no two processors race on it. A race on a
/// slot is a bug, which the model checker reports.
pub trait Slot<T: Copy + Send>: Send + Sync {
    /// A slot that holds `value`.
    fn new(value: T) -> Self;
    /// Reads the slot.
    ///
    /// # Safety
    /// No other processor may be writing the slot.
    unsafe fn read(&self) -> T;
    /// Writes the slot.
    ///
    /// # Safety
    /// No other processor may be reading or writing the slot.
    unsafe fn write(&self, value: T);
}

/// What a worker holds while it runs: who it is, and the ways to spend time.
pub trait Processor {
    /// The word of its machine.
    type Word: Word;
    /// Whether a task looked into for a timeline is marked within too: what a scheme does with the tasks it
    /// emits, at once, is then sending and not work. Natively it stays work, as even the branches take time.
    const MARKS_WITHIN: bool = false;
    /// This processor's number, `0 .. count()`.
    fn id(&self) -> usize;
    /// How many processors take part in this run.
    fn count(&self) -> usize;
    /// Spends `cycles` of private work. Costs nothing natively, where the work itself takes its time.
    fn charge(&self, cycles: u64);
    /// Reads shared read-only data of `T`'s size. Costs nothing natively. Data that was not allocated
    /// from the machine is private and costs nothing anywhere.
    fn touch<T>(&self, data: &T);
    /// Spends what the private bookkeeping of one task costs. Costs nothing natively, where the code
    /// around a visit takes its own time.
    #[inline(always)]
    fn keep_books(&self) {}
    /// One turn of a busy wait. It ends the worker (by unwinding) when another worker has panicked,
    /// so that no wait outlives a failed run.
    fn spin(&self);
    /// Waits until `ready` says so. `ready` may change its answer only through a write to one of
    /// `words`: a simulated processor sleeps until one of their lines is written.
    fn wait_until(&self, words: &[&Self::Word], ready: impl FnMut() -> bool);
    /// Says what this processor does from now on, for a timeline; returns what it did before. It costs a
    /// branch where no trace is being made, and no virtual time anywhere.
    #[inline(always)]
    fn enter(&self, activity: Activity) -> Activity {
        activity
    }
    /// Takes up a task that stands for up to `size` tasks: from now on this processor works. Says whether the
    /// task is looked into, that is, whether its end is to be marked with [`Processor::enter`]. Never, where
    /// no trace is being made; a machine on which marks take time lets short tasks pass, and counts the
    /// time between them as part of them.
    #[inline(always)]
    fn take_up(&self, _size: usize) -> bool {
        false
    }
    /// Runs `body` as an activity, and goes back to what was done before.
    #[inline]
    fn during<R>(&self, activity: Activity, body: impl FnOnce() -> R) -> R {
        let before = self.enter(activity);
        let result = body();
        self.enter(before);
        result
    }
}

/// Why a run on a machine failed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A worker panicked; the others were ended.
    #[error("processor {processor} panicked: {message}")]
    Panicked {
        /// Which processor.
        processor: usize,
        /// The panic's message.
        message: String,
    },
    /// Every virtual processor waits for another.
    #[error("deadlock: processors {waiting:?} all wait, {finished} have finished")]
    Deadlock {
        /// Who waits (the first 16).
        waiting: Vec<usize>,
        /// How many have finished.
        finished: usize,
    },
    /// The number of processors is out of range.
    #[error("{asked} processors asked of machine `{machine}`, which takes 1 to {most}")]
    Processors {
        /// How many were asked for.
        asked: usize,
        /// The most there can be.
        most: usize,
        /// The machine's name.
        machine: String,
    },
    /// The machine is running already: runs cannot be nested or overlap.
    #[error("machine `{0}` is already running: runs of one machine can neither nest nor overlap")]
    Busy(String),
    /// The operating system refused a thread or a stack.
    #[error("the operating system refused {what}: {source}")]
    System {
        /// What was asked for.
        what: &'static str,
        /// Its answer.
        source: std::io::Error,
    },
}

/// A set of processors with shared memory.
pub trait Machine: Sync {
    /// Its atomic word.
    type Word: Word;
    /// Its plain shared storage.
    type Slot<T: Copy + Send>: Slot<T>;
    /// What its operating system offers to sleep on.
    type Monitor: Monitor<Self::Processor>;
    /// What a worker of it holds.
    type Processor: Processor<Word = Self::Word>;

    /// The machine's name: the word of the command line, the value in rows, the chart's legend.
    fn name(&self) -> &str;
    /// Whether this machine is made of real threads, on which rivals from other libraries can run.
    fn is_native(&self) -> bool {
        false
    }
    /// The most processors a run may ask for.
    fn most_processors(&self) -> usize;
    /// Allocates `n` values in the machine's shared memory, laid out as asked. Addresses are real:
    /// they decide which coherence line a value lies in.
    fn alloc<T: Send + Sync>(&self, n: usize, layout: Layout, make: impl FnMut(usize) -> T) -> Shared<T>;
    /// A monitor with the value 0; none where nobody has said how long this machine's system takes to wake a
    /// sleeper.
    fn monitor(&self) -> Option<Self::Monitor>;
    /// Runs `body` once on each of `processors` processors, this thread being processor 0, and
    /// returns what they returned, in order.
    ///
    /// # Errors
    /// [`RunError`]: a panic on one processor ends the run as an error, never as a hang.
    fn run<L: Send>(
        &self,
        processors: usize,
        body: impl Fn(&Self::Processor) -> L + Sync,
    ) -> Result<Vec<L>, RunError>;
    /// Runs `body` on processor 0 alone, with as little ado as the machine can.
    ///
    /// # Errors
    /// [`RunError::Panicked`].
    fn alone<L: Send>(&self, body: impl FnOnce(&Self::Processor) -> L + Send) -> Result<L, RunError>;
    /// The machine's clock between runs, in ticks.
    fn now(&self) -> u64;
    /// Roughly what it costs, in ticks, to start and end an empty run on `processors` processors as the
    /// machine is now: what work must be able to save before sharing it is even tried.
    fn start_ticks(&self, processors: usize) -> u64;
    /// Ticks of work charged in the last run, summed over its processors, where the machine counts them:
    /// what is left of their time went into finding and handing over tasks (P2-24).
    fn charged(&self) -> Option<u64> {
        None
    }
    /// Starts a record of what each processor does, in place of one that was not taken; says whether this
    /// machine can make one. No run may be going on.
    fn start_trace(&self) -> bool {
        false
    }
    /// Ends the record and returns it; none if none was started. No run may be going on.
    fn take_trace(&self) -> Option<Trace> {
        None
    }
    /// A handle for one of the threads of a rival library, which this machine does not run.
    fn outside(&self, processor: usize, processors: usize) -> threads::Thread {
        threads::Thread::outside(processor, processors)
    }
    /// Ticks a nanosecond: 1 natively, the clock rate in GHz on a simulated machine.
    fn ticks_per_nanosecond(&self) -> f64 {
        1.0
    }
    /// Checks a number of processors.
    ///
    /// # Errors
    /// [`RunError::Processors`] for 0 and for more than [`Machine::most_processors`].
    fn check_processors(&self, asked: usize) -> Result<(), RunError> {
        let most = self.most_processors();
        if asked == 0 || asked > most {
            return Err(RunError::Processors { asked, most, machine: self.name().to_owned() });
        }
        Ok(())
    }
}

/// The text of a panic's payload.
pub(crate) fn panic_message(payload: &(dyn std::any::Any + Send)) -> String {
    if let Some(text) = payload.downcast_ref::<&str>() {
        (*text).to_owned()
    } else if let Some(text) = payload.downcast_ref::<String>() {
        text.clone()
    } else {
        "(a panic without a message)".to_owned()
    }
}

/// The payload with which a worker is ended after another one failed. It is raised with
/// `resume_unwind`, so the panic hook prints nothing for it.
pub(crate) struct Ended;

impl fmt::Debug for Ended {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("ended because another worker failed")
    }
}
