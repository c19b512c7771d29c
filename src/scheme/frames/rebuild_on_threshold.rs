//! Refitted until it has become too bad, then made anew (the rebuild heuristic of Lauterbach et al. 2006, on expected
//! cost).
//!
//! Setting: `percent` (150), of the cost expected when the structure was last made; above it, it is made anew within the
//! same frame, so no frame goes through one that is worse. At 100 any loss will do.

use super::{FrameScheme, Kept, SettingError, Settings, Upkeep};

pub(super) struct RebuildOnThreshold {
    most: f64,
    /// What it was expected to cost when it was last made.
    made: f64,
}

impl FrameScheme for RebuildOnThreshold {
    const SUMMARY: &'static str = "refitted, and made anew when it is expected to cost too much";

    fn new(settings: &Settings) -> Result<Self, SettingError> {
        let percent = settings.number("percent", 150, 100..=1_000_000)?;
        Ok(Self { most: percent as f64 / 100.0, made: 0.0 })
    }

    fn next<K: Kept>(&mut self, kept: &mut K, _frame: usize, unmade: bool) -> Result<Upkeep, K::Error> {
        if !unmade {
            kept.refit()?;
            // A cost that cannot be told is above any threshold.
            if kept.cost() <= self.most * self.made {
                return Ok(Upkeep::Refitted);
            }
        }
        kept.rebuild()?;
        self.made = kept.cost();
        Ok(Upkeep::Rebuilt)
    }
}
