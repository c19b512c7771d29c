//! Runs the cells of an experiment and turns them into rows.
//!
//! 1. [`Shelf`] finds an experiment, [`Experiment`] is its file, checked.
//! 2. [`Plan`] is the list of [`Cell`]s it asks for, narrowed by the [`Selection`] of the command line.
//! 3. [`run()`] gives each cell to its [`Subject`], repeat by repeat, interleaved, and writes each row at once.

pub mod advise;
pub mod calibrate;
mod experiment;
pub mod inspect;
mod near;
mod noise;
mod plan;
mod processors;
mod run;
mod shelf;
pub mod stress;
pub mod subject;
mod summary;
mod trace;
mod until;
mod value;

pub use experiment::Experiment;
pub use near::near;
pub use plan::{Cell, Options, Plan, Selection};
pub use processors::processor_list;
pub use run::{Ending, Open, Progress, run};
pub use shelf::Shelf;
pub use subject::{Known, Sample, Subject, SubjectCache};
pub use trace::{FrameTrace, Tracer};
pub use until::Until;
pub use value::Value;

use crate::record::RecordError;
use std::path::PathBuf;

/// What can go wrong between an experiment's file and its rows.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// An experiment's file holds something else than was expected.
    #[error("{file}, line {line}: {message}")]
    Experiment {
        /// The file.
        file: String,
        /// Its line, from 1.
        line: usize,
        /// What stands there and what was expected.
        message: String,
    },
    /// A file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A name nobody knows.
    #[error("there is no {kind} `{name}`{near}")]
    Unknown {
        /// What it should name: "experiment", "scheme".
        kind: &'static str,
        /// The name.
        name: String,
        /// The near ones, as [`near`] says them.
        near: String,
    },
    /// A setting that is off, wherever it was set.
    #[error("{0}")]
    Setting(String),
    /// The words of the command line do not make a run.
    #[error("{0}")]
    Words(String),
    /// A cell failed; the rows of the cells before it are kept.
    #[error("{cell}: {message}")]
    Cell {
        /// Which one.
        cell: String,
        /// What its subject said.
        message: String,
    },
    /// A scene, a structure, a job or a machine failed.
    #[error("{0}")]
    Failed(String),
    /// Rows could not be kept.
    #[error(transparent)]
    Record(#[from] RecordError),
}

impl MeasureError {
    /// Whether the words of the command line were off, rather than the run having failed.
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::Unknown { .. } | Self::Setting(_) | Self::Words(_))
    }
}
