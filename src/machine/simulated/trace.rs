//! Tracing of virtual processors: marks at their own clocks. It takes no virtual time, so a traced run is the
//! same run.

use super::engine;
use crate::machine::trace::{Marks, Reading};
use crate::machine::{Activity, Trace};

/// Marks a trace has room for, shared out evenly over the processors: 64 MiB at most, taken as needed.
const ROOM: usize = 1 << 22;

/// A trace in the making.
#[derive(Debug)]
pub(super) struct Tracing {
    started: u64,
    tracks: Vec<Marks>,
}

impl Tracing {
    pub(super) fn new(started: u64) -> Self {
        Tracing { started, tracks: Vec::new() }
    }

    /// Makes room for a run on so many processors.
    pub(super) fn begin(&mut self, processors: usize) {
        while self.tracks.len() < processors {
            self.tracks.push(Marks::new(ROOM / processors));
        }
    }

    /// The trace, taken at `now`.
    pub(super) fn end(self, now: u64) -> Trace {
        let (started, end) = (self.started, now - self.started);
        let reading = Reading { ticks: |at: u64| at.saturating_sub(started), end, look: 0 };
        Trace {
            processors: self.tracks.iter().map(|track| track.spans(&reading)).collect(),
            ticks: end,
            lost: self.tracks.iter().map(Marks::lost).sum(),
        }
    }
}

/// Does something with the marks and the clock of processor `p`; nothing where no trace is being made.
fn with_track<R>(p: usize, act: impl FnOnce(&mut Marks, u64) -> R) -> Option<R> {
    engine::with(|engine| {
        let clock = engine.clocks[p];
        Some(act(&mut engine.tracing.as_mut()?.tracks[p], clock))
    })?
}

/// Marks what processor `p` does from now on; returns what it did before.
pub(super) fn enter(p: usize, activity: Activity) -> Activity {
    let before = with_track(p, |marks, now| {
        let before = marks.now();
        marks.mark(now, Some(activity));
        before
    });
    before.flatten().unwrap_or(activity)
}

/// Marks that processor `p` waits, unless it is idle or at a barrier; returns what it did before.
pub(super) fn begin_wait(p: usize) -> Activity {
    match with_track(p, |marks, _| marks.now()).flatten() {
        Some(Activity::Working | Activity::Sending) => enter(p, Activity::Waiting),
        other => other.unwrap_or(Activity::Barrier),
    }
}

/// Marks that processor `p` works, if a trace is being made; says whether it is.
pub(super) fn take_up(p: usize) -> bool {
    with_track(p, |marks, now| marks.mark(now, Some(Activity::Working))).is_some()
}
