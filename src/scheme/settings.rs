//! Named settings of a scheme, as words: what a command line, an experiment file and a row hold.

use crate::machine::{Layout, Machine};
use crate::sync::{BarrierKind, CounterKind, LockKind};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// A setting that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingError {
    /// The value is not of the kind expected.
    #[error("scheme `{scheme}`: setting `{key}` is `{value}`, expected {expected}")]
    Value {
        /// The scheme's name.
        scheme: String,
        /// The setting.
        key: String,
        /// What it was.
        value: String,
        /// What it should be.
        expected: String,
    },
    /// The scheme has no such setting.
    #[error("scheme `{scheme}` has no setting `{key}`; it has: {known}")]
    Unknown {
        /// The scheme's name.
        scheme: String,
        /// The setting.
        key: String,
        /// The settings there are.
        known: String,
    },
    /// There is no such scheme.
    #[error("no scheme `{name}` for {shape}; there are: {known}")]
    NoScheme {
        /// What it should share out: "trees", "tiles".
        shape: &'static str,
        /// What was asked for.
        name: String,
        /// The schemes there are.
        known: String,
    },
    /// A scheme from another library cannot run on this machine.
    #[error("scheme `{scheme}` runs on threads only, not on machine `{machine}`")]
    NativeOnly {
        /// The scheme's name.
        scheme: String,
        /// The machine's name.
        machine: String,
    },
    /// A scheme wants to know of frames to come where nobody may.
    #[error("scheme `{scheme}` looks ahead, which is for predetermined mode, not for interactive mode")]
    LooksAhead {
        /// The scheme's name.
        scheme: String,
    },
}

/// Settings by name, with a note of which ones have been asked for.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    scheme: String,
    values: BTreeMap<String, String>,
    known: RefCell<Vec<&'static str>>,
}

impl Settings {
    /// The settings of `scheme`.
    pub fn new(scheme: &str, values: BTreeMap<String, String>) -> Self {
        Settings { scheme: scheme.to_owned(), values, known: RefCell::default() }
    }

    fn wrong(&self, key: &str, value: &str, expected: String) -> SettingError {
        let (scheme, key, value) = (self.scheme.clone(), key.to_owned(), value.to_owned());
        SettingError::Value { scheme, key, value, expected }
    }

    fn get(&self, key: &'static str) -> Option<&str> {
        self.known.borrow_mut().push(key);
        self.values.get(key).map(String::as_str)
    }

    /// A whole number within `range`, or the default.
    ///
    /// # Errors
    /// [`SettingError::Value`].
    pub fn number(
        &self,
        key: &'static str,
        default: usize,
        range: std::ops::RangeInclusive<usize>,
    ) -> Result<usize, SettingError> {
        let Some(value) = self.get(key) else { return Ok(default) };
        match value.parse() {
            Ok(number) if range.contains(&number) => Ok(number),
            _ => {
                let expected = format!("a whole number from {} to {}", range.start(), range.end());
                Err(self.wrong(key, value, expected))
            }
        }
    }

    /// `true` or `false`, or the default.
    ///
    /// # Errors
    /// [`SettingError::Value`].
    pub fn flag(&self, key: &'static str, default: bool) -> Result<bool, SettingError> {
        self.choice(key, default, &[("true", true), ("false", false)])
    }

    /// One of some words, or the default.
    ///
    /// # Errors
    /// [`SettingError::Value`].
    pub fn choice<T: Copy>(
        &self,
        key: &'static str,
        default: T,
        words: &[(&str, T)],
    ) -> Result<T, SettingError> {
        let Some(value) = self.get(key) else { return Ok(default) };
        match words.iter().find(|(word, _)| *word == value) {
            Some((_, choice)) => Ok(*choice),
            None => {
                let words = words.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
                Err(self.wrong(key, value, format!("one of: {words}")))
            }
        }
    }

    /// The data layout: `1999` (packed) or `padded`, the default.
    ///
    /// # Errors
    /// [`SettingError::Value`].
    pub fn layout(&self) -> Result<Layout, SettingError> {
        self.choice("layout", Layout::Padded, &[("1999", Layout::Packed), ("padded", Layout::Padded)])
    }

    /// The kind of lock; test-and-test-and-set by default.
    ///
    /// # Errors
    /// [`SettingError::Value`].
    pub fn lock(&self) -> Result<LockKind, SettingError> {
        self.choice("lock", LockKind::default(), LockKind::ALL)
    }

    /// How a counter draws: `locked`, the default, or `fetch_add`.
    ///
    /// # Errors
    /// [`SettingError::Value`].
    pub fn counter(&self) -> Result<CounterKind, SettingError> {
        let locked = CounterKind::Locked(self.lock()?);
        self.choice("counter", locked, &[("locked", locked), ("fetch_add", CounterKind::FetchAdd)])
    }

    /// The kind of barrier; fetch-op by default.
    ///
    /// # Errors
    /// [`SettingError::Value`], also for one that the machine does not have.
    pub fn barrier<M: Machine>(&self, machine: &M) -> Result<BarrierKind, SettingError> {
        let has = |kind| kind != BarrierKind::System || machine.is_native() || machine.monitor().is_some();
        let kind = self.choice("barrier", BarrierKind::default(), BarrierKind::ALL)?;
        if has(kind) {
            return Ok(kind);
        }
        let expected =
            format!("fetch_op or tree: how long the system of `{}` takes is not known", machine.name());
        Err(self.wrong("barrier", "system", expected))
    }

    /// Refuses a machine that is not made of real threads.
    ///
    /// # Errors
    /// [`SettingError::NativeOnly`].
    pub fn native_only<M: Machine>(&self, machine: &M) -> Result<(), SettingError> {
        if machine.is_native() {
            return Ok(());
        }
        let (scheme, machine) = (self.scheme.clone(), machine.name().to_owned());
        Err(SettingError::NativeOnly { scheme, machine })
    }

    /// Checks that no setting was given that nobody asked for.
    ///
    /// # Errors
    /// [`SettingError::Unknown`].
    pub fn finish(&self) -> Result<(), SettingError> {
        let known = self.known.borrow();
        match self.values.keys().find(|key| !known.contains(&key.as_str())) {
            None => Ok(()),
            Some(key) => {
                let mut known = known.clone();
                known.sort_unstable();
                known.dedup();
                let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
                Err(SettingError::Unknown { scheme: self.scheme.clone(), key: key.clone(), known })
            }
        }
    }
}
