//! The in-queue against the ring of the crate `rtrb`, on two pinned threads and on one.
//!
//! Rivals take turns round by round, in an order that alternates, so that both meet the same weather; what
//! counts is the median of the rounds' ratios. Criterion then times each by itself. Both are shown to hand
//! over every task in order before anything is timed, and each timed run checks the sum of what it received.
//!
//! Between rounds each rival's ring is a new one, so that no lucky or unlucky address decides.

use apportion::machine::threads::{TeamSettings, Thread};
use apportion::machine::{Machine, Processor, Threads};
use criterion::Criterion;
use rivals::{Receiving, Sending, ours, theirs, theirs_in_place};
use std::hint::black_box;
use std::sync::Mutex;
use std::time::Duration;

#[path = "in_queue/rivals.rs"]
mod rivals;

/// Tasks a ring holds.
const CAPACITY: usize = 1024;
/// Tasks of a chunk.
const CHUNK: usize = 64;
/// Tasks handed over in one timed run: well under a millisecond, so that most runs are over before the
/// operating system thinks of something else. A multiple of the chunk.
const TASKS: usize = 1 << 16;
/// Rounds of the comparison.
const ROUNDS: usize = 301;

/// A turn of waiting for the other thread: a core that is needed elsewhere is given up now and then.
#[inline]
fn wait(turns: &mut u32) {
    *turns += 1;
    if turns.is_multiple_of(4096) { std::thread::yield_now() } else { std::hint::spin_loop() }
}

#[derive(Clone, Copy, PartialEq)]
enum Way {
    Item,
    Chunk,
}

fn send_all(to: &mut impl Sending, way: Way, source: &[u64]) {
    let mut turns = 0;
    if way == Way::Item {
        for &task in source {
            while !to.item(task) {
                wait(&mut turns);
            }
        }
    } else {
        for mut chunk in source.chunks(CHUNK) {
            while !chunk.is_empty() {
                let sent = to.chunk(chunk);
                chunk = &chunk[sent..];
                if sent == 0 {
                    wait(&mut turns);
                }
            }
        }
    }
}

fn receive_all(from: &mut impl Receiving, way: Way, n: usize, mut each: impl FnMut(u64)) {
    let (mut turns, mut left) = (0, n);
    while left > 0 {
        let found = match way {
            Way::Item => from.item().map(&mut each).map_or(0, |()| 1),
            Way::Chunk => from.chunk(&mut each),
        };
        if found == 0 {
            wait(&mut turns);
        }
        left -= found;
    }
}

/// Hands the source over between two threads; nanoseconds from before the start to after the end.
fn across<S: Sending, R: Receiving>(team: &Threads, ends: (S, R), way: Way, source: &[u64]) -> u64 {
    let (to, from) = (Mutex::new(Some(ends.0)), Mutex::new(Some(ends.1)));
    let before = team.now();
    let sums = team.run(2, |cpu: &Thread| {
        let mut sum = 0_u64;
        if cpu.id() == 0 {
            let mut to = to.lock().expect("nobody panics").take().expect("there is one sender");
            send_all(&mut to, way, source);
        } else {
            let mut from = from.lock().expect("nobody panics").take().expect("there is one receiver");
            receive_all(&mut from, way, source.len(), |task| sum = sum.wrapping_add(task));
        }
        sum
    });
    let elapsed = team.now() - before;
    assert_eq!(sums.expect("the run works")[1], sum(source), "every task has arrived");
    elapsed
}

/// Hands the source over on this thread alone; nanoseconds.
fn alone<S: Sending, R: Receiving>(team: &Threads, mut ends: (S, R), source: &[u64]) -> u64 {
    let before = team.now();
    let mut received = 0_u64;
    for &task in source {
        assert!(ends.0.item(black_box(task)));
        received = received.wrapping_add(ends.1.item().expect("it was just sent"));
    }
    let elapsed = team.now() - before;
    assert_eq!(received, sum(source));
    elapsed
}

fn sum(source: &[u64]) -> u64 {
    source.iter().fold(0, |sum, task| sum.wrapping_add(*task))
}

/// Every task arrives, in order, also when sender and receiver are out of step.
fn check<S: Sending, R: Receiving>(team: &Threads, make: impl Fn() -> (S, R), source: &[u64]) {
    for way in [Way::Item, Way::Chunk] {
        let (to, from) = make();
        let (to, from) = (Mutex::new(to), Mutex::new(from));
        let received = team.run(2, |cpu: &Thread| {
            let mut received = Vec::new();
            if cpu.id() == 0 {
                send_all(&mut *to.lock().expect("nobody panics"), way, source);
            } else {
                let mut from = from.lock().expect("nobody panics");
                receive_all(&mut *from, way, source.len(), |task| received.push(task));
            }
            received
        });
        assert_eq!(received.expect("the run works")[1], source, "in order, each once");
    }
    alone(team, make(), source);
}

/// Times `ours` and `theirs` by turns and prints the medians, and the ratio of throughputs with quartiles.
fn compare(what: &str, mut ours: impl FnMut() -> u64, mut theirs: impl FnMut() -> u64) {
    let mut rounds: Vec<(f64, f64)> = (0..ROUNDS)
        .map(|round| {
            let first = (round % 2 == 0).then(&mut ours);
            let other = theirs();
            (first.unwrap_or_else(&mut ours) as f64, other as f64)
        })
        .collect();
    let mut sorted = |key: fn(&(f64, f64)) -> f64| {
        rounds.sort_by(|a, b| key(a).total_cmp(&key(b)));
        [1, 2, 3].map(|quarter| key(&rounds[ROUNDS * quarter / 4]))
    };
    let rate = |ns: f64| TASKS as f64 / ns * 1e3;
    let (mine, other) = (sorted(|r| r.0)[1], sorted(|r| r.1)[1]);
    let [low, ratio, high] = sorted(|r| r.1 / r.0);
    println!(
        "{what:<22} apportion {:7.1} M/s  rtrb {:7.1} M/s  ratio {ratio:.3} ({low:.3} to {high:.3})",
        rate(mine),
        rate(other)
    );
}

fn main() {
    let settings = TeamSettings { spin: Duration::from_millis(50), pin: true, pin_caller: true };
    let team = &Threads::with_settings(2, &settings).expect("two threads");
    let source: Vec<u64> = (0..TASKS as u64).map(|i| i.wrapping_mul(0x9e37_79b9_7f4a_7c15)).collect();
    let source = source.as_slice();
    check(team, || ours(team), source);
    check(team, theirs, source);
    check(team, theirs_in_place, source);

    // As Criterion decides it: without `--bench` (`cargo test`) each body runs once, untimed.
    let is_bench = std::env::args().any(|a| a == "--bench") && !std::env::args().any(|a| a == "--test");
    let ways = [("two threads, item", Way::Item), ("two threads, chunk", Way::Chunk)];
    if is_bench {
        for (name, way) in ways {
            let ours = || across(team, ours(team), way, source);
            compare(name, ours, || across(team, theirs(), way, source));
        }
        let chunks = || across(team, ours(team), Way::Chunk, source);
        compare("chunk, rtrb in place", chunks, || across(team, theirs_in_place(), Way::Chunk, source));
        compare("one thread", || alone(team, ours(team), source), || alone(team, theirs(), source));
    }

    let mut criterion = Criterion::default()
        .measurement_time(Duration::from_secs(1))
        .warm_up_time(Duration::from_millis(200))
        .sample_size(20)
        .configure_from_args();
    let repeat =
        |iterations, run: &dyn Fn() -> u64| Duration::from_nanos((0..iterations).map(|_| run()).sum());
    let mut group = criterion.benchmark_group("in_queue");
    group.throughput(criterion::Throughput::Elements(TASKS as u64));
    let mut both = |name: &str, ours: &dyn Fn() -> u64, theirs: &dyn Fn() -> u64| {
        group.bench_function(format!("{name}/apportion"), |b| b.iter_custom(|n| repeat(n, ours)));
        group.bench_function(format!("{name}/rtrb"), |b| b.iter_custom(|n| repeat(n, theirs)));
    };
    for (name, way) in ways {
        both(name, &|| across(team, ours(team), way, source), &|| across(team, theirs(), way, source));
    }
    both("one thread", &|| alone(team, ours(team), source), &|| alone(team, theirs(), source));
    group.finish();
    criterion.final_summary();
}
