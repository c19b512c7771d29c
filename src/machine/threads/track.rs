//! Tracing of real threads: who marks what, when, at which price.
//!
//! Invariant: a track (a fixed buffer of marks) belongs to one worker for the length of a run. It is lent from
//! its home before the run and goes home after it, also when the worker unwinds, so that a mark takes neither
//! a lock nor an allocation.
//!
//! A look at the clock takes some ten nanoseconds and a task may take no longer. So a worker looks into one
//! task of so many that looking takes less than a hundredth of its time: 1. it marks the start of a task, its
//! end, and the start of the next; 2. from how long that took it reckons how many tasks to let pass, one
//! unmarked stretch; 3. it looks into the next. Long tasks are looked into one by one, and so are those that
//! stand for more than [`LARGE`] tasks, as they say nothing about others. What was work and what was sending
//! in an unmarked stretch is told from the tasks looked into. Waits are always marked: who waits has the time.

use crate::machine::trace::{Marks, Reading};
use crate::machine::{Activity, Trace};
use quanta::Clock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock};

/// Marks a worker has room for between taking one trace and the next: 256 KiB.
const ROOM: usize = 1 << 14;
/// How much time, in nanoseconds, goes by for each task looked into, where tasks are short.
const CYCLE: u64 = 16_000;
/// A task that may stand for more tasks than this is always looked into.
pub(super) const LARGE: usize = 64;
/// Tasks let pass at once, however short they are.
const MOST_PASSED: u64 = 512;

/// The marks of one worker, and what it needs to make them.
#[derive(Debug)]
struct Track {
    marks: Marks,
    clock: Clock,
    /// [`CYCLE`] in the clock's own units.
    cycle: u64,
    /// When the task looked into last began; none once it has been seen to its end.
    looked: Option<u64>,
    /// Whether tasks are let pass now.
    passing: bool,
}

/// Where a track is while nobody uses it.
type Home = Mutex<Option<Box<Track>>>;

/// A track out of its home; dropping it marks the end of the worker's part and sends it back.
#[derive(Debug)]
pub(super) struct Lent {
    track: Option<Box<Track>>,
    home: Arc<Home>,
}

impl Lent {
    fn track(&mut self) -> &mut Track {
        self.track.as_mut().expect("it goes home when it is dropped")
    }

    /// What is being done now; sending, where tasks are let pass.
    pub(super) fn now(&self) -> Activity {
        self.track.as_ref().and_then(|track| track.marks.now()).unwrap_or(Activity::Sending)
    }

    /// Marks a change of activity; returns what was done before.
    pub(super) fn enter(&mut self, activity: Activity) -> Activity {
        let last = self.now();
        let track = self.track();
        let part_of_a_task = matches!(activity, Activity::Working | Activity::Sending);
        let now = track.clock.raw();
        track.marks.mark(now, if track.passing && part_of_a_task { None } else { Some(activity) });
        last
    }

    /// Marks the start of a task that stands for up to `size`, or of a stretch of tasks to let pass; returns
    /// how many those are, 0 for a task to look into.
    pub(super) fn take_up(&mut self, size: usize) -> u32 {
        let track = self.track();
        let now = track.clock.raw();
        let pass = match track.looked.take() {
            Some(since) if size <= LARGE => (track.cycle / now.saturating_sub(since).max(1)).min(MOST_PASSED),
            _ => 0,
        };
        track.passing = pass > 0;
        if !track.passing {
            track.looked = Some(now);
        }
        track.marks.mark(now, if track.passing { None } else { Some(Activity::Working) });
        pass as u32
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        if let Some(mut track) = self.track.take() {
            track.marks.mark(track.clock.raw(), Some(Activity::Barrier));
            *open(&self.home) = Some(track);
        }
    }
}

/// The tracks of a team, and whether it is being traced.
#[derive(Debug, Default)]
pub(super) struct Tracks {
    on: AtomicBool,
    desk: OnceLock<Desk>,
}

#[derive(Debug)]
struct Desk {
    clock: Clock,
    /// What a look at the clock takes, ns.
    look: u64,
    homes: Vec<Arc<Home>>,
    /// When the trace was started, in the clock's own units.
    started: Mutex<u64>,
}

impl Desk {
    fn new(processors: usize) -> Self {
        let clock = Clock::new();
        let looks = (0..100).map(|_| (clock.raw(), clock.raw()));
        let look = looks.map(|(one, next)| clock.delta_as_nanos(one, next)).min().unwrap_or(0);
        // Nanoseconds a billion units of the clock, so that the division below loses nothing.
        let billion = clock.delta_as_nanos(0, 1_000_000_000).max(1);
        let cycle = CYCLE * 1_000_000_000 / billion;
        let home = |_| {
            let (marks, clock) = (Marks::new(ROOM).with_memory(), clock.clone());
            let track = Track { marks, clock, cycle, looked: None, passing: false };
            Arc::new(Mutex::new(Some(Box::new(track))))
        };
        Desk { look, homes: (0..processors).map(home).collect(), started: Mutex::new(0), clock }
    }
}

impl Tracks {
    /// Starts a trace of up to so many processors; the first one sets up clock and buffers.
    pub(super) fn start(&self, processors: usize) {
        let desk = self.desk.get_or_init(|| Desk::new(processors));
        for home in &desk.homes {
            if let Some(track) = &mut *open(home) {
                track.marks.clear();
                (track.looked, track.passing) = (None, false);
            }
        }
        // ORDERING: Relaxed: the flag carries no data; a run's posts publish what was set up before.
        self.on.store(true, Ordering::Relaxed);
        *open(&desk.started) = desk.clock.raw();
    }

    /// Ends the trace; none if none was started.
    pub(super) fn take(&self) -> Option<Trace> {
        // ORDERING: Relaxed: as above; the marks travel through the homes' locks.
        if !self.on.swap(false, Ordering::Relaxed) {
            return None;
        }
        let desk = self.desk.get()?;
        let (end, start) = (desk.clock.raw(), *open(&desk.started));
        let ticks = |at| desk.clock.delta_as_nanos(start, at);
        let reading = Reading { end: ticks(end), look: desk.look, ticks };
        let mut trace = Trace { ticks: reading.end, ..Trace::default() };
        for home in &desk.homes {
            if let Some(track) = &*open(home) {
                trace.lost += track.marks.lost();
                trace.processors.push(track.marks.spans(&reading));
            }
        }
        Some(trace)
    }

    /// Whether a trace is being made.
    pub(super) fn are_on(&self) -> bool {
        // ORDERING: Relaxed: the flag carries no data.
        self.on.load(Ordering::Relaxed)
    }

    /// Lends a processor its track, which begins with `activity`; none where no trace is being made.
    pub(super) fn lend(&self, processor: usize, activity: Activity) -> Option<Lent> {
        if !self.are_on() {
            return None;
        }
        let home = self.desk.get()?.homes.get(processor)?;
        let mut track = open(home).take()?;
        track.marks.mark(track.clock.raw(), Some(activity));
        Some(Lent { track: Some(track), home: home.clone() })
    }
}

/// Takes a lock that nobody holds for long; what it guards is whole whatever happened to its last holder.
fn open<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|e| e.into_inner())
}
