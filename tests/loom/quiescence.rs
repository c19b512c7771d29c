//! The end of a run, alone: nobody is told that all is over while somebody works or a task is on its way.

use crate::machine::{Loom, LoomProcessor, LoomWord};
use crate::mutant::Mutant::{FirstWordOnly, NeverBusy, Relaxed};
use crate::mutant::assert_caught;
use crate::{Bounds, check};
use apportion::machine::{Layout, Machine, Processor, Seats, Word};
use apportion::sync::{Quiescence, Receiver, RingSettings, Sender, in_queue};
use std::sync::atomic::Ordering;

/// A processor's ends of rings.
#[derive(Default)]
struct Ends {
    to: Vec<Sender<Loom>>,
    from: Vec<Receiver<Loom>>,
}

/// A task that travels from processor to processor, as often as its number says, along `links`.
///
/// With the links 0 to 1, 1 to 2, 2 to 1 it is the case for which a processor takes its counts back
/// before it takes a task: 1 and 2 pass a task to and fro while 0 adds up what they published.
fn travels(processors: usize, links: &[(usize, usize)], hops: u64) {
    let machine = Loom::new();
    let mut ends: Vec<Ends> = (0..processors).map(|_| Ends::default()).collect();
    for &(sender, receiver) in links {
        let settings = RingSettings { capacity: 1, layout: Layout::Packed, remember_index: false };
        let (to, from) = in_queue(&machine, settings);
        ends[sender].to.push(to);
        ends[receiver].from.push(from);
    }
    let mut ends = ends.into_iter();
    let seats = Seats::new(&machine, processors, |_| ends.next().expect("one a processor"));
    let quiescence = Quiescence::new(&machine, processors);
    quiescence.reset();
    let handled = machine.alloc(1, Layout::Packed, |_| LoomWord::new(0));
    let handle = |cpu: &LoomProcessor| {
        let mut seat = seats.claim(cpu);
        let Ends { to, from } = &mut *seat;
        let (mut sent, mut received) = (0, 0);
        if cpu.id() == 0 {
            assert!(to[0].push(hops), "the ring is empty");
            sent += 1;
        }
        loop {
            if let Some(task) = from.iter_mut().find_map(Receiver::pop) {
                received += 1;
                if task > 1 {
                    assert!(to[0].push(task - 1), "there is but one task");
                    sent += 1;
                }
                // ORDERING: Relaxed: what is checked is that it comes before the end of the run.
                handled[0].fetch_add(1, Ordering::Relaxed);
                continue;
            }
            let arrivals: Vec<_> = from.iter().map(Receiver::arrivals).collect();
            let has_work = || from.iter().any(Receiver::has_arrivals);
            if quiescence.wait(cpu, sent, received, &arrivals, has_work) {
                // ORDERING: Relaxed, as above.
                return handled[0].load(Ordering::Relaxed);
            }
        }
    };
    let seen = machine.run(processors, handle).expect("no panic");
    assert_eq!(seen, vec![hops; processors], "tasks handled when each was told that all was over");
}

#[test]
fn two_processors_end_together() {
    let body = || travels(2, &[(0, 1), (1, 0)], 3);
    eprintln!("quiescence of 2: {} executions", check(Bounds::default(), body));
    assert_caught("quiescence of 2", &[Relaxed, FirstWordOnly], Bounds::default(), body);
}

#[test]
fn a_busy_processor_is_not_taken_at_its_old_word() {
    let body = || travels(3, &[(0, 1), (1, 2), (2, 1)], 2);
    let bounds = Bounds { preemptions: 1, ..Bounds::default() };
    eprintln!("quiescence of 3: {} executions", check(bounds, body));
    assert_caught("quiescence of 3", &[Relaxed, NeverBusy, FirstWordOnly], bounds, body);
}
