//! Virtual processors in virtual time.
//!
//! Each virtual processor is a stackful coroutine with a clock. The one with the smallest (clock, id)
//! runs; only a shared access or a wait can hand over, charging private work cannot, so accesses
//! happen in exact order of virtual time and a run is the same every time.
//!
//! Invariant: no reference to the engine is alive across a suspension. Every function below takes the
//! pointer from [`CURRENT`], borrows it for a few lines, and lets go before it suspends.

use super::arena::Extent;
use super::memory::{Access, Coherence};
use super::model::Model;
use super::trace::Tracing;
use corosensei::Yielder;
use std::cell::Cell;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, VecDeque};
use std::ptr;

thread_local! {
    /// The engine whose virtual processor runs on this host thread, or null outside a run.
    static CURRENT: Cell<*mut Engine> = const { Cell::new(ptr::null_mut()) };
}

/// Bits of a heap key that hold the processor's number, the rest being the clock.
const ID_BITS: u32 = 13;

/// A kind of shared access.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Load,
    Store,
    Atomic,
    /// An atomic operation carried out by the memory that holds the word.
    AtMemory,
}

/// What the processors of a run did, summed over them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Shared accesses.
    pub accesses: u64,
    /// Transactions on the bus.
    pub transactions: u64,
    /// Cycles of private work charged, a processor.
    pub charged: Vec<u64>,
}

pub(super) struct Engine {
    pub(super) model: Model,
    pub(super) coherence: Coherence,
    pub(super) extents: Vec<Extent>,
    pub(super) clocks: Vec<u64>,
    pub(super) statistics: Statistics,
    /// The trace being made, if any.
    pub(super) tracing: Option<Tracing>,
    /// State of the generator of random delays, for schedule exploration.
    pub(super) noise: Option<u64>,
    /// Those who could run now, the current one excepted.
    ready: BinaryHeap<Reverse<u64>>,
    current: usize,
    next: Option<usize>,
    yielders: Vec<*const Yielder<(), ()>>,
    stores: Vec<VecDeque<u64>>,
    watchers: HashMap<u32, Vec<(usize, u64)>>,
    /// A processor's tickets are numbered; one that is parked holds the newest, marked here.
    tickets: Vec<u64>,
    parked: Vec<bool>,
}

// SAFETY: the yielder pointers are set and followed only within one `Simulated::run`, on its thread.
unsafe impl Send for Engine {}

impl Engine {
    pub(super) fn new(model: Model) -> Self {
        Engine {
            model,
            coherence: Coherence::new(),
            extents: Vec::new(),
            clocks: Vec::new(),
            statistics: Statistics::default(),
            tracing: None,
            noise: None,
            ready: BinaryHeap::new(),
            current: 0,
            next: None,
            yielders: Vec::new(),
            stores: Vec::new(),
            watchers: HashMap::new(),
            tickets: Vec::new(),
            parked: Vec::new(),
        }
    }

    /// Readies `processors` processors at time `now`.
    pub(super) fn begin(&mut self, extents: Vec<Extent>, processors: usize, now: u64) {
        let bytes = extents.iter().map(|e| e.before + e.end - e.start).max().unwrap_or(0);
        self.extents = extents;
        self.coherence.grow(&self.model, bytes.div_ceil(self.model.line_bytes), processors);
        self.clocks = vec![now; processors];
        self.statistics.charged = vec![0; processors];
        self.yielders = vec![ptr::null(); processors];
        self.stores = vec![VecDeque::new(); processors];
        self.parked = vec![false; processors];
        self.tickets.resize(processors.max(self.tickets.len()), 0);
        self.watchers.clear();
        if let Some(tracing) = &mut self.tracing {
            tracing.begin(processors);
        }
        self.next = None;
        self.ready.clear();
        for p in 0..processors {
            self.ready.push(Reverse(self.key(p)));
        }
    }

    fn key(&self, p: usize) -> u64 {
        self.clocks[p] << ID_BITS | p as u64
    }

    /// Who runs next, if anybody can.
    pub(super) fn pick(&mut self) -> Option<usize> {
        let next = self.next.take().or_else(|| {
            let Reverse(key) = self.ready.pop()?;
            Some((key & ((1 << ID_BITS) - 1)) as usize)
        })?;
        self.current = next;
        Some(next)
    }

    /// The processors that wait.
    pub(super) fn waiting(&self) -> Vec<usize> {
        (0..self.parked.len()).filter(|&p| self.parked[p]).collect()
    }

    fn line_of(&self, address: usize) -> Option<u32> {
        let extent = self.extents.iter().find(|e| (e.start..e.end).contains(&address))?;
        u32::try_from((extent.before + address - extent.start) / self.model.line_bytes).ok()
    }

    /// Bills one access to one line; the caller has made sure that it is this processor's turn.
    fn access(&mut self, line: u32, kind: Kind) {
        let p = self.current;
        let mut clock = self.clocks[p];
        // A machine whose memories cannot do it has the line brought.
        let kind =
            if kind == Kind::AtMemory && self.model.network.at_memory == 0 { Kind::Atomic } else { kind };
        self.statistics.accesses += 1;
        let stores = &mut self.stores[p];
        while stores.front().is_some_and(|&done| done <= clock) {
            stores.pop_front();
        }
        let access = if kind == Kind::Load { Access::Read } else { Access::Write };
        if kind == Kind::Atomic || kind == Kind::AtMemory {
            // An atomic access waits until all stores before it are visible.
            clock = clock.max(stores.back().copied().unwrap_or(0));
            stores.clear();
        } else if kind == Kind::Store && stores.len() >= self.model.store_buffer {
            clock = clock.max(stores.pop_front().unwrap_or(0));
        }
        // Buffered stores miss a few at a time (`store_misses`); a load does not wait for them.
        let stores = &self.stores[p];
        let after = match self.model.store_misses {
            at_once if kind == Kind::Store && at_once > 0 && stores.len() >= at_once => {
                stores[stores.len() - at_once]
            }
            _ => 0,
        };
        let served = if kind == Kind::AtMemory {
            self.coherence.at_memory(&self.model, (p as u16, line), clock)
        } else {
            self.coherence.access(&self.model, (p as u16, line), access, clock, after)
        };
        match kind {
            Kind::Load | Kind::AtMemory => clock = served.done,
            Kind::Atomic => clock = served.done + self.model.atomic,
            Kind::Store => {
                let stores = &mut self.stores[p];
                let before = stores.back().copied().unwrap_or(0);
                if !served.hit || before > clock {
                    stores.push_back(served.done.max(before));
                }
                clock += self.model.l1_hit;
            }
        }
        self.clocks[p] = clock;
        if access == Access::Write && self.coherence.take_watch(line) {
            self.wake(line, served.done);
        }
    }

    fn wake(&mut self, line: u32, at: u64) {
        for (p, ticket) in self.watchers.remove(&line).unwrap_or_default() {
            if self.parked[p] && self.tickets[p] == ticket {
                self.parked[p] = false;
                // Whoever looks every `poll_pause` cycles sees a change half a pause late, on average.
                self.clocks[p] = self.clocks[p].max(at + self.model.poll_pause / 2);
                self.ready.push(Reverse(self.key(p)));
            }
        }
    }

    /// A random delay of up to 1,000 cycles, now and then (SplitMix64).
    fn disturb(&mut self) {
        let Some(state) = &mut self.noise else { return };
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        if z & 3 == 0 {
            self.clocks[self.current] += z >> 2 & 1023;
        }
    }
}

/// Makes `engine` the one that bills this thread, until the guard is dropped.
pub(super) struct Installed;

impl Installed {
    pub(super) fn new(engine: *mut Engine) -> Self {
        CURRENT.set(engine);
        Installed
    }
}

impl Drop for Installed {
    fn drop(&mut self) {
        CURRENT.set(ptr::null_mut());
    }
}

/// Whether a virtual processor runs on this thread.
pub(super) fn is_running() -> bool {
    !CURRENT.get().is_null()
}

/// Does something with the engine that bills this thread, which must not suspend; nothing outside a run.
#[inline]
pub(super) fn with<R>(act: impl FnOnce(&mut Engine) -> R) -> Option<R> {
    let engine = CURRENT.get();
    // SAFETY: the engine outlives the run; nothing suspends while this borrow lasts.
    (!engine.is_null()).then(|| act(unsafe { &mut *engine }))
}

/// Remembers how processor `p` suspends itself.
pub(super) fn register(p: usize, yielder: &Yielder<(), ()>) {
    // SAFETY: `Simulated::run` keeps the engine alive and untouched while coroutines run.
    unsafe { (&mut *CURRENT.get()).yielders[p] = yielder };
}

/// Lets whoever is earlier in virtual time go first.
#[inline]
fn take_turn(engine: *mut Engine) {
    let yielder = {
        // SAFETY: the engine outlives the run; this borrow ends before the suspension below.
        let e = unsafe { &mut *engine };
        e.disturb();
        let key = e.key(e.current);
        let Some(mut top) = e.ready.peek_mut() else { return };
        if top.0 > key {
            return;
        }
        let earlier = std::mem::replace(&mut *top, Reverse(key)).0;
        drop(top);
        e.next = Some((earlier & ((1 << ID_BITS) - 1)) as usize);
        e.yielders[e.current]
    };
    // SAFETY: the yielder lives at the bottom of this very coroutine's stack.
    unsafe { (*yielder).suspend(()) };
}

/// Bills an access to `bytes` bytes at `address`.
#[inline]
pub(super) fn bill(address: usize, bytes: usize, kind: Kind) {
    let engine = CURRENT.get();
    if engine.is_null() {
        return;
    }
    take_turn(engine);
    // SAFETY: the engine outlives the run; nothing suspends while this borrow lasts.
    let e = unsafe { &mut *engine };
    let Some(first) = e.line_of(address) else {
        panic!("a shared word or slot lies outside the simulated machine's memory: use Machine::alloc");
    };
    let last = e.line_of(address + bytes.max(1) - 1).unwrap_or(first);
    for line in first..=last {
        e.access(line, kind);
    }
}

/// Bills reading `bytes` bytes at `address`, if they lie in shared memory at all.
pub(super) fn touch(address: usize, bytes: usize) {
    let engine = CURRENT.get();
    // SAFETY: as in `bill`; the borrow ends with this statement.
    if !engine.is_null() && unsafe { (*engine).line_of(address).is_some() } {
        bill(address, bytes, Kind::Load);
    }
}

/// Bills a full fence.
pub(super) fn fence() {
    let engine = CURRENT.get();
    if engine.is_null() {
        return;
    }
    // SAFETY: as in `bill`; nothing suspends here.
    let e = unsafe { &mut *engine };
    let pending = e.stores[e.current].back().copied().unwrap_or(0);
    e.stores[e.current].clear();
    let clock = &mut e.clocks[e.current];
    *clock = (*clock).max(pending) + e.model.fence;
}

/// Spends private time; with `work`, it counts as work charged.
#[inline]
pub(super) fn spend(cycles: u64, work: bool) {
    let engine = CURRENT.get();
    if engine.is_null() {
        return;
    }
    // SAFETY: as in `bill`; nothing suspends here.
    let e = unsafe { &mut *engine };
    e.clocks[e.current] += cycles;
    if work {
        e.statistics.charged[e.current] += cycles;
    }
}

/// Spends what the bookkeeping of one task costs beyond its shared accesses.
#[inline]
pub(super) fn keep_books() {
    let engine = CURRENT.get();
    if !engine.is_null() {
        // SAFETY: as in `bill`; nothing suspends here.
        let e = unsafe { &mut *engine };
        e.clocks[e.current] += e.model.task;
    }
}

/// One turn of a busy wait that watches nothing: a pause, then whoever is earlier.
pub(super) fn pause() {
    let engine = CURRENT.get();
    if engine.is_null() {
        return;
    }
    // SAFETY: as in `bill`; the borrow ends here.
    let pause = unsafe { (*engine).model.poll_pause };
    spend(pause, false);
    take_turn(engine);
}

/// Sleeps until one of the watched addresses' lines is written, unless `ready` holds.
pub(super) fn wait_until(addresses: impl Iterator<Item = usize> + Clone, mut ready: impl FnMut() -> bool) {
    let engine = CURRENT.get();
    if engine.is_null() {
        assert!(ready(), "a wait outside a run of the simulated machine would never end");
        return;
    }
    loop {
        // SAFETY: as in `bill`; the borrow ends with the statement.
        let armed = unsafe { (*engine).coherence.newest_write() };
        if ready() {
            return;
        }
        let yielder = {
            // SAFETY: the borrow ends before the suspension.
            let e = unsafe { &mut *engine };
            let missed = addresses
                .clone()
                .any(|a| e.line_of(a).is_some_and(|line| e.coherence.written_since(line, armed)));
            if missed {
                None
            } else {
                let p = e.current;
                e.tickets[p] += 1;
                e.parked[p] = true;
                for address in addresses.clone() {
                    let Some(line) = e.line_of(address) else { continue };
                    e.coherence.watch(line);
                    e.watchers.entry(line).or_default().push((p, e.tickets[p]));
                }
                Some(e.yielders[p])
            }
        };
        match yielder {
            None => pause(),
            // SAFETY: the yielder lives at the bottom of this very coroutine's stack.
            Some(yielder) => unsafe { (*yielder).suspend(()) },
        }
    }
}
