//! `apportion machine calibrate`: fits the constants of the preset `host` to the machine this runs on.
//!
//! The same little programs (`programs`) run on two real threads and on the simulated machine; a
//! constant is turned until the simulated machine takes as long as the real one. No scheme is among
//! these programs, so [`predict`] can hold predictions of whole schemes against measurements.
//!
//! Steps: 1. the clock, from a chain of additions: one cycle of the simulated machine is one of the
//! host; 2. caches, by walks through blocks of memory; 3. each constant by its program, in an order in
//! which each program depends on constants already known, between two pings ([`Gate`]).
//!
//! What is not measured: the store buffer's depth (taken as 32 misses under way) and the processors'
//! number, which the system knows.

mod caches;
mod gate;
mod predict;
mod programs;

use crate::machine::simulated::{Model, Network};
use crate::machine::threads::TeamSettings;
use crate::machine::{RunError, Simulated, Threads};
use caches::caches;
pub use gate::Gate;
pub use predict::{Prediction, Predictions, predict};
use programs::lines;
use std::fmt::Write as _;
use std::time::Duration;

/// The fitted machine, and how the fit went.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The preset `host` for this machine.
    pub model: Model,
    /// A line for each program: its name, and how long it takes here and on the simulated machine, ns.
    pub programs: Vec<(&'static str, f64, f64)>,
    /// How many samples counted, and how near the cores were.
    pub gate: Gate,
}

/// Why this host cannot be calibrated.
#[derive(Debug, thiserror::Error)]
pub enum CalibrateError {
    /// Latencies between processors cannot be measured on one.
    #[error("calibration needs two processors, this host offers {0}")]
    Processors(usize),
    /// A thread was refused, or a measurement failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A scheme could not be set up.
    #[error(transparent)]
    Setting(#[from] crate::scheme::SettingError),
    /// What was measured does not make a machine.
    #[error("what was measured makes no machine: {0}")]
    Model(#[from] crate::machine::simulated::ModelError),
    /// Something else ran on the two cores most of the time.
    #[error(
        "the host is too busy to be calibrated: lines came from another core at no cost, and {discarded} \
         samples were discarded beside {kept} kept; try again when it is idle"
    )]
    Disturbed {
        /// Samples taken while the cores were disturbed.
        discarded: usize,
        /// Samples that counted.
        kept: usize,
    },
    /// No measurement of a whole scheme was undisturbed.
    #[error("the host was never quiet at the distance it was fitted for; try again when it is idle")]
    NeverQuiet,
    /// The file cannot be written.
    #[error("{file}: cannot write the machine description: {source}")]
    Write {
        /// The file.
        file: String,
        /// The system's answer.
        source: std::io::Error,
    },
}

/// Samples a program.
const SAMPLES: usize = 41;

/// Runs the micro-benchmarks; takes some seconds, on the first two cores. `progress` is told what is
/// being measured. The calling thread is left as it was.
///
/// # Errors
/// [`CalibrateError`].
pub fn calibrate(progress: &mut dyn FnMut(&str)) -> Result<Calibration, CalibrateError> {
    let cores = Threads::cores();
    if cores < 2 {
        return Err(CalibrateError::Processors(cores));
    }
    let (told, tell) = std::sync::mpsc::channel();
    // On a thread of its own, which stays pinned.
    std::thread::scope(|scope| {
        let fitted = scope.spawn(move || fit(cores, &|what| _ = told.send(what)));
        tell.iter().for_each(progress);
        fitted.join().unwrap_or_else(|payload| std::panic::resume_unwind(payload))
    })
}

/// A team whose threads stay where they are and do not sleep.
fn team() -> Result<Threads, RunError> {
    let settings = TeamSettings { spin: Duration::from_secs(1), pin: true, pin_caller: true };
    Threads::with_settings(2, &settings)
}

type Program<M> = fn(&M) -> Result<f64, RunError>;

/// Programs with the constant each one fixes, in order.
const PROGRAMS: &[(&str, &str, Program<Threads>, Program<Simulated>)] = &[
    ("ring in cache", "l1_hit", programs::ring, programs::ring),
    ("fetch_add, own line", "atomic", programs::atomics, programs::atomics),
    ("store and fence, own line", "fence", programs::fences, programs::fences),
    ("lines read after the other", "cache_to_cache", |m| lines(m, false), |m| lines(m, false)),
    ("lines written, fenced", "upgrade", |m| lines(m, true), |m| lines(m, true)),
    ("lines read, again", "cache_to_cache", |m| lines(m, false), |m| lines(m, false)),
    ("ping-pong", "poll_pause", programs::ping_pong, programs::ping_pong),
    ("fetch_add, contended", "burst", programs::contended, programs::contended),
    ("a task through a stack", "task", programs::books, programs::books),
    ("run, the helper done first", "finish", programs::one_sided_run, programs::one_sided_run),
    ("run, empty", "start", programs::empty_run, programs::empty_run),
];

fn fit(processors: usize, progress: &dyn Fn(&'static str)) -> Result<Calibration, CalibrateError> {
    let team = team()?;
    let mut gate = Gate::now(&team)?;
    progress("clock and caches");
    let cycle_ns = gate.median(&team, SAMPLES, |_| Ok(caches::addition()))?;
    let caches = caches();
    let cycles = |ns: f64| (ns / cycle_ns).round().max(1.0) as u64;
    let mut model = Model {
        name: "host".to_owned(),
        description: describe(processors),
        source: "fitted by apportion machine calibrate".to_owned(),
        processors,
        clock_mhz: (1000.0 / cycle_ns).round(),
        line_bytes: caches::LINE,
        l1_lines: caches.l1_bytes / caches::LINE,
        l1_hit: 1,
        l2_lines: caches.l2_bytes / caches::LINE,
        l2_hit: cycles(caches.l2),
        memory: cycles(caches.beyond),
        cache_to_cache: cycles(caches.beyond),
        upgrade: cycles(caches.beyond),
        bus_occupancy: cycles(caches.apart),
        atomic: 0,
        fence: 0,
        store_buffer: 32,
        store_misses: 0,
        poll_pause: 1,
        burst: 0,
        task: 0,
        start: 0,
        finish: 0,
        wake: 0,
        cycles_per_measured_ns: (1000.0 / cycle_ns).round() / 1000.0,
        network: Network::default(),
    };
    let mut measured = Vec::new();
    for &(name, constant, native, simulated) in PROGRAMS {
        progress(name);
        let target = gate.median(&team, SAMPLES, native)? / cycle_ns;
        solve(&mut model, constant, target, simulated)?;
        measured.push((name, target, simulated));
    }
    if model.cache_to_cache == 0 {
        return Err(CalibrateError::Disturbed { discarded: gate.discarded, kept: gate.kept });
    }
    let mut programs = Vec::new();
    for (name, target, simulated) in measured {
        let there = simulated(&Simulated::new(model.clone()))?;
        programs.push((name, target * cycle_ns, there * cycle_ns));
    }
    Ok(Calibration { model, programs, gate })
}

/// Turns `constant` until `program` takes `target` cycles on the simulated machine, or as near as it
/// gets: bisection, as every program takes the longer the greater its constant is, but for
/// `burst`, where it is the other way round.
fn solve(
    model: &mut Model,
    constant: &str,
    target: f64,
    program: Program<Simulated>,
) -> Result<(), CalibrateError> {
    let falls = constant == "burst";
    let took = |value: u64, model: &mut Model| -> Result<f64, CalibrateError> {
        model.set(constant, value as f64)?;
        Ok(program(&Simulated::new(model.clone()))?)
    };
    let least = u64::from(matches!(constant, "l1_hit" | "poll_pause"));
    let (mut low, mut high) = (least, 20_000);
    while low + 1 < high {
        let middle = low.midpoint(high);
        if (took(middle, model)? <= target) != falls {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (below, above) = (took(low, model)?, took(high, model)?);
    let nearest = if (below - target).abs() <= (above - target).abs() { low } else { high };
    model.set(constant, nearest as f64)?;
    Ok(())
}

/// The processor's name, how many there are, and the day.
fn describe(processors: usize) -> String {
    let known = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |name: &str| {
        let line = known.lines().find(|line| line.split(':').next().is_some_and(|key| key.trim() == name))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    let name = field("model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let kind = match (field("cpu family"), field("model")) {
        (Some(family), Some(model)) => format!(" (family {family}, model {model})"),
        _ => String::new(),
    };
    format!("{processors} processors, {name}{kind}, fitted {}", crate::record::clock::today())
}

impl Calibration {
    /// The machine as the text of a preset, which [`Model::named`] reads from a file.
    pub fn to_toml(&self) -> String {
        let mut text =
            String::from("# Fitted by `apportion machine calibrate`; times are cycles of the clock.\n");
        let (near, far) = self.gate.spread();
        let Gate { kept, discarded, ping, .. } = self.gate;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "# {kept} samples, {discarded} discarded; cores {ping:.0} ns apart ({near:.0} to {far:.0})."
        );
        text + &toml::to_string(&self.model).expect("a model is a table")
    }

    /// Writes [`Calibration::to_toml`] to a file.
    ///
    /// # Errors
    /// [`CalibrateError::Write`].
    pub fn write(&self, file: &std::path::Path) -> Result<(), CalibrateError> {
        let name = || file.display().to_string();
        std::fs::write(file, self.to_toml()).map_err(|source| CalibrateError::Write { file: name(), source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fitted_model_is_read_back() {
        let mut model = Model::named("host").unwrap();
        model.description = "quotes \" and\nlines".to_owned();
        let fitted = Calibration { model: model.clone(), programs: Vec::new(), gate: Gate::default() };
        assert_eq!(Model::parse("fitted.toml", &fitted.to_toml()).unwrap(), model);
    }

    #[test]
    fn constants_are_found_again() {
        let truth = Model::named("host").unwrap();
        for &(name, constant, _, program) in PROGRAMS {
            let target = program(&Simulated::new(truth.clone())).unwrap();
            let mut model = truth.clone();
            solve(&mut model, constant, target, program).unwrap();
            let there = program(&Simulated::new(model)).unwrap();
            assert!((there - target).abs() <= 0.02 * target + 1.0, "{name}: {there} for {target}");
        }
    }
}
