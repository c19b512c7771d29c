//! The constants of a simulated multiprocessor, and the presets shipped as data.

use super::network::Network;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A cache-coherent multiprocessor, on one bus or with its nodes in a network. Times are cycles of its own clock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// The machine's name.
    pub name: String,
    /// What it is, in a line.
    pub description: String,
    /// Where the constants come from.
    pub source: String,
    /// Processors of the real machine. More may be simulated.
    pub processors: usize,
    /// Clock rate, MHz.
    pub clock_mhz: f64,
    /// Bytes of a coherence line: a power of two, 16 to 128.
    pub line_bytes: usize,
    /// Lines of the first-level cache (direct mapped).
    pub l1_lines: usize,
    /// Cycles of a first-level hit.
    pub l1_hit: u64,
    /// Lines of the second-level cache (direct mapped).
    pub l2_lines: usize,
    /// Cycles of a second-level hit.
    pub l2_hit: u64,
    /// Cycles of a miss that memory serves, in one's own node where there is a [`Network`].
    pub memory: u64,
    /// Cycles of a miss that another processor's cache serves.
    pub cache_to_cache: u64,
    /// Cycles to invalidate the other copies of a line one holds.
    pub upgrade: u64,
    /// Cycles for which one transaction occupies the bus, or the memory of the line's home node.
    pub bus_occupancy: u64,
    /// Extra cycles of an atomic read-modify-write.
    pub atomic: u64,
    /// Cycles of a full fence.
    pub fence: u64,
    /// Depth of the store buffer (in order, as on a total-store-order machine).
    pub store_buffer: usize,
    /// How many misses of buffered stores are under way at once; 0 for as many as the buffer holds. With
    /// 1, a store asks for its line only when the one before is done.
    #[serde(default)]
    pub store_misses: usize,
    /// Cycles between two looks of a busy wait.
    pub poll_pause: u64,
    /// Cycles for which a processor keeps using a line it has written after another has asked for it,
    /// because the request is still on its way: what lets an owner make several accesses a turn. 0: the
    /// line leaves at once.
    #[serde(default)]
    pub burst: u64,
    /// Cycles of private bookkeeping a task that passes through a scheme (a local queue's push and pop,
    /// the loop around them), beyond its shared accesses. 0: only shared accesses are billed.
    #[serde(default)]
    pub task: u64,
    /// Cycles from the start of a run until a helper begins, beyond what the start word's line takes.
    #[serde(default)]
    pub start: u64,
    /// Cycles from the last helper's finish to the end of the run, beyond what the finishing word takes.
    #[serde(default)]
    pub finish: u64,
    /// Cycles the operating system takes to wake one sleeper, while others who are to be woken wait. 0: nobody has
    /// said, and the machine has no [`Monitor`](crate::machine::Monitor).
    #[serde(default)]
    pub wake: u64,
    /// How much slower this machine is than the host on which node costs were measured, in cycles
    /// of this machine for a nanosecond measured there. See `job::cull::costs`.
    pub cycles_per_measured_ns: f64,
    /// Where memory lies; without it there is one bus.
    #[serde(default)]
    pub network: Network,
}

/// Why a machine description cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file cannot be read.
    #[error("{file}: cannot read the machine description: {source}")]
    Read {
        /// The file.
        file: String,
        /// The system's answer.
        source: std::io::Error,
    },
    /// The file is not a machine description.
    #[error("{file}: {message}")]
    Parse {
        /// The file.
        file: String,
        /// Line, column and what was expected.
        message: String,
    },
    /// A constant makes no sense.
    #[error("{file}: `{key}` is {value}, expected {expected}")]
    Value {
        /// The file.
        file: String,
        /// The constant.
        key: &'static str,
        /// What it was.
        value: String,
        /// What it should be.
        expected: &'static str,
    },
    /// There is no machine of that name.
    #[error("no machine `{name}`; there are: {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// The names there are.
        known: String,
    },
}

/// The presets: adding one is a file and a line here.
const PRESETS: &[(&str, &str)] = &[
    ("e4000", include_str!("presets/e4000.toml")),
    ("pentium3x2", include_str!("presets/pentium3x2.toml")),
    ("origin2000", include_str!("presets/origin2000.toml")),
    ("superdome1024", include_str!("presets/superdome1024.toml")),
    ("opteron16", include_str!("presets/opteron16.toml")),
    ("host", include_str!("presets/host.toml")),
];

impl Model {
    /// The names of the presets.
    pub fn names() -> impl Iterator<Item = &'static str> {
        PRESETS.iter().map(|(name, _)| *name)
    }

    /// A preset by its name, or a description in a file (a name that ends in `.toml`).
    ///
    /// # Errors
    /// [`ModelError`], naming the file, the line and what was expected.
    pub fn named(name: &str) -> Result<Self, ModelError> {
        if let Some((_, text)) = PRESETS.iter().find(|(preset, _)| *preset == name) {
            return Self::parse(name, text);
        }
        if Path::new(name).extension().is_some_and(|e| e == "toml") {
            let text = std::fs::read_to_string(name)
                .map_err(|source| ModelError::Read { file: name.to_owned(), source })?;
            return Self::parse(name, &text);
        }
        let known = Self::names().collect::<Vec<_>>().join(", ");
        Err(ModelError::Unknown { name: name.to_owned(), known: format!("{known}, or a FILE.toml") })
    }

    /// Reads a description; `file` is for messages.
    ///
    /// # Errors
    /// [`ModelError::Parse`] and [`ModelError::Value`].
    pub fn parse(file: &str, text: &str) -> Result<Self, ModelError> {
        // Some editors begin a file with a byte order mark.
        let model: Model = toml::from_str(text.trim_start_matches('\u{feff}'))
            .map_err(|e| ModelError::Parse { file: file.to_owned(), message: e.to_string() })?;
        model.check(file)?;
        Ok(model)
    }

    /// Sets one constant by its name (`memory`, `network.hop`), as a sweep over machine settings does.
    ///
    /// # Errors
    /// [`ModelError::Parse`] for an unknown constant, [`ModelError::Value`] for a senseless value.
    pub fn set(&mut self, key: &str, value: f64) -> Result<(), ModelError> {
        let file = format!("machine `{}`", self.name);
        let mut whole_table = toml::Table::try_from(&*self).expect("a model is a table");
        let whole = value.fract() == 0.0 && value.abs() < 1e15;
        let (table, last) = match key.strip_prefix("network.") {
            Some(last) => match whole_table.get_mut("network") {
                Some(toml::Value::Table(network)) => (network, last),
                _ => unreachable!("a model has a network"),
            },
            None => (&mut whole_table, key),
        };
        let entry = match table.get(last) {
            Some(toml::Value::Integer(_)) if whole => toml::Value::Integer(value as i64),
            Some(toml::Value::Integer(_)) => {
                let message = format!("`{key}` = {value}: expected a whole number");
                return Err(ModelError::Parse { file, message });
            }
            Some(toml::Value::Float(_)) => toml::Value::Float(value),
            _ => {
                let numbers = |value: &toml::Value| value.is_integer() || value.is_float();
                let keys = table.iter().filter(|(_, v)| numbers(v)).map(|(k, _)| k.as_str());
                let keys = keys.collect::<Vec<_>>().join(", ");
                let message = format!("no constant `{key}`; there are: {keys}");
                return Err(ModelError::Parse { file, message });
            }
        };
        table.insert(last.to_owned(), entry);
        let model = whole_table.try_into::<Model>();
        let model = model.map_err(|e| ModelError::Parse { file: file.clone(), message: e.to_string() })?;
        model.check(&file)?;
        *self = model;
        Ok(())
    }

    fn check(&self, file: &str) -> Result<(), ModelError> {
        let wrong = |key, value: String, expected| {
            Err(ModelError::Value { file: file.to_owned(), key, value, expected })
        };
        if !self.line_bytes.is_power_of_two() || !(16..=128).contains(&self.line_bytes) {
            return wrong("line_bytes", self.line_bytes.to_string(), "a power of two from 16 to 128");
        }
        for (key, lines) in [("l1_lines", self.l1_lines), ("l2_lines", self.l2_lines)] {
            if !lines.is_power_of_two() || lines > 1 << 24 {
                return wrong(key, lines.to_string(), "a power of two up to 2^24");
            }
        }
        if self.processors == 0 || self.processors > super::MOST {
            return wrong("processors", self.processors.to_string(), "1 to 4096");
        }
        if self.store_buffer == 0 {
            return wrong("store_buffer", "0".to_owned(), "at least 1");
        }
        let times = [self.l1_hit, self.l2_hit, self.memory, self.cache_to_cache, self.upgrade];
        let times = times.into_iter().chain([self.bus_occupancy, self.atomic, self.fence, self.poll_pause]);
        let times = times.chain([self.burst, self.task, self.start, self.finish, self.wake]);
        if let Some(time) = times.into_iter().find(|&t| t > 1_000_000) {
            return wrong("a time", time.to_string(), "at most 1,000,000 cycles");
        }
        if self.l1_hit == 0 || self.poll_pause == 0 {
            return wrong(
                "l1_hit or poll_pause",
                "0".to_owned(),
                "at least 1 cycle, or waiting takes no time",
            );
        }
        if let Some((key, value, expected)) = self.network.wrong() {
            return wrong(key, value, expected);
        }
        for (key, value) in
            [("clock_mhz", self.clock_mhz), ("cycles_per_measured_ns", self.cycles_per_measured_ns)]
        {
            if !(value.is_finite() && value > 0.0) {
                return wrong(key, value.to_string(), "a finite number above 0");
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_parse_and_carry_their_names() {
        for name in Model::names() {
            assert_eq!(Model::named(name).unwrap().name, name);
        }
    }

    #[test]
    fn bad_input_says_where_and_what() {
        let says = |text: &str| Model::parse("my.toml", text).unwrap_err().to_string();
        assert!(says("name = 3").contains("my.toml"), "{}", says("name = 3"));
        assert!(says("name = 3").contains("line 1"));
        let mut text = PRESETS[0].1.replace("line_bytes = 32", "line_bytes = 33");
        assert!(says(&text).contains("`line_bytes` is 33, expected a power of two"));
        text = PRESETS[0].1.replace("line_bytes = 32", "line_bites = 32");
        assert!(says(&text).contains("line_bites"));
        assert!(Model::named("e400").unwrap_err().to_string().contains("e4000"));
    }

    #[test]
    fn constants_can_be_set_by_name() {
        let mut model = Model::named("e4000").unwrap();
        model.set("cache_to_cache", 250.0).unwrap();
        assert_eq!(model.cache_to_cache, 250);
        assert!(model.set("cache_to_cash", 1.0).unwrap_err().to_string().contains("cache_to_cache"));
        assert!(model.set("memory", 0.5).is_err());
        assert!(model.set("store_buffer", 0.0).is_err());
        assert!(model.store_buffer > 0, "a value that is refused is not kept");
        model.set("network.hop", 7.0).unwrap();
        assert_eq!(model.network.hop, 7);
        assert!(model.set("network.hops", 1.0).unwrap_err().to_string().contains("hop, "));
        assert!(model.set("network.page", 1000.0).unwrap_err().to_string().contains("a power of two"));
    }
}
