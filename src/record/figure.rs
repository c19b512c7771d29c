//! A figure a paper printed, to be held beside ours.

use serde::{Deserialize, Serialize};

/// One number of a paper, read off a chart or quoted from the text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PaperFigure {
    /// Which figure or table it stands in: `Fig. 1a`.
    pub figure: String,
    /// The scheme it is about.
    pub scheme: String,
    /// Settings a row must have to be compared, `key=value;key=value`; of the rest the best is taken, point by point.
    #[serde(default)]
    pub settings: String,
    /// The scene; any where absent.
    pub scene: Option<String>,
    /// The machine the paper used.
    pub machine: String,
    /// At how many processors; absent: the best over all of them, the peak of the curve.
    pub processors: Option<u32>,
    /// The metric, one of [`METRICS`](super::METRICS).
    pub metric: String,
    /// Its unit.
    pub unit: String,
    /// The paper's number.
    pub value: f64,
    /// Where in the paper: `Paper II sec. 4.2`.
    pub source: String,
    /// The number's name, for those who look it up elsewhere.
    pub fact: Option<String>,
}
