//! One processor, no sharing: what every speedup is measured against (P2-01).
//!
//! Settings: `order` = `descend` (the work's own best way down: skip pointers where it has them) or
//! `stack` (an explicit stack of tasks, as on a tree of pointers).

use super::{Share, Task, TreeWork};
use crate::machine::{Machine, RunError};
use crate::scheme::{SettingError, Settings};
use std::marker::PhantomData;

pub(super) const SUMMARY: &str = "one processor, no sharing";
pub(super) const NATIVE_ONLY: bool = false;
pub(super) const LEARNS: bool = false;

pub(super) struct Serial<M> {
    stack: Vec<u64>,
    by_stack: bool,
    machine: PhantomData<fn(M)>,
}

impl<M: Machine> Serial<M> {
    pub(super) fn new(_: &M, _processors: usize, settings: &Settings) -> Result<Self, SettingError> {
        let by_stack = settings.choice("order", false, &[("descend", false), ("stack", true)])?;
        Ok(Serial { stack: Vec::new(), by_stack, machine: PhantomData })
    }

    pub(super) fn run<W: TreeWork>(
        &mut self,
        machine: &M,
        work: &W,
    ) -> Result<Vec<Share<W::Found>>, RunError> {
        let (stack, by_stack) = (&mut self.stack, self.by_stack);
        stack.clear();
        let share = machine.alone(|cpu| {
            let mut found = work.found();
            let mut visited = 0;
            if !by_stack {
                visited = work.root().map_or(0, |root| work.descend(root, &mut found, cpu, stack));
                return Share { found, visited };
            }
            stack.extend(work.root().map(Task::pack));
            while let Some(task) = stack.pop() {
                visited += 1;
                work.visit(W::Task::unpack(task), &mut found, cpu, |below| stack.push(below.pack()));
            }
            Share { found, visited }
        })?;
        Ok(vec![share])
    }
}
