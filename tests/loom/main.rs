//! Model checking: every primitive and every tree scheme runs on a machine made of loom's words, which
//! tries the schedules and the stale reads that the memory model allows, up to a number of preemptions.
//!
//! A checker that finds nothing may be blind, so each check is run again on broken machines
//! ([`mutant::Mutant`]), on which it must fail.
//!
//! loom takes SeqCst accesses for AcqRel, but SeqCst fences for what they are.

mod barriers;
mod first_contact;
mod handoff;
mod locks;
mod machine;
mod mutant;
mod quiescence;
mod rings;
mod schemes;
mod tiles;

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// How far a check goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    /// Involuntary switches an execution may have.
    pub preemptions: usize,
    /// Steps an execution may have: beyond that it is taken to be endless, and fails.
    pub steps: usize,
}

impl Default for Bounds {
    fn default() -> Self {
        Bounds { preemptions: 3, steps: 5_000 }
    }
}

/// Runs `body` under every schedule within the bounds; returns how many there were.
pub(crate) fn check(bounds: Bounds, body: impl Fn() + Send + Sync + 'static) -> u32 {
    let mut model = loom::model::Builder::new();
    model.preemption_bound = Some(bounds.preemptions);
    model.max_branches = bounds.steps;
    let executions = Arc::new(AtomicU32::new(0));
    let counted = executions.clone();
    model.check(move || {
        // ORDERING: Relaxed: loom runs its threads on one thread of the system.
        counted.fetch_add(1, Ordering::Relaxed);
        body();
    });
    executions.load(Ordering::Relaxed)
}
