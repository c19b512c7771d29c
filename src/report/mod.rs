//! Tables, charts and the page, drawn from rows only.
//!
//! A number of a cell is the median over its repeats. Cells are gathered into *groups*: one machine, one scene, one
//! choice of the settings that concern all schemes; within a group a *curve* is one scheme with its own settings.
//!
//! 1. `figure` works out what is to be seen: a file a kind of figure, each a list of panels and a sentence.
//! 2. `draw` turns a panel into SVG, `vega` a figure into a Vega-Lite specification.
//! 3. `page` puts the figures of many runs into one HTML file, with a style sheet and a small script of ours.
//!
//! The same rows give the same bytes.

mod animation;
mod choices;
pub mod comparison;
mod doubt;
mod draw;
mod escape;
mod figure;
mod group;
mod listing;
mod marker;
mod page;
mod run;
mod table;
mod text;
mod vega;
mod winners;

pub use comparison::{Comparison, compare};
pub use doubt::loose;
pub use page::page;
pub use run::{Chart, Run};
pub use table::{Line, Table, table};
pub use text::wrap;

use crate::record::RecordError;
use std::path::PathBuf;

/// What went wrong while a run was read or drawn.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file of the run is off.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// There is nothing to show.
    #[error("no rows to show: {what}")]
    Empty {
        /// The run, or that there is none.
        what: String,
    },
    /// The timeline is not in the Trace Event format.
    #[error("{}: expected the Trace Event format: {message}", path.display())]
    Timeline {
        /// The file.
        path: PathBuf,
        /// What the parser said.
        message: String,
    },
    /// The drawing library refused.
    #[error("cannot draw {chart}: {message}")]
    Draw {
        /// What was to be drawn.
        chart: String,
        /// What the library said.
        message: String,
    },
}
