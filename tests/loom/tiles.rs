//! Every tile scheme of the list, whole: each piece is worked on exactly once, by one processor alone.

use crate::machine::{Loom, LoomSlot};
use crate::mutant::Mutant::{NoWait, Torn};
use crate::mutant::is_caught;
use crate::{Bounds, check};
use apportion::machine::{Processor, Slot};
use apportion::scheme::tiles::{SCHEMES, Scheme, TileWork};
use std::collections::BTreeMap;
use std::ops::Range;

/// Pieces that count how often they were worked on: two processors on one piece are a race.
struct Pieces(Vec<LoomSlot<u32>>);

impl TileWork for Pieces {
    type Found = ();

    fn pieces(&self) -> usize {
        self.0.len()
    }

    fn found(&self) {}

    fn work_on<P: Processor>(&self, pieces: Range<usize>, _found: &mut (), _cpu: &P) {
        for slot in &self.0[pieces] {
            // SAFETY: nobody else has the piece, if the scheme is right; loom reports races.
            unsafe { slot.write(slot.read() + 1) };
        }
    }
}

/// Runs a scheme twice on so many pieces.
fn works(name: &str, processors: usize, count: usize) {
    let machine = Loom::new();
    let mut scheme = Scheme::new(name, &machine, processors, BTreeMap::new()).expect("defaults");
    for _ in 0..2 {
        let pieces = Pieces((0..count).map(|_| LoomSlot::new(0)).collect());
        let shares = scheme.run(&machine, &pieces).expect("no panic");
        assert_eq!(shares.iter().map(|share| share.visited).sum::<u64>(), count as u64, "{name}");
        for (piece, slot) in pieces.0.iter().enumerate() {
            // SAFETY: the run is over.
            assert_eq!(unsafe { slot.read() }, 1, "{name}: times piece {piece} was worked on");
        }
    }
}

/// Goes through three frames in one run: the pieces of one are those of the next, so that a frame begun too early is a
/// race.
fn goes_through_frames(name: &str, processors: usize, count: usize) {
    let machine = Loom::new();
    let mut scheme = Scheme::new(name, &machine, processors, BTreeMap::new()).expect("defaults");
    let pieces = Pieces((0..count).map(|_| LoomSlot::new(0)).collect());
    scheme.run_frames(&machine, &[&pieces, &pieces, &pieces]).expect("no panic");
    for (piece, slot) in pieces.0.iter().enumerate() {
        // SAFETY: the run is over.
        assert_eq!(unsafe { slot.read() }, 3, "{name}: times piece {piece} was worked on");
    }
}

fn names() -> impl Iterator<Item = &'static str> {
    SCHEMES.iter().filter(|scheme| !scheme.native_only).map(|scheme| scheme.name)
}

/// Schemes in which the processors share nothing, so that nothing can go wrong between two.
const SHARE_NOTHING: &[&str] = &["serial", "static_blocks", "interleaved"];

/// Schemes that take so many steps a piece that fewer pieces and preemptions have to do.
const MANY_STEPS: &[&str] = &["per_pixel_queue", "work_stealing"];

fn bounds() -> Bounds {
    Bounds { preemptions: 3, steps: 5_000 }
}

#[test]
fn every_scheme_works_on_each_piece_once() {
    for name in names() {
        let mut executions = 0;
        let many = MANY_STEPS.contains(&name);
        let cases = if many {
            &[(2, 0), (2, 1), (2, 3), (3, 2)][..]
        } else {
            &[(2, 0), (2, 1), (2, 4), (2, 5), (3, 3)]
        };
        for &(processors, count) in cases {
            let bounds = Bounds { preemptions: if many { 4 - processors } else { 3 }, ..bounds() };
            executions += check(bounds, move || works(name, processors, count));
        }
        eprintln!("{name}: {executions} executions");
    }
}

#[test]
fn no_frame_runs_into_the_next() {
    let bounds = Bounds { preemptions: 2, ..bounds() };
    for name in names() {
        let executions = check(bounds, move || goes_through_frames(name, 2, 2));
        eprintln!("frames, {name}: {executions} executions");
    }
    // Where nothing is shared, a piece is the same processor's in every frame, and who comes early does no harm.
    for name in names().filter(|name| !SHARE_NOTHING.contains(name)) {
        assert!(is_caught(NoWait, bounds, move || goes_through_frames(name, 2, 2)), "{name}");
    }
}

#[test]
fn a_counter_that_is_loaded_and_stored_is_caught() {
    for name in names().filter(|name| !SHARE_NOTHING.contains(name)) {
        assert!(is_caught(Torn, bounds(), move || works(name, 2, 4)), "{name}");
    }
}
