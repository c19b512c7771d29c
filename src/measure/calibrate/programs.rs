//! The little programs that tell what a machine's constants are. Each is written once and runs on real
//! threads and on the simulated machine alike: a constant is right when both take as long.
//!
//! Each returns ticks of its machine: nanoseconds on threads, cycles on a simulated one.

use crate::job::synthetic::Synthetic;
use crate::machine::{Layout, Machine, Processor, RunError, Shared, Word};
use crate::scheme::tree::{Scheme, TreeWork};
use crate::sync::{RingSettings, in_queue};
use std::collections::BTreeMap;
use std::sync::atomic::Ordering::{AcqRel, Acquire, Relaxed, Release, SeqCst};

/// Lines that are handed over at once.
const LINES: usize = 32;

fn word<M: Machine>(machine: &M) -> Shared<M::Word> {
    machine.alloc(1, Layout::Padded, |_| Word::new(0))
}

fn ticks<M: Machine>(machine: &M, body: impl FnOnce() -> Result<(), RunError>) -> Result<f64, RunError> {
    let before = machine.now();
    body()?;
    Ok((machine.now() - before) as f64)
}

/// One processor, everything in its first-level cache: a task through an in-queue and back, as an
/// example of the short dependent code schemes consist of. Ticks a task.
pub(super) fn ring<M: Machine>(machine: &M) -> Result<f64, RunError> {
    const TASKS: u64 = 4_000;
    let (mut to, mut from) = in_queue(machine, RingSettings::default());
    let body = |_: &M::Processor| {
        for task in 0..TASKS {
            to.push(task);
            std::hint::black_box(from.pop());
        }
    };
    Ok(ticks(machine, || machine.alone(body))? / TASKS as f64)
}

/// One processor: fetch-and-add on a word it owns. Ticks each.
pub(super) fn atomics<M: Machine>(machine: &M) -> Result<f64, RunError> {
    const TIMES: u64 = 4_000;
    let word = &word(machine)[0];
    // ORDERING: as schemes use it; there is no partner.
    let body = |_: &M::Processor| (0..TIMES).for_each(|_| _ = word.fetch_add(1, AcqRel));
    Ok(ticks(machine, || machine.alone(body))? / TIMES as f64)
}

/// One processor: a store to a line it owns and a full fence. Ticks each.
pub(super) fn fences<M: Machine>(machine: &M) -> Result<f64, RunError> {
    const TIMES: u64 = 4_000;
    let word = &word(machine)[0];
    let body = |_: &M::Processor| {
        for i in 0..TIMES {
            // ORDERING: what is measured is the fence; there is no partner.
            word.store(i, Relaxed);
            M::Word::fence(SeqCst);
        }
    };
    Ok(ticks(machine, || machine.alone(body))? / TIMES as f64)
}

/// Two processors write a word in turn, each waiting for the other. Ticks a handover.
pub(super) fn ping_pong<M: Machine>(machine: &M) -> Result<f64, RunError> {
    const TURNS: u64 = 400;
    let word = &word(machine)[0];
    let body = |cpu: &M::Processor| {
        for turn in (cpu.id() as u64..TURNS).step_by(2) {
            // ORDERING: Acquire and Release pair with each other.
            cpu.wait_until(&[word], || word.load(Acquire) == turn);
            word.store(turn + 1, Release);
        }
    };
    Ok(ticks(machine, || machine.run(2, body).map(drop))? / TURNS as f64)
}

/// Processor 0 writes some lines, processor 1 reads each after the one before, and so on. With
/// `fenced`, a full fence follows each write. Ticks a line, there and back.
pub(super) fn lines<M: Machine>(machine: &M, fenced: bool) -> Result<f64, RunError> {
    const ROUNDS: u64 = 20;
    let data = machine.alloc(LINES, Layout::Padded, |_| M::Word::new(0));
    let turn = &word(machine)[0];
    let body = |cpu: &M::Processor| {
        let me = cpu.id() as u64;
        for round in 0..ROUNDS {
            // ORDERING: Acquire and Release of `turn` pair with each other; the rest is plain data.
            cpu.wait_until(&[turn], || turn.load(Acquire) == 2 * round + me);
            let mut at = 0;
            for _ in 0..LINES {
                // An odd step, so that no prefetcher helps.
                at = (at + 13) % LINES;
                if me == 1 {
                    // The next address waits for the data.
                    at += data[at].load(Relaxed) as usize;
                    continue;
                }
                data[at].store(0, Relaxed);
                if fenced {
                    M::Word::fence(SeqCst);
                }
            }
            turn.store(2 * round + me + 1, Release);
        }
    };
    Ok(ticks(machine, || machine.run(2, body).map(drop))? / (ROUNDS * LINES as u64) as f64)
}

/// Two processors add to one word with no pause. Ticks an addition.
pub(super) fn contended<M: Machine>(machine: &M) -> Result<f64, RunError> {
    const TIMES: u64 = 4_000;
    let word = &word(machine)[0];
    // ORDERING: as schemes use it; the sum alone matters.
    let body = |_: &M::Processor| (0..TIMES).for_each(|_| _ = word.fetch_add(1, AcqRel));
    Ok(ticks(machine, || machine.run(2, body).map(drop))? / (2 * TIMES) as f64)
}

/// What a task costs when it goes through a stack of tasks instead of being descended on the spot.
/// Ticks a task.
pub(super) fn books<M: Machine>(machine: &M) -> Result<f64, RunError> {
    const NODES: u32 = 2_001;
    let work = Synthetic::new(machine, NODES, 10..=30, 3);
    let mut took = [0.0; 2];
    for (order, took) in ["descend", "stack"].into_iter().zip(&mut took) {
        let settings = BTreeMap::from([("order".to_owned(), order.to_owned())]);
        let mut scheme = Scheme::new("serial", machine, 1, settings).expect("the setting exists");
        scheme.run(machine, &work)?;
        let mut times = Vec::new();
        for _ in 0..5 {
            times.push(ticks(machine, || scheme.run(machine, &work).map(drop))?);
        }
        *took = super::gate::median(&mut times);
    }
    Ok((took[1] - took[0]).max(0.0) / f64::from(NODES))
}

/// An empty run on two processors. Ticks a run.
pub(super) fn empty_run<M: Machine>(machine: &M) -> Result<f64, RunError> {
    const RUNS: u32 = 50;
    machine.run(2, |_| ())?;
    let all = || (0..RUNS).try_for_each(|_| machine.run(2, |_| ()).map(drop));
    Ok(ticks(machine, all)? / f64::from(RUNS))
}

/// What a run on two processors takes longer than its work, when processor 0 works for so long that
/// the other finishes first. Ticks a run.
pub(super) fn one_sided_run<M: Machine>(machine: &M) -> Result<f64, RunError> {
    const RUNS: u32 = 20;
    let work = Synthetic::new(machine, 1, 4_000..=4_000, 3);
    let visit = |cpu: &M::Processor| {
        if cpu.id() == 0 {
            let mut found = 0;
            work.visit((0, 1), &mut found, cpu, |_| ());
            std::hint::black_box(found);
        }
    };
    machine.run(2, visit)?;
    let shared = ticks(machine, || (0..RUNS).try_for_each(|_| machine.run(2, visit).map(drop)))?;
    let alone = ticks(machine, || (0..RUNS).try_for_each(|_| machine.alone(visit)))?;
    Ok((shared - alone).max(0.0) / f64::from(RUNS))
}
