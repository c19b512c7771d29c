//! The universal property of tile schemes: whatever the machine, the number of processors and of pieces, each
//! piece is worked on exactly once.

use apportion::machine::simulated::Model;
use apportion::machine::{Machine, Processor, RunError, Simulated, Threads};
use apportion::scheme::SettingError;
use apportion::scheme::tiles::{SCHEMES, Scheme, Share, TileWork};
use apportion::sync::BarrierKind;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};

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
const SETTINGS: [&[(&str, &str)]; 9] = [
    &[],
    &[("tile", "3")],
    &[("tile", "1000000")],
    &[("layout", "1999")],
    &[("first", "7"), ("last", "2")],
    &[("first", "1"), ("last", "9")],
    &[("counter", "locked")],
    &[("lock", "ticket")],
    &[("lock", "mcs")],
];

fn e4000() -> Simulated {
    Simulated::new(Model::named("e4000").expect("a preset"))
}

fn schemes<M: Machine>(machine: &M, processors: usize) -> impl Iterator<Item = Scheme<M>> {
    let names = SCHEMES.iter().filter(|scheme| machine.is_native() || !scheme.native_only);
    names.flat_map(move |about| {
        // Locks that serve in order wait for the system's clock where there are more threads than cores.
        let slow =
            |pairs: &&&[(&str, &str)]| machine.is_native() && pairs.iter().any(|(key, _)| *key == "lock");
        SETTINGS.iter().filter(move |pairs| !slow(pairs)).filter_map(move |pairs| {
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

/// Runs every scheme of the machine but some, with its default settings.
fn check_defaults<M: Machine>(machine: &M, processors: usize, count: usize, without: &[&str]) {
    let names = SCHEMES.iter().filter(|scheme| machine.is_native() || !scheme.native_only);
    for about in names.filter(|about| !without.contains(&about.name)) {
        let mut scheme = Scheme::new(about.name, machine, processors, BTreeMap::new()).expect("defaults");
        assert_once(
            about.name,
            count,
            scheme.run(machine, &Pieces { count, rotten: None }).expect("no panic"),
        );
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
    // A thousand who fight for one lock, or a million entries that each take it twice, are minutes.
    check_defaults(&e4000(), 1000, 64, &["per_pixel_queue"]);
    check_defaults(&*team().lock().unwrap_or_else(|e| e.into_inner()), 5, 1 << 20, &["per_pixel_queue"]);
}

#[test]
fn every_number_of_pieces_about_the_number_of_processors() {
    for processors in [1, 2, 3, 7, 64, 128] {
        let origin = Simulated::new(Model::named("origin2000").expect("a preset"));
        for count in [0, 1, processors - 1, processors, processors + 1] {
            check_defaults(&origin, processors, count, &[]);
            if processors < 8 {
                check_all(&Threads::new(processors).expect("threads"), processors, count);
            }
        }
    }
    for processors in [7, 128] {
        let origin = Simulated::new(Model::named("origin2000").expect("a preset"));
        check_defaults(&origin, processors, 100_000, if processors > 7 { &["per_pixel_queue"] } else { &[] });
    }
    check_defaults(&*team().lock().unwrap_or_else(|e| e.into_inner()), 5, 100_000, &[]);
}

/// A frame whose pieces look whether all of the frame before are done.
struct Frame<'a> {
    number: usize,
    count: usize,
    /// Pieces done, frame by frame.
    done: &'a [AtomicU32],
    /// The frame and piece that panics.
    rotten: Option<(usize, usize)>,
}

impl TileWork for Frame<'_> {
    type Found = Vec<usize>;

    fn pieces(&self) -> usize {
        self.count
    }

    fn found(&self) -> Vec<usize> {
        Vec::new()
    }

    fn work_on<P: Processor>(&self, pieces: Range<usize>, found: &mut Vec<usize>, cpu: &P) {
        // ORDERING: Relaxed: the barrier of the run orders one frame and the next.
        let before = self.number.checked_sub(1).map(|before| self.done[before].load(Ordering::Relaxed));
        assert!(
            before.is_none_or(|before| before as usize == self.count),
            "frame {} came early",
            self.number
        );
        for piece in pieces {
            if self.rotten == Some((self.number, piece)) {
                // As a panic, but the hook prints nothing.
                std::panic::resume_unwind(Box::new("a rotten piece"));
            }
            cpu.charge(50 + piece as u64 * 31 % 300);
            cpu.spin();
            found.push(self.number * self.count + piece);
            self.done[self.number].fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// Goes through six frames of so many pieces in one run, then through six of which one fails, then again.
fn check_frames<M: Machine>(machine: &M, processors: usize, count: usize) {
    const FRAMES: usize = 6;
    let names = SCHEMES.iter().filter(|scheme| machine.is_native() || !scheme.native_only);
    for (about, &(barrier, _)) in
        names.flat_map(|about| BarrierKind::ALL.iter().map(move |kind| (about, kind)))
    {
        let what = format!("{} with barrier {barrier} on {processors}", about.name);
        let given = BTreeMap::from([("barrier".to_owned(), barrier.to_owned())]);
        let mut scheme =
            Scheme::new(about.name, machine, processors, given).expect("every machine here has all");
        for rotten in [None, (count > 0).then_some((3, count / 2)), None] {
            let done: Vec<AtomicU32> = (0..FRAMES).map(|_| AtomicU32::new(0)).collect();
            let frame = |number| Frame { number, count, done: &done, rotten };
            let frames: Vec<Frame<'_>> = (0..FRAMES).map(frame).collect();
            match (scheme.run_frames(machine, &frames), rotten) {
                (Ok(shares), None) => assert_once(&what, FRAMES * count, shares),
                (Err(RunError::Panicked { message, .. }), Some(_)) => {
                    assert_eq!(message, "a rotten piece", "{what}")
                }
                (other, _) => panic!("{what}: {other:?}"),
            }
        }
    }
}

#[test]
fn no_frame_begins_before_the_last_is_done() {
    for (processors, count) in [(1, 5), (2, 0), (2, 40), (3, 41), (7, 6), (64, 130)] {
        check_frames(&Simulated::new(Model::named("origin2000").expect("a preset")), processors, count);
    }
    for (processors, count) in [(1, 5), (2, 0), (2, 400), (5, 101)] {
        check_frames(&*team().lock().unwrap_or_else(|e| e.into_inner()), processors, count);
    }
    let none: &[Pieces] = &[];
    let mut scheme = Scheme::new("fixed_tiles", &e4000(), 2, BTreeMap::new()).expect("defaults");
    assert!(scheme.run_frames(&e4000(), none).expect("nothing to do").is_empty());
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
    assert!(new("static_blocks", "tile", "3").contains("has no setting `tile`; it has: barrier"));
    assert!(new("fixed_tiles", "barrier", "gate").contains("expected one of: fetch_op, tree, system"));
    assert!(new("fixed_tiles", "barrier", "system").contains("`e4000`"));
}
