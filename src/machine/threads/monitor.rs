//! A monitor of real threads: `std`'s mutex and condition variable.

use super::Thread;
use crate::machine::{Monitor, Processor};
use std::sync::{Condvar, Mutex, MutexGuard};
use std::time::Duration;

/// How long a sleeper sleeps before it looks whether its run has failed. It is woken long before, if all goes well.
const LOOK: Duration = Duration::from_millis(10);

/// A value under a mutex, with a condition variable.
#[derive(Debug, Default)]
pub struct NativeMonitor {
    value: Mutex<u64>,
    changed: Condvar,
}

impl NativeMonitor {
    /// A panic in somebody's `change` ends the run; what it left behind is set back before the next.
    fn lock(&self) -> MutexGuard<'_, u64> {
        self.value.lock().unwrap_or_else(|e| e.into_inner())
    }
}

impl Monitor<Thread> for NativeMonitor {
    fn pass(&self, cpu: &Thread, change: impl FnOnce(u64) -> u64, may_go: impl Fn(u64, u64) -> bool) {
        let mut value = self.lock();
        let before = *value;
        *value = change(before);
        if may_go(before, *value) {
            self.changed.notify_all();
            return;
        }
        let was = cpu.begin_wait();
        while !may_go(before, *value) {
            let (woken, timeout) = self.changed.wait_timeout(value, LOOK).unwrap_or_else(|e| e.into_inner());
            value = woken;
            if timeout.timed_out() {
                cpu.end_if_told();
            }
        }
        drop(value);
        cpu.enter(was);
    }

    fn reset(&self) {
        *self.lock() = 0;
    }
}
