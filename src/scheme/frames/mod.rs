//! Keeping a structure in step with what moves, frame by frame: made anew, or given new bounds, and when which.
//!
//! A scheme sees a structure through [`Kept`] alone: it can be rebuilt, refitted, and says what going through it is
//! expected to cost. In *interactive* mode (Lext, Assarsson and Möller 2000; P3-07) that is all there is to know; a scheme
//! that looks ahead is set up in *predetermined* mode only, where it is told of all frames beforehand ([`Foretold`]).
//!
//! ```
//! use apportion::scheme::frames::{Kept, Mode, Scheme, Upkeep};
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
//! let settings = [("percent".to_owned(), "300".to_owned())].into();
//! let mut scheme = Scheme::new("rebuild_on_threshold", settings, Mode::Interactive)?;
//! let mut structure = Doubling(0.0);
//! let upkeep: Vec<Upkeep> = (0..6).map(|_| scheme.next(&mut structure).unwrap()).collect();
//! // The third frame would have cost 4 times as much as the first.
//! use Upkeep::{Rebuilt, Refitted};
//! assert_eq!(upkeep, [Rebuilt, Refitted, Rebuilt, Refitted, Rebuilt, Refitted]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod rebuild_each_frame;
mod rebuild_on_threshold;
mod rebuild_when_best;
mod refit_only;

use super::{SettingError, Settings};
use std::collections::BTreeMap;

/// A structure over things that move. Between two frames they do; then a scheme has it rebuilt or refitted, and from then
/// on it answers for them as they are.
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

/// All frames of a sequence, for who may look ahead.
pub trait Foretold {
    /// Why it cannot be told.
    type Error;

    /// How many there are.
    fn count(&self) -> usize;

    /// What a question is expected to cost in each of the frames from `made` to before `end`, by a structure made anew
    /// for the first of them and refitted for every other; in the unit of [`Kept::cost`].
    ///
    /// # Errors
    /// The structure cannot be made.
    ///
    /// # Panics
    /// If there are no such frames.
    fn costs(&mut self, made: usize, end: usize) -> Result<Vec<f64>, Self::Error>;
}

/// What may be known of frames to come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Nothing.
    #[default]
    Interactive,
    /// All of it.
    Predetermined,
}

impl Mode {
    /// Every mode with its name in settings.
    pub const ALL: &[(&str, Self)] =
        &[("interactive", Self::Interactive), ("predetermined", Self::Predetermined)];
}

/// A scheme in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct About {
    /// Its name: value of settings and in rows, legend.
    pub name: &'static str,
    /// What it is, in a line.
    pub summary: &'static str,
    /// Whether it wants to know of frames to come.
    pub looks_ahead: bool,
}

/// What a scheme's file holds.
trait FrameScheme: Sized {
    /// What it is, in a line.
    const SUMMARY: &'static str;
    /// Whether it makes plans.
    const LOOKS_AHEAD: bool = false;

    fn new(settings: &Settings) -> Result<Self, SettingError>;

    /// Is told of all frames, in predetermined mode.
    fn plan<F: Foretold>(&mut self, frames: &mut F) -> Result<(), F::Error> {
        let _ = frames;
        Ok(())
    }

    /// Brings a structure up to date with a frame, by number; it has to be made anew if it is `unmade`.
    fn next<K: Kept>(&mut self, kept: &mut K, frame: usize, unmade: bool) -> Result<Upkeep, K::Error>;
}

/// What was done to a structure for a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Upkeep {
    /// It was made anew, whether or not it was refitted first.
    Rebuilt,
    /// It was refitted.
    Refitted,
}

/// Declares the schemes: the list is the table of contents. Each file holds a type of one name, a [`FrameScheme`]; the
/// file's name is the scheme's word everywhere.
macro_rules! frame_schemes {
    ($($file:ident => $Scheme:ident),* $(,)?) => {
        enum AnyScheme { $($Scheme($file::$Scheme)),* }

        /// The schemes, by name.
        pub const SCHEMES: &[About] = &[$(About {
            name: stringify!($file),
            summary: $file::$Scheme::SUMMARY,
            looks_ahead: $file::$Scheme::LOOKS_AHEAD,
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

            fn plan<F: Foretold>(&mut self, frames: &mut F) -> Result<(), F::Error> {
                match self { $(AnyScheme::$Scheme(scheme) => scheme.plan(frames)),* }
            }

            fn next<K: Kept>(&mut self, kept: &mut K, frame: usize, unmade: bool) -> Result<Upkeep, K::Error> {
                match self { $(AnyScheme::$Scheme(scheme) => scheme.next(kept, frame, unmade)),* }
            }
        }
    };
}

frame_schemes! {
    rebuild_each_frame => RebuildEachFrame,
    refit_only => RefitOnly,
    rebuild_on_threshold => RebuildOnThreshold,
    rebuild_when_best => RebuildWhenBest,
}

/// A scheme set up for one structure.
pub struct Scheme {
    scheme: AnyScheme,
    looks_ahead: bool,
    /// The number of the frame that comes next.
    frame: usize,
    /// Whether the structure has not been made yet, or of no use since a failure.
    unmade: bool,
}

impl Scheme {
    /// Sets up the scheme called `name`.
    ///
    /// # Errors
    /// [`SettingError`]: an unknown scheme or setting, a senseless value, one that looks ahead in interactive mode.
    pub fn new(name: &str, settings: BTreeMap<String, String>, mode: Mode) -> Result<Self, SettingError> {
        let settings = Settings::new(name, settings);
        let scheme = AnyScheme::new(name, &settings)?;
        settings.finish()?;
        let looks_ahead = SCHEMES.iter().any(|about| about.name == name && about.looks_ahead);
        if looks_ahead && mode == Mode::Interactive {
            return Err(SettingError::LooksAhead { scheme: name.to_owned() });
        }
        Ok(Self { scheme, looks_ahead, frame: 0, unmade: true })
    }

    /// Whether it wants to know of frames to come.
    pub fn looks_ahead(&self) -> bool {
        self.looks_ahead
    }

    /// Tells a scheme that looks ahead of all frames, the next one being the first of them; no other is told.
    ///
    /// # Errors
    /// What the frames say. They are not foretold then.
    pub fn plan<F: Foretold>(&mut self, frames: &mut F) -> Result<(), F::Error> {
        // Whatever the structure comes to meanwhile.
        (self.frame, self.unmade) = (0, true);
        if self.looks_ahead { self.scheme.plan(frames) } else { Ok(()) }
    }

    /// Makes a structure before the first frame comes.
    ///
    /// # Errors
    /// What the structure says.
    pub fn prepare<K: Kept>(&mut self, kept: &mut K) -> Result<(), K::Error> {
        self.unmade = true;
        self.scheme.next(kept, self.frame, true)?;
        self.unmade = false;
        Ok(())
    }

    /// Brings a structure up to date with the next frame. The first time, and after a failure, it is made anew,
    /// whatever the scheme.
    ///
    /// # Errors
    /// What the structure says.
    pub fn next<K: Kept>(&mut self, kept: &mut K) -> Result<Upkeep, K::Error> {
        let unmade = std::mem::replace(&mut self.unmade, true);
        let frame = self.frame;
        self.frame += 1;
        let upkeep = self.scheme.next(kept, frame, unmade)?;
        self.unmade = false;
        Ok(upkeep)
    }
}

#[cfg(test)]
mod tests;
