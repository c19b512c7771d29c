//! Made once and refitted ever after: cheap, and the worse the less things stay together.

use super::{FrameScheme, Kept, SettingError, Settings, Upkeep};

pub(super) struct RefitOnly;

impl FrameScheme for RefitOnly {
    const SUMMARY: &'static str = "the structure is made once, then given new bounds for every frame";

    fn new(_settings: &Settings) -> Result<Self, SettingError> {
        Ok(Self)
    }

    fn next<K: Kept>(&mut self, kept: &mut K, _frame: usize, unmade: bool) -> Result<Upkeep, K::Error> {
        if unmade {
            kept.rebuild()?;
            return Ok(Upkeep::Rebuilt);
        }
        kept.refit()?;
        Ok(Upkeep::Refitted)
    }
}
