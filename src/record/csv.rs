//! `rows.csv`: the log as a table, written whole.

use super::{RecordError, Row, log::read_rows, write_whole};
use std::borrow::Cow;
use std::io::Write;
use std::path::Path;

/// Writes `csv` from the log `jsonl`, whole: a cut CSV would be read as if it were complete.
///
/// # Errors
/// The log cannot be read, or the table cannot be written; then the old table, if any, stays as it was.
pub fn export_csv(jsonl: &Path, csv: &Path) -> Result<(), RecordError> {
    let rows = read_rows(jsonl)?;
    write_whole(csv, |out| {
        writeln!(out, "{}", Row::COLUMNS.join(","))?;
        rows.iter().try_for_each(|row| write_row(out, row))
    })
}

fn write_row(out: &mut dyn Write, row: &Row) -> std::io::Result<()> {
    for word in [
        &row.run,
        &row.experiment,
        &row.job,
        &row.scene,
        &row.structure,
        &row.scheme,
        &row.settings,
        &row.machine,
    ] {
        write!(out, "{},", quoted(word))?;
    }
    let frame = row.frame.map_or(String::new(), |frame| frame.to_string());
    write!(out, "{},{},{frame},", row.processors, row.repeat)?;
    writeln!(out, "{},{},{}", quoted(&row.metric), quoted(&row.unit), row.value)
}

/// A word as a CSV field: in quotes where it holds a comma, a quote or a line's end (RFC 4180).
pub fn quoted(word: &str) -> Cow<'_, str> {
    if word.contains([',', '"', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", word.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(word)
    }
}
