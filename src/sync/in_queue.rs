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

use crate::machine::{Layout, Machine, Slot, Word};
use std::hint::black_box;
use std::sync::Arc;
use std::sync::atomic::Ordering;

mod ring;
use ring::{HEAD, Hold, Ring, TAIL};

/// How many slots [`Receiver::pop_all`] gives back at once: few enough that the sender goes on meanwhile.
const GIVE_BACK: usize = 128;

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
        settings,
    });
    let sender = Sender { hold: Hold::new(ring.clone(), TAIL, HEAD), tail: 0, limit: 0, head: 0 };
    (sender, Receiver { hold: Hold::new(ring, HEAD, TAIL), head: 0, limit: 0, tail: 0 })
}

/// The sending end. There is one a ring.
///
/// Invariant: `tail <= limit <= head + capacity`.
pub struct Sender<M: Machine> {
    hold: Hold<M>,
    /// What the shared `tail` holds; only this end writes it.
    tail: u64,
    /// Slots below are this end's; here it looks again.
    limit: u64,
    /// The newest `head` seen; the true one is the same or greater.
    head: u64,
}

impl<M: Machine> Sender<M> {
    /// Looks up how far the receiver has come; returns how many tasks fit in now.
    #[inline]
    fn look(&mut self) -> u64 {
        // ORDERING: Acquire pairs with the receiver's Release store of `head`: it has read the
        // slots before that index, so they may be written again.
        self.head = self.hold.other().load(Ordering::Acquire);
        let room = self.head + self.hold.ring.settings.capacity as u64 - self.tail;
        self.limit = self.tail + room.min(self.hold.memory);
        room
    }

    /// Sends a task; says whether there was room for it.
    #[inline]
    pub fn push(&mut self, task: u64) -> bool {
        if self.tail == self.limit && self.look() == 0 {
            return false;
        }
        // SAFETY: `tail < limit <= head + capacity`, so this slot is the sender's.
        unsafe { self.hold.slot(self.tail).write(task) };
        self.tail += 1;
        // ORDERING: Release pairs with the receiver's Acquire load of `tail`: the slot is written.
        self.hold.own().store(self.tail, Ordering::Release);
        true
    }

    /// Sends as many of `tasks` as there is room for, from the first on, publishing them at once;
    /// returns how many.
    #[inline]
    pub fn push_all(&mut self, tasks: &[u64]) -> usize {
        let mut room = self.limit - self.tail;
        if room < tasks.len() as u64 {
            room = self.look();
        }
        let sent = tasks.len().min(room as usize);
        if sent == 0 {
            // A store of nothing new would still take the line from the receiver, and wake it.
            return 0;
        }
        let [first, second] = self.hold.stretches(self.tail, sent);
        let (tasks, rest) = tasks[..sent].split_at(first.len());
        for (slots, tasks) in [(first, tasks), (second, rest)] {
            for (slot, &task) in slots.iter().zip(tasks) {
                // SAFETY: one of at most `room` slots from `tail` on, which are the sender's.
                unsafe { slot.write(task) };
            }
        }
        self.tail += sent as u64;
        self.limit = self.limit.max(self.tail);
        // ORDERING: Release, as in `push`.
        self.hold.own().store(self.tail, Ordering::Release);
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
///
/// Invariant: `head <= limit <= tail`.
pub struct Receiver<M: Machine> {
    hold: Hold<M>,
    /// What the shared `head` holds; only this end writes it.
    head: u64,
    /// Slots below are this end's; here it looks again.
    limit: u64,
    /// The newest `tail` seen; the true one is the same or greater.
    tail: u64,
}

impl<M: Machine> Receiver<M> {
    /// Looks for new tasks; says how many there are.
    #[inline]
    pub fn look(&mut self) -> usize {
        // ORDERING: Acquire pairs with the sender's Release store of `tail`: the slots are written.
        self.tail = self.arrivals().load(Ordering::Acquire);
        self.limit = self.head + (self.tail - self.head).min(self.hold.memory);
        self.len()
    }

    /// Takes the oldest task.
    #[inline]
    pub fn pop(&mut self) -> Option<u64> {
        if self.head == self.limit && self.look() == 0 {
            return None;
        }
        // SAFETY: `head < limit <= tail`, so this slot is written and the receiver's.
        let task = unsafe { self.hold.slot(self.head).read() };
        // Kept in memory, which paces the loop around a `pop` by a few cycles. In a register it outruns
        // any sender and then lives at the ring's empty end, where each look at `tail` takes that line
        // away from the sender: item by item both sides lose about a third (`benches/in_queue.rs`).
        *black_box(&mut self.head) += 1;
        // ORDERING: Release pairs with the sender's Acquire load of `head`: the slot has been read.
        self.hold.own().store(self.head, Ordering::Release);
        Some(task)
    }

    /// Moves all tasks there are into `into`, giving their slots back as it goes; returns how many.
    #[inline]
    pub fn pop_all(&mut self, into: &mut Vec<u64>) -> usize {
        let found = self.look();
        if found == 0 {
            return 0;
        }
        into.reserve(found);
        for stretch in self.hold.stretches(self.head, found) {
            for slots in stretch.chunks(GIVE_BACK) {
                // SAFETY: slots from `head` up to `tail`: written, and the receiver's.
                into.extend(slots.iter().map(|slot| unsafe { slot.read() }));
                self.head += slots.len() as u64;
                // ORDERING: Release, as in `pop`.
                self.hold.own().store(self.head, Ordering::Release);
            }
        }
        self.limit = self.tail;
        found
    }

    /// The word whose change means that a task has come.
    #[inline]
    pub fn arrivals(&self) -> &M::Word {
        self.hold.other()
    }

    /// Whether there are tasks that have not been taken.
    pub fn has_arrivals(&self) -> bool {
        // ORDERING: Relaxed: only `pop` and `look` follow up on it, with Acquire.
        self.arrivals().load(Ordering::Relaxed) != self.head
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
