//! The settings of a cell, told apart: those of the job, and those of its scheme.

use super::{Cell, MeasureError};
use crate::measure::near;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::str::FromStr;

/// A scheme's settings that are really the job's: how the job presents itself to this scheme.
const OF_THE_JOB: [&str; 1] = ["tasks"];

/// The job's settings by their bare names.
pub(super) struct JobSettings {
    values: BTreeMap<String, String>,
    known: RefCell<Vec<&'static str>>,
}

impl JobSettings {
    /// The settings `job.*` of a cell, and its scheme's `tasks`.
    pub(super) fn of(cell: &Cell) -> Self {
        let mut values: BTreeMap<_, _> = part(cell, "job.").collect();
        let own = part(cell, "scheme.").chain(part(cell, &format!("{}.", cell.scheme)));
        values.extend(own.filter(|(key, _)| OF_THE_JOB.contains(&key.as_str())));
        JobSettings { values, known: RefCell::default() }
    }

    /// One of some words, the first where the setting is absent.
    pub(super) fn choice<T: Copy>(&self, key: &'static str, words: &[(&str, T)]) -> Result<T, MeasureError> {
        self.known.borrow_mut().push(key);
        let Some(value) = self.values.get(key) else { return Ok(words[0].1) };
        words.iter().find(|(word, _)| word == value).map(|(_, choice)| *choice).ok_or_else(|| {
            let words = words.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
            MeasureError::Setting(format!("setting `{}` is `{value}`, expected one of: {words}", whole(key)))
        })
    }

    /// What a text stands for; none where the setting is absent.
    pub(super) fn parsed<T: FromStr<Err: Display>>(
        &self,
        key: &'static str,
    ) -> Result<Option<T>, MeasureError> {
        self.known.borrow_mut().push(key);
        let Some(value) = self.values.get(key) else { return Ok(None) };
        let wrong = |error| MeasureError::Setting(format!("setting `{}`: {error}", whole(key)));
        value.parse().map(Some).map_err(wrong)
    }

    /// A number within a range.
    pub(super) fn number(
        &self,
        key: &'static str,
        default: f64,
        range: std::ops::RangeInclusive<f64>,
    ) -> Result<f64, MeasureError> {
        self.known.borrow_mut().push(key);
        let Some(value) = self.values.get(key) else { return Ok(default) };
        value.parse().ok().filter(|number| range.contains(number)).ok_or_else(|| {
            let (least, most) = (range.start(), range.end());
            MeasureError::Setting(format!(
                "setting `{}` is `{value}`, expected a number from {least} to {most}",
                whole(key)
            ))
        })
    }

    /// A range of whole numbers, written `LEAST-MOST`.
    pub(super) fn range(
        &self,
        key: &'static str,
        default: std::ops::RangeInclusive<u32>,
    ) -> Result<std::ops::RangeInclusive<u32>, MeasureError> {
        self.known.borrow_mut().push(key);
        let Some(value) = self.values.get(key) else { return Ok(default) };
        let ends =
            value.split_once('-').and_then(|(least, most)| Some((least.parse().ok()?, most.parse().ok()?)));
        ends.filter(|(least, most)| least <= most).map(|(least, most)| least..=most).ok_or_else(|| {
            let key = whole(key);
            MeasureError::Setting(format!(
                "setting `{key}` is `{value}`, expected LEAST-MOST, such as 100-300"
            ))
        })
    }

    /// Anything that can be read off its words; `expected` says what those are.
    pub(super) fn read<T>(
        &self,
        key: &'static str,
        default: T,
        expected: &str,
        read: impl Fn(&str) -> Option<T>,
    ) -> Result<T, MeasureError> {
        self.known.borrow_mut().push(key);
        let Some(value) = self.values.get(key) else { return Ok(default) };
        read(value).ok_or_else(|| {
            MeasureError::Setting(format!("setting `{}` is `{value}`, expected {expected}", whole(key)))
        })
    }

    /// Refuses settings that nobody asked for.
    pub(super) fn finish(&self, cell: &Cell) -> Result<(), MeasureError> {
        let known = self.known.borrow();
        match self.values.keys().find(|key| !known.contains(&key.as_str())) {
            None => Ok(()),
            Some(key) => {
                let near = near(key, known.iter().copied());
                Err(MeasureError::Setting(format!(
                    "job `{}` has no setting `{}`{near}",
                    cell.job,
                    whole(key)
                )))
            }
        }
    }
}

/// A setting's key as an experiment has it.
fn whole(key: &str) -> String {
    let owner = if OF_THE_JOB.contains(&key) { "scheme" } else { "job" };
    format!("{owner}.{key}")
}

fn part<'a>(cell: &'a Cell, prefix: &str) -> impl Iterator<Item = (String, String)> + use<'a> {
    let prefix = prefix.to_owned();
    cell.settings
        .iter()
        .filter_map(move |(key, value)| Some((key.strip_prefix(&prefix)?.to_owned(), value.to_string())))
}

/// What can be set about a cell's scene.
const OF_THE_SCENE: [&str; 6] = ["path", "copies", "spacing", "fov", "off_axis", "moving"];

/// The settings `scene.*` of a cell, by their bare names.
///
/// # Errors
/// One that nobody asked for.
pub(super) fn of_scene(cell: &Cell) -> Result<BTreeMap<String, String>, MeasureError> {
    let settings: BTreeMap<String, String> = part(cell, "scene.").collect();
    match settings.keys().find(|key| !OF_THE_SCENE.contains(&key.as_str())) {
        None => Ok(settings),
        Some(key) => {
            let near = near(key, OF_THE_SCENE);
            Err(MeasureError::Setting(format!("there is no setting `scene.{key}`{near}")))
        }
    }
}

/// The settings of a cell's scheme, by their bare names: `scheme.*` for all that share (the serial one has
/// nothing to set there), its own name's over them.
pub(super) fn of_scheme(cell: &Cell) -> BTreeMap<String, String> {
    let shared = part(cell, "scheme.").filter(|_| cell.scheme != "serial");
    let own = shared.chain(part(cell, &format!("{}.", cell.scheme)));
    own.filter(|(key, _)| !OF_THE_JOB.contains(&key.as_str())).collect()
}
