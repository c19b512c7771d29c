//! One frame of each cell traced: that of median time, as the one that stands for the others.
//!
//! Rows are taken without a trace. After a cell's first measured path the path is gone through once more, with
//! a trace of each frame, of which the one is kept whose time comes nearest to the median of those measured.
//! A simulated cell does that on a machine of its own, fresh as the first was: its time is exactly the
//! median's. That costs a path more a cell, and keeps memory and file to one frame a cell.

use super::{Cell, MeasureError, Options, Sample, Subject, SubjectCache, subject};
use crate::machine::{Activity, Span, Trace};
use crate::record::{Stretch, TracedFrame};
use std::cell::RefCell;
use std::rc::Rc;

/// Gathers a frame of each cell that is opened through it.
#[derive(Debug, Default)]
pub struct Tracer {
    frames: Rc<RefCell<Vec<TracedFrame>>>,
}

impl Tracer {
    /// Makes a cell ready to run, as [`subject::open`] does, and to be traced on the way.
    ///
    /// # Errors
    /// As [`subject::open`].
    pub fn open(
        &self,
        cell: &Cell,
        options: &Options,
        cache: &mut SubjectCache,
    ) -> Result<Box<dyn Subject>, MeasureError> {
        // Threads are warmed up by a path that is not recorded; what is traced comes after their second.
        let (twin, paths) = match cell.is_simulated() {
            true => (Some(subject::open(cell, options, cache)?), 1),
            false => (None, 2),
        };
        let subject = subject::open(cell, options, cache)?;
        let frames = Rc::clone(&self.frames);
        Ok(Box::new(Traced { subject, twin, paths, cell: cell.clone(), frames }))
    }

    /// The frames gathered, in the order in which their cells ran.
    pub fn take(&self) -> Vec<TracedFrame> {
        self.frames.take()
    }
}

/// A subject that is traced after a number of paths.
struct Traced {
    subject: Box<dyn Subject>,
    /// The same once more, to trace, where the path must begin as the first did.
    twin: Option<Box<dyn Subject>>,
    /// Paths until then.
    paths: u32,
    cell: Cell,
    frames: Rc<RefCell<Vec<TracedFrame>>>,
}

impl Subject for Traced {
    fn sample(&mut self, repeat: u32) -> Result<Vec<Sample>, MeasureError> {
        let samples = self.subject.sample(repeat)?;
        if self.paths == 1
            && let Some(median) = median_frame(&samples)
        {
            let subject = self.twin.as_mut().unwrap_or(&mut self.subject);
            let found = subject.trace(median)?;
            self.frames.borrow_mut().extend(found.map(|found| in_words(&self.cell, found)));
            self.twin = None;
        }
        self.paths = self.paths.saturating_sub(1);
        Ok(samples)
    }
}

/// The median of the frame times, ns: the lower of the two in the middle, so that some frame took just that.
fn median_frame(samples: &[Sample]) -> Option<f64> {
    let times = samples.iter().filter(|sample| sample.metric == "frame_time").map(|sample| sample.value);
    let mut times: Vec<f64> = times.collect();
    times.sort_by(f64::total_cmp);
    times.get(times.len().saturating_sub(1) / 2).copied()
}

/// A frame's trace, and how to read it.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameTrace {
    /// The frame, from 0.
    pub frame: u32,
    /// What each processor did.
    pub trace: Trace,
    /// Nanoseconds a tick of the trace.
    pub tick: f64,
}

/// Of the frames of a path that whose time comes nearest to a given one.
pub(super) struct Nearest {
    time: f64,
    distance: f64,
    found: Option<FrameTrace>,
}

impl Nearest {
    /// Looks for a frame of `time` ns.
    pub(super) fn new(time: f64) -> Self {
        Nearest { time, distance: f64::INFINITY, found: None }
    }

    /// Looks at a frame that took `time` ns; says whether it is met exactly.
    pub(super) fn look(&mut self, time: f64, frame: usize, trace: Option<Trace>, tick: f64) -> bool {
        let distance = (time - self.time).abs();
        if distance < self.distance
            && let (Some(trace), Ok(frame)) = (trace, u32::try_from(frame))
        {
            self.distance = distance;
            self.found = Some(FrameTrace { frame, trace, tick });
        }
        distance == 0.0
    }

    /// The nearest of those looked at.
    pub(super) fn found(self) -> Option<FrameTrace> {
        self.found
    }
}

/// The frame as a viewer is told of it.
fn in_words(cell: &Cell, found: FrameTrace) -> TracedFrame {
    let FrameTrace { frame, trace, tick } = found;
    let stretch = |span: &Span| Stretch {
        name: span.activity.name(),
        start: span.start as f64 * tick,
        end: span.end as f64 * tick,
        estimated: span.estimated,
    };
    let mut processors: Vec<Vec<Stretch>> =
        trace.processors.iter().map(|spans| spans.iter().map(stretch).collect()).collect();
    let time = trace.ticks as f64 * tick;
    while processors.len() < cell.processors as usize {
        // A scheme may have left it out of this frame.
        let name = Activity::Idle.name();
        processors.push(vec![Stretch { name, start: 0.0, end: time, estimated: false }]);
    }
    let key = cell.key(0);
    let words = [key.scheme.as_str(), key.settings.as_str()].join(" ");
    let cell = format!("{} on {}, P={}, {}", words.trim_end(), key.machine, key.processors, key.scene);
    TracedFrame { cell, frame, time, processors, lost: trace.lost }
}
