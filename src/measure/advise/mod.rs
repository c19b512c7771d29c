//! `apportion advise`: which scheme, on how many processors, for a user's own scene.
//!
//! Steps: 1. the job is run serially over [`FRAMES`] frames of a camera path through the scene; 2. every scheme
//! runs the same frames on the simulated machine, on 2, 4, 8, … processors; for `threads` that is this
//! computer's model, fitted on the spot; 3. for `threads`, the best few run on real threads, interleaved
//! with the serial one. The answer is the fastest that was measured, or else predicted, with the fewest
//! processors within 2 % of it: one processor, where nothing is faster.

mod probe;

use super::MeasureError;
use crate::record::THREADS;
use crate::record::statistics::Interval;
use probe::Probe;
use std::fmt;

/// Frames of the probe.
pub const FRAMES: u32 = 16;
/// A gain below this is none.
const LEAST_GAIN: f64 = 1.02;
/// Schemes tried on real threads.
const CHECKED: usize = 3;

/// What is asked.
#[derive(Clone, Debug)]
pub struct Question {
    /// The job's word.
    pub job: String,
    /// A generator's name or a scene's file.
    pub scene: String,
    /// `threads`, a simulated machine's name, or its file.
    pub machine: String,
    /// How many processors there are to use at most; all the machine has where absent.
    pub processors: Option<u32>,
}

/// A scheme on so many processors.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The scheme's name.
    pub scheme: &'static str,
    /// How many processors take part.
    pub processors: u32,
    /// Speedup against serial on the simulated machine, over the frames; none for what runs on threads only.
    pub predicted: Option<Interval>,
    /// Speedup against serial on threads, over the repeats; none where it was not tried.
    pub measured: Option<Interval>,
}

impl Choice {
    /// The best that is known: measured, or else predicted.
    pub fn speedup(&self) -> Option<Interval> {
        self.measured.or(self.predicted)
    }
}

/// The answer. Its [`Display`](fmt::Display) is three lines; [`Advice::ranking`] is all of it.
#[derive(Clone, Debug)]
pub struct Advice {
    /// The machine asked for.
    pub machine: String,
    /// Processors that might have been used.
    pub available: u32,
    /// Nodes of the box tree, and its depth.
    pub tree: (usize, usize),
    /// The mean share of a node's tasks that lies under its heaviest child, 0 to 1.
    pub heaviest_share: f64,
    /// Nodes visited a frame, on average.
    pub visited: f64,
    /// A serial frame on the machine asked for, mean, nanoseconds.
    pub serial_frame: f64,
    /// All that was tried, the best first.
    pub tried: Vec<Choice>,
    /// The one to take: none for one processor.
    pub best: Option<Choice>,
    /// What `auto` reached on threads by itself.
    pub auto: Option<Interval>,
    /// What went otherwise than planned.
    pub notes: Vec<String>,
}

/// Answers the question; `progress` is told what is being tried. Takes some seconds.
///
/// # Errors
/// [`MeasureError`]: a name is unknown, the scene cannot be read, a run failed.
pub fn advise(question: &Question, progress: &mut (dyn FnMut(&str) + Send)) -> Result<Advice, MeasureError> {
    let mut probe = Probe::new(question, progress)?;
    let serial = probe.serial()?;
    let mut tried = probe.predict(progress)?;
    sort(&mut tried);
    let mut auto = None;
    if question.machine == THREADS {
        let cores = probe.cores();
        let mut checked: Vec<usize> = Vec::new();
        for (i, choice) in tried.iter().enumerate() {
            let is_new = checked.iter().all(|&other| tried[other].scheme != choice.scheme);
            if checked.len() < CHECKED && choice.processors <= cores && is_new {
                checked.push(i);
            }
        }
        auto = probe.check(&mut tried, &checked, progress)?;
        sort(&mut tried);
    }
    let best = best(&tried, question.machine == THREADS && auto.is_some()).cloned();
    Ok(Advice {
        machine: question.machine.clone(),
        available: probe.processors,
        tree: (probe.shape.nodes, probe.shape.depth),
        heaviest_share: probe.shape.mean_heaviest_share,
        visited: serial.visited,
        serial_frame: serial.frame,
        tried,
        best,
        auto,
        notes: probe.notes,
    })
}

/// Measured ones first, each lot by its speedup.
fn sort(tried: &mut [Choice]) {
    let key = |choice: &Choice| {
        let median = |of: Option<Interval>| of.map_or(f64::NEG_INFINITY, |interval| interval.median);
        (choice.measured.is_some(), median(choice.speedup()))
    };
    tried.sort_by(|a, b| {
        let (a, b) = (key(a), key(b));
        b.0.cmp(&a.0).then(b.1.total_cmp(&a.1))
    });
}

/// The fewest processors that come within 2 % of the best; none if that is no gain.
fn best(tried: &[Choice], measured_only: bool) -> Option<&Choice> {
    let speedup = |choice: &Choice| if measured_only { choice.measured } else { choice.speedup() };
    let gains =
        |choice: &&Choice| speedup(choice).is_some_and(|gain| gain.median >= LEAST_GAIN && gain.low > 1.0);
    let most = tried.iter().filter(gains).filter_map(speedup).map(|gain| gain.median).fold(0.0, f64::max);
    let near = |choice: &&Choice| speedup(choice).is_some_and(|gain| LEAST_GAIN * gain.median >= most);
    tried.iter().filter(gains).filter(near).min_by_key(|choice| choice.processors)
}

impl Advice {
    /// Everything that was tried, best first, a line each.
    pub fn ranking(&self) -> String {
        let mut text = format!("{:20} {:>10}  {:22}{}\n", "scheme", "processors", "predicted", "measured");
        let words = |interval: Option<Interval>| {
            interval
                .map_or_else(|| "-".to_owned(), |i| format!("{:.2} [{:.2}, {:.2}]", i.median, i.low, i.high))
        };
        for choice in &self.tried {
            let (predicted, measured) = (words(choice.predicted), words(choice.measured));
            text += &format!("{:20} {:>10}  {predicted:22}{measured}\n", choice.scheme, choice.processors);
        }
        if let Some(auto) = self.auto {
            text += &format!("{:20} {:>10}  {:22}{}\n", "auto", self.available, "-", words(Some(auto)));
        }
        text.trim_end().to_owned()
    }

    /// Why: the work there is, and what else was near.
    fn reason(&self) -> String {
        let (nodes, depth) = self.tree;
        let each = self.serial_frame / self.visited.max(1.0);
        let mut text = format!(
            "{:.0} of {nodes} boxes ({depth} deep) are visited a frame, {each:.0} ns each: {:.1} us",
            self.visited,
            self.serial_frame / 1000.0
        );
        let gain = |choice: &Choice| choice.speedup().map_or(0.0, |gain| gain.median);
        let Some(best) = &self.best else {
            if let Some(most) = self.tried.first() {
                text += &format!(
                    "; sharing reaches {:.2}x at best ({} on {})",
                    gain(most),
                    most.scheme,
                    most.processors
                );
            }
            return text;
        };
        let other = self.tried.iter().find(|choice| choice.scheme != best.scheme);
        if let Some(other) = other {
            text += &format!("; {} on {} reaches {:.2}x", other.scheme, other.processors, gain(other));
        }
        let more = self.tried.iter().filter(|choice| choice.processors > best.processors);
        if let Some(more) = more.max_by(|a, b| gain(a).total_cmp(&gain(b))) {
            text += &format!(", more processors {:.2}x ({})", gain(more), more.processors);
        }
        text
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.best {
            None => {
                writeln!(f, "use      one processor (scheme serial)")?;
                writeln!(f, "expect   1.00x, and no other processor kept busy")?;
            }
            Some(best) => {
                let (machine, all) = (&self.machine, self.available);
                writeln!(
                    f,
                    "use      {} on {} of {all} processors ({machine})",
                    best.scheme, best.processors
                )?;
                let gain = best.speedup().unwrap_or(Interval { median: 1.0, low: 1.0, high: 1.0 });
                let how = if best.measured.is_some() { "measured here" } else { "simulated" };
                writeln!(
                    f,
                    "expect   {:.2}x serial [{:.2}, {:.2}], {how} over {FRAMES} frames",
                    gain.median, gain.low, gain.high
                )?;
            }
        }
        write!(f, "because  {}", self.reason())?;
        for note in &self.notes {
            write!(f, "\nnote     {note}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Choice, best, sort};
    use crate::record::statistics::Interval;

    fn choice(scheme: &'static str, processors: u32, predicted: f64, measured: Option<f64>) -> Choice {
        let around = |median| Interval { median, low: 0.97 * median, high: 1.03 * median };
        Choice { scheme, processors, predicted: Some(around(predicted)), measured: measured.map(around) }
    }

    #[test]
    fn the_fewest_processors_near_the_best() {
        let tried = [
            choice("lock_free", 8, 4.00, None),
            choice("work_stealing", 4, 3.95, None),
            choice("hybrid", 2, 1.9, None),
        ];
        assert_eq!(best(&tried, false).map(|c| c.processors), Some(4));
    }

    #[test]
    fn one_processor_where_nothing_gains() {
        assert_eq!(best(&[], false), None);
        assert_eq!(best(&[choice("lock_free", 2, 1.01, None)], false), None);
        assert_eq!(best(&[choice("lock_free", 2, 0.7, None)], false), None);
        // Predicted to gain, measured not to.
        assert_eq!(best(&[choice("lock_free", 2, 1.7, Some(0.9))], true), None);
    }

    #[test]
    fn what_was_measured_goes_before_what_was_predicted() {
        let mut tried = [
            choice("lock_free", 4, 3.0, None),
            choice("hybrid", 2, 1.4, Some(1.6)),
            choice("work_stealing", 2, 1.8, Some(1.5)),
        ];
        sort(&mut tried);
        assert_eq!(tried.map(|c| c.scheme), ["hybrid", "work_stealing", "lock_free"]);
    }
}
