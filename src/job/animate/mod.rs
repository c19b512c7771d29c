//! Pictures of a scene that moves, frame by frame (Lext, Assarsson and Möller 2000).
//!
//! For each frame: 1. the scene takes the pose of its time; 2. the hierarchy over it is brought up to date, as one of
//! [`frames::SCHEMES`](crate::scheme::frames) sees fit; 3. the picture is traced by a tile scheme, exactly or by an
//! [`Approximation`]. A frame's time takes in all of it (P3-Q02).
//!
//! In *interactive* mode nothing of later frames may be used (P3-07). That is so by what each part is told: a frame
//! scheme sees a structure over things as they are ([`Kept`](crate::scheme::frames::Kept)), an approximation this
//! frame's eye and the frame before ([`Seen`]); only [`Moving`] knows the scene, and it is told one time after the other.
//! In *predetermined* mode, a frame scheme that looks ahead is told of all frames before the first ([`Animator::prepare`]).
//!
//! The picture of an exact frame is that of the scene standing still as it is then, whatever the frame scheme, tile
//! scheme, machine and processor count.

mod approximation;
mod moving;
mod split;

pub use approximation::{APPROXIMATIONS, About, Approximation, Knob, Seen};
use moving::Ahead;
pub use moving::Moving;
pub use split::Split;

use crate::job::trace::{Counts, Draft, Eye, Film, Frame, Image, Look, TileCosts, Tracer};
use crate::machine::{Machine, RunError};
use crate::scheme::frames::{self, Upkeep};
use crate::scheme::tiles;
use crate::structure::bvh::Intersector;
use crate::structure::bvh::build::BuildError;

/// Why a frame cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum AnimateError {
    /// The hierarchy cannot be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The machine failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// There is no way to look at it.
    #[error("at {time} s the camera looks nowhere")]
    NoView {
        /// The frame's time, in seconds.
        time: f64,
    },
}

/// What a frame came to. Times are in the machine's ticks.
#[derive(Clone, Debug)]
pub struct Made {
    /// What was done to the hierarchy.
    pub upkeep: Upkeep,
    /// Taking the pose and bringing the hierarchy up to date.
    pub update_ticks: u64,
    /// All of it; where tiles were measured, all but those.
    pub ticks: u64,
    /// The rays it took.
    pub rays: Counts,
    /// Tiles by processor.
    pub tiles: Vec<u64>,
    /// The picture, where it is another than the film's.
    shown: Option<Image>,
}

impl Made {
    /// The picture that is shown, the film being the one it was made on.
    pub fn image<M: Machine>(&self, film: &mut Film<M>) -> Image {
        self.shown.clone().unwrap_or_else(|| film.image())
    }
}

/// Goes through a scene's frames.
pub struct Animator {
    /// What moves.
    pub moving: Moving,
    upkeep: frames::Scheme,
    method: Approximation,
    look: Look,
    /// Pixels across and down of the picture, and of a tile.
    size: (u32, u32),
    tile: (u32, u32),
    /// The frame before, if the method wants it.
    before: Option<Seen>,
    number: u32,
}

impl Animator {
    /// To go through `moving` from its first frame on.
    pub fn new(
        moving: Moving,
        upkeep: frames::Scheme,
        method: Approximation,
        look: Look,
        size: (u32, u32),
        tile: (u32, u32),
    ) -> Self {
        Self { moving, upkeep, look: method.look(look), method, size, tile, before: None, number: 0 }
    }

    /// How large a film it takes, in pixels across and down.
    pub fn traced(&self) -> (u32, u32) {
        self.method.traced(self.size)
    }

    /// Gets ready for the frames of those times, in seconds, before the first of them: makes plans, where the frame scheme
    /// looks ahead, and the hierarchy as it is in the first.
    ///
    /// # Errors
    /// [`AnimateError::Build`].
    pub fn prepare(&mut self, times: &[f64]) -> Result<(), AnimateError> {
        if self.upkeep.looks_ahead() {
            self.upkeep.plan(&mut Ahead { moving: &mut self.moving, times })?;
        }
        if let Some(first) = times.first() {
            self.moving.advance(*first);
            self.upkeep.prepare(&mut self.moving)?;
        }
        Ok(())
    }

    /// Makes the picture of a time, in seconds.
    ///
    /// # Errors
    /// [`AnimateError`]; the next frame may be made all the same.
    ///
    /// # Panics
    /// If the film is not of the size of [`Animator::traced`].
    pub fn next<M: Machine>(
        &mut self,
        time: f64,
        machine: &M,
        scheme: &mut tiles::Scheme<M>,
        film: &mut Film<M>,
    ) -> Result<Made, AnimateError> {
        let start = machine.now();
        let upkeep = self.update(time)?;
        let updated = machine.now();
        let (eye, draft) = self.look_about(time)?;
        let shares = scheme.run(machine, &self.frame(eye, draft.as_ref(), film))?;
        let mut rays = Counts::default();
        shares.iter().for_each(|share| rays += share.found);
        self.remember(eye, film);
        let shown = self.method.shown(film, self.size);
        let end = machine.now();
        let tiles = shares.iter().map(|share| share.visited).collect();
        Ok(Made { upkeep, update_ticks: updated - start, ticks: end - start, rays, tiles, shown })
    }

    /// Makes the picture of a time as [`Animator::next`], on one processor of a machine whose clock is real, and tells
    /// what each of its tiles costs ([`TileCosts::measure`]).
    ///
    /// # Errors
    /// As [`Animator::next`].
    ///
    /// # Panics
    /// As [`Animator::next`].
    pub fn measure<M: Machine>(
        &mut self,
        time: f64,
        machine: &M,
        film: &mut Film<M>,
        rounds: u32,
    ) -> Result<(Made, TileCosts), AnimateError> {
        let start = machine.now();
        let upkeep = self.update(time)?;
        let update_ticks = machine.now() - start;
        let (eye, draft) = self.look_about(time)?;
        let looked = machine.now();
        let (costs, rays) = TileCosts::measure(machine, &self.frame(eye, draft.as_ref(), film), rounds)?;
        let traced = machine.now();
        self.remember(eye, film);
        let shown = self.method.shown(film, self.size);
        let ticks = looked - start + (machine.now() - traced);
        Ok((Made { upkeep, update_ticks, ticks, rays, tiles: vec![costs.len() as u64], shown }, costs))
    }

    fn update(&mut self, time: f64) -> Result<Upkeep, AnimateError> {
        self.moving.advance(time);
        Ok(self.upkeep.next(&mut self.moving)?)
    }

    /// From where the frame is seen, and what is known of it.
    fn look_about(&mut self, time: f64) -> Result<(Eye, Option<Draft>), AnimateError> {
        let aspect = self.size.0 as f32 / self.size.1 as f32;
        let view = self.moving.view(aspect);
        let eye = view.and_then(|view| Eye::of_view(&view, aspect, self.traced()));
        let eye = eye.ok_or(AnimateError::NoView { time })?;
        let draft = self.before.as_ref().and_then(|before| self.method.draft(&eye, self.number, before));
        self.number += 1;
        Ok((eye, draft))
    }

    fn frame<'a, M: Machine>(
        &'a self,
        eye: Eye,
        draft: Option<&'a Draft>,
        film: &'a mut Film<M>,
    ) -> Frame<'a, M> {
        self.frame_by(self.moving.hierarchy(), eye, draft, film)
    }

    /// The same, `intersector` answering for the rays.
    fn frame_by<'a, M: Machine>(
        &'a self,
        intersector: &'a dyn Intersector,
        eye: Eye,
        draft: Option<&'a Draft>,
        film: &'a mut Film<M>,
    ) -> Frame<'a, M> {
        let tracer = Tracer::new(self.moving.world(), intersector, self.look);
        let frame = Frame::new(tracer, eye, self.tile, film);
        match draft {
            Some(draft) => frame.drafted(draft),
            None => frame,
        }
    }

    fn remember<M: Machine>(&mut self, eye: Eye, film: &mut Film<M>) {
        if self.method.looks_back() {
            self.before = Some(Seen { eye, pixels: film.pixels().collect() });
        }
    }
}

#[cfg(test)]
mod tests;
