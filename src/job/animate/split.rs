//! What the time of a frame goes into: rebuild, visibility and shading, of which it is the sum (Lext, Assarsson and
//! Möller 2000, Measurement report proposal; P3-11).
//!
//! An intersector around the real one reads the clock before each question about rays and after it, so that this is a
//! pass of its own: it is slower than a frame that nobody times. How often the clock was read is told, and nothing is
//! subtracted: rays are asked about by up to 512 at once, so that is not often.

use std::sync::atomic::Ordering;

use super::{AnimateError, Animator};
use crate::geometry::{Hit, Ray};
use crate::job::trace::{Counts, Film, Image};
use crate::machine::threads::NativeWord;
use crate::machine::{Machine, Word};
use crate::scheme::tiles::TileWork;
use crate::structure::bvh::Intersector;

/// What a frame's time went into, in the machine's ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Split {
    /// Taking the pose and bringing the structure up to date.
    pub rebuild_ticks: u64,
    /// Finding what rays meet.
    pub visibility_ticks: u64,
    /// All else that tracing takes: making rays, shading, pixels that are not traced.
    pub shading_ticks: u64,
    /// How often the clock was read while tracing.
    pub readings: u64,
}

/// Answers as another does, and takes the time.
struct Timed<'a, M: Machine> {
    inner: &'a dyn Intersector,
    machine: &'a M,
    /// Ticks, and questions. Words, for an intersector is asked by any number of processors; here by one.
    ticks: NativeWord,
    questions: NativeWord,
}

impl<'a, M: Machine> Timed<'a, M> {
    fn new(inner: &'a dyn Intersector, machine: &'a M) -> Self {
        Self { inner, machine, ticks: NativeWord::new(0), questions: NativeWord::new(0) }
    }

    fn timed<A>(&self, ask: impl FnOnce() -> A) -> A {
        let before = self.machine.now();
        let answer = ask();
        let ticks = self.machine.now() - before;
        // ORDERING: Relaxed, both: they carry nothing else, and are read when the run has ended.
        self.ticks.fetch_add(ticks, Ordering::Relaxed);
        self.questions.fetch_add(1, Ordering::Relaxed);
        answer
    }
}

impl<M: Machine> Intersector for Timed<'_, M> {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.timed(|| self.inner.closest(ray))
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.timed(|| self.inner.occluded(ray))
    }

    fn closest_coherent(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        self.timed(|| self.inner.closest_coherent(rays, hits));
    }

    fn occluded_coherent(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.timed(|| self.inner.occluded_coherent(rays, occluded));
    }
}

impl Animator {
    /// Makes the picture of a time, in seconds, as [`Animator::next`] does, on one processor of a machine whose clock is
    /// real, and tells what its time went into.
    ///
    /// # Errors
    /// As [`Animator::next`].
    ///
    /// # Panics
    /// As [`Animator::next`].
    pub fn split<M: Machine>(
        &mut self,
        time: f64,
        machine: &M,
        film: &mut Film<M>,
    ) -> Result<(Image, Split), AnimateError> {
        let start = machine.now();
        self.update(time)?;
        let rebuild_ticks = machine.now() - start;
        let looking = machine.now();
        let (eye, draft) = self.look_about(time)?;
        let timed = Timed::new(self.moving.hierarchy(), machine);
        {
            let frame = self.frame_by(&timed, eye, draft.as_ref(), film);
            machine.alone(|cpu| frame.work_on(0..frame.pieces(), &mut Counts::default(), cpu))?;
        }
        // ORDERING: Relaxed: the run has ended, and whoever added to them with it.
        let visibility_ticks = timed.ticks.load(Ordering::Relaxed);
        let readings = 2 * timed.questions.load(Ordering::Relaxed);
        self.remember(eye, film);
        let shown = self.method.shown(film, self.size);
        let shading_ticks = (machine.now() - looking).saturating_sub(visibility_ticks);
        let image = shown.unwrap_or_else(|| film.image());
        Ok((image, Split { rebuild_ticks, visibility_ticks, shading_ticks, readings }))
    }
}
