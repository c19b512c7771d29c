//! The in-queue: every task comes out once, in order, whatever the capacity and the way it is used.

use crate::machine::Loom;
use crate::mutant::Mutant::{LostHead, NoWait, Relaxed};
use crate::mutant::assert_caught;
use crate::{Bounds, check};
use apportion::machine::{Layout, Machine, Processor, Seats};
use apportion::sync::{Receiver, RingSettings, Sender, in_queue};

/// The two ends of a ring, one of which each processor takes.
enum End {
    To(Sender<Loom>),
    From(Receiver<Loom>),
}

const TASKS: u64 = 3;

/// Sends the tasks 1 to [`TASKS`] through a ring and checks that they arrive so.
fn passes(capacity: usize, remember_index: bool, in_chunks: bool) {
    let machine = Loom::new();
    let settings = RingSettings { capacity, layout: Layout::Packed, remember_index };
    let (to, from) = in_queue(&machine, settings);
    let mut ends = [End::To(to), End::From(from)].into_iter();
    let seats = Seats::new(&machine, 2, |_| ends.next().expect("two ends"));
    let run = machine.run(2, |cpu| match &mut *seats.claim(cpu) {
        End::To(to) => {
            let tasks: Vec<u64> = (1..=TASKS).collect();
            let mut sent = 0;
            while sent < tasks.len() {
                let now =
                    if in_chunks { to.push_all(&tasks[sent..]) } else { usize::from(to.push(tasks[sent])) };
                sent += now;
                if now == 0 {
                    cpu.spin();
                }
            }
        }
        End::From(from) => {
            let mut got = Vec::new();
            while got.len() < TASKS as usize {
                cpu.wait_until(&[from.arrivals()], || from.has_arrivals());
                if in_chunks {
                    assert!(from.pop_all(&mut got) > 0, "something has arrived");
                } else {
                    got.push(from.pop().expect("something has arrived"));
                }
            }
            assert_eq!(got, (1..=TASKS).collect::<Vec<_>>());
            assert!(!from.has_arrivals() && from.is_empty());
        }
    });
    run.expect("no panic");
}

#[test]
fn a_ring_passes_tasks_on_once_and_in_order() {
    for capacity in [1, 2] {
        for remember in [true, false] {
            for in_chunks in [false, true] {
                let what = format!("ring of {capacity}, remember {remember}, in chunks {in_chunks}");
                let body = move || passes(capacity, remember, in_chunks);
                let executions = check(Bounds::default(), body);
                eprintln!("{what}: {executions} executions");
                assert_caught(&what, &[Relaxed, LostHead, NoWait], Bounds::default(), body);
            }
        }
    }
}
