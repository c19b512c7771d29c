//! The universal property: whatever the scheme, the machine, the number of processors and the tree, each
//! node is visited exactly once.

use apportion::machine::simulated::Model;
use apportion::machine::{Layout, Machine, Processor, RunError, Simulated, Threads, Word};
use apportion::scheme::SettingError;
use apportion::scheme::tree::{SCHEMES, Scheme, Share, TreeWork, work};
use apportion::sync::{Lock, LockKind};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard};
use std::time::Duration;

/// A tree by the children of each node; no root if there is no node.
#[derive(Clone, Debug, Default)]
struct Tree {
    children: Vec<Vec<u32>>,
    /// The node whose visit panics.
    panics: Option<u32>,
    /// The node whose visit takes a nap, as if its worker had been descheduled.
    sleeps: Option<u32>,
}

impl Tree {
    fn of(parents: impl IntoIterator<Item = u32>) -> Self {
        let mut children = vec![Vec::new()];
        for parent in parents {
            let node = children.len() as u32;
            children[parent as usize].push(node);
            children.push(Vec::new());
        }
        Tree { children, ..Tree::default() }
    }

    fn len(&self) -> usize {
        self.children.len()
    }
}

impl TreeWork for Tree {
    type Task = u32;
    type Found = Vec<u32>;

    fn root(&self) -> Option<u32> {
        (!self.children.is_empty()).then_some(0)
    }

    fn found(&self) -> Vec<u32> {
        Vec::new()
    }

    fn visit<P: Processor>(&self, node: u32, found: &mut Vec<u32>, cpu: &P, emit: impl FnMut(u32)) {
        if self.panics == Some(node) {
            // As a panic, but the hook prints nothing.
            std::panic::resume_unwind(Box::new(format!("node {node} is rotten")));
        }
        if self.sleeps == Some(node) {
            std::thread::sleep(Duration::from_millis(10));
        }
        cpu.charge(50 + u64::from(node) * 37 % 400);
        found.push(node);
        self.children[node as usize].iter().copied().for_each(emit);
    }
}

/// Chains, stars, wide and ragged trees, one node, none at all.
fn trees(most: usize) -> impl Strategy<Value = Tree> {
    let shape = prop_oneof![Just(0_u32), Just(1), Just(2), Just(3), Just(4)];
    (shape, 0..most, any::<u64>()).prop_map(|(shape, nodes, seed)| {
        if nodes == 0 {
            return Tree::default();
        }
        let mut state = seed;
        Tree::of((1..nodes as u32).map(|node| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let random = (state >> 33) as u32;
            match shape {
                0 => node - 1,
                1 => 0,
                2 => (node - 1) / 8,
                3 => random % node,
                _ => node - 1 - random % node.min(5),
            }
        }))
    })
}

/// One team for all tests, oversubscribed on most hosts.
fn team() -> MutexGuard<'static, Threads> {
    static TEAM: Mutex<Option<&'static Mutex<Threads>>> = Mutex::new(None);
    let mut team = TEAM.lock().unwrap_or_else(|e| e.into_inner());
    let team = *team.get_or_insert_with(|| {
        let processors = (4 * Threads::cores()).clamp(2, 8);
        Box::leak(Box::new(Mutex::new(Threads::new(processors).expect("threads"))))
    });
    team.lock().unwrap_or_else(|e| e.into_inner())
}

fn names() -> impl Iterator<Item = &'static str> {
    SCHEMES.iter().map(|scheme| scheme.name)
}

fn e4000() -> Simulated {
    Simulated::new(Model::named("e4000").expect("a preset"))
}

fn settings(pairs: &[(&str, String)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect()
}

/// The scheme with those of the settings that it knows; none if the machine cannot run it.
fn scheme<M: Machine>(name: &str, machine: &M, processors: usize, room: usize) -> Option<Scheme<M>> {
    let rooms = [("capacity", room.to_string()), ("mailbox", room.to_string())];
    for chosen in [&rooms[..1], &rooms[1..], &[]] {
        match Scheme::new(name, machine, processors, settings(chosen)) {
            Ok(scheme) => return Some(scheme),
            Err(SettingError::Unknown { .. }) => {}
            Err(SettingError::NativeOnly { .. }) => return None,
            Err(e) => panic!("{e}"),
        }
    }
    panic!("{name} cannot be set up");
}

fn assert_once(what: &str, tree: &Tree, processors: usize, shares: Vec<Share<Vec<u32>>>) {
    assert!(shares.len() <= processors, "{what}: {} shares of {processors}", shares.len());
    for (p, share) in shares.iter().enumerate() {
        assert_eq!(share.visited, share.found.len() as u64, "{what}: processor {p}");
    }
    let mut found: Vec<u32> = shares.into_iter().flat_map(|share| share.found).collect();
    found.sort_unstable();
    assert!(found.iter().copied().eq(0..tree.len() as u32), "{what}: not each node once: {found:?}");
}

/// Runs every scheme that the machine takes on the tree, several times with the same queues.
fn check_all<M: Machine>(machine: &M, processors: usize, room: usize, tree: &Tree, runs: usize) {
    for name in names() {
        let Some(mut scheme) = scheme(name, machine, processors, room) else { continue };
        for _ in 0..runs {
            let shares = scheme.run(machine, tree).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_once(name, tree, processors, shares);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn each_node_once_on_threads(tree in trees(2000), p in 1_usize..=8, room in 1_usize..=3) {
        let team = team();
        check_all(&*team, p.min(team.most_processors()), room, &tree, 2);
    }

    #[test]
    fn each_node_once_on_simulated_machines(tree in trees(600), p in 1_usize..=13, room in 1_usize..=3) {
        check_all(&e4000(), p, room, &tree, 2);
    }

    #[test]
    fn each_node_once_on_disturbed_machines(
        tree in trees(200),
        p in 2_usize..=13,
        room in 1_usize..=2,
        seed: u64,
    ) {
        check_all(&e4000().disturbed(seed), p, room, &tree, 2);
    }

    #[test]
    fn a_seed_fixes_the_run(tree in trees(150), p in 1_usize..=13, seed: u64) {
        for name in names() {
            let run = || {
                let machine = e4000().disturbed(seed);
                let mut scheme = scheme(name, &machine, p, 2)?;
                let shares = [scheme.run(&machine, &tree), scheme.run(&machine, &tree)];
                Some(format!("{shares:?} {} {:?}", machine.now(), machine.statistics()))
            };
            prop_assert_eq!(run(), run(), "{}", name);
        }
    }

    #[test]
    fn a_panic_is_an_error_and_the_scheme_lives_on(tree in trees(300), p in 1_usize..=8, node: u32, seed: u64) {
        prop_assume!(tree.len() > 0);
        let rotten = Tree { panics: Some(node % tree.len() as u32), ..tree.clone() };
        {
            let team = team();
            survives(&*team, p.min(team.most_processors()), &tree, &rotten);
        }
        survives(&e4000().disturbed(seed), p, &tree, &rotten);
    }
}

fn survives<M: Machine>(machine: &M, processors: usize, tree: &Tree, rotten: &Tree) {
    let expected = format!("node {} is rotten", rotten.panics.expect("one panics"));
    for name in names() {
        let Some(mut scheme) = scheme(name, machine, processors, 2) else { continue };
        for _ in 0..2 {
            match scheme.run(machine, rotten) {
                Err(RunError::Panicked { message, .. }) => assert_eq!(message, expected, "{name}"),
                other => panic!("{name}: {other:?}"),
            }
            let shares = scheme.run(machine, tree).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_once(name, tree, processors, shares);
        }
    }
}

/// A holder that is being unwound must give its lock back without waiting for anybody.
fn locks_in_failed_runs<M: Machine>(machine: &M, culprit: usize, delay: u64) {
    for &(name, kind) in LockKind::ALL {
        let lock = Lock::new(machine, kind, Layout::Packed, 3);
        let word = || machine.alloc(1, Layout::Packed, |_| M::Word::new(0));
        let (words, own) = (word(), word());
        let failed = machine.run(3, |cpu| {
            if culprit == 3 && cpu.id() == 2 {
                // It has nothing to do with the lock, so it may fail at any moment of the others.
                cpu.charge(delay);
                // ORDERING: Relaxed: a shared access to wait for its turn at.
                own[0].load(Ordering::Relaxed);
                std::panic::resume_unwind(Box::new("beside"));
            }
            for turn in 0..200 {
                lock.with(cpu, || {
                    // ORDERING: Relaxed: the lock orders it.
                    words[0].store(turn, Ordering::Relaxed);
                    if culprit == cpu.id() && turn == 20 + delay % 7 {
                        std::panic::resume_unwind(Box::new("while holding"));
                    }
                });
                cpu.charge(delay % 97);
            }
        });
        assert!(matches!(failed, Err(RunError::Panicked { .. })), "{name}: {failed:?}");
    }
}

#[test]
fn a_panic_while_a_lock_is_held_or_handed_on_ends_the_run() {
    let team = Threads::new(3).expect("threads");
    for delay in 0..300 {
        for culprit in [0, 3] {
            locks_in_failed_runs(&e4000().disturbed(delay), culprit, delay * 13);
            locks_in_failed_runs(&team, culprit, delay);
        }
    }
}

/// With MCS locks a releasing processor may wait for its successor, also while it is being unwound.
#[test]
fn a_panic_ends_runs_under_every_kind_of_lock() {
    let tree = Tree::of((1..200).map(|node| (node - 1) / 4));
    for name in names() {
        for (lock, _) in LockKind::ALL {
            for seed in 0..20 {
                let machine = e4000().disturbed(seed);
                let given = settings(&[("lock", (*lock).to_owned())]);
                let Ok(mut scheme) = Scheme::new(name, &machine, 9, given) else { continue };
                let rotten = Tree { panics: Some(seed as u32 * 7 + 3), ..tree.clone() };
                let failed = scheme.run(&machine, &rotten);
                assert!(matches!(failed, Err(RunError::Panicked { .. })), "{name}, {lock}: {failed:?}");
                let shares = scheme.run(&machine, &tree).unwrap_or_else(|e| panic!("{name}, {lock}: {e}"));
                assert_once(name, &tree, 9, shares);
            }
        }
    }
}

#[test]
fn a_descheduled_worker_delays_but_spoils_nothing() {
    let team = team();
    for sleeps in [0, 1, 17, 99] {
        let tree = Tree { sleeps: Some(sleeps), ..Tree::of((1..100).map(|node| (node - 1) / 3)) };
        check_all(&*team, team.most_processors(), 1, &tree, 1);
    }
}

#[test]
fn a_large_tree() {
    let tree =
        Tree::of((1..100_000_u32).map(|node| node - 1 - node.wrapping_mul(2_654_435_761) % node.min(40)));
    {
        let team = team();
        check_all(&*team, team.most_processors(), 32, &tree, 1);
    }
    check_all(&e4000(), 13, 32, &tree, 1);
}

/// Depth costs no scheme its stack: a chain, and a chain with a leaf beside each of its nodes.
#[test]
fn trees_as_deep_as_they_have_nodes() {
    let team = team();
    for width in [1, 2] {
        let tree = Tree::of((1..20_000_u32).map(|node| (node - 1) / width * width));
        check_all(&*team, 3, 4, &tree, 1);
    }
}

#[test]
fn a_thousand_processors() {
    check_all(&e4000(), 1024, 1, &Tree::of((1..300).map(|node| (node - 1) / 3)), 1);
}

#[test]
fn found_sets_are_the_serial_ones() {
    // The children of n are n * 3 + 1 to n * 3 + 3.
    let job = work(0_u64, Vec::new, |node, found: &mut Vec<u64>, emit| {
        found.push(node);
        (3 * node + 1..=3 * node + 3).filter(|&child| child < 500).for_each(emit);
    });
    let team = team();
    let union = |name: &str| {
        let shares = Scheme::new(name, &*team, 2, BTreeMap::new()).expect("defaults").run(&*team, &job);
        let mut all: Vec<u64> = shares.expect("a run").into_iter().flat_map(|share| share.found).collect();
        all.sort_unstable();
        all
    };
    let serial = union("serial");
    assert_eq!(serial.len(), 500);
    for name in names() {
        assert_eq!(union(name), serial, "{name}");
    }
}

#[test]
fn wrong_settings_are_told_apart() {
    let machine = e4000();
    let new = |name: &str, pairs: &[(&str, String)]| Scheme::new(name, &machine, 2, settings(pairs)).err();
    match new("lockfree", &[]) {
        Some(SettingError::NoScheme { name, known, .. }) => {
            assert_eq!(name, "lockfree");
            assert!(names().all(|name| known.contains(name)), "{known}");
        }
        other => panic!("{other:?}"),
    }
    let known_by = |error| match error {
        Some(SettingError::Unknown { key, known, .. }) => (key, known),
        other => panic!("{other:?}"),
    };
    let (key, known) = known_by(new("lock_free", &[("capasity", "3".to_owned())]));
    assert!(key == "capasity" && known.contains("capacity"), "{known}");
    for (name, key, value) in [
        ("lock_free", "capacity", "0"),
        ("lock_free", "capacity", "-1"),
        ("lock_free", "balance", "on"),
        ("global_queue", "lock", "spin"),
        ("global_counter", "counter", "atomic"),
        ("hybrid", "threshold", "six"),
        ("receiver_initiated", "mailbox", "0"),
        ("work_stealing", "grain", "0"),
        ("serial", "order", "up"),
    ] {
        let error = new(name, &[(key, value.to_owned())]);
        let right = matches!(&error, Some(SettingError::Value { scheme, key: k, value: v, .. })
            if scheme == name && k == key && v == value);
        assert!(right, "{name} {key} {value}: {error:?}");
    }
    for name in ["crossbeam_deque", "rayon_join"] {
        assert!(matches!(new(name, &[]), Some(SettingError::NativeOnly { .. })), "{name}");
    }
    let few = Scheme::new("lock_free", &machine, 5000, BTreeMap::new()).expect("set up");
    let failed = { few }.run(&machine, &Tree::default());
    assert!(matches!(failed, Err(RunError::Processors { asked: 5000, .. })), "{failed:?}");
}
