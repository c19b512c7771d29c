//! Test-and-set: every try is a write, so every waiter pulls the line over on every try.

use super::Words;
use crate::machine::{Activity, Processor, Word};
use std::sync::atomic::Ordering;

pub(super) fn words(_processors: usize) -> usize {
    1
}

pub(super) fn acquire<P: Processor>(words: Words<'_, P::Word>, cpu: &P) {
    // ORDERING: Acquire pairs with the Release in `release`.
    let is_taken = || words.at(0).test_and_set(Ordering::Acquire);
    if is_taken() {
        cpu.during(Activity::Waiting, || {
            cpu.spin();
            while is_taken() {
                cpu.spin();
            }
        });
    }
}

pub(super) fn release<P: Processor>(words: Words<'_, P::Word>, _cpu: &P) {
    // ORDERING: Release pairs with the Acquire in `acquire`.
    words.at(0).store(0, Ordering::Release);
}
