//! Tables and charts, drawn from rows only.
//!
//! A number of a cell is the median over its repeats. Cells are gathered into *groups*: one machine, one scene, one
//! choice of the settings that concern all schemes; within a group a *curve* is one scheme with its own settings.

mod chart;
pub mod comparison;
mod doubt;
mod group;
mod marker;
mod table;
mod text;
mod winners;

pub use chart::{Chart, speedup_charts};
pub use comparison::{Comparison, compare};
pub use doubt::loose;
pub use table::{Line, Table, table};
pub use text::wrap;

/// What went wrong while a chart was drawn.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The drawing library refused.
    #[error("cannot draw {chart}: {message}")]
    Draw {
        /// The chart's file name.
        chart: String,
        /// What the library said.
        message: String,
    },
}
