//! What can be wrong with a scene, a camera path or their names.

use std::io;

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
    #[error(
        "{file}: unknown scene format {extension:?}; expected one of {known}, or one of these with .gz after it"
    )]
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
