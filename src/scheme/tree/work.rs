//! What a tree scheme shares out.

use crate::machine::{Activity, Processor};

/// Something small enough to travel through a queue: it packs into 64 bits.
pub trait Task: Copy + Send + Sync {
    /// Packs the task.
    fn pack(self) -> u64;
    /// Unpacks what `pack` gave.
    fn unpack(word: u64) -> Self;
}

impl Task for u64 {
    #[inline]
    fn pack(self) -> u64 {
        self
    }
    #[inline]
    fn unpack(word: u64) -> Self {
        word
    }
}

impl Task for u32 {
    #[inline]
    fn pack(self) -> u64 {
        u64::from(self)
    }
    #[inline]
    fn unpack(word: u64) -> Self {
        word as u32
    }
}

/// A (start, stop) range of a depth-first array, or a pair of nodes.
impl Task for (u32, u32) {
    #[inline]
    fn pack(self) -> u64 {
        u64::from(self.0) << 32 | u64::from(self.1)
    }
    #[inline]
    fn unpack(word: u64) -> Self {
        ((word >> 32) as u32, word as u32)
    }
}

/// A hierarchy to descend.
pub trait TreeWork: Sync {
    /// What stands for a node.
    type Task: Task;
    /// What one processor gathers.
    type Found: Send;

    /// The first task, or none if there is nothing to do.
    fn root(&self) -> Option<Self::Task>;

    /// An empty gathering, made once a run on each processor.
    fn found(&self) -> Self::Found;

    /// Visits one task: gathers into `found`, emits the tasks below. `cpu` is where the work is
    /// charged and shared data is touched on a simulated machine.
    fn visit<P: Processor>(
        &self,
        task: Self::Task,
        found: &mut Self::Found,
        cpu: &P,
        emit: impl FnMut(Self::Task),
    );

    /// Visits a task and everything below it, on one processor; returns how many tasks that were.
    /// `stack` is scratch space, and is left as it was.
    ///
    /// The default keeps an explicit stack. A depth-first array with skip pointers does better.
    fn descend<P: Processor>(
        &self,
        task: Self::Task,
        found: &mut Self::Found,
        cpu: &P,
        stack: &mut Vec<u64>,
    ) -> u64 {
        let (bottom, mut visited) = (stack.len(), 0);
        let mut next = Some(task);
        while let Some(task) = next {
            visited += 1;
            self.visit(task, found, cpu, |below| stack.push(below.pack()));
            next = if stack.len() > bottom { stack.pop().map(Self::Task::unpack) } else { None };
        }
        visited
    }

    /// An upper bound of the tasks a task stands for (itself and all below), where that is known at
    /// once: schemes with a grain do not share out less than that.
    fn size(&self, _task: Self::Task) -> usize {
        usize::MAX
    }
}

/// Work whose every task passes through a scheme's hands: each visit is billed its bookkeeping (what is
/// descended on the spot is not), and marked on a timeline. Between its tasks a scheme is taken to be
/// sending, unless it says otherwise.
pub(super) struct Billed<'a, W>(pub(super) &'a W);

impl<W: TreeWork> TreeWork for Billed<'_, W> {
    type Task = W::Task;
    type Found = W::Found;

    #[inline]
    fn root(&self) -> Option<W::Task> {
        self.0.root()
    }

    #[inline]
    fn found(&self) -> W::Found {
        self.0.found()
    }

    #[inline]
    fn visit<P: Processor>(
        &self,
        task: W::Task,
        found: &mut W::Found,
        cpu: &P,
        mut emit: impl FnMut(W::Task),
    ) {
        cpu.keep_books();
        let looked_into = cpu.take_up(1);
        // One visit for both cases: a second one would make a scheme's locals live in memory in the first.
        self.0.visit(task, found, cpu, |below| {
            if P::MARKS_WITHIN && looked_into {
                cpu.enter(Activity::Sending);
            }
            emit(below);
            if P::MARKS_WITHIN && looked_into {
                cpu.enter(Activity::Working);
            }
        });
        if looked_into {
            cpu.enter(Activity::Sending);
        }
    }

    #[inline]
    fn descend<P: Processor>(
        &self,
        task: W::Task,
        found: &mut W::Found,
        cpu: &P,
        stack: &mut Vec<u64>,
    ) -> u64 {
        let looked_into = cpu.take_up(self.0.size(task));
        let visited = self.0.descend(task, found, cpu, stack);
        if looked_into {
            cpu.enter(Activity::Sending);
        }
        visited
    }

    #[inline]
    fn size(&self, task: W::Task) -> usize {
        self.0.size(task)
    }
}

/// Work made of closures: a root, an empty gathering, and a visit that gets the task, the gathering
/// and a function to emit tasks with.
pub fn work<T: Task, F: Send>(
    root: T,
    found: impl Fn() -> F + Sync,
    visit: impl Fn(T, &mut F, &mut dyn FnMut(T)) + Sync,
) -> impl TreeWork<Task = T, Found = F> {
    Closures { root, found, visit }
}

struct Closures<T, A, V> {
    root: T,
    found: A,
    visit: V,
}

impl<T, F, A, V> TreeWork for Closures<T, A, V>
where
    T: Task,
    F: Send,
    A: Fn() -> F + Sync,
    V: Fn(T, &mut F, &mut dyn FnMut(T)) + Sync,
{
    type Task = T;
    type Found = F;

    fn root(&self) -> Option<T> {
        Some(self.root)
    }

    fn found(&self) -> F {
        (self.found)()
    }

    fn visit<P: Processor>(&self, task: T, found: &mut F, _cpu: &P, mut emit: impl FnMut(T)) {
        (self.visit)(task, found, &mut emit);
    }
}
