//! What only the host itself can tell: its clock, the sizes and latencies of its caches, and how fast it
//! serves misses. One thread each; nanoseconds.

use std::hint::black_box;
use std::time::Duration;

/// Bytes between the elements of a chase: a coherence line of every host so far.
pub(super) const LINE: usize = 64;

/// Bytes of a block beyond the second level, yet no more than a scheme's queues and trees may take: what
/// serves its misses is the third level, where there is one.
const BEYOND: usize = 4 << 20;

#[expect(clippy::disallowed_methods, reason = "micro-benchmarks take native time")]
fn time(body: impl FnOnce()) -> Duration {
    let before = std::time::Instant::now();
    body();
    before.elapsed()
}

/// Nanoseconds of a dependent addition: one cycle on any processor of the last decades.
pub(super) fn addition() -> f64 {
    const ROUNDS: u32 = 5_000;
    let (mut a, mut b) = (black_box(1_u64), black_box(2_u64));
    let took = time(|| {
        for _ in 0..ROUNDS {
            for _ in 0..16 {
                // Each needs the one before, and their sum has no short form.
                a = a.wrapping_add(b);
                b = b.wrapping_add(a);
            }
        }
        black_box((a, b));
    });
    took.as_nanos() as f64 / f64::from(ROUNDS * 32)
}

/// A closed walk through a block of memory, in an order no prefetcher guesses.
pub(super) struct Chase {
    next: Vec<Line>,
    at: Vec<u32>,
}

#[derive(Clone)]
#[repr(align(64))]
struct Line(u32);

impl Chase {
    /// A walk through `bytes` bytes by `walkers` walkers at once, evenly apart.
    pub(super) fn new(bytes: usize, walkers: usize) -> Self {
        let n = bytes / LINE;
        // Sattolo's shuffle makes one closed walk through all lines.
        let mut order: Vec<u32> = (0..n as u32).collect();
        let mut state = 1_u64;
        for i in (1..n).rev() {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            order.swap(i, (state >> 33) as usize % i);
        }
        let next: Vec<Line> = order.into_iter().map(Line).collect();
        let mut at = Vec::new();
        let mut place = 0;
        for step in 0..n {
            if step % n.div_ceil(walkers) == 0 {
                at.push(place);
            }
            place = next[place as usize].0;
        }
        Chase { next, at }
    }

    /// Walks on for about `steps` steps; nanoseconds a step.
    pub(super) fn walk(&mut self, steps: usize) -> f64 {
        let rounds = steps / self.at.len();
        let Chase { next, at } = self;
        let took = match at.as_mut_slice() {
            [one] => time(|| {
                let mut place = *one;
                (0..rounds).for_each(|_| place = next[place as usize].0);
                *one = place;
            }),
            many => time(|| {
                for _ in 0..rounds {
                    many.iter_mut().for_each(|place| *place = next[*place as usize].0);
                }
            }),
        };
        took.as_nanos() as f64 / (rounds * self.at.len()) as f64
    }
}

/// What the caches are like.
#[derive(Clone, Copy, Debug)]
pub(super) struct Caches {
    pub(super) l1_bytes: usize,
    pub(super) l2_bytes: usize,
    /// Nanoseconds of a hit in the second level.
    pub(super) l2: f64,
    /// Nanoseconds of a miss in it.
    pub(super) beyond: f64,
    /// Nanoseconds from one such miss to the next, when many are under way.
    pub(super) apart: f64,
}

/// Walks through blocks of growing size.
pub(super) fn caches() -> Caches {
    let best = |bytes: usize, walkers: usize| {
        let mut chase = Chase::new(bytes, walkers);
        chase.walk(2 * bytes / LINE);
        (0..7).map(|_| chase.walk(20_000)).min_by(f64::total_cmp).unwrap_or(0.0)
    };
    let sizes: Vec<usize> = (13..=22).map(|bits| 1 << bits).collect();
    let latencies: Vec<f64> = sizes.iter().map(|&bytes| best(bytes, 1)).collect();
    let beyond = best(BEYOND, 1);
    let largest_below = |limit: f64| {
        let fits = latencies.iter().take_while(|&&latency| latency < limit).count();
        sizes[fits.max(1) - 1]
    };
    let l1_bytes = largest_below(1.5 * latencies[0]);
    // Four times the first level lies well within the second.
    let l2 = best(4 * l1_bytes, 1);
    let l2_bytes = largest_below(0.5 * (l2 + beyond)).max(4 * l1_bytes);
    Caches { l1_bytes, l2_bytes, l2, beyond, apart: best(BEYOND, 8) }
}

#[cfg(test)]
mod tests {
    use super::Chase;

    #[test]
    fn a_walk_comes_back_after_all_lines() {
        let chase = Chase::new(1 << 14, 4);
        assert_eq!(chase.at.len(), 4);
        let mut place = 0;
        let lines = chase.next.len();
        for step in 1..=lines {
            place = chase.next[place as usize].0;
            assert_eq!(place == 0, step == lines);
        }
    }
}
