//! Keeping a structure in step with what moves, frame by frame: made anew, or given new bounds, and when which.
//!
//! A scheme sees a structure through [`Kept`] alone: it can be rebuilt, refitted, and says what going through it is
//! expected to cost.
//!
//! ```
//! use apportion::scheme::frames::{Kept, Scheme, Upkeep};
//!
//! // What is asked of it costs twice as much with each refit, until it is rebuilt.
//! struct Doubling(f64);
//! impl Kept for Doubling {
//!     type Error = std::convert::Infallible;
//!     fn rebuild(&mut self) -> Result<(), Self::Error> {
//!         self.0 = 1.0;
//!         Ok(())
//!     }
//!     fn refit(&mut self) -> Result<(), Self::Error> {
//!         self.0 *= 2.0;
//!         Ok(())
//!     }
//!     fn cost(&self) -> f64 {
//!         self.0
//!     }
//! }
//! let mut scheme = Scheme::new("rebuild_on_threshold", [("percent".to_owned(), "300".to_owned())].into())?;
//! let mut structure = Doubling(0.0);
//! let upkeep: Vec<Upkeep> = (0..6).map(|_| scheme.next(&mut structure).unwrap()).collect();
//! // The third frame would have cost 4 times as much as the first.
//! use Upkeep::{Rebuilt, Refitted};
//! assert_eq!(upkeep, [Rebuilt, Refitted, Rebuilt, Refitted, Rebuilt, Refitted]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod rebuild_each_frame;
mod rebuild_on_threshold;
mod refit_only;

pub use super::About;
use super::{SettingError, Settings};
use std::collections::BTreeMap;

/// A structure over things that move. Between two frames they do; then a scheme has it rebuilt or refitted, and from then on it
/// answers for them as they are.
pub trait Kept {
    /// Why it cannot be.
    type Error;

    /// Makes it anew.
    ///
    /// # Errors
    /// It cannot be made; the structure is then of no use.
    fn rebuild(&mut self) -> Result<(), Self::Error>;

    /// Keeps how things are grouped, and takes in where they are.
    ///
    /// # Errors
    /// As [`Kept::rebuild`].
    fn refit(&mut self) -> Result<(), Self::Error>;

    /// What a question asked of it is expected to cost as it is now, in any unit.
    fn cost(&self) -> f64;
}

/// What was done to a structure for a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Upkeep {
    /// It was made anew, whether or not it was refitted first.
    Rebuilt,
    /// It was refitted.
    Refitted,
}

/// Declares the schemes: the list is the table of contents. Each file holds a type of one name, with `SUMMARY`, `new`
/// and `next`; the file's name is the scheme's word everywhere.
macro_rules! frame_schemes {
    ($($file:ident => $Scheme:ident),* $(,)?) => {
        enum AnyScheme { $($Scheme($file::$Scheme)),* }

        /// The schemes, by name.
        pub const SCHEMES: &[About] = &[$(About {
            name: stringify!($file),
            summary: $file::SUMMARY,
            native_only: false,
            learns: false,
        }),*];

        impl AnyScheme {
            fn new(name: &str, settings: &Settings) -> Result<Self, SettingError> {
                match name {
                    $(stringify!($file) => Ok(AnyScheme::$Scheme($file::$Scheme::new(settings)?)),)*
                    _ => {
                        let known = SCHEMES.iter().map(|scheme| scheme.name).collect::<Vec<_>>().join(", ");
                        Err(SettingError::NoScheme { shape: "frames", name: name.to_owned(), known })
                    }
                }
            }

            fn next<K: Kept>(&mut self, kept: &mut K, first: bool) -> Result<Upkeep, K::Error> {
                match self { $(AnyScheme::$Scheme(scheme) => scheme.next(kept, first)),* }
            }
        }
    };
}

frame_schemes! {
    rebuild_each_frame => RebuildEachFrame,
    refit_only => RefitOnly,
    rebuild_on_threshold => RebuildOnThreshold,
}

/// A scheme set up for one structure.
pub struct Scheme {
    scheme: AnyScheme,
    /// Whether the structure has not been made yet, or of no use since a failure.
    unmade: bool,
}

impl Scheme {
    /// Sets up the scheme called `name`.
    ///
    /// # Errors
    /// [`SettingError`]: an unknown scheme or setting, a senseless value.
    pub fn new(name: &str, settings: BTreeMap<String, String>) -> Result<Self, SettingError> {
        let settings = Settings::new(name, settings);
        let scheme = AnyScheme::new(name, &settings)?;
        settings.finish()?;
        Ok(Self { scheme, unmade: true })
    }

    /// Brings a structure up to date with the next frame. The first time, and after a failure, it is made anew,
    /// whatever the scheme.
    ///
    /// # Errors
    /// What the structure says.
    pub fn next<K: Kept>(&mut self, kept: &mut K) -> Result<Upkeep, K::Error> {
        let first = std::mem::replace(&mut self.unmade, true);
        let upkeep = self.scheme.next(kept, first)?;
        self.unmade = false;
        Ok(upkeep)
    }
}

#[cfg(test)]
mod tests;
