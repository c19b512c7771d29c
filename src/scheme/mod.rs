//! How work is shared out, by the shape of the work. A scheme knows nothing of boxes or rays.

mod settings;
pub mod tree;

pub use settings::{SettingError, Settings};
