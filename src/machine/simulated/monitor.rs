//! A monitor of a simulated machine. The system's time to wake one sleeper is the machine's constant `wake`; sleepers
//! are woken one after the other, in the order in which they fell asleep.

use super::engine;
use super::{SimulatedWord, VirtualProcessor};
use crate::machine::{Monitor, Processor, Shared, Word};
use std::sync::atomic::Ordering;

/// A value under a mutex, with sleepers whose waking is billed.
#[derive(Debug)]
pub struct SimulatedMonitor {
    /// Whether the mutex is held, the value, and how many sleep.
    words: Shared<SimulatedWord>,
    /// Cycles to wake one sleeper.
    wake: u64,
}

impl SimulatedMonitor {
    /// `words`: three at zero.
    pub(super) fn new(words: Shared<SimulatedWord>, wake: u64) -> Self {
        SimulatedMonitor { words, wake }
    }

    fn lock(&self, cpu: &VirtualProcessor) {
        let held = &self.words[0];
        // ORDERING: Acquire pairs with the Release in `unlock`; every access is sequentially consistent here.
        while held.test_and_set(Ordering::Acquire) {
            cpu.wait_until(&[held], || held.load(Ordering::Relaxed) == 0);
        }
    }

    fn unlock(&self) {
        // ORDERING: Release pairs with the Acquire in `lock`.
        self.words[0].store(0, Ordering::Release);
    }
}

impl Monitor<VirtualProcessor> for SimulatedMonitor {
    fn pass(
        &self,
        cpu: &VirtualProcessor,
        change: impl FnOnce(u64) -> u64,
        may_go: impl Fn(u64, u64) -> bool,
    ) {
        let (value, asleep) = (&self.words[1], &self.words[2]);
        self.lock(cpu);
        // ORDERING: Relaxed: the mutex orders both words, and this machine every access.
        let before = value.load(Ordering::Relaxed);
        let after = change(before);
        value.store(after, Ordering::Relaxed);
        if may_go(before, after) {
            asleep.store(0, Ordering::Relaxed);
            return self.unlock();
        }
        let place = asleep.load(Ordering::Relaxed) + 1;
        asleep.store(place, Ordering::Relaxed);
        self.unlock();
        cpu.wait_until(&[value], || may_go(before, value.load(Ordering::Relaxed)));
        engine::spend(place * self.wake, false);
    }

    fn reset(&self) {
        // ORDERING: Relaxed: between runs.
        self.words.iter().for_each(|word| word.store(0, Ordering::Relaxed));
    }
}
