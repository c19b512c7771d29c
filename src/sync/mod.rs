//! Made from machine words only: locks, the in-queue ring, counters, barriers, quiescence.
//!
//! Nothing here knows what it is used for, nor on which machine it runs. Each file opens with its
//! invariant and protocol; each is model-checked in `tests/loom`.

mod barrier;
mod counter;
mod in_queue;
mod lock;
mod quiescence;
mod shared_queue;

pub use barrier::{Barrier, BarrierKind};
pub use counter::{Counter, CounterKind};
pub use in_queue::{Receiver, RingSettings, Sender, in_queue};
pub use lock::{Lock, LockKind};
pub use quiescence::Quiescence;
pub use shared_queue::{LockedQueue, QueueGuard};
