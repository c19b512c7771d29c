//! Standard output, which may close early: `apportion list | head -1` is no failure.

use super::words::Format;
use anyhow::Result;
use apportion::report::Table;
use std::io::{ErrorKind, Write};

/// Prints a line, or several.
pub(crate) fn line(text: &str) -> Result<()> {
    bytes(format!("{}\n", text.trim_end()).as_bytes())
}

/// Prints bytes as they are.
pub(crate) fn bytes(bytes: &[u8]) -> Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(bytes)?;
    Ok(out.flush()?)
}

/// Prints a table.
pub(crate) fn table(table: &Table, format: Format) -> Result<()> {
    line(&match format {
        Format::Table => table.text(),
        Format::Json => table.json(),
        Format::Csv => table.csv(),
    })
}

/// Whether the reader of our output went away.
pub(crate) fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error.downcast_ref::<std::io::Error>().is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
}
