//! Made anew for the frames for which that is best, all of them being known beforehand: dynamic programming over what
//! each frame is expected to cost by a structure made for each frame before it.
//!
//! Setting: `percent` (10), what making a structure anew takes more than a refit, in per cent of what a frame is
//! expected to cost by the structure just made. Of all ways to refit and make anew, the one whose frames and structures
//! are expected to cost least altogether is taken. Frames that were not foretold are made anew.

use super::{Foretold, FrameScheme, Kept, SettingError, Settings, Upkeep};

/// How many frames a structure serves at most, so that planning takes no more refits a frame.
const LONGEST: usize = 64;

pub(super) struct RebuildWhenBest {
    price: f64,
    /// Whether it is made anew, by frame.
    anew: Vec<bool>,
}

impl FrameScheme for RebuildWhenBest {
    const SUMMARY: &'static str =
        "made anew for the frames for which that is best, knowing all of them beforehand";
    const LOOKS_AHEAD: bool = true;

    fn new(settings: &Settings) -> Result<Self, SettingError> {
        let percent = settings.number("percent", 10, 0..=1_000_000)?;
        Ok(Self { price: percent as f64 / 100.0, anew: Vec::new() })
    }

    fn plan<F: Foretold>(&mut self, frames: &mut F) -> Result<(), F::Error> {
        let count = frames.count();
        // By how many frames are behind: the least that they can cost, and for which frame the last structure is made.
        let mut best = vec![(f64::INFINITY, 0); count + 1];
        best[0].0 = 0.0;
        for made in 0..count {
            let costs = frames.costs(made, count.min(made + LONGEST))?;
            // The first structure has to be made whatever is planned.
            let price = if made == 0 { 0.0 } else { self.price * costs[0] };
            let mut sum = best[made].0 + price;
            for (cost, best) in costs.iter().zip(&mut best[made + 1..]) {
                sum += cost;
                // Not so if it cannot be told.
                if sum < best.0 {
                    *best = (sum, made);
                }
            }
        }
        self.anew = vec![false; count];
        let mut end = count;
        while end > 0 {
            // Costs that cannot be told leave nothing to choose from: made anew.
            let (cost, made) = best[end];
            end = if cost < f64::INFINITY { made } else { end - 1 };
            self.anew[end] = true;
        }
        // It is there when the first frame comes.
        if let Some(first) = self.anew.first_mut() {
            *first = false;
        }
        Ok(())
    }

    fn next<K: Kept>(&mut self, kept: &mut K, frame: usize, unmade: bool) -> Result<Upkeep, K::Error> {
        if unmade || self.anew.get(frame).is_none_or(|anew| *anew) {
            kept.rebuild()?;
            return Ok(Upkeep::Rebuilt);
        }
        kept.refit()?;
        Ok(Upkeep::Refitted)
    }
}
