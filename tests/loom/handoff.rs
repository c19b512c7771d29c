//! The hand-over of work to a helper that may have gone to sleep: no wake-up is lost.

use crate::machine::{LoomSlot, LoomWord};
use crate::mutant::Mutant::{NoFence, Relaxed};
use crate::mutant::assert_caught;
use crate::{Bounds, check};
use apportion::machine::handoff::Handoff;
use apportion::machine::{Slot, Word};
use loom::sync::Notify;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Two pieces of work, one after the other, to a helper that looks `patience` times before it parks.
fn hands_over(patience: u32, wakes: bool) {
    let shared =
        Arc::new((Handoff::<LoomWord>::default(), LoomSlot::new(0_u64), Notify::new(), LoomWord::new(0)));
    let helper = {
        let shared = shared.clone();
        loom::thread::spawn(move || {
            let (handoff, job, bell, done) = &*shared;
            let mut seen = 0;
            for expected in [1, 2] {
                let mut looks = 0;
                let keep_spinning = || {
                    looks += 1;
                    looks <= patience
                };
                seen = handoff.wait(seen, keep_spinning, || bell.wait());
                assert_eq!(seen, expected);
                // SAFETY: the poster waits until this work is done; loom reports races.
                assert_eq!(unsafe { job.read() }, 10 * expected);
                // ORDERING: Release pairs with the Acquire load below: the work has been read.
                done.store(seen, Ordering::Release);
            }
        })
    };
    let (handoff, job, bell, done) = &*shared;
    for epoch in [1, 2] {
        // SAFETY: the helper waits for the post; loom reports races.
        unsafe { job.write(10 * epoch) };
        handoff.post(epoch, || {
            if wakes {
                bell.notify();
            }
        });
        // A notification may come for no reason, so it could not say that the work is done.
        // ORDERING: Acquire pairs with the Release store above.
        while done.load(Ordering::Acquire) != epoch {
            loom::thread::yield_now();
        }
    }
    helper.join().expect("a panic ends the model");
}

#[test]
fn no_post_is_lost() {
    for patience in [0, 1] {
        let executions = check(Bounds::default(), move || hands_over(patience, true));
        eprintln!("handoff, {patience} looks: {executions} executions");
        let what = format!("handoff, {patience} looks");
        assert_caught(&what, &[Relaxed, NoFence], Bounds::default(), move || hands_over(patience, true));
    }
}

#[test]
#[should_panic(expected = "maximum number of branches")]
fn a_dropped_wake_up_is_noticed() {
    check(Bounds::default(), || hands_over(0, false));
}
