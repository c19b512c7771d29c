//! Ticket lock: word 0 is the next number to draw, word 1 the number being served.

use super::Words;
use crate::machine::{Processor, Word};
use std::sync::atomic::Ordering;

pub(super) fn words(_processors: usize) -> usize {
    2
}

pub(super) fn acquire<P: Processor>(words: Words<'_, P::Word>, cpu: &P) {
    let (next, serving) = (words.at(0), words.at(1));
    // ORDERING: Relaxed: drawing a number orders nothing; being served does.
    let mine = next.fetch_add(1, Ordering::Relaxed);
    // ORDERING: Acquire pairs with the Release in `release`.
    cpu.wait_until(&[serving], || serving.load(Ordering::Acquire) == mine);
}

pub(super) fn release<P: Processor>(words: Words<'_, P::Word>, _cpu: &P) {
    let serving = words.at(1);
    // ORDERING: Relaxed: only the holder writes this word.
    let mine = serving.load(Ordering::Relaxed);
    // ORDERING: Release pairs with the Acquire in `acquire`.
    serving.store(mine.wrapping_add(1), Ordering::Release);
}
