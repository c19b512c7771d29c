//! Made once and refitted ever after: cheap, and the worse the less things stay together.

use super::{Kept, SettingError, Settings, Upkeep};

pub(super) const SUMMARY: &str = "the structure is made once, then given new bounds for every frame";

pub(super) struct RefitOnly;

impl RefitOnly {
    pub(super) fn new(_settings: &Settings) -> Result<Self, SettingError> {
        Ok(Self)
    }

    pub(super) fn next<K: Kept>(&mut self, kept: &mut K, first: bool) -> Result<Upkeep, K::Error> {
        if first {
            kept.rebuild()?;
            return Ok(Upkeep::Rebuilt);
        }
        kept.refit()?;
        Ok(Upkeep::Refitted)
    }
}
