//! Samples that count: on a virtual machine cores drift between near and far, and other guests take
//! their time. Each sample is put between two pings; it counts if both took about as long as at the
//! beginning. On a shared host the difference is not small: two virtual cores may be threads of one core
//! now (15 ns) and cores apart a minute later (220 ns). A fit holds for the distance it was made at.

use super::programs;
use crate::machine::{RunError, Threads};

/// How much longer or shorter than the first ones a ping may take.
const TOLERANCE: f64 = 1.5;

/// What the gate let through.
#[derive(Clone, Debug, Default)]
pub struct Gate {
    /// What a ping takes, nanoseconds one way, at the distance that counts.
    pub ping: f64,
    /// Samples that counted.
    pub kept: usize,
    /// Samples between two pings that differed.
    pub discarded: usize,
    /// All pings, nanoseconds one way.
    pings: Vec<f64>,
}

impl Gate {
    /// A gate for the distance at which the cores are now.
    pub(super) fn now(team: &Threads) -> Result<Self, RunError> {
        let mut pings = (0..101).map(|_| programs::ping_pong(team)).collect::<Result<Vec<_>, _>>()?;
        Ok(Gate::at(median(&mut pings)))
    }

    /// A gate for a given distance, nanoseconds one way.
    pub(super) fn at(ping: f64) -> Self {
        Gate { ping, ..Gate::default() }
    }

    /// Whether a ping tells of the distance that counts.
    pub(super) fn lets(&self, ping: f64) -> bool {
        ping < TOLERANCE * self.ping && self.ping < TOLERANCE * ping
    }

    /// The median of `wanted` samples of `sample` that count; of all, if there are too few within four
    /// times as many tries.
    pub(super) fn median(
        &mut self,
        team: &Threads,
        wanted: usize,
        mut sample: impl FnMut(&Threads) -> Result<f64, RunError>,
    ) -> Result<f64, RunError> {
        // Warm up: code, caches, the helper out of its sleep.
        sample(team)?;
        let (mut kept, mut all) = (Vec::new(), Vec::new());
        while kept.len() < wanted && all.len() < 4 * wanted {
            let before = programs::ping_pong(team)?;
            let value = sample(team)?;
            let after = programs::ping_pong(team)?;
            self.pings.extend([before, after]);
            all.push(value);
            if self.lets(before) && self.lets(after) {
                kept.push(value);
                self.kept += 1;
            } else {
                self.discarded += 1;
            }
        }
        Ok(median(if kept.len() * 2 < wanted { &mut all } else { &mut kept }))
    }

    /// The 5th and the 95th percentile of all pings, nanoseconds one way: how near and how far the
    /// cores were.
    pub fn spread(&self) -> (f64, f64) {
        let mut pings = self.pings.clone();
        pings.sort_by(f64::total_cmp);
        let at =
            |share: f64| pings.get((share * (pings.len() as f64 - 1.0)) as usize).copied().unwrap_or(0.0);
        (at(0.05), at(0.95))
    }
}

/// The median; 0 of nothing.
pub(super) fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n if n % 2 == 1 => values[n / 2],
        n => 0.5 * (values[n / 2 - 1] + values[n / 2]),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(super::median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(super::median(&mut [4.0, 1.0, 2.0, 3.0]), 2.5);
        assert_eq!(super::median(&mut []), 0.0);
    }
}
