//! Barriers: nobody goes on before everybody has come. Parker et al. 1999, sec. 2.1 (PK-04): at high frame
//! rates the system's own barrier takes longer than is left for it, one made from hardware fetch-and-op does not.
//!
//! Invariant: the n-th return from `wait` on any processor comes after the n-th call on every processor, and
//! whoever returns sees what all others wrote before they called.
//!
//! A turn of the barrier is numbered by what is counted there anyway, so that no processor has a sense of its own
//! to keep: the sense of the classic algorithm is the lowest bit of the turn.

mod fetch_op;
mod system;
mod tree;

use crate::machine::{Activity, Layout, Machine, Processor};

/// What a kind of barrier does.
trait Turns<M: Machine>: Sized {
    /// A barrier nobody has come to; none where the machine has not what it needs.
    fn new(machine: &M, layout: Layout, processors: usize) -> Option<Self>;
    /// Waits for everybody. The last one to come runs `last` before anybody goes on.
    fn wait_then(&self, cpu: &M::Processor, last: impl FnOnce());
    /// Makes the barrier as new; nobody may be waiting.
    fn reset(&self);
}

/// Declares the kinds: the list is the table of contents.
macro_rules! barrier_kinds {
    ($($(#[$doc:meta])* $kind:ident => $file:ident),* $(,)?) => {
        /// How a barrier counts and waits.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
        pub enum BarrierKind { $($(#[$doc])* $kind),* }

        impl BarrierKind {
            /// Every kind with its name in settings.
            pub const ALL: &[(&str, BarrierKind)] = &[$((stringify!($file), BarrierKind::$kind)),*];
        }

        enum AnyBarrier<M: Machine> { $($kind($file::$kind<M>)),* }

        impl<M: Machine> Barrier<M> {
            /// A barrier for `processors` processors, all of which come to every turn. None where the machine has
            /// not what this kind needs: a simulated one of which nobody has said how long its system takes to wake
            /// a sleeper has no [`BarrierKind::System`].
            pub fn new(machine: &M, kind: BarrierKind, layout: Layout, processors: usize) -> Option<Self> {
                let barrier = match kind {
                    $(BarrierKind::$kind => AnyBarrier::$kind(Turns::new(machine, layout, processors)?)),*
                };
                Some(Barrier { barrier })
            }

            /// Waits for everybody. The last one to come runs `last` before anybody goes on: what has to be
            /// done between two frames by one processor while the others are known to do nothing.
            #[inline]
            pub fn wait_then(&self, cpu: &M::Processor, last: impl FnOnce()) {
                cpu.during(Activity::Barrier, || match &self.barrier {
                    $(AnyBarrier::$kind(barrier) => barrier.wait_then(cpu, last)),*
                });
            }

            /// Makes the barrier as new. Nobody may be waiting; after a failed run, in which some came and others
            /// did not, it must be called.
            pub fn reset(&self) {
                match &self.barrier { $(AnyBarrier::$kind(barrier) => Turns::<M>::reset(barrier)),* }
            }
        }
    };
}

barrier_kinds! {
    /// One counter at memory and one flag. The default.
    #[default]
    FetchOp => fetch_op,
    /// Counters in a tree, four to a node, so that no counter is everybody's.
    Tree => tree,
    /// The system's mutex and condition variable.
    System => system,
}

/// A barrier of one of the kinds.
pub struct Barrier<M: Machine> {
    barrier: AnyBarrier<M>,
}

impl<M: Machine> Barrier<M> {
    /// Waits for everybody.
    #[inline]
    pub fn wait(&self, cpu: &M::Processor) {
        self.wait_then(cpu, || ());
    }
}
