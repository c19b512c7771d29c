//! Every tree scheme of the list, whole: each node is visited exactly once, and what a visit wrote is
//! seen by the visits below it.

use crate::machine::{Loom, LoomSlot};
use crate::mutant::Mutant::{self, AlwaysFree, FirstWordOnly, LostHead, NeverBusy, NoFence, Relaxed, Torn};
use crate::mutant::is_caught;
use crate::{Bounds, check};
use apportion::machine::{Processor, Slot};
use apportion::scheme::SettingError;
use apportion::scheme::tree::{SCHEMES, Scheme, TreeWork};
use std::collections::BTreeMap;

/// A tree of a few nodes: the parent of each but the first, which is the root.
type Tree = &'static [usize];

const ONE: Tree = &[];
const CHAIN: Tree = &[0, 1];
const FORK: Tree = &[0, 0];
const STAR: Tree = &[0, 0, 0];
/// The task that a neighbour gets first has two below it, so that something comes back.
const MIXED: Tree = &[0, 0, 2, 2];
/// The neighbour sends back twice: the second must not come too late.
const TWICE: Tree = &[0, 0, 2, 2, 2, 2];

/// The tree as work. A node's slot is written by the visit to its parent and read by its own: loom
/// reports a race unless the scheme puts one before the other.
struct Nodes {
    parents: Tree,
    slots: Vec<LoomSlot<u32>>,
}

impl TreeWork for Nodes {
    type Task = u32;
    type Found = Vec<u32>;

    fn root(&self) -> Option<u32> {
        Some(0)
    }

    fn found(&self) -> Vec<u32> {
        Vec::new()
    }

    fn visit<P: Processor>(&self, node: u32, found: &mut Vec<u32>, _cpu: &P, mut emit: impl FnMut(u32)) {
        // SAFETY: the visit to the parent came before, if the scheme is right; loom reports races.
        assert_eq!(unsafe { self.slots[node as usize].read() }, node, "what the parent wrote");
        found.push(node);
        let below = self.parents.iter().zip(1..).filter(|(parent, _)| **parent == node as usize);
        for (_, child) in below {
            // SAFETY: as above.
            unsafe { self.slots[child as usize].write(child) };
            emit(child);
        }
    }
}

/// One setting to add to the smallest capacity; the ones a scheme does not know are left out.
pub(crate) type Extra = Option<(&'static str, &'static str)>;

const EXTRAS: [Extra; 13] = [
    None,
    Some(("capacity", "2")),
    Some(("lock", "test_and_set")),
    Some(("lock", "ticket")),
    Some(("lock", "mcs")),
    Some(("counter", "fetch_add")),
    Some(("insert", "batch")),
    Some(("threshold", "0")),
    Some(("threshold", "1")),
    Some(("balance", "half_difference")),
    Some(("ring", "1999")),
    Some(("mailbox", "1")),
    Some(("order", "stack")),
];

/// A scheme set up with small rooms; none if it does not know the extra setting.
pub(crate) fn set_up(name: &str, machine: &Loom, extra: Extra) -> Option<Scheme<Loom>> {
    let extra: Vec<(&str, &str)> = extra.into_iter().collect();
    for small in [&[("capacity", "1")][..], &[]] {
        let pairs = small.iter().chain(&extra).map(|(k, v)| ((*k).to_owned(), (*v).to_owned()));
        let given = pairs.collect::<BTreeMap<_, _>>();
        match Scheme::new(name, machine, 2, given) {
            Ok(scheme) => return Some(scheme),
            Err(SettingError::Unknown { .. }) => {}
            Err(e) => panic!("{e}"),
        }
    }
    None
}

/// Runs a scheme until it has shared (one that never does: three times); checks every run. Nothing is
/// done if the scheme does not know the extra setting.
fn visits(name: &str, extra: Extra, parents: Tree) {
    let machine = Loom::new();
    let Some(mut scheme) = set_up(name, &machine, extra) else {
        assert!(extra.is_some(), "{name} cannot be set up");
        return;
    };
    for _ in 0..3 {
        let slots = (0..=parents.len()).map(|_| LoomSlot::new(0)).collect();
        let shares = scheme.run(&machine, &Nodes { parents, slots }).expect("no panic");
        let visited: u64 = shares.iter().map(|share| share.visited).sum();
        let mut found: Vec<u32> = shares.into_iter().flat_map(|share| share.found).collect();
        found.sort_unstable();
        assert!(found.iter().copied().eq(0..=parents.len() as u32), "{name}: visited {found:?}");
        assert_eq!(visited, found.len() as u64, "{name}");
        if machine.shared_runs() > 0 {
            return;
        }
    }
}

/// The schemes that run on machines other than real threads.
fn portable() -> impl Iterator<Item = &'static str> {
    SCHEMES.iter().filter(|scheme| !scheme.native_only).map(|scheme| scheme.name)
}

/// Which broken machines the check of a whole scheme tells from a sound one.
const CAUGHT: &[(&str, &[Mutant])] = &[
    ("global_queue", &[Relaxed, Torn, AlwaysFree, FirstWordOnly]),
    ("global_counter", &[Relaxed, Torn, AlwaysFree, FirstWordOnly, NeverBusy]),
    ("hybrid", &[Relaxed, Torn, AlwaysFree, FirstWordOnly, NeverBusy]),
    ("lock_free", &[Relaxed, FirstWordOnly, NeverBusy, LostHead]),
    ("receiver_initiated", &[Relaxed, FirstWordOnly, NeverBusy]),
    ("work_stealing", &[Relaxed, NoFence, Torn, FirstWordOnly]),
    // What it shares with first is `work_stealing`.
    ("auto", &[Relaxed, NoFence, Torn, FirstWordOnly]),
];

/// Schemes that use one processor only, so that nothing can go wrong between two.
const ALONE: &[&str] = &["serial"];

fn bounds() -> Bounds {
    Bounds { preemptions: 2, steps: 5_000 }
}

#[test]
fn every_scheme_visits_each_node_once() {
    for name in portable() {
        for extra in EXTRAS {
            let trees = if extra.is_none() { &[ONE, CHAIN, FORK, STAR, MIXED][..] } else { &[STAR] };
            let mut executions = 0;
            for &parents in trees {
                executions += check(bounds(), move || visits(name, extra, parents));
            }
            eprintln!("{name} {extra:?}: {executions} executions");
        }
    }
}

#[test]
fn every_scheme_is_wrong_on_a_broken_machine() {
    for name in portable().filter(|name| !ALONE.contains(name)) {
        let is_caught = |mutant| {
            let cases = [(None, MIXED), (None, TWICE), (Some(("capacity", "2")), STAR)];
            cases
                .into_iter()
                .any(|(extra, tree)| is_caught(mutant, bounds(), move || visits(name, extra, tree)))
        };
        match CAUGHT.iter().find(|(known, _)| *known == name) {
            Some((_, mutants)) => {
                for &mutant in *mutants {
                    assert!(is_caught(mutant), "{name}: the mutant {mutant:?} was not caught");
                }
            }
            None => assert!(
                Mutant::ALL.into_iter().any(is_caught),
                "{name}: no mutant was caught; does the scheme share at all?"
            ),
        }
    }
}
