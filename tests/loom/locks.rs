//! Locks, and what is made of them: mutual exclusion, and the next holder sees what the last one wrote.

use crate::machine::{Loom, LoomProcessor, LoomSlot};
use crate::mutant::Mutant::{self, AlwaysFree, NoWait, Relaxed, Torn};
use crate::mutant::assert_caught;
use crate::{Bounds, check};
use apportion::machine::{Layout, Machine, Processor, Slot, Word};
use apportion::sync::{Counter, CounterKind, Lock, LockKind, LockedQueue};
use std::sync::atomic::Ordering;

/// `processors` add to a plain number under the lock, `turns` times each.
fn excludes(kind: LockKind, processors: usize, turns: u64) {
    let machine = Loom::new();
    let lock = Lock::new(&machine, kind, Layout::Packed, processors);
    let number = LoomSlot::new(0);
    let add = |cpu: &_| {
        for _ in 0..turns {
            lock.with(cpu, || {
                // SAFETY: the lock is held; if it does not exclude, loom says so.
                unsafe { number.write(number.read() + 1) };
            });
        }
    };
    machine.run(processors, add).expect("no panic");
    // SAFETY: the run is over.
    assert_eq!(unsafe { number.read() }, processors as u64 * turns);
}

/// Which broken machines the check of each kind of lock tells from a whole one.
fn caught(kind: LockKind) -> &'static [Mutant] {
    match kind {
        LockKind::TestAndSet => &[Relaxed, Torn, AlwaysFree],
        LockKind::TestAndTestAndSet => &[Relaxed, Torn, AlwaysFree],
        LockKind::Ticket | LockKind::Mcs => &[Relaxed, Torn, NoWait],
    }
}

#[test]
fn each_kind_of_lock_excludes() {
    for &(name, kind) in LockKind::ALL {
        let two = check(Bounds::default(), move || excludes(kind, 2, 2));
        let three = check(Bounds { preemptions: 2, ..Bounds::default() }, move || excludes(kind, 3, 1));
        eprintln!("lock {name}: {two} + {three} executions");
        assert_caught(name, caught(kind), Bounds::default(), move || excludes(kind, 2, 2));
    }
}

fn draws(kind: CounterKind) {
    let machine = Loom::new();
    let counter = Counter::new(&machine, kind, Layout::Packed, 2);
    let drawn = machine.run(2, |cpu| [counter.draw(cpu), counter.draw(cpu)]).expect("no panic");
    assert!(drawn.iter().all(|[first, second]| first < second), "{drawn:?}");
    let mut drawn = drawn.concat();
    drawn.sort_unstable();
    assert_eq!(drawn, [0, 1, 2, 3]);
}

#[test]
fn a_counter_gives_every_number_once() {
    for &(name, lock) in LockKind::ALL {
        let kind = CounterKind::Locked(lock);
        let executions = check(Bounds::default(), move || draws(kind));
        eprintln!("counter, {name}: {executions} executions");
        let caught = caught(lock);
        // A lock whose orderings are too weak shows in a stale count, too.
        assert_caught(name, caught, Bounds::default(), move || draws(kind));
    }
    let executions = check(Bounds::default(), || draws(CounterKind::FetchAdd));
    eprintln!("counter, fetch_add: {executions} executions");
    assert_caught("fetch_add", &[Torn], Bounds::default(), || draws(CounterKind::FetchAdd));
}

/// Processor 0 queues two tasks; each processor takes one, and reports that it is in work.
fn queues() {
    let machine = Loom::new();
    let queue = LockedQueue::new(&machine, LockKind::default(), Layout::Packed, 2, 2);
    let take = |cpu: &LoomProcessor| {
        let mut held = queue.lock(cpu);
        let task = held.pop().expect("two tasks for two");
        let in_work = held.in_work();
        held.set_in_work(in_work + 1);
        task
    };
    let taken = machine.run(2, |cpu| {
        if cpu.id() == 0 {
            assert!(queue.lock(cpu).push(7) && queue.lock(cpu).push(8));
        }
        // ORDERING: Relaxed: a hint; the lock decides.
        cpu.wait_until(&[queue.length()], || queue.length().load(Ordering::Relaxed) != 0);
        take(cpu)
    });
    let mut taken = taken.expect("no panic");
    taken.sort_unstable();
    assert_eq!(taken, [7, 8]);
    let left = machine.alone(|cpu| {
        let held = queue.lock(cpu);
        (held.len(), held.in_work())
    });
    assert_eq!(left.expect("no panic"), (0, 2));
}

#[test]
fn a_locked_queue_loses_and_doubles_nothing() {
    let executions = check(Bounds::default(), queues);
    eprintln!("locked queue: {executions} executions");
    let caught = [Relaxed, Torn, AlwaysFree, NoWait];
    assert_caught("locked queue", &caught, Bounds::default(), queues);
}
