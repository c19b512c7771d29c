//! The universal property of tile schemes: whatever the machine, the number of processors and of pieces, each
//! piece is worked on exactly once.

use apportion::machine::simulated::Model;
use apportion::machine::{Machine, Processor, RunError, Simulated, Threads};
use apportion::scheme::SettingError;
use apportion::scheme::tiles::{SCHEMES, Scheme, Share, TileWork};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Mutex;

#[derive(Clone, Copy, Debug, Default)]
struct Pieces {
    count: usize,
    /// The piece that panics.
    rotten: Option<usize>,
}

impl TileWork for Pieces {
    type Found = Vec<usize>;

    fn pieces(&self) -> usize {
        self.count
    }

    fn found(&self) -> Vec<usize> {
        Vec::new()
    }

    fn work_on<P: Processor>(&self, pieces: Range<usize>, found: &mut Vec<usize>, cpu: &P) {
        assert!(!pieces.is_empty(), "a tile has a piece at least");
        for piece in pieces {
            if self.rotten == Some(piece) {
                // As a panic, but the hook prints nothing.
                std::panic::resume_unwind(Box::new(format!("piece {piece} is rotten")));
            }
            cpu.charge(40 + piece as u64 * 31 % 300);
            found.push(piece);
        }
    }
}

/// Settings that some scheme has; the others are asked without.
const SETTINGS: [&[(&str, &str)]; 6] = [
    &[],
    &[("tile", "3")],
    &[("tile", "1000000")],
    &[("layout", "1999")],
    &[("first", "7"), ("last", "2")],
    &[("first", "1"), ("last", "9")],
];

fn e4000() -> Simulated {
    Simulated::new(Model::named("e4000").expect("a preset"))
}

fn schemes<M: Machine>(machine: &M, processors: usize) -> impl Iterator<Item = Scheme<M>> {
    let names = SCHEMES.iter().filter(|scheme| machine.is_native() || !scheme.native_only);
    names.flat_map(move |about| {
        SETTINGS.iter().filter_map(move |pairs| {
            let given = pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
            match Scheme::new(about.name, machine, processors, given.collect()) {
                Err(SettingError::Unknown { .. }) => None,
                scheme => Some(scheme.expect("it can be set up")),
            }
        })
    })
}

fn assert_once(what: &str, count: usize, shares: Vec<Share<Vec<usize>>>) {
    assert!(shares.iter().all(|share| share.visited == share.found.len() as u64), "{what}: {shares:?}");
    let mut found: Vec<usize> = shares.into_iter().flat_map(|share| share.found).collect();
    found.sort_unstable();
    assert!(found.iter().copied().eq(0..count), "{what}: of {count} pieces {found:?}");
}

/// Runs every scheme of the machine on so many pieces, then on others, then as before.
fn check_all<M: Machine>(machine: &M, processors: usize, count: usize) {
    for mut scheme in schemes(machine, processors) {
        let name = scheme.about().name;
        for count in [count, count / 3, count] {
            let shares = scheme.run(machine, &Pieces { count, rotten: None });
            assert_once(name, count, shares.unwrap_or_else(|error| panic!("{name}: {error}")));
        }
    }
}

fn team() -> &'static Mutex<Threads> {
    static TEAM: std::sync::OnceLock<Mutex<Threads>> = std::sync::OnceLock::new();
    TEAM.get_or_init(|| Mutex::new(Threads::new(5).expect("threads")))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn each_piece_once(count in 0_usize..900, processors in 1_usize..=17, seed: u64) {
        check_all(&*team().lock().unwrap_or_else(|e| e.into_inner()), processors.min(5), count);
        check_all(&e4000(), processors, count);
        check_all(&e4000().disturbed(seed), processors, count);
    }

    #[test]
    fn a_panic_is_an_error_and_the_scheme_lives_on(count in 1_usize..300, rotten: usize, processors in 1_usize..=5) {
        let rotten = Pieces { count, rotten: Some(rotten % count) };
        survives(&*team().lock().unwrap_or_else(|e| e.into_inner()), processors, rotten);
        survives(&e4000(), processors, rotten);
    }
}

fn survives<M: Machine>(machine: &M, processors: usize, rotten: Pieces) {
    let expected = format!("piece {} is rotten", rotten.rotten.expect("one is"));
    for mut scheme in schemes(machine, processors) {
        let name = scheme.about().name;
        for _ in 0..2 {
            match scheme.run(machine, &rotten) {
                Err(RunError::Panicked { message, .. }) => assert_eq!(message, expected, "{name}"),
                other => panic!("{name}: {other:?}"),
            }
            let shares = scheme.run(machine, &Pieces { rotten: None, ..rotten });
            assert_once(name, rotten.count, shares.unwrap_or_else(|error| panic!("{name}: {error}")));
        }
    }
}

#[test]
fn a_thousand_processors_and_a_million_pieces() {
    check_all(&e4000(), 1000, 64);
    check_all(&*team().lock().unwrap_or_else(|e| e.into_inner()), 5, 1 << 20);
}

#[test]
fn wrong_words_are_told_apart() {
    let machine = e4000();
    let new = |name: &str, key: &str, value: &str| {
        let given = BTreeMap::from([(key.to_owned(), value.to_owned())]);
        Scheme::new(name, &machine, 2, given).err().map(|error| error.to_string()).unwrap_or_default()
    };
    assert!(new("lock_free", "tile", "1").contains("no scheme `lock_free` for tiles; there are: serial, "));
    assert!(new("fixed_tiles", "tile", "0").contains("expected a whole number from 1 "));
    assert!(new("decreasing_tiles", "first", "x").contains("setting `first` is `x`"));
    assert!(new("static_blocks", "tile", "3").contains("has no setting `tile`; it has: none"));
}
