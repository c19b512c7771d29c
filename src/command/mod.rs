//! The command line: thin. Words in, exit code out: 0 done, 1 the run failed, 2 the words were off.

mod advise;
mod compare;
mod list;
mod print;
mod progress;
mod render;
mod report;
mod run;
mod save;
mod stress;
mod table;
mod trace;
mod words;

use anyhow::{Context, Result};
use apportion::measure::{MeasureError, inspect};
use clap::{CommandFactory, Parser};
use std::io::IsTerminal;
use std::process::ExitCode;
use words::{Action, Words};

/// What a shell calls a program ended by Ctrl-C.
const INTERRUPTED: u8 = 130;

/// Reads the words, does what they say, tells how it went.
pub(crate) fn main() -> ExitCode {
    match act(Words::parse().action) {
        Ok(code) => code,
        Err(error) if print::is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            print::note(&told(&error));
            let usage = error.downcast_ref::<MeasureError>().is_some_and(MeasureError::is_usage);
            ExitCode::from(if usage { 2 } else { 1 })
        }
    }
}

/// The error and its causes, without those that the message before them tells already.
fn told(error: &anyhow::Error) -> String {
    error.chain().skip(1).map(ToString::to_string).fold(error.to_string(), |told, cause| {
        if told.ends_with(&cause) { told } else { format!("{told}: {cause}") }
    })
}

/// Tells a person at a terminal what takes its time.
fn tell(what: &str) {
    if std::io::stderr().is_terminal() {
        eprintln!("measuring: {what}");
    }
}

fn act(action: Action) -> Result<ExitCode> {
    match action {
        Action::List => list::list()?,
        Action::Run(words) => return run::run(&words),
        Action::Table(words) => table::table(&words)?,
        Action::Report(words) => report::report(&words)?,
        Action::Advise(words) => advise::advise(&words)?,
        Action::Render(words) => render::render(&words)?,
        Action::Compare(words) => compare::compare(&words)?,
        Action::Scene { scene, save: Some(file) } => save::save(&scene, &file)?,
        Action::Scene { scene, save: None } => print::line(&inspect::scene(&scene)?)?,
        Action::Machine { machine } => {
            print::line(&inspect::machine(machine.as_deref(), &mut tell)?)?;
        }
        Action::Stress { what, processors, seconds } => {
            stress::stress(&what, processors, seconds)?;
        }
        Action::Completions { shell } => {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut words::with_names()?, "apportion", &mut text);
            print::bytes(&text)?;
        }
        Action::Man { out: Some(folder) } => {
            std::fs::create_dir_all(&folder)
                .and_then(|()| clap_mangen::generate_to(Words::command(), &folder))
                .with_context(|| format!("cannot write to {}", folder.display()))?;
        }
        Action::Man { out: None } => {
            let mut text = Vec::new();
            clap_mangen::Man::new(Words::command()).render(&mut text)?;
            print::bytes(&text)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}
