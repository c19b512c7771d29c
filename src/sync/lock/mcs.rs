//! MCS lock (Mellor-Crummey and Scott 1991): word 0 is the tail of the queue of waiters (a
//! processor's number + 1, 0 for nobody); processor `p` owns word `1 + 2p`, set while it must wait,
//! and word `2 + 2p`, the number + 1 of the one behind it.

use super::Words;
use crate::machine::{Processor, Word};
use std::sync::atomic::Ordering;

/// How often a processor that is being unwound looks for its successor.
const UNWINDING_LOOKS: u32 = 1000;

pub(super) fn words(processors: usize) -> usize {
    1 + 2 * processors
}

pub(super) fn acquire<P: Processor>(words: Words<'_, P::Word>, cpu: &P) {
    let me = cpu.id();
    let (tail, wait, behind) = (words.at(0), words.at(1 + 2 * me), words.at(2 + 2 * me));
    // ORDERING: Relaxed: published by the AcqRel swap below before anybody else looks at them.
    behind.store(0, Ordering::Relaxed);
    wait.store(1, Ordering::Relaxed);
    // ORDERING: the Acquire half pairs with the last holder's Release compare-exchange in `release`;
    // the Release half publishes the two stores above to the one who finds us as predecessor.
    let ahead = tail.swap(me as u64 + 1, Ordering::AcqRel);
    if ahead != 0 {
        // ORDERING: Release pairs with the Acquire load of `behind` in `release`.
        words.at(2 * ahead as usize).store(me as u64 + 1, Ordering::Release);
        // ORDERING: Acquire pairs with the Release store of `wait` in `release`.
        cpu.wait_until(&[wait], || wait.load(Ordering::Acquire) == 0);
    }
}

pub(super) fn release<P: Processor>(words: Words<'_, P::Word>, cpu: &P) {
    let me = cpu.id();
    let (tail, behind) = (words.at(0), words.at(2 + 2 * me));
    // ORDERING: Acquire pairs with the Release store of `behind` in `acquire`.
    if behind.load(Ordering::Acquire) == 0 {
        // ORDERING: Release pairs with the Acquire swap in `acquire`: the next holder comes after us.
        let alone = tail.compare_exchange(me as u64 + 1, 0, Ordering::Release, Ordering::Relaxed);
        if alone.is_ok() {
            return;
        }
        // Somebody has drawn us as predecessor and is about to say so.
        if std::thread::panicking() {
            // This processor is being unwound out of a failed run: a wait could unwind once more, which
            // would abort the program, or be for one who never runs again. So the wait has an end; if
            // nobody shows up, the lock stays held, and the failure ends those who wait for it.
            // ORDERING: Acquire, as above.
            for _ in 0..UNWINDING_LOOKS {
                if behind.load(Ordering::Acquire) != 0 {
                    break;
                }
                std::thread::yield_now();
            }
            if behind.load(Ordering::Acquire) == 0 {
                return;
            }
        }
        // ORDERING: Acquire, as above.
        cpu.wait_until(&[behind], || behind.load(Ordering::Acquire) != 0);
    }
    // ORDERING: Acquire, as above; the value cannot change any more.
    let next = behind.load(Ordering::Acquire) as usize;
    // ORDERING: Release pairs with the Acquire load of `wait` in `acquire`.
    words.at(2 * next - 1).store(0, Ordering::Release);
}
