//! The in-queue of Paper II's lock-free scheme (section 4): a ring buffer with two indices between one
//! sender and one receiver.
//!
//! Invariant: `head <= tail <= head + capacity`. Both only grow. Slots `head .. tail` (modulo the size)
//! belong to the receiver, the others to the sender.
//!
//! Protocol: 1. the sender writes a slot, then publishes `tail` (Release); 2. the receiver sees `tail`
//! (Acquire), reads the slot, then publishes `head` (Release); 3. the sender sees `head` (Acquire)
//! before it writes that slot again.
//!
//! Deviations from the paper: it relies on SPARC's in-order stores where this uses Release and Acquire
//! (P2-F15); a full ring refuses the task, and the caller keeps it (P2-F14); each side remembers the
//! other's index and looks again only when the ring seems full or empty, so that the indices' lines
//! move seldom (`remember_index = false` looks every time, as one wrote it in 1999).

use crate::machine::{Layout, Machine, Shared, Slot, Word};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// How a ring is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RingSettings {
    /// Tasks it holds; at least 1.
    pub capacity: usize,
    /// Whether both indices share a line or have one each.
    pub layout: Layout,
    /// Whether each side remembers the other's index.
    pub remember_index: bool,
}

impl Default for RingSettings {
    fn default() -> Self {
        RingSettings { capacity: 64, layout: Layout::Padded, remember_index: true }
    }
}

struct Ring<M: Machine> {
    /// Word 0: `head`, written by the receiver. Word 1: `tail`, written by the sender.
    indices: Shared<M::Word>,
    slots: Shared<M::Slot<u64>>,
    /// Number of slots minus one; the number is a power of two, at least the capacity.
    mask: u64,
    settings: RingSettings,
}

impl<M: Machine> Ring<M> {
    fn head(&self) -> &M::Word {
        &self.indices[0]
    }

    fn tail(&self) -> &M::Word {
        &self.indices[1]
    }

    #[inline]
    fn slot(&self, index: u64) -> &M::Slot<u64> {
        &self.slots[(index & self.mask) as usize]
    }
}

/// Makes an empty in-queue of packed tasks.
///
/// ```
/// use apportion::machine::Threads;
/// use apportion::sync::{RingSettings, in_queue};
/// let (mut to, mut from) = in_queue(&Threads::new(1)?, RingSettings { capacity: 2, ..Default::default() });
/// assert!(to.push(7) && to.push(8) && !to.push(9), "a full ring refuses");
/// assert_eq!((from.pop(), from.pop(), from.pop()), (Some(7), Some(8), None));
/// # Ok::<(), apportion::machine::RunError>(())
/// ```
///
/// # Panics
/// If the capacity is 0.
pub fn in_queue<M: Machine>(machine: &M, settings: RingSettings) -> (Sender<M>, Receiver<M>) {
    assert!(settings.capacity > 0, "an in-queue needs room for at least one task");
    let size = settings.capacity.next_power_of_two();
    let ring = Arc::new(Ring {
        indices: machine.alloc(2, settings.layout, |_| Word::new(0)),
        slots: machine.alloc(size, Layout::Packed, |_| Slot::new(0)),
        mask: size as u64 - 1,
        settings,
    });
    (Sender { ring: ring.clone(), tail: 0, head: 0 }, Receiver { ring, head: 0, tail: 0 })
}

/// The sending end. There is one a ring.
pub struct Sender<M: Machine> {
    ring: Arc<Ring<M>>,
    /// What the shared `tail` holds; only this end writes it.
    tail: u64,
    /// The newest `head` seen; the true one is the same or greater.
    head: u64,
}

impl<M: Machine> Sender<M> {
    /// How many tasks fit in now, looked up anew if none seems to.
    #[inline]
    fn room(&mut self) -> u64 {
        let capacity = self.ring.settings.capacity as u64;
        if self.tail - self.head >= capacity || !self.ring.settings.remember_index {
            // ORDERING: Acquire pairs with the receiver's Release store of `head`: it has read the
            // slots before that index, so they may be written again.
            self.head = self.ring.head().load(Ordering::Acquire);
        }
        capacity - (self.tail - self.head)
    }

    /// Sends a task; says whether there was room for it.
    #[inline]
    pub fn push(&mut self, task: u64) -> bool {
        if self.room() == 0 {
            return false;
        }
        // SAFETY: `tail - head < capacity`, so this slot is the sender's.
        unsafe { self.ring.slot(self.tail).write(task) };
        self.tail += 1;
        // ORDERING: Release pairs with the receiver's Acquire load of `tail`: the slot is written.
        self.ring.tail().store(self.tail, Ordering::Release);
        true
    }

    /// Sends as many of `tasks` as there is room for, from the first on, publishing them at once;
    /// returns how many.
    pub fn push_all(&mut self, tasks: &[u64]) -> usize {
        let mut room = self.room();
        if room < tasks.len() as u64 {
            // ORDERING: Acquire, as in `room`.
            self.head = self.ring.head().load(Ordering::Acquire);
            room = self.ring.settings.capacity as u64 - (self.tail - self.head);
        }
        let sent = tasks.len().min(room as usize);
        if sent == 0 {
            // A store of nothing new would still take the line from the receiver, and wake it.
            return 0;
        }
        for &task in &tasks[..sent] {
            // SAFETY: at most `room` slots from `tail` on, which are the sender's.
            unsafe { self.ring.slot(self.tail).write(task) };
            self.tail += 1;
        }
        // ORDERING: Release, as in `push`.
        self.ring.tail().store(self.tail, Ordering::Release);
        sent
    }

    /// Tasks in the ring as far as this end knows; never fewer than there are.
    pub fn len(&self) -> usize {
        (self.tail - self.head) as usize
    }

    /// Whether the ring is known to be empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The receiving end. There is one a ring.
pub struct Receiver<M: Machine> {
    ring: Arc<Ring<M>>,
    /// What the shared `head` holds; only this end writes it.
    head: u64,
    /// The newest `tail` seen; the true one is the same or greater.
    tail: u64,
}

impl<M: Machine> Receiver<M> {
    /// Looks for new tasks; says how many there are.
    #[inline]
    pub fn look(&mut self) -> usize {
        // ORDERING: Acquire pairs with the sender's Release store of `tail`: the slots are written.
        self.tail = self.ring.tail().load(Ordering::Acquire);
        (self.tail - self.head) as usize
    }

    /// Takes the oldest task.
    #[inline]
    pub fn pop(&mut self) -> Option<u64> {
        if (self.head == self.tail || !self.ring.settings.remember_index) && self.look() == 0 {
            return None;
        }
        // SAFETY: `head < tail`, so this slot is written and the receiver's.
        let task = unsafe { self.ring.slot(self.head).read() };
        self.head += 1;
        // ORDERING: Release pairs with the sender's Acquire load of `head`: the slot has been read.
        self.ring.head().store(self.head, Ordering::Release);
        Some(task)
    }

    /// Moves all tasks there are into `into`, giving the slots back at once; returns how many.
    pub fn pop_all(&mut self, into: &mut Vec<u64>) -> usize {
        let found = self.look();
        if found == 0 {
            return 0;
        }
        into.extend((self.head..self.tail).map(|index| {
            // SAFETY: `head <= index < tail`: written, and the receiver's.
            unsafe { self.ring.slot(index).read() }
        }));
        self.head = self.tail;
        // ORDERING: Release, as in `pop`.
        self.ring.head().store(self.head, Ordering::Release);
        found
    }

    /// The word whose change means that a task has come.
    pub fn arrivals(&self) -> &M::Word {
        self.ring.tail()
    }

    /// Whether there are tasks that have not been taken.
    pub fn has_arrivals(&self) -> bool {
        // ORDERING: Relaxed: only `pop` and `look` follow up on it, with Acquire.
        self.ring.tail().load(Ordering::Relaxed) != self.head
    }

    /// Tasks seen and not yet taken: a look at this end's own memory only.
    pub fn len(&self) -> usize {
        (self.tail - self.head) as usize
    }

    /// Whether no task has been seen that is not yet taken.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
