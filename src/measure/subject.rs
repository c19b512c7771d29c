//! What is measured: the way from a cell to the job, scheme and machine it names.

use super::{Cell, MeasureError, Options};

/// One number a subject took.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// The metric's name, declared in [`METRICS`](crate::record::METRICS).
    pub metric: &'static str,
    /// The frame, from 0; none for a number of the whole camera path.
    pub frame: Option<u32>,
    /// The number, in the metric's unit.
    pub value: f64,
}

/// A cell made ready to run, as often as the plan has repeats.
pub trait Subject {
    /// Runs the whole camera path once and returns what it took: a `frame_time` for each frame at least.
    ///
    /// # Errors
    /// The run failed, or its result is not the oracle's.
    fn sample(&mut self, repeat: u32) -> Result<Vec<Sample>, MeasureError>;
}

/// The names there are: what experiments and the command line may ask for.
#[derive(Clone, Debug)]
pub struct Known {
    /// Words of the jobs.
    pub jobs: Vec<String>,
    /// Words of the schemes.
    pub schemes: Vec<String>,
    /// Words of the machines, real and simulated.
    pub machines: Vec<String>,
    /// Whether a scheme can run on a machine with so many processors; a plan leaves out what cannot.
    pub fits: fn(scheme: &str, machine: &str, processors: u32) -> bool,
}

impl Known {
    /// All that this version knows.
    pub fn here() -> Self {
        let words = |list: &[&str]| list.iter().map(|word| (*word).to_owned()).collect();
        Self {
            jobs: words(&["cull", "tree"]),
            schemes: words(&[
                "serial",
                "global_queue",
                "global_counter",
                "hybrid",
                "lock_free",
                "receiver_initiated",
                "work_stealing",
                "rayon",
            ]),
            machines: words(&["threads", "e4000", "pentium3x2", "host"]),
            fits: |_, _, _| true,
        }
    }
}

/// What cells share and is dear to make: scenes, structures, teams of threads.
#[derive(Debug, Default)]
pub struct SubjectCache {}

/// Makes a cell ready to run.
///
/// # Errors
/// The cell's job, scene, scheme, settings or machine cannot be had.
pub fn open(
    cell: &Cell,
    _options: &Options,
    _cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    Err(MeasureError::Failed(format!("job `{}` cannot be run yet", cell.job)))
}
