//! Test-and-test-and-set (Rudolph and Segall, ISCA 1984): waits on a cached copy of the word and
//! tries only when it has been seen free.

use super::Words;
use crate::machine::{Processor, Word};
use std::sync::atomic::Ordering;

pub(super) fn words(_processors: usize) -> usize {
    1
}

pub(super) fn acquire<P: Processor>(words: Words<'_, P::Word>, cpu: &P) {
    let word = words.at(0);
    // ORDERING: Acquire pairs with the Release in `release`.
    while word.test_and_set(Ordering::Acquire) {
        // ORDERING: Relaxed: only a hint; the test-and-set above decides.
        cpu.wait_until(&[word], || word.load(Ordering::Relaxed) == 0);
    }
}

pub(super) fn release<P: Processor>(words: Words<'_, P::Word>, _cpu: &P) {
    // ORDERING: Release pairs with the Acquire in `acquire`.
    words.at(0).store(0, Ordering::Release);
}
