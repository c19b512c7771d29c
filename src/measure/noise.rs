//! How much of a core other work takes away.

use std::time::{Duration, Instant};

/// Long enough to meet a busy neighbour, short enough to be paid before every cell.
const LOOK: Duration = Duration::from_millis(5);
/// Two readings of the clock are some 30 ns apart; a gap of this length is someone else's.
const GAP: Duration = Duration::from_micros(2);

/// The share of a core lost to other work, in per cent: the sum of the gaps a spin on the clock sees.
#[expect(clippy::disallowed_methods, reason = "the real clock is what is asked about here")]
pub(crate) fn lost_time() -> f64 {
    let start = Instant::now();
    let (mut last, mut lost) = (start, Duration::ZERO);
    while last - start < LOOK {
        let now = Instant::now();
        if now - last > GAP {
            lost += now - last;
        }
        last = now;
    }
    100.0 * lost.as_secs_f64() / (last - start).as_secs_f64()
}
