//! Schemes and primitives under random load on real threads, and the tests of culling and collision under random
//! volumes and triangles, with their invariants checked run by run.
//!
//! Tiny queues, random pauses and more workers than cores bring about the interleavings that ordinary
//! runs seldom see. A schedule of real threads cannot be repeated, but what was asked of it can: each
//! run has a seed. A run that never ends shows in a progress that stops.

mod barriers;
mod contacts;
mod cull_kernels;
mod cull_tests;
mod leaks;
mod overlaps;
mod primitives;
mod tiles;
mod trees;

use crate::machine::{RunError, Threads};
use crate::scene::SplitMix64;
use crate::scheme::{About, tiles as tile_schemes, tree as tree_schemes};
use std::time::{Duration, Instant};

/// The primitives that can be stressed by themselves.
const PRIMITIVES: &[(&str, primitives::Check)] = &[
    ("barriers", barriers::barriers),
    ("in_queue", primitives::in_queue),
    ("lock", primitives::lock),
    ("quiescence", primitives::quiescence),
    ("cull_tests", cull_tests::check),
    ("cull_kernels", cull_kernels::check),
    ("contacts", contacts::check),
    ("overlaps", overlaps::check),
    ("leaks", leaks::check),
];

/// What was run, and what went wrong.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StressReport {
    /// Runs made.
    pub runs: u64,
    /// Nodes visited, tasks passed on, turns taken, boxes tested, verdicts given, pairs tried, or rays aimed in these
    /// runs.
    pub nodes: u64,
    /// Invariants found broken. Stressing ends at the first of them.
    pub violations: Vec<Violation>,
}

/// A broken invariant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// The scheme or primitive.
    pub what: String,
    /// The seed of the run.
    pub seed: u64,
    /// What was expected, and what was found.
    pub found: String,
}

/// Why stressing could not begin.
#[derive(Debug, thiserror::Error)]
pub enum StressError {
    /// There is nothing of that name.
    #[error("nothing called `{what}` can be stressed; there are: {known}")]
    Unknown {
        /// What was asked for.
        what: String,
        /// What there is.
        known: String,
    },
    /// The threads could not be had.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// Everything that can be stressed, besides `all`.
pub fn names() -> impl Iterator<Item = &'static str> {
    let is_new = |scheme: &&About| !is_in(tree_schemes::SCHEMES, scheme.name);
    let schemes = tree_schemes::SCHEMES.iter().chain(tile_schemes::SCHEMES.iter().filter(is_new));
    PRIMITIVES.iter().map(|(name, _)| *name).chain(schemes.map(|scheme| scheme.name))
}

fn is_in(schemes: &[About], name: &str) -> bool {
    schemes.iter().any(|scheme| scheme.name == name)
}

/// Checks the schemes of a name: there may be one for trees and one for tiles (`serial`, `work_stealing`).
fn check_schemes(
    name: &str,
    team: &Threads,
    processors: usize,
    random: &mut SplitMix64,
) -> Result<u64, String> {
    let mut done = 0;
    if is_in(tree_schemes::SCHEMES, name) {
        done += trees::check(name, team, processors, random)?;
    }
    if is_in(tile_schemes::SCHEMES, name) {
        done += tiles::check(name, team, processors, random)?;
    }
    Ok(done)
}

/// Stresses the scheme or primitive called `what`, or `all` in turn, on up to `processors` threads until
/// `duration` is over or an invariant is broken. `progress` gets the number of runs so far, now and then.
///
/// ```
/// use apportion::measure::stress::stress;
/// let report = stress("lock_free", 2, std::time::Duration::from_millis(20), |_| ())?;
/// assert!(report.runs > 0 && report.violations.is_empty(), "{report:?}");
/// # Ok::<(), apportion::measure::stress::StressError>(())
/// ```
///
/// # Errors
/// [`StressError`].
pub fn stress(
    what: &str,
    processors: usize,
    duration: Duration,
    progress: impl FnMut(u64),
) -> Result<StressReport, StressError> {
    stress_from(what, processors, duration, first_seed(), progress)
}

/// As [`stress`], with the seed of the first run; the next ones follow it one by one.
///
/// # Errors
/// [`StressError`].
#[expect(clippy::disallowed_methods, reason = "measure takes native time: the load lasts as long as asked")]
pub fn stress_from(
    what: &str,
    processors: usize,
    duration: Duration,
    first_seed: u64,
    mut progress: impl FnMut(u64),
) -> Result<StressReport, StressError> {
    let chosen: Vec<&str> = names().filter(|name| what == "all" || what == *name).collect();
    if chosen.is_empty() {
        let known = names().chain(["all"]).collect::<Vec<_>>().join(", ");
        return Err(StressError::Unknown { what: what.to_owned(), known });
    }
    // An in-queue takes two, whatever was asked for.
    let team = Threads::new(if processors == 1 { 2 } else { processors })?;
    let (mut report, started) = (StressReport::default(), Instant::now());
    let (mut seed, mut reported) = (first_seed, started);
    while started.elapsed() < duration && report.violations.is_empty() {
        for &name in &chosen {
            let mut random = SplitMix64::new(seed);
            let primitive = PRIMITIVES.iter().find(|(primitive, _)| *primitive == name);
            let outcome = match primitive {
                Some((_, check)) => check(&team, processors, &mut random),
                None => check_schemes(name, &team, processors, &mut random),
            };
            report.runs += 1;
            match outcome {
                Ok(nodes) => report.nodes += nodes,
                Err(found) => {
                    report.violations.push(Violation { what: name.to_owned(), seed, found });
                    break;
                }
            }
        }
        seed = seed.wrapping_add(1);
        if reported.elapsed() > Duration::from_millis(100) {
            reported = Instant::now();
            progress(report.runs);
        }
    }
    progress(report.runs);
    Ok(report)
}

/// A seed that differs from call to call.
fn first_seed() -> u64 {
    use std::hash::{BuildHasher, RandomState};
    RandomState::new().hash_one(0)
}

/// Loses some time in one of several ways, as `random` says.
fn pause(random: u64) {
    match random % 64 {
        0 => std::thread::yield_now(),
        1 if random & 0xf000 == 0 => std::thread::sleep(Duration::from_micros(random >> 20 & 63)),
        2..12 => (0..random >> 20 & 255).for_each(|_| std::hint::spin_loop()),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_holds_for_a_moment() {
        for name in names() {
            let report = stress(name, 4, Duration::from_millis(30), |_| ()).unwrap();
            assert!(report.violations.is_empty(), "{report:?}");
            assert!(report.runs > 0 && report.nodes > 0, "{name}: {report:?}");
        }
    }

    #[test]
    fn an_unknown_name_lists_the_known() {
        let error = stress("queue", 2, Duration::ZERO, |_| ()).unwrap_err().to_string();
        assert!(names().chain(["all"]).all(|name| error.contains(name)), "{error}");
    }
}
