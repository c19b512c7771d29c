//! `apportion run`.

use super::list::EXPERIMENTS;
use super::progress::Bar;
use super::report::write_charts;
use super::table::RESULTS;
use super::trace::TraceFile;
use super::words::{Format, RunWords};
use super::{INTERRUPTED, print};
use anyhow::{Context, Result};
use apportion::measure::{
    self, Ending, Experiment, Known, MeasureError, Plan, Selection, Shelf, SubjectCache, Tracer, subject,
};
use apportion::record::{Host, Meta, RowLog, RunFolder, export_csv, run_id, utc_now, write_whole};
use apportion::report::{self, Run, Table};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs the experiments named, one after the other.
pub(crate) fn run(words: &RunWords) -> Result<ExitCode> {
    let (shelf, known) = (Shelf::open(Path::new(EXPERIMENTS))?, Known::here());
    if let Some(twice) = words.names.iter().enumerate().find(|(at, name)| words.names[..*at].contains(name)) {
        return Err(MeasureError::Words(format!("experiment {} is named twice", twice.1)).into());
    }
    // All words are checked before the first experiment takes its minutes.
    let prepared = words.names.iter().map(|name| Prepared::new(words, name, &shelf, &known));
    let prepared: Vec<Prepared> = prepared.collect::<Result<_>>()?;
    let mut trace = words.trace.as_deref().map(TraceFile::new).transpose()?;
    let stop = stop_on_interrupt()?;
    let mut together = Table::default();
    for mut one in prepared {
        let folder = one.folder()?;
        let tracer = trace.is_some().then(Tracer::default);
        let ending = one.go(&folder, &stop, tracer.as_ref());
        let traced = trace.as_mut().zip(tracer).map(|(trace, tracer)| trace.add(&tracer, &folder));
        // What the run says comes first; its cells are traced in any case.
        let ending = ending?;
        let traced = traced.transpose()?.unwrap_or_default();
        if let Ending::Stopped { left } = ending {
            let place = folder.path().display();
            print::note(&format!("stopped with {left} cells missing in {place}; take it up with --resume"));
            return Ok(ExitCode::from(INTERRUPTED));
        }
        let table = one.finish(&folder, words.format, traced)?;
        together.lines.extend(table.lines);
    }
    if words.format != Format::Table {
        print::table(&together, words.format)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The first Ctrl-C asks for an end after the cell in hand, the second does not wait.
fn stop_on_interrupt() -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        // Relaxed: the flag carries no data.
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
        eprintln!("\napportion: ending after the cell in hand; Ctrl-C again to end at once");
    })
    .context("cannot catch Ctrl-C")?;
    Ok(stop)
}

/// An experiment whose words are checked.
struct Prepared {
    experiment: Experiment,
    text: String,
    selection: Selection,
    plan: Plan,
    /// Scenes that checking the words has opened already.
    cache: SubjectCache,
    /// The folder a new run was told to use.
    out: Option<PathBuf>,
    resumed: Option<RunFolder>,
}

impl Prepared {
    fn new(words: &RunWords, name: &str, shelf: &Shelf, known: &Known) -> Result<Self> {
        // Also when resuming, so that a wrong name is called one.
        let mut text = shelf.text(name)?.to_owned();
        let mut selection = words.selection();
        let out =
            words.out.as_ref().map(|out| if words.names.len() == 1 { out.clone() } else { out.join(name) });
        let resumed = match (&out, words.resume) {
            (_, false) => None,
            (Some(out), true) => Some(RunFolder::at(out)),
            (None, true) => Some(RunFolder::newest_unfinished(Path::new(RESULTS), name)?),
        };
        let experiment = match &resumed {
            None => shelf.load(name, known)?,
            Some(folder) => {
                selection = kept_selection(folder, name, &selection)?;
                let file = folder.experiment();
                text = std::fs::read_to_string(&file)
                    .with_context(|| format!("cannot read {}", file.display()))?;
                Experiment::parse(name, &file.display().to_string(), &text, known)?
            }
        };
        let plan = Plan::new(&experiment, &selection, known, Host::here().cores)?;
        let mut cache = SubjectCache::default();
        if resumed.is_none() {
            open_each_kind(&plan, &mut cache).map_err(|error| match error {
                MeasureError::Setting(message) => {
                    MeasureError::Words(format!("{}: {message}", shelf.file(name)))
                }
                error => error,
            })?;
        }
        Ok(Self { experiment, text, selection, plan, cache, out, resumed })
    }

    /// The folder to run in: the one taken up, or a new one that says what is run.
    fn folder(&self) -> Result<RunFolder> {
        if let Some(folder) = &self.resumed {
            return Ok(folder.clone());
        }
        let name = &self.experiment.name;
        let run = run_id();
        let folder = RunFolder::create(Path::new(RESULTS), self.out.as_deref(), name, &run)?;
        // The experiment first: a folder with meta.json can be resumed.
        write_whole(&folder.experiment(), |out| out.write_all(self.text.as_bytes()))?;
        let words = std::env::args().skip(1);
        let meta = Meta {
            run,
            experiment: name.clone(),
            command: std::iter::once("apportion".to_owned()).chain(words).collect(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: Meta::commit_here(),
            host: Host::here(),
            seed: self.plan.options.seed,
            start: utc_now(),
            end: None,
            selection: serde_json::to_value(&self.selection)?,
        };
        meta.write(&folder.meta())?;
        Ok(folder)
    }

    fn go(&mut self, folder: &RunFolder, stop: &AtomicBool, tracer: Option<&Tracer>) -> Result<Ending> {
        let mut meta = Meta::read(&folder.meta())?;
        let (mut log, kept) = RowLog::open(&folder.rows())?;
        let bar = Bar::new(&self.experiment.name);
        let ending = measure::run(
            &self.plan,
            &meta.run,
            (&mut log, &kept),
            &mut |cell, options| match tracer {
                Some(tracer) => tracer.open(cell, options, &mut self.cache),
                None => subject::open(cell, options, &mut self.cache),
            },
            &mut |progress| bar.show(progress),
            stop,
        );
        bar.end();
        let ending = ending?;
        if ending == Ending::Complete {
            export_csv(&folder.rows(), &folder.csv())?;
            // Last: `end` says that all else is there.
            meta.end.get_or_insert_with(utc_now);
            meta.write(&folder.meta())?;
        }
        Ok(ending)
    }

    /// Draws the charts and makes the table; prints it, and what was written where (also the traces before), unless
    /// it is for a program.
    fn finish(&self, folder: &RunFolder, format: Format, traced: Vec<PathBuf>) -> Result<Table> {
        let run = Run::read(folder)?;
        let mut table = report::table(&run.rows, &self.experiment.paper);
        table.hold_peaks_to(|machine| Plan::whole_counts(&self.experiment, machine, Host::here().cores));
        table.made_on(&run.meta.host);
        let mut written = vec![folder.rows(), folder.csv(), folder.meta()];
        written.extend(write_charts(&run, folder)?);
        let loose = self.selection.until.map(|percent| (percent, report::loose(&run.rows, percent)));
        written.extend(traced);
        if format == Format::Table {
            print::line(&format!("{}\n\n{}", self.experiment.title, table.text()))?;
        }
        if let Some((percent, loose)) = loose {
            tell_loose(percent, &loose);
        }
        if format == Format::Table {
            for path in written {
                print::line(&format!("wrote {}", path.display()))?;
            }
        }
        Ok(table)
    }
}

/// Says on standard error which speedups `--until` gave up on.
fn tell_loose(percent: f64, loose: &[String]) {
    if !loose.is_empty() {
        print::note(&format!("time was up before these speedups were sure to {percent} %:"));
        loose.iter().for_each(|cell| eprintln!("  {cell}"));
    }
}

/// Opens one cell for each scene, machine, scheme and choice of settings: a scene that cannot be read or a setting that is
/// off must not leave a folder behind that `--resume` would take up.
fn open_each_kind(plan: &Plan, cache: &mut SubjectCache) -> Result<(), MeasureError> {
    let mut seen = HashSet::new();
    for cell in &plan.cells {
        if seen.insert((&cell.scene, &cell.machine, &cell.scheme, cell.settings_text())) {
            subject::open(cell, &plan.options, cache)?;
        }
    }
    Ok(())
}

/// The selection a run was begun with; words that say otherwise are refused, as one run asks one question.
fn kept_selection(folder: &RunFolder, name: &str, words: &Selection) -> Result<Selection> {
    let meta = Meta::read(&folder.meta())?;
    let kept: Selection = serde_json::from_value(meta.selection)
        .with_context(|| format!("{}: `selection` is off", folder.meta().display()))?;
    let place = folder.path().display();
    if meta.experiment != name {
        let message = format!("{place} holds a run of {}, not of {name}", meta.experiment);
        return Err(MeasureError::Words(message).into());
    }
    if *words != Selection::default() && *words != kept {
        let message = format!("{place} was begun with other words: {}", meta.command.join(" "));
        return Err(MeasureError::Words(message).into());
    }
    Ok(kept)
}
