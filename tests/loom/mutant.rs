//! Broken machines, and the assertion that a check fails on them.

use crate::{Bounds, check};
use std::cell::Cell;
use std::sync::Once;

/// What is wrong with the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mutant {
    /// Acquire, Release and AcqRel accesses are Relaxed.
    Relaxed,
    /// Fences do nothing.
    NoFence,
    /// A read-modify-write is a load and a store.
    Torn,
    /// `test_and_set` always says that the word was free.
    AlwaysFree,
    /// `wait_until` watches the first of its words only: the wake-up through the others is lost.
    FirstWordOnly,
    /// `wait_until` returns at once.
    NoWait,
    /// Plain stores to the first word of a pair are lost during a run: an in-queue's `head`.
    LostHead,
    /// Stores of `u64::MAX` are lost during a run: `Quiescence::leave` does nothing.
    NeverBusy,
    /// Not the machine but the work: a query says that it is over before its contact is found.
    HastyStop,
}

impl Mutant {
    /// Every one of them.
    pub(crate) const ALL: [Mutant; 9] = [
        Mutant::Relaxed,
        Mutant::NoFence,
        Mutant::Torn,
        Mutant::AlwaysFree,
        Mutant::FirstWordOnly,
        Mutant::NoWait,
        Mutant::LostHead,
        Mutant::NeverBusy,
        Mutant::HastyStop,
    ];
}

thread_local! {
    // loom runs all threads of a model on the system's thread that started it.
    static MUTANT: Cell<Option<Mutant>> = const { Cell::new(None) };
}

/// Whether this is wrong with the machine of this thread's model.
pub(crate) fn is(mutant: Mutant) -> bool {
    MUTANT.get() == Some(mutant)
}

const QUIET: &str = "mutant";

/// Whether loom finds `body` wrong on the broken machine.
pub(crate) fn is_caught(mutant: Mutant, bounds: Bounds, body: impl Fn() + Send + Sync + 'static) -> bool {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let loud = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if std::thread::current().name() != Some(QUIET) {
                loud(info);
            }
        }));
    });
    // A thread of its own: whatever a failed model leaves behind goes with it.
    let model = std::thread::Builder::new().name(QUIET.to_owned()).spawn(move || {
        MUTANT.set(Some(mutant));
        check(bounds, body);
    });
    model.expect("a thread").join().is_err()
}

/// Asserts that loom finds `body` wrong on each of the broken machines.
#[track_caller]
pub(crate) fn assert_caught(
    what: &str,
    mutants: &[Mutant],
    bounds: Bounds,
    body: impl Fn() + Copy + Send + Sync + 'static,
) {
    for &mutant in mutants {
        assert!(is_caught(mutant, bounds, body), "{what}: the mutant {mutant:?} was not caught");
    }
}
