//! `apportion compare`: what changed between two runs.

use super::list::EXPERIMENTS;
use super::print;
use super::table::RESULTS;
use super::words::{CompareWords, Format};
use anyhow::Result;
use apportion::measure::{MeasureError, Shelf, near};
use apportion::record::{METRICS, Meta, RunFolder, read_rows};
use apportion::report::compare as compare_rows;
use std::path::Path;

/// Prints the comparison of two runs; what makes it doubtful goes to standard error.
pub(crate) fn compare(words: &CompareWords) -> Result<()> {
    if METRICS.iter().all(|metric| metric.name != words.metric) {
        let near = near(&words.metric, METRICS.iter().map(|metric| metric.name));
        return Err(MeasureError::Unknown { kind: "metric", name: words.metric.clone(), near }.into());
    }
    let [a, b] = [find(&words.a)?, find(&words.b)?];
    let metas = [Meta::read(&a.meta())?, Meta::read(&b.meta())?];
    let comparison = compare_rows(&read_rows(&a.rows())?, &read_rows(&b.rows())?, &words.metric)?;
    for doubt in doubts([&a, &b], &metas) {
        print::note(&doubt);
    }
    match words.format {
        Format::Table => {
            for (run, (folder, meta)) in ["A", "B"].into_iter().zip([&a, &b].into_iter().zip(&metas)) {
                print::line(&format!("{run}: {}, of {}", folder.path().display(), meta.start))?;
            }
            print::verdicts(&comparison.text())
        }
        Format::Json => print::line(&comparison.json()),
        Format::Csv => print::line(&comparison.csv()),
    }
}

/// A run by its folder, or the newest finished one of an experiment.
fn find(run: &str) -> Result<RunFolder> {
    let folder = RunFolder::at(Path::new(run));
    if folder.meta().exists() {
        return Ok(folder);
    }
    if Path::new(run).exists() {
        let message = format!("{run} holds no run: expected a folder with meta.json and rows.jsonl");
        return Err(MeasureError::Words(message).into());
    }
    Shelf::open(Path::new(EXPERIMENTS))?.text(run)?;
    Ok(RunFolder::newest_finished(Path::new(RESULTS), run)?)
}

/// What the two runs do not have in common, or lack.
fn doubts(folders: [&RunFolder; 2], [a, b]: &[Meta; 2]) -> Vec<String> {
    let mut doubts = Vec::new();
    let mut differ = |what: &str, a: &str, b: &str| {
        if a != b {
            doubts.push(format!("the runs are of different {what}: A {a}, B {b}"));
        }
    };
    let commit = |meta: &Meta| meta.commit.clone().unwrap_or_else(|| "unknown".to_owned());
    let host = |meta: &Meta| {
        let host = &meta.host;
        format!("{}, {} cores, {}, {}", host.cpu, host.cores, host.caches.join(" "), host.system)
    };
    differ("experiments", &a.experiment, &b.experiment);
    differ("hosts", &host(a), &host(b));
    differ("versions", &a.version, &b.version);
    differ("commits", &commit(a), &commit(b));
    differ("seeds", &a.seed.to_string(), &b.seed.to_string());
    if folders[0].path() == folders[1].path() {
        doubts.push("A and B are the same run".to_owned());
    }
    for (run, meta) in [("A", a), ("B", b)] {
        if meta.end.is_none() {
            doubts.push(format!("{run} lacks cells: those it has are compared"));
        }
    }
    doubts
}
