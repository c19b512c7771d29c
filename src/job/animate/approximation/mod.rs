//! Pictures that are not quite those of the scene, for less time: each with one knob, how far it goes (P3-A01..A04).
//!
//! Adding one is a file with a `const ABOUT`, and its line in the list.

mod exact;
mod fewer_lights;
mod lower_depth;
mod lower_resolution;
mod pixel_reuse;
mod reprojection;
mod turns;

use crate::job::trace::{Draft, Eye, Film, Image, Look};
use crate::machine::Machine;

/// All of them. The list is the table of contents.
pub const APPROXIMATIONS: &[About] = &[
    exact::ABOUT,
    pixel_reuse::ABOUT,
    reprojection::ABOUT,
    lower_depth::ABOUT,
    fewer_lights::ABOUT,
    lower_resolution::ABOUT,
];

/// An approximation in the list.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Its name: word of the command line, value in rows, legend.
    pub name: &'static str,
    /// What it does, in a line.
    pub summary: &'static str,
    /// What tells how far it goes.
    pub knob: Knob,
    make: fn(f64) -> Box<dyn Method>,
}

/// A number that tells how far an approximation goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knob {
    /// What it is, in a few words, with its unit.
    pub about: &'static str,
    /// What it is if nobody says.
    pub default: f64,
    /// The least it can be.
    pub least: f64,
    /// The most it can be.
    pub most: f64,
}

/// The frame before, as it was seen.
#[derive(Clone, Debug)]
pub struct Seen {
    /// From where.
    pub eye: Eye,
    /// Its colours and distances, row by row, as a [`Film`] holds them.
    pub pixels: Vec<[f32; 4]>,
}

impl Seen {
    /// A pixel.
    fn pixel(&self, x: u32, y: u32) -> [f32; 4] {
        self.pixels[y as usize * self.eye.size().0 as usize + x as usize]
    }
}

/// What an approximation changes of how a frame is made. It is told of this frame and the one before, of none that come.
trait Method {
    /// How surfaces are looked at.
    fn look(&self, look: Look) -> Look {
        look
    }

    /// How many pixels are traced, across and down, for a picture of so many.
    fn traced(&self, size: (u32, u32)) -> (u32, u32) {
        size
    }

    /// Whether it wants the frame before.
    fn looks_back(&self) -> bool {
        false
    }

    /// What is known of this frame, the `number`th, seen from `eye`, by the one before, which is of the same size.
    fn draft(&self, eye: &Eye, number: u32, before: &Seen) -> Option<Draft> {
        let _ = (eye, number, before);
        None
    }

    /// The picture that is shown, where it is not what was traced.
    fn shown(&self, traced: &mut dyn FnMut() -> Image, size: (u32, u32)) -> Option<Image> {
        let _ = (traced, size);
        None
    }
}

/// One of [`APPROXIMATIONS`], set up.
pub struct Approximation(Box<dyn Method>);

impl Approximation {
    /// Sets up the one called `name`; where no knob is told, at its default. None if there is none of that name, or the
    /// knob cannot be set so.
    pub fn new(name: &str, knob: Option<f64>) -> Option<Self> {
        let about = APPROXIMATIONS.iter().find(|about| about.name == name)?;
        let Knob { default, least, most, .. } = about.knob;
        let knob = knob.unwrap_or(default);
        (least..=most).contains(&knob).then(|| Self((about.make)(knob)))
    }

    /// How surfaces are looked at.
    pub(super) fn look(&self, look: Look) -> Look {
        self.0.look(look)
    }

    /// How many pixels are traced, across and down, for a picture of so many.
    pub(super) fn traced(&self, size: (u32, u32)) -> (u32, u32) {
        self.0.traced(size)
    }

    pub(super) fn looks_back(&self) -> bool {
        self.0.looks_back()
    }

    pub(super) fn draft(&self, eye: &Eye, number: u32, before: &Seen) -> Option<Draft> {
        (eye.size() == before.eye.size()).then(|| self.0.draft(eye, number, before))?
    }

    pub(super) fn shown<M: Machine>(&self, film: &mut Film<M>, size: (u32, u32)) -> Option<Image> {
        self.0.shown(&mut || film.image(), size)
    }
}
