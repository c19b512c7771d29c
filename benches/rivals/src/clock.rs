//! How contenders are timed: in turn, round after round, so that what else the computer does meets all of them, and
//! each is held against the first in its own round.

use std::time::{Duration, Instant};

/// Rounds, in each of which every contender runs for about [`SLICE`], once at least.
const ROUNDS: usize = 41;
const SLICE: Duration = Duration::from_millis(4);

/// What is timed.
pub(crate) type Run<'a> = Box<dyn FnMut() + 'a>;

/// The time of a run, in nanoseconds, by contender and round.
pub(crate) fn rounds(runs: &mut [Run<'_>]) -> Vec<Vec<f64>> {
    let times: Vec<u32> = runs
        .iter_mut()
        .map(|run| {
            let once = (0..2).map(|_| time(run, 1)).min().expect("two");
            (SLICE.as_nanos() / once.as_nanos().max(1)).max(1) as u32
        })
        .collect();
    let mut taken = vec![Vec::new(); runs.len()];
    for _ in 0..ROUNDS {
        for ((run, &times), taken) in runs.iter_mut().zip(&times).zip(&mut taken) {
            taken.push(time(run, times).as_secs_f64() * 1e9 / f64::from(times));
        }
    }
    taken
}

fn time(run: &mut Run<'_>, times: u32) -> Duration {
    let start = Instant::now();
    (0..times).for_each(|_| run());
    start.elapsed()
}

/// How many times as long as `first` a contender took, round by round.
pub(crate) fn ratios<'a>(own: &'a [f64], first: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    own.iter().zip(first).map(|(own, first)| own / first)
}

/// The middle one.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The least one, which is what a computer busy with other things can still tell.
pub(crate) fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}
