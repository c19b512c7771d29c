//! Anew for every frame: dear, and as good as can be whatever moves how.

use super::{FrameScheme, Kept, SettingError, Settings, Upkeep};

pub(super) struct RebuildEachFrame;

impl FrameScheme for RebuildEachFrame {
    const SUMMARY: &'static str = "the structure is made anew for every frame";

    fn new(_settings: &Settings) -> Result<Self, SettingError> {
        Ok(Self)
    }

    fn next<K: Kept>(&mut self, kept: &mut K, _frame: usize, _unmade: bool) -> Result<Upkeep, K::Error> {
        kept.rebuild()?;
        Ok(Upkeep::Rebuilt)
    }
}
