//! What an operating system offers to sleep on.

/// A value that processors change one at a time and sleep on: a mutex with a condition variable. A sleeper
/// costs no processor time, but waking it is the system's business, and takes the system's time.
pub trait Monitor<P>: Send + Sync {
    /// Changes the value, then sleeps until `may_go` holds of the value as this call found it and as it is now.
    /// Whoever may go at once wakes all others. Once it holds, `may_go` must go on holding until the caller has
    /// come back.
    ///
    /// A sleeper is ended, by unwinding, when another worker of its run has panicked.
    fn pass(&self, cpu: &P, change: impl FnOnce(u64) -> u64, may_go: impl Fn(u64, u64) -> bool);
    /// Sets the value back to zero; nobody may be in [`Monitor::pass`]. After a failed run it must be called.
    fn reset(&self);
}
