//! How work is shared out, by the shape of the work. A scheme knows nothing of boxes or rays.

pub mod frames;
mod settings;
pub mod tiles;
pub mod tree;

use crate::machine::RunError;
pub use settings::{SettingError, Settings};

/// A scheme in the list of schemes of its shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct About {
    /// Its name: word of the command line, value in rows, legend.
    pub name: &'static str,
    /// What it is, in a line.
    pub summary: &'static str,
    /// Whether it is another library's, which runs on real threads only.
    pub native_only: bool,
    /// Whether it learns from run to run, so that its first runs do not tell how fast it is.
    pub learns: bool,
}

/// What one processor did in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share<F> {
    /// What it found.
    pub found: F,
    /// Tasks it visited, or pieces it worked on.
    pub visited: u64,
}

/// Why sharing out once failed.
#[derive(Debug, thiserror::Error)]
pub enum ShareError {
    /// The scheme cannot be set up so.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// The run failed.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// A shape of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A hierarchy to descend: [`tree`].
    Tree,
    /// Independent pieces: [`tiles`].
    Tiles,
}

impl Shape {
    /// The shapes there are.
    pub const ALL: [Self; 2] = [Self::Tree, Self::Tiles];

    /// The schemes that share out work of this shape.
    pub fn schemes(self) -> &'static [About] {
        match self {
            Self::Tree => tree::SCHEMES,
            Self::Tiles => tiles::SCHEMES,
        }
    }
}
