//! `apportion list`.

use super::print;
use anyhow::Result;
use apportion::measure::{Known, Shelf};
use std::path::Path;

/// Where a user's experiments lie, from where the program is started.
pub(crate) const EXPERIMENTS: &str = "experiments";

/// Prints the experiments, one a line, with the figure each reproduces. A file that is off gets a line that says so,
/// so that one bad file does not hide the others; the run then fails.
pub(crate) fn list() -> Result<()> {
    let (shelf, known) = (Shelf::open(Path::new(EXPERIMENTS))?, Known::here());
    let width = shelf.names().map(str::len).max().unwrap_or(0);
    let mut first_error = None;
    for name in shelf.names() {
        match shelf.load(name, &known) {
            Ok(experiment) if experiment.reproduces.is_empty() => {
                print::line(&format!("{name:width$}  {}", experiment.title))?;
            }
            Ok(experiment) => {
                print::line(&format!("{name:width$}  {} ({})", experiment.title, experiment.reproduces))?;
            }
            Err(error) => {
                print::line(&format!("{name:width$}  cannot be read"))?;
                first_error = first_error.or(Some(error));
            }
        }
    }
    first_error.map_or(Ok(()), |error| Err(error.into()))
}
