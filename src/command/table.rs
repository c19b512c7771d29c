//! `apportion table`.

use super::list::EXPERIMENTS;
use super::print;
use super::words::{Format, TableWords};
use anyhow::Result;
use apportion::measure::{Known, Plan, Shelf};
use apportion::record::{Meta, RunFolder, read_rows};
use apportion::report;
use std::path::Path;

/// Where runs are kept, from where the program is started.
pub(crate) const RESULTS: &str = "results";

/// Prints the table of the newest finished run.
pub(crate) fn table(words: &TableWords) -> Result<()> {
    let experiment = Shelf::open(Path::new(EXPERIMENTS))?.load(&words.name, &Known::here())?;
    let folder = RunFolder::newest_finished(Path::new(RESULTS), &words.name)?;
    let mut table = report::table(&read_rows(&folder.rows())?, &experiment.paper);
    let host = Meta::read(&folder.meta())?.host;
    table.hold_peaks_to(|machine| Plan::whole_counts(&experiment, machine, host.cores));
    table.made_on(&host);
    print::table(&table, words.format)?;
    if words.format == Format::Table {
        print::line(&format!("from {}", folder.path().display()))?;
    }
    Ok(())
}
