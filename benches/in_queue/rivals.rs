//! The rivals behind one face.

use crate::{CAPACITY, CHUNK};
use apportion::machine::Threads;
use apportion::sync::{Receiver, RingSettings, Sender, in_queue};

/// One side of a rival: it hands over tasks item by item or in chunks.
pub(crate) trait Sending: Send {
    fn item(&mut self, task: u64) -> bool;
    /// Sends some of these, at most a chunk; says how many.
    fn chunk(&mut self, tasks: &[u64]) -> usize;
}

/// The other side.
pub(crate) trait Receiving: Send {
    fn item(&mut self) -> Option<u64>;
    /// Hands what has come to `each`, and returns how many there were.
    fn chunk(&mut self, each: impl FnMut(u64)) -> usize;
}

impl Sending for Sender<Threads> {
    #[inline]
    fn item(&mut self, task: u64) -> bool {
        self.push(task)
    }
    #[inline]
    fn chunk(&mut self, tasks: &[u64]) -> usize {
        self.push_all(tasks)
    }
}

/// Our receiving end with the list it fills.
pub(crate) struct Ours(Receiver<Threads>, Vec<u64>);

impl Receiving for Ours {
    #[inline]
    fn item(&mut self) -> Option<u64> {
        self.0.pop()
    }
    #[inline]
    fn chunk(&mut self, each: impl FnMut(u64)) -> usize {
        let found = self.0.pop_all(&mut self.1);
        self.1.drain(..).for_each(each);
        found
    }
}

impl Sending for rtrb::Producer<u64> {
    #[inline]
    fn item(&mut self, task: u64) -> bool {
        self.push(task).is_ok()
    }
    #[inline]
    fn chunk(&mut self, tasks: &[u64]) -> usize {
        // This is `write_chunk_uninit`, a copy into both its slices, and `commit_all`.
        if self.push_entire_slice(tasks).is_ok() { tasks.len() } else { 0 }
    }
}

/// Their receiving end with the list it fills, as ours does: the tasks are then the receiver's own, and the
/// slots free again. `None` has the tasks used where they lie in the ring, which ours does not offer.
pub(crate) struct Theirs(rtrb::Consumer<u64>, Option<Vec<u64>>);

impl Receiving for Theirs {
    #[inline]
    fn item(&mut self) -> Option<u64> {
        self.0.pop().ok()
    }
    #[inline]
    fn chunk(&mut self, mut each: impl FnMut(u64)) -> usize {
        let Ok(chunk) = self.0.read_chunk(CHUNK) else { return 0 };
        let (first, second) = chunk.as_slices();
        let found = first.len() + second.len();
        if let Some(list) = &mut self.1 {
            list.extend_from_slice(first);
            list.extend_from_slice(second);
            chunk.commit_all();
            list.drain(..).for_each(each);
        } else {
            first.iter().chain(second).for_each(|&task| each(task));
            chunk.commit_all();
        }
        found
    }
}

pub(crate) fn ours(machine: &Threads) -> (Sender<Threads>, Ours) {
    let (to, from) = in_queue(machine, RingSettings { capacity: CAPACITY, ..Default::default() });
    (to, Ours(from, Vec::with_capacity(CAPACITY)))
}

pub(crate) fn theirs() -> (rtrb::Producer<u64>, Theirs) {
    let (to, from) = rtrb::RingBuffer::new(CAPACITY);
    (to, Theirs(from, Some(Vec::with_capacity(CAPACITY))))
}

pub(crate) fn theirs_in_place() -> (rtrb::Producer<u64>, Theirs) {
    let (to, from) = rtrb::RingBuffer::new(CAPACITY);
    (to, Theirs(from, None))
}
