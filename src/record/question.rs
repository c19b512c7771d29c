//! What a run asked: the parts of its `experiment.toml` that are needed to show its rows.

use super::{PaperFigure, RecordError};
use serde::Deserialize;
use std::path::Path;

/// The question a run's rows answer.
///
/// Keys that only matter to run it again are passed over, so that the rows of an older or newer version, with
/// schemes this one does not know, can still be shown.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct Question {
    /// The experiment's title.
    pub title: String,
    /// The paper and figure it reproduces; empty for a question of our own.
    #[serde(default)]
    pub reproduces: String,
    /// What the paper printed.
    #[serde(default)]
    pub paper: Vec<PaperFigure>,
}

impl Question {
    /// Reads `experiment.toml`.
    ///
    /// # Errors
    /// It cannot be read, or holds something else.
    pub fn read(path: &Path) -> Result<Self, RecordError> {
        let text = std::fs::read_to_string(path).map_err(RecordError::file("read", path))?;
        toml::from_str(&text).map_err(|error| RecordError::Question {
            path: path.to_path_buf(),
            line: error.span().map_or(0, |span| text[..span.start].lines().count().max(1)),
            message: error.message().to_owned(),
        })
    }
}
