//! Barriers: nobody goes on before everybody has come, and all see what the others wrote before.

use crate::machine::{Loom, LoomSlot};
use crate::mutant::Mutant::{self, NoWait, Relaxed, Torn};
use crate::mutant::assert_caught;
use crate::{Bounds, check};
use apportion::machine::{Layout, Machine, Processor, Slot};
use apportion::sync::{Barrier, BarrierKind};

/// Each processor writes a slot of its own, waits, reads all slots, and waits again, so many times. The last one to
/// come writes one more, which all read after.
fn separates(kind: BarrierKind, processors: usize, turns: u32) {
    let machine = Loom::new();
    let barrier = Barrier::new(&machine, kind, Layout::Padded, processors).expect("loom has all it needs");
    let slots: Vec<_> = (0..=processors).map(|_| LoomSlot::new(0)).collect();
    let body = |cpu: &_| {
        let me = Processor::id(cpu);
        for turn in 1..=turns {
            // SAFETY: one's own slot; the others read it between two turns of the barrier only. If they do not, loom
            // says so.
            unsafe { slots[me].write(turn) };
            // SAFETY: all others wait.
            barrier.wait_then(cpu, || unsafe { slots[processors].write(turn) });
            for slot in &slots {
                // SAFETY: nobody writes before the next turn of the barrier.
                assert_eq!(unsafe { slot.read() }, turn, "{kind:?}: processor {me} in turn {turn}");
            }
            if turn < turns {
                barrier.wait(cpu);
            }
        }
    };
    machine.run(processors, body).expect("no panic");
    barrier.reset();
}

/// Which broken machines the check of each kind tells from a whole one.
fn caught(kind: BarrierKind) -> &'static [Mutant] {
    match kind {
        BarrierKind::FetchOp | BarrierKind::Tree => &[Relaxed, Torn, NoWait],
        // A mutex and a condition variable have no orderings of ours.
        BarrierKind::System => &[NoWait],
    }
}

#[test]
fn each_kind_of_barrier_separates() {
    for &(name, kind) in BarrierKind::ALL {
        let two = check(Bounds::default(), move || separates(kind, 2, 2));
        let three = check(Bounds { preemptions: 2, ..Bounds::default() }, move || separates(kind, 3, 1));
        eprintln!("barrier {name}: {two} + {three} executions");
        assert_caught(name, caught(kind), Bounds::default(), move || separates(kind, 2, 2));
    }
}
