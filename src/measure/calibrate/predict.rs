//! Holds predictions of the simulated machine against this host: the speedup of whole schemes on two
//! processors, on synthetic trees, none of which took part in the fit.

use super::gate::{Gate, median};
use super::{CalibrateError, Calibration, calibrate, programs, team};
use crate::job::synthetic::Synthetic;
use crate::machine::{Machine, RunError, Simulated};
use crate::scheme::tree::{Scheme, TreeWork};
use std::collections::BTreeMap;
use std::fmt;

/// The schemes compared, serial first.
const SCHEMES: &[&str] = &[
    "serial",
    "global_queue",
    "global_counter",
    "hybrid",
    "lock_free",
    "receiver_initiated",
    "work_stealing",
];

/// Nodes of the trees.
const NODES: &[u32] = &[401, 4_001];

/// Work a node, nanoseconds.
const WORK: &[(u32, u32)] = &[(20, 60), (100, 300), (500, 1_500)];

/// One scheme on one tree.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// The scheme.
    pub scheme: &'static str,
    /// Nodes of the tree.
    pub nodes: u32,
    /// Least and most work a node, nanoseconds.
    pub work_ns: (u32, u32),
    /// Speedup over serial on two threads: median, and the quartiles.
    pub measured: (f64, f64, f64),
    /// Speedup on the simulated machine.
    pub predicted: f64,
}

impl Prediction {
    /// Predicted over measured, less 1.
    pub fn error(&self) -> f64 {
        self.predicted / self.measured.0 - 1.0
    }
}

/// All comparisons.
#[derive(Clone, Debug)]
pub struct Predictions(pub Vec<Prediction>);

impl Predictions {
    /// Mean absolute error, a share of the measured speedup.
    pub fn mean_absolute_error(&self) -> f64 {
        self.0.iter().map(|p| p.error().abs()).sum::<f64>() / self.0.len().max(1) as f64
    }
}

impl fmt::Display for Predictions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "scheme             | nodes | work, ns | measured (quartiles) | predicted |  error")?;
        for p in &self.0 {
            let work = format!("{}-{}", p.work_ns.0, p.work_ns.1);
            let (middle, low, high) = p.measured;
            let measured = format!("{middle:.2} ({low:.2}-{high:.2})");
            let error = 100.0 * p.error();
            writeln!(
                f,
                "{:18} | {:5} | {work:8} | {measured:20} | {:9.2} | {error:+5.1} %",
                p.scheme, p.nodes, p.predicted
            )?;
        }
        write!(f, "mean absolute error {:.1} %", 100.0 * self.mean_absolute_error())
    }
}

/// Fits of one tree at most: cores that drift between the fit and the measurement spoil a try.
const TRIES: usize = 5;

/// Fits, measures and predicts, with `repeats` interleaved repeats (15 or more for a result that counts) of
/// `runs` runs back to back. The speedup of a repeat is its median serial run over its median run, of
/// those between two quiet moments, of the scheme. The fit is made anew before each tree: virtual
/// cores drift between near and far within minutes, and a fit holds for the distance it was made at.
///
/// # Errors
/// [`CalibrateError`].
pub fn predict(
    repeats: usize,
    runs: usize,
    progress: &mut (dyn FnMut(&str) + Send),
) -> Result<Predictions, CalibrateError> {
    let mut all = Vec::new();
    for &nodes in NODES {
        for &work_ns in WORK {
            let tree = format!("{nodes} nodes of {} to {} ns", work_ns.0, work_ns.1);
            let mut compared = Vec::new();
            for _ in 0..TRIES {
                progress(&tree);
                let fitted = calibrate(&mut |_| ())?;
                // On a thread of its own, which stays pinned.
                compared = std::thread::scope(|scope| {
                    let compared = scope.spawn(|| compare(&fitted, nodes, work_ns, repeats, runs));
                    compared.join().unwrap_or_else(|payload| std::panic::resume_unwind(payload))
                })?;
                if compared.len() + 1 == SCHEMES.len() {
                    break;
                }
                progress("the cores drifted or were disturbed: once more");
            }
            all.append(&mut compared);
        }
    }
    if all.is_empty() {
        return Err(CalibrateError::NeverQuiet);
    }
    Ok(Predictions(all))
}

/// All schemes on one tree, but those that were never measured undisturbed.
fn compare(
    fitted: &Calibration,
    nodes: u32,
    work_ns: (u32, u32),
    repeats: usize,
    runs: usize,
) -> Result<Vec<Prediction>, CalibrateError> {
    let measured = measure(&team()?, nodes, work_ns, repeats, runs, &fitted.gate)?;
    let simulated = Simulated::new(fitted.model.clone());
    let predicted = measure(&simulated, nodes, work_ns, 1, 5, &fitted.gate)?;
    let mut all = Vec::new();
    for (i, scheme) in SCHEMES.iter().enumerate().skip(1) {
        let mut speedups = speedups(&measured, i);
        if speedups.is_empty() {
            continue;
        }
        let middle = median(&mut speedups);
        let quartile = |share: usize| speedups[(speedups.len() - 1) * share / 4];
        all.push(Prediction {
            scheme,
            nodes,
            work_ns,
            measured: (middle, quartile(1), quartile(3)),
            predicted: median(&mut self::speedups(&predicted, i)),
        });
    }
    Ok(all)
}

fn speedups(repeats: &[Vec<f64>], scheme: usize) -> Vec<f64> {
    repeats.iter().map(|times| times[0] / times[scheme]).filter(|speedup| !speedup.is_nan()).collect()
}

/// Most runs between two looks whether the host is quiet, and ticks after which to look.
const CHUNK: usize = 5;
const CHUNK_TICKS: u64 = 500_000;

/// Whether two processors now work at the same time undisturbed, at the distance the model was fitted
/// for: another program on one of them would tell of the scheduler, not of the scheme. A simulated machine always is.
fn is_quiet<M: Machine>(machine: &M, gate: &Gate) -> Result<bool, RunError> {
    const NS: u32 = 60_000;
    if !machine.is_native() {
        return Ok(true);
    }
    if !gate.lets(programs::ping_pong(machine)?) {
        return Ok(false);
    }
    let work = Synthetic::new(machine, 1, NS..=NS, 1);
    let before = machine.now();
    machine.run(2, |cpu| {
        let mut found = 0;
        work.visit((0, 1), &mut found, cpu, |_| ());
        std::hint::black_box(found)
    })?;
    Ok(machine.now() - before < u64::from(NS) * 6 / 5)
}

/// Median ticks of a run: for each repeat, for each scheme.
fn measure<M: Machine>(
    machine: &M,
    nodes: u32,
    work_ns: (u32, u32),
    repeats: usize,
    runs: usize,
    gate: &Gate,
) -> Result<Vec<Vec<f64>>, CalibrateError> {
    let work = Synthetic::new(machine, nodes, work_ns.0..=work_ns.1, 1);
    let mut schemes = Vec::new();
    for name in SCHEMES {
        let processors = if *name == "serial" { 1 } else { 2 };
        schemes.push(Scheme::new(name, machine, processors, BTreeMap::new())?);
    }
    let mut repeat = || -> Result<Vec<f64>, RunError> {
        let mut medians = Vec::new();
        for scheme in &mut schemes {
            let mut times = Vec::new();
            let mut disturbed = 0;
            let mut quiet = is_quiet(machine, gate)?;
            // The first one warms up.
            scheme.run(machine, &work)?;
            while times.len() < runs && times.len() + disturbed < 4 * runs {
                let mut some = Vec::new();
                let started = machine.now();
                while some.is_empty() || (some.len() < CHUNK && machine.now() - started < CHUNK_TICKS) {
                    let before = machine.now();
                    let shares = scheme.run(machine, &work)?;
                    some.push((machine.now() - before) as f64);
                    debug_assert_eq!(shares.iter().fold(0, |sum, s| sum ^ s.found), work.expected());
                }
                let was_quiet = std::mem::replace(&mut quiet, is_quiet(machine, gate)?);
                if was_quiet && quiet {
                    times.append(&mut some);
                } else {
                    disturbed += some.len();
                }
            }
            // Never quiet: there is no result.
            medians.push(if times.is_empty() { f64::NAN } else { median(&mut times) });
        }
        Ok(medians)
    };
    repeat()?;
    Ok((0..repeats).map(|_| repeat()).collect::<Result<_, _>>()?)
}
