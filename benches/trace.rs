//! What tracing costs: frames with and without a trace by turns, on two pinned threads.
//!
//! A frame is a tree of 4001 nodes at 100-300 ns a node. Within a round both kinds of frame run, in an order
//! that alternates, so that they meet the same weather; what counts is the median of the rounds' ratios, with
//! the 95 % interval of that median by order statistics. Starting and taking the trace lie outside the frame,
//! as they do in a run.
//!
//! `cargo bench --bench trace`; a number after `--` sets the nanoseconds a node.

use apportion::job::synthetic::Synthetic;
use apportion::machine::threads::TeamSettings;
use apportion::machine::{Machine, Threads};
use apportion::scheme::tree::{SCHEMES, Scheme};
use std::collections::BTreeMap;
use std::time::Duration;

const NODES: u32 = 4001;
/// Rounds of the comparison; odd, so that there is a median.
const ROUNDS: usize = 1001;

fn main() {
    let settings =
        TeamSettings { spin: Duration::from_millis(20), pin_caller: true, ..TeamSettings::default() };
    let team = Threads::with_settings(2, &settings).expect("two threads");
    let asked = std::env::args().skip(1).find_map(|word| word.parse::<u32>().ok());
    let work_ns = asked.map_or(100..=300, |ns| ns / 2..=ns + ns / 2);
    let work = Synthetic::new(&team, NODES, work_ns.clone(), 1);
    println!("{NODES} nodes, {work_ns:?} ns each, 2 threads, {ROUNDS} rounds: traced / untraced frame time");
    for name in SCHEMES.iter().map(|scheme| scheme.name) {
        let processors = if name == "serial" { 1 } else { 2 };
        let mut scheme = Scheme::new(name, &team, processors, BTreeMap::new()).expect("a scheme of the list");
        let mut marks = Vec::new();
        let mut frame = |traced: bool| {
            if traced {
                team.start_trace();
            }
            let before = team.now();
            let shares = scheme.run(&team, &work).expect("a frame");
            let took = team.now() - before;
            assert_eq!(shares.iter().map(|share| share.visited).sum::<u64>(), u64::from(NODES));
            if let Some(trace) = team.take_trace() {
                assert_eq!(trace.lost, 0, "{name}: there is room for a frame's marks");
                marks.push(trace.processors.iter().map(Vec::len).sum::<usize>());
            }
            took as f64
        };
        let round = |number: usize| {
            let first = number.is_multiple_of(2);
            let (one, other) = (frame(first), frame(!first));
            let (traced, plain) = if first { (one, other) } else { (other, one) };
            (traced / plain, plain)
        };
        let rounds: Vec<(f64, f64)> = (0..ROUNDS + 50).map(round).skip(50).collect();
        let (ratios, plain): (Vec<f64>, Vec<f64>) = rounds.into_iter().unzip();
        let (ratios, plain) = (sorted(ratios), sorted(plain));
        // The ranks between which the median lies 19 times in 20: a half, and 1.96 half roots of the count, off.
        let off = (0.98 * (ROUNDS as f64).sqrt()).ceil() as usize;
        let (low, high) = (ratios[ROUNDS / 2 - off], ratios[ROUNDS / 2 + off]);
        marks.sort_unstable();
        println!(
            "{name:20} {:.4} [{low:.4}, {high:.4}]   untraced {:8.1} us, {:6} spans",
            ratios[ROUNDS / 2],
            plain[ROUNDS / 2] / 1e3,
            marks[marks.len() / 2],
        );
    }
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}
