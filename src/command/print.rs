//! Standard output, which may close early: `apportion list | head -1` is no failure.

use super::words::Format;
use anstyle::{AnsiColor, Effects, Style};
use anyhow::Result;
use apportion::report::Table;
use std::io::{ErrorKind, Write};

/// Prints a line, or several.
pub(crate) fn line(text: &str) -> Result<()> {
    bytes(format!("{}\n", text.trim_end()).as_bytes())
}

/// Prints a text whose lines may end in a verdict, which is coloured where that can be seen: on a terminal, and
/// unless `NO_COLOR` is set.
pub(crate) fn verdicts(text: &str) -> Result<()> {
    let mut out = anstream::stdout().lock();
    for line in text.lines() {
        let verdict = VERDICTS.iter().find(|(word, _)| line.ends_with(word));
        match verdict.and_then(|(word, style)| Some((line.strip_suffix(word)?, word, style))) {
            Some((before, word, style)) => writeln!(out, "{before}{style}{word}{style:#}")?,
            None => writeln!(out, "{line}")?,
        }
    }
    Ok(out.flush()?)
}

const VERDICTS: [(&str, Style); 4] = [
    (" better", AnsiColor::Green.on_default()),
    (" worse", AnsiColor::Red.on_default()),
    (" mixed", AnsiColor::Yellow.on_default()),
    (" cannot tell", Style::new().dimmed()),
];

/// Says on standard error what went wrong, or what to keep in mind.
pub(crate) fn note(text: &str) {
    let style = AnsiColor::Red.on_default().effects(Effects::BOLD);
    anstream::eprintln!("{style}apportion:{style:#} {text}");
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
