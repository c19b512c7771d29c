//! What a cell of the job `animate` asks for.

use crate::job::animate::{APPROXIMATIONS, Animator, Approximation, Knob, Moving};
use crate::job::trace::{Levels, Look};
use crate::measure::subject::settings::JobSettings;
use crate::measure::subject::trace::Pictured;
use crate::measure::subject::{Cell, MeasureError, failed};
use crate::scene::Scene;
use crate::scheme::frames::{self, Mode};
use crate::structure::bvh::build::{Builder, Settings};
use std::collections::BTreeMap;

pub(super) struct Asked {
    pub(super) picture: Pictured,
    pub(super) levels: Levels,
    upkeep: String,
    mode: Mode,
    percent: Option<u32>,
    /// Its name and its knob.
    pub(super) approximation: (String, Option<f64>),
    pub(super) lights: Option<u32>,
    pub(super) frames: Option<u32>,
    /// Whether to tell what the time goes into.
    pub(super) split: bool,
}

impl Asked {
    pub(super) fn of(cell: &Cell) -> Result<Self, MeasureError> {
        let settings = JobSettings::of(cell);
        let upkeep: Vec<_> = frames::SCHEMES.iter().map(|scheme| (scheme.name, scheme.name)).collect();
        let asked = Asked {
            picture: Pictured::of(&settings)?,
            levels: settings.choice("levels", &[("two", Levels::Two), ("one", Levels::One)])?,
            upkeep: settings.choice("upkeep", &upkeep)?.to_owned(),
            mode: settings.choice("mode", Mode::ALL)?,
            percent: settings.parsed("percent")?,
            approximation: settings.read(
                "approximation",
                ("exact".to_owned(), None),
                &approximations(),
                approximation,
            )?,
            lights: settings.parsed("lights")?,
            frames: settings.parsed("frames")?,
            split: settings.choice("split", &[("no", false), ("yes", true)])?,
        };
        settings.finish(cell)?;
        asked.upkeep()?;
        Ok(asked)
    }

    /// The frame scheme.
    fn upkeep(&self) -> Result<frames::Scheme, MeasureError> {
        let percent = self.percent.map(|percent| ("percent".to_owned(), percent.to_string()));
        frames::Scheme::new(&self.upkeep, percent.into_iter().collect(), self.mode)
            .map_err(|error| MeasureError::Setting(error.to_string()))
    }

    /// Whether every picture must be that of the scene standing still.
    pub(super) fn is_exact(&self) -> bool {
        self.approximation.0 == "exact"
    }

    /// To go through the scene as the cell says, or, exactly, as whatever it says is held against.
    pub(super) fn animator(&self, scene: &Scene, exactly: bool) -> Result<Animator, MeasureError> {
        let builder = Builder::new(self.picture.builder, &Settings::default()).map_err(failed)?;
        let moving = Moving::new(scene.clone(), builder, self.levels, self.picture.triangle);
        let upkeep = match exactly {
            true => frames::Scheme::new("rebuild_each_frame", BTreeMap::new(), Mode::Interactive)
                .map_err(failed)?,
            false => self.upkeep()?,
        };
        let (name, knob) =
            if exactly { ("exact", None) } else { (&*self.approximation.0, self.approximation.1) };
        let method = Approximation::new(name, knob).expect("it was read");
        let look = Look { depth: self.picture.depth, ..Look::of(scene) };
        Ok(Animator::new(moving, upkeep, method, look, self.picture.size, self.picture.tile))
    }
}

/// An approximation and its knob, such as `pixel_reuse:4`.
fn approximation(text: &str) -> Option<(String, Option<f64>)> {
    let (name, knob) = match text.split_once(':') {
        Some((name, knob)) => (name, Some(knob.parse().ok()?)),
        None => (text, None),
    };
    Approximation::new(name, knob).map(|_| (name.to_owned(), knob))
}

/// What there is to choose from, for a message.
fn approximations() -> String {
    let all = APPROXIMATIONS.iter().map(|about| {
        let Knob { about: what, least, most, .. } = about.knob;
        if least == most { about.name.to_owned() } else { format!("{}:{least}-{most} ({what})", about.name) }
    });
    format!("one of: {}", all.collect::<Vec<_>>().join(", "))
}
