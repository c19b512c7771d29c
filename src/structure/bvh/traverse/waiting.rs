//! Children that wait until a ray has been through those nearer to it.

use super::super::wide::{Child, Node, WIDTH};
use std::mem::MaybeUninit;

/// A child that waits, and where the ray enters its box: a number that is not negative, so its bits are in the order of
/// such numbers and stand above the child's.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Waiting(u64);

impl Waiting {
    #[inline(always)]
    fn new(enters: f32, child: Child) -> Self {
        Self(u64::from(enters.to_bits()) << 32 | u64::from(child.bits()))
    }

    #[inline(always)]
    pub(super) fn enters(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    pub(super) fn child(self) -> Child {
        Child::from_bits(self.0 as u32)
    }

    /// Both, the farther one first.
    #[inline(always)]
    fn farther_first(self, other: Self) -> (Self, Self) {
        (self.max(other), self.min(other))
    }
}

/// How many children wait at most in a hierarchy that is not much out of balance.
pub(super) const PLACES: usize = 256;

/// What waits, the next one last.
pub(super) struct Stack<'a> {
    places: &'a mut [MaybeUninit<Waiting>],
    top: usize,
}

impl<'a> Stack<'a> {
    #[inline(always)]
    pub(super) fn of(places: &'a mut [MaybeUninit<Waiting>]) -> Self {
        Self { places, top: 0 }
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<Waiting> {
        self.top = self.top.checked_sub(1)?;
        // SAFETY: what is below the top was written.
        Some(unsafe { self.places.get_unchecked(self.top).assume_init() })
    }

    /// # Safety
    /// There is a place.
    #[inline(always)]
    unsafe fn wait(&mut self, waiting: Waiting) {
        // SAFETY: as above.
        unsafe { self.places.get_unchecked_mut(self.top).write(waiting) };
        self.top += 1;
    }

    /// The child entered first of those whose bits are set in `met`; the others wait.
    ///
    /// # Safety
    /// There is one at least, and a place for each.
    #[inline(always)]
    pub(super) unsafe fn nearest(&mut self, mut met: u64, enters: &[f32; WIDTH], node: &Node) -> Child {
        let mut next = || {
            let lane = met.trailing_zeros() as usize & (WIDTH - 1);
            met &= met.wrapping_sub(1);
            (Waiting::new(enters[lane], node.children[lane]), met)
        };
        // Mostly one or two are met, which one branch each tells: a jump by their number would be foreseen less often.
        // Those few are put in order without a branch, which nobody could foresee either.
        // SAFETY: the places are the caller's.
        unsafe {
            let (a, left) = next();
            if left == 0 {
                return a.child();
            }
            let (b, left) = next();
            let (a, b) = a.farther_first(b);
            if left == 0 {
                self.wait(a);
                return b.child();
            }
            let (c, left) = next();
            let (a, c) = a.farther_first(c);
            let (b, c) = b.farther_first(c);
            if left == 0 {
                self.wait(a);
                self.wait(b);
                return c.child();
            }
            let first = self.top;
            self.wait(a);
            self.wait(b);
            self.wait(c);
            loop {
                let (next, left) = next();
                self.wait(next);
                if left == 0 {
                    break;
                }
            }
            sort(self.places.get_unchecked_mut(first..self.top), 3);
            self.top -= 1;
            self.places.get_unchecked(self.top).assume_init().child()
        }
    }
}

/// Puts what waits in order, the nearest last; the first `sorted` are.
///
/// # Safety
/// All were written.
#[inline(always)]
unsafe fn sort(waiting: &mut [MaybeUninit<Waiting>], sorted: usize) {
    for end in sorted..waiting.len() {
        let mut at = end;
        // SAFETY: all were written, and `at` is above 0.
        while at > 0 && unsafe { waiting[at - 1].assume_init() < waiting[at].assume_init() } {
            waiting.swap(at - 1, at);
            at -= 1;
        }
    }
}
