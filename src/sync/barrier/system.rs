//! The system's barrier: a count under a mutex, and a condition variable to sleep on (PK-04, PK-F01). Waiting takes
//! no processor time, but every sleeper has to be woken by the system.
//!
//! Invariant: the monitor's value holds the turn in its upper half and, in its lower half, how many have come.

use super::Turns;
use crate::machine::{Layout, Machine, Monitor};

/// Bits of the count.
const HALF: u32 = 32;

pub(super) struct System<M: Machine> {
    processors: u64,
    monitor: M::Monitor,
}

impl<M: Machine> Turns<M> for System<M> {
    fn new(machine: &M, _: Layout, processors: usize) -> Option<Self> {
        Some(System { processors: processors as u64, monitor: machine.monitor()? })
    }

    fn wait_then(&self, cpu: &M::Processor, last: impl FnOnce()) {
        let come = |value: u64| {
            let (turn, before) = (value >> HALF, value & ((1 << HALF) - 1));
            if before + 1 < self.processors {
                return value + 1;
            }
            last();
            // Wraps to zero after 2^32 turns; nobody sleeps that long.
            (turn + 1) << HALF
        };
        self.monitor.pass(cpu, come, |before, now| before >> HALF != now >> HALF);
    }

    fn reset(&self) {
        self.monitor.reset();
    }
}
