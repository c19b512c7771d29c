//! What can be wrong with a scene, a camera path or their names.

use std::io;
use std::path::Path;

use thiserror::Error;

/// Why a scene or a camera path cannot be had. Messages name the file, the place in it and what was
/// expected there.
#[derive(Debug, Error)]
pub enum SceneError {
    /// A file cannot be read.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error("{file}: cannot be written: {source}")]
    Write {
        /// The file.
        file: String,
        /// What the system said.
        source: io::Error,
    },
    /// Something in a file, or in a scene made by a program, is not as it must be.
    #[error("{file}: {place}: {found}; expected {expected}")]
    Malformed {
        /// The file, or the name of the scene if it came from none.
        file: String,
        /// Line, or node or mesh by number and name.
        place: String,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// No format has this extension.
    #[error("{file}: unknown scene format {extension:?}; expected one of {known}")]
    UnknownFormat {
        /// The file.
        file: String,
        /// Its extension, without the dot.
        extension: String,
        /// The extensions that are known.
        known: String,
    },
    /// No generator has this name.
    #[error("unknown scene {name:?}; {advice}")]
    UnknownName {
        /// The name asked for.
        name: String,
        /// The near names, or all of them.
        advice: String,
    },
}

impl SceneError {
    pub(super) fn malformed(
        file: &str,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Malformed {
            file: file.to_string(),
            place: place.into(),
            found: found.into(),
            expected: expected.into(),
        }
    }
}

/// Reads a whole file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, SceneError> {
    std::fs::read(path).map_err(|source| SceneError::Read { file: path.display().to_string(), source })
}

/// Reads a whole file of text.
pub(super) fn read_text(path: &Path) -> Result<String, SceneError> {
    String::from_utf8(read(path)?).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..valid].iter().filter(|byte| **byte == b'\n').count() + 1;
        let file = path.display().to_string();
        SceneError::malformed(&file, format!("line {line}"), "a byte that is not UTF-8", "text in UTF-8")
    })
}
