//! Random numbers of pieces, settings and pauses for a tile scheme; now and then a piece panics.

use super::pause;
use crate::machine::{RunError, Threads};
use crate::scene::SplitMix64;
use crate::scheme::tiles::{Scheme, work};
use std::collections::BTreeMap;

/// Settings to choose from; a scheme takes those that it knows.
const CHOICES: &[(&str, &[&str])] = &[
    ("tile", &["1", "2", "3", "50"]),
    ("first", &["1", "20", "500"]),
    ("last", &["1", "4"]),
    ("layout", &["1999", "padded"]),
    ("counter", &["locked", "fetch_add"]),
    ("lock", &["test_and_set", "test_and_test_and_set", "ticket", "mcs"]),
    ("barrier", &["fetch_op", "tree", "system"]),
];

const PANIC: &str = "a rotten piece";

/// Sets the scheme up with random settings and runs it a few times; returns the pieces worked on.
pub(super) fn check(
    name: &str,
    team: &Threads,
    processors: usize,
    random: &mut SplitMix64,
) -> Result<u64, String> {
    let processors = 1 + random.below(processors);
    let mut given = BTreeMap::new();
    for (key, values) in CHOICES {
        let one = BTreeMap::from([((*key).to_owned(), values[random.below(values.len())].to_owned())]);
        if Scheme::new(name, team, 1, one.clone()).is_ok() {
            given.extend(one);
        }
    }
    let about = |e: String| format!("{e} (on {processors} processors, {given:?})");
    let mut scheme = Scheme::new(name, team, processors, given.clone()).map_err(|e| about(e.to_string()))?;
    let mut worked = 0;
    for _ in 0..3 {
        let pieces = random.below(600);
        let rotten = (pieces > 0 && random.below(8) == 0).then(|| random.below(pieces));
        worked += run(&mut scheme, team, pieces, rotten, random.next_u64()).map_err(about)?;
    }
    Ok(worked)
}

fn run(
    scheme: &mut Scheme<Threads>,
    team: &Threads,
    pieces: usize,
    rotten: Option<usize>,
    seed: u64,
) -> Result<u64, String> {
    let job = work(pieces, Vec::new, |tile, found: &mut Vec<usize>| {
        for piece in tile {
            pause(SplitMix64::new(seed ^ piece as u64).next_u64());
            if rotten == Some(piece) {
                // As a panic, but the hook prints nothing.
                std::panic::resume_unwind(Box::new(PANIC));
            }
            found.push(piece);
        }
    });
    let shares = match (scheme.run(team, &job), rotten) {
        (Ok(shares), None) => shares,
        (Err(RunError::Panicked { message, .. }), Some(_)) if message == PANIC => return Ok(0),
        (Err(e), _) => return Err(format!("{pieces} pieces, {rotten:?} rotten: {e}")),
        (Ok(_), Some(piece)) => return Err(format!("{pieces} pieces: the panic at {piece} went unnoticed")),
    };
    let mut times = vec![0_u32; pieces];
    shares.iter().flat_map(|share| &share.found).for_each(|&piece| times[piece] += 1);
    match times.iter().position(|&times| times != 1) {
        Some(piece) => Err(format!("piece {piece} of {pieces} was worked on {} times", times[piece])),
        None => Ok(pieces as u64),
    }
}
