//! Anew for every frame: dear, and as good as can be whatever moves how.

use super::{Kept, SettingError, Settings, Upkeep};

pub(super) const SUMMARY: &str = "the structure is made anew for every frame";

pub(super) struct RebuildEachFrame;

impl RebuildEachFrame {
    pub(super) fn new(_settings: &Settings) -> Result<Self, SettingError> {
        Ok(Self)
    }

    pub(super) fn next<K: Kept>(&mut self, kept: &mut K, _first: bool) -> Result<Upkeep, K::Error> {
        kept.rebuild()?;
        Ok(Upkeep::Rebuilt)
    }
}
