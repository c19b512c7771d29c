//! Shared operations a second that the simulated machine gets through, at 13 processors of `e4000`.
//!
//! `hammer`: every processor adds to one word, so that each operation moves a line and changes processors,
//! the worst there is. `lock_free`: the scheme on a generated tree, where most operations hit.

use apportion::job::synthetic::Synthetic;
use apportion::machine::simulated::{Model, SimulatedWord};
use apportion::machine::{Layout, Machine, Simulated, Threads, Word};
use apportion::scheme::tree::Scheme;
use criterion::{Criterion, Throughput};
use std::collections::BTreeMap;
use std::sync::atomic::Ordering;
use std::time::Duration;

const PROCESSORS: usize = 13;
/// Additions of one processor in a run of the hammer.
const ADDITIONS: u64 = 2_000;
const NODES: u32 = 20_001;
const ROUNDS: usize = 31;

fn e4000() -> Simulated {
    Simulated::new(Model::named("e4000").expect("the preset is there"))
}

fn main() {
    let machine = e4000();
    let word = machine.alloc(1, Layout::Padded, |_| SimulatedWord::new(0));
    let mut runs = 0;
    let hammer = || {
        let add = |_: &_| {
            for _ in 0..ADDITIONS {
                // ORDERING: Relaxed: a count, read after the run.
                word[0].fetch_add(1, Ordering::Relaxed);
            }
        };
        machine.run(PROCESSORS, add).expect("the run works");
        runs += 1;
        // ORDERING: Relaxed, as above.
        assert_eq!(word[0].load(Ordering::Relaxed), runs * PROCESSORS as u64 * ADDITIONS);
        machine.statistics().accesses
    };

    let other = e4000();
    let work = Synthetic::new(&other, NODES, 100..=300, 1);
    let mut scheme =
        Scheme::new("lock_free", &other, PROCESSORS, BTreeMap::new()).expect("the scheme is there");
    let lock_free = || {
        let shares = scheme.run(&other, &work).expect("the run works");
        assert_eq!(shares.iter().fold(0, |found, share| found ^ share.found), work.expected());
        other.statistics().accesses
    };

    let clock = Threads::new(1).expect("this thread");
    // As Criterion decides it: without `--bench` (`cargo test`) each body runs once, untimed.
    let is_bench = std::env::args().any(|a| a == "--bench") && !std::env::args().any(|a| a == "--test");
    let mut criterion = Criterion::default()
        .measurement_time(Duration::from_secs(1))
        .warm_up_time(Duration::from_millis(200))
        .sample_size(10)
        .configure_from_args();
    let mut group = criterion.benchmark_group("simulator");
    let mut both = |name: &str, run: &mut dyn FnMut() -> u64| {
        // The first run meets cold caches, and makes the stacks.
        let first = run();
        let mut total = run();
        let each = total - first;
        if is_bench {
            let mut rates: Vec<f64> = (0..ROUNDS)
                .map(|_| {
                    let (before, total_before) = (clock.now(), total);
                    total = run();
                    (total - total_before) as f64 / (clock.now() - before) as f64 * 1e3
                })
                .collect();
            rates.sort_by(f64::total_cmp);
            let [low, rate, high] = [1, 2, 3].map(|quarter| rates[ROUNDS * quarter / 4]);
            println!("{name:<10} {each} shared operations a run, {rate:.1} M/s ({low:.1} to {high:.1})");
        }
        group.throughput(Throughput::Elements(each));
        group.bench_function(name, |b| b.iter(&mut *run));
    };
    both("hammer", &mut { hammer });
    both("lock_free", &mut { lock_free });
    group.finish();
    criterion.final_summary();
}
