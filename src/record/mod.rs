//! Rows, their columns, the log they are written to.
//!
//! A run is a folder: `rows.jsonl` (the log: one record, one write, one line), `rows.csv` (written whole from the
//! log when the run ends), `meta.json` (what was run, where, when) and `experiment.toml` (the question as it was
//! put). A traced run has `timeline.json` too. A row is one number with all that is needed to read it; nothing is told by a file's name or place.
//!
//! Invariant: a *cell* (one scheme, with its settings, on one machine with P processors, once) is either in the log
//! with its last row, `cell_complete`, or it counts as never run: opening the log drops what is left of it.

pub(crate) mod clock;
mod csv;
mod figure;
mod folder;
mod log;
mod meta;
mod metric;
mod question;
mod row;
pub mod statistics;
mod trace_events;
mod whole;

pub use clock::{run_id, utc_now};
pub use csv::{export_csv, quoted};
pub use figure::PaperFigure;
pub use folder::RunFolder;
pub use log::{RowLog, read_rows};
pub use meta::{Host, Meta};
pub use metric::{AccuracyKind, Better, METRICS, Metric, metric};
pub use question::Question;
pub use row::{CellKey, Row, THREADS, settings_pairs};
pub use trace_events::{Stretch, TracedFrame, check_trace_place, write_trace};
pub use whole::write_whole;

use std::path::{Path, PathBuf};

/// What went wrong while rows were kept or read; every variant names the file.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The file or folder could not be made, read, written or renamed (no space, no permission, not a folder).
    #[error("cannot {what} {}: {source}", path.display())]
    File {
        /// What was tried, as a verb: "create", "write", "read".
        what: &'static str,
        /// The file or folder it was tried on.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A line holds something else than a record.
    #[error("{}, line {line}: expected one record in JSON: {message}", path.display())]
    Line {
        /// The file read.
        path: PathBuf,
        /// Its line, from 1.
        line: usize,
        /// What the parser said.
        message: String,
    },
    /// A run's `experiment.toml` holds something else than an experiment.
    #[error("{}, line {line}: {message}", path.display())]
    Question {
        /// The file read.
        path: PathBuf,
        /// Its line, from 1.
        line: usize,
        /// What the parser said.
        message: String,
    },
    /// A number that is no number: JSON has no word for it, and no row should.
    #[error("{}: metric {metric} is {value}, which is not a finite number", path.display())]
    NotFinite {
        /// The log it was meant for.
        path: PathBuf,
        /// The row's metric.
        metric: String,
        /// The value refused.
        value: f64,
    },
    /// A new run was asked for in a folder that holds one.
    #[error("{} holds a run already: name another folder, or take it up with --resume", path.display())]
    Taken {
        /// The folder.
        path: PathBuf,
    },
    /// Another process is writing this run.
    #[error("{} is being written by another run: wait for it to end", path.display())]
    InUse {
        /// The folder.
        path: PathBuf,
    },
    /// There is no run to take up or to show.
    #[error("no {what} run of {experiment} in {}", path.display())]
    NoRun {
        /// "finished" or "unfinished".
        what: &'static str,
        /// The experiment asked for.
        experiment: String,
        /// Where it was looked for.
        path: PathBuf,
    },
}

impl RecordError {
    /// An error of the file system, with what was tried on which file.
    pub(crate) fn file(what: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |source| Self::File { what, path: path.to_path_buf(), source }
    }
}
