//! The row, and the key of the cell it belongs to.

use serde::{Deserialize, Serialize};

/// The machine that is real: OS threads. All others are simulated.
pub const THREADS: &str = "threads";

/// One number and all that is needed to read it: a tidy, long row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// The run's id: its start in UTC, as in the folder's name.
    pub run: String,
    /// The experiment's name: its file without `.toml`.
    pub experiment: String,
    /// The job: `cull`, ...
    pub job: String,
    /// The scene: a generator's name or a file's name.
    pub scene: String,
    /// The structure built over the scene.
    pub structure: String,
    /// The scheme that shared out the work.
    pub scheme: String,
    /// The settings as `key=value;key=value`, sorted, without those of other schemes and machines.
    pub settings: String,
    /// The machine: `threads`, or a simulated one.
    pub machine: String,
    /// How many processors took part.
    pub processors: u32,
    /// Which of the interleaved repeats, from 0.
    pub repeat: u32,
    /// The frame of the camera path, from 0; none for a number of the whole cell.
    pub frame: Option<u32>,
    /// The metric's name, one of [`METRICS`](super::METRICS).
    pub metric: String,
    /// The metric's unit.
    pub unit: String,
    /// The number itself, finite.
    pub value: f64,
}

/// What tells one cell of a run from another.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CellKey {
    /// See [`Row::experiment`].
    pub experiment: String,
    /// See [`Row::job`].
    pub job: String,
    /// See [`Row::scene`].
    pub scene: String,
    /// See [`Row::structure`].
    pub structure: String,
    /// See [`Row::scheme`].
    pub scheme: String,
    /// See [`Row::settings`].
    pub settings: String,
    /// See [`Row::machine`].
    pub machine: String,
    /// See [`Row::processors`].
    pub processors: u32,
    /// See [`Row::repeat`].
    pub repeat: u32,
}

impl Row {
    /// The names of the columns, in their order in `rows.csv`.
    pub const COLUMNS: [&'static str; 14] = [
        "run",
        "experiment",
        "job",
        "scene",
        "structure",
        "scheme",
        "settings",
        "machine",
        "processors",
        "repeat",
        "frame",
        "metric",
        "unit",
        "value",
    ];

    /// The key of the cell this row belongs to.
    pub fn key(&self) -> CellKey {
        CellKey {
            experiment: self.experiment.clone(),
            job: self.job.clone(),
            scene: self.scene.clone(),
            structure: self.structure.clone(),
            scheme: self.scheme.clone(),
            settings: self.settings.clone(),
            machine: self.machine.clone(),
            processors: self.processors,
            repeat: self.repeat,
        }
    }
}

/// The pairs of a settings column: `"a=1;b=x"` gives `("a", "1")` and `("b", "x")`.
pub fn settings_pairs(settings: &str) -> impl Iterator<Item = (&str, &str)> {
    settings.split(';').filter(|pair| !pair.trim().is_empty()).map(|pair| {
        let (key, value) = pair.split_once('=').unwrap_or((pair, ""));
        (key.trim(), value.trim())
    })
}
