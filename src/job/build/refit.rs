//! New boxes for a hierarchy, by all processors (Ize ch. 7.6.1, I7-03).
//!
//! Steps: 1. a seeder lists the subtrees at a level, once for a hierarchy; 2. processors take one after the other by a
//! fetch-and-add and refit it; 3. who ends the last one refits the nodes above them; 4. who finds no subtree left goes
//! on, without waiting, to whatever data of the items is to be renewed, also taken in pieces.
//!
//! Invariant: what is below a node lies side by side, so subtrees are parts of the list of nodes that do not overlap,
//! and the nodes above are touched by one processor, after all subtrees are done.

use super::Costs;
use crate::geometry::Aabb;
use crate::machine::{Layout, Machine, Processor, RunError, Shared, Word};
use crate::structure::bvh::{BinaryBvh, refit};
use std::sync::atomic::Ordering::{AcqRel, Relaxed};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Subtrees for each processor that are enough as a rule: some are larger than others.
pub const SUBTREES: usize = 8;

/// How a hierarchy is refitted by so many processors of a machine: its subtrees, and the words they share.
pub struct Refit<M: Machine> {
    cut: refit::Cut,
    processors: usize,
    /// Subtrees taken; subtrees done; pieces of data taken.
    words: Shared<M::Word>,
    costs: Costs,
}

impl<M: Machine> Refit<M> {
    /// Lists the subtrees of a hierarchy, about as many for each processor as asked, if there are as many; nothing is
    /// charged.
    pub fn new(machine: &M, processors: usize, subtrees: usize, bvh: &BinaryBvh) -> Self {
        let cut = refit::Cut::new(bvh, subtrees * processors);
        let words = machine.alloc(3, Layout::Padded, |_| M::Word::new(0));
        Self { cut, processors, words, costs: Costs::default() }
    }

    /// The same, charged what refitting costs.
    pub fn charging(self, costs: Costs) -> Self {
        Self { costs, ..self }
    }

    /// Gives every node of the hierarchy the box around what is below it now, and calls `renew` with each of `pieces`
    /// pieces of the items' other data, once; it tells how many items that was.
    ///
    /// # Errors
    /// [`RunError`]: a machine that failed.
    ///
    /// # Panics
    /// If it is another hierarchy.
    pub fn run(
        &self,
        machine: &M,
        bvh: &mut BinaryBvh,
        bounds: impl Fn(u32) -> Aabb + Sync,
        pieces: usize,
        renew: impl Fn(usize) -> usize + Sync,
    ) -> Result<(), RunError> {
        let (parts, above) = self.cut.part(bvh);
        let count = parts.len();
        let parts: Vec<_> = parts.into_iter().map(|part| Mutex::new((Some(part), Aabb::EMPTY))).collect();
        let above = Mutex::new(Some(above));
        let [taken, done, renewed] = [0, 1, 2].map(|word| &self.words[word]);
        for word in [taken, done, renewed] {
            // ORDERING: nobody else runs; starting the run publishes it.
            word.store(0, Relaxed);
        }
        machine.run(self.processors, |cpu: &M::Processor| {
            let take = |from: &M::Word, most: usize| {
                // ORDERING: the number taken is all there is to it.
                let at = from.fetch_add(1, Relaxed) as usize;
                (at < most).then_some(at)
            };
            while let Some(at) = take(taken, count) {
                let part = lock(&parts[at]).0.take().expect("each number is taken once");
                let (root, refitted) = part.refit(&bounds);
                cpu.charge(self.costs.of_refitting(&refitted));
                lock(&parts[at]).1 = root;
                // ORDERING: each such addition is in the release sequence that the last one acquires.
                if done.fetch_add(1, AcqRel) as usize + 1 == count {
                    let above = lock(&above).take().expect("there is one last");
                    let refitted = above.refit(|subtree| lock(&parts[subtree]).1);
                    cpu.charge(self.costs.of_refitting(&refitted));
                }
            }
            while let Some(piece) = take(renewed, pieces) {
                cpu.charge(self.costs.of_renewing(renew(piece)));
            }
        })?;
        Ok(())
    }
}

/// What a lock holds that nobody waits for.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
