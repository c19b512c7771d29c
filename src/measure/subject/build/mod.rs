//! The job `build`: a hierarchy for rays is built, or given new boxes, frame after frame (Ize Table 7.2, ch. 7.6.1).
//!
//! Settings: `job.what` (`build`, `refit`); `job.how`, one of [`Way::ALL`] or, under `serial` on threads, one of
//! [`BUILDERS`]; `job.bins`; `job.bend`, how often the scene, as one body, is rolled up in the last frame (not at all in the
//! first); `job.subtrees`, for each processor that refits; `job.rays`, one of [`KINDS`], and `job.count`, how many of them
//! (0) go through each frame's hierarchy, untimed, to tell what it is worth.
//!
//! Under `serial` a way is built in one piece by its rule for what is below the top, as Ize has it: other ways may
//! then be faster than their processors are many. What is refitted is shared out as I7-03 has it, subtree by subtree
//! and then piece by piece of the triangles' corners, which is what `fixed_tiles` is; other schemes do not refit.
//!
//! Every hierarchy is held, bit for bit, against the serial one, and that against its boxes ([`Answers`]).

mod answers;

use super::rolled::{Surface, rolled, turns};
use super::settings::{JobSettings, of_scheme};
use super::{Cell, MeasureError, Options, Sample, Subject, SubjectCache, failed, simulated, staging};
use crate::geometry::Aabb;
use crate::job::build::{Costs, Crew, Refit, SUBTREES};
use crate::job::rays::KINDS;
use crate::machine::{Machine, Processor, Simulated, Threads};
use crate::record::THREADS;
use crate::scheme::tiles::Scheme;
use crate::structure::bvh::BinaryBvh;
use crate::structure::bvh::build::phased::{Phased, Way};
use crate::structure::bvh::build::{BUILDERS, Builder, Input, MOST_BINS, Settings};
use crate::structure::volume_tree::in_world;
use answers::{Answers, Looked};
use glam::Vec3;
use std::borrow::Borrow;
use std::sync::{Mutex, PoisonError};

/// Triangles whose corners are renewed in one piece.
const PIECE: usize = 2048;

/// How a hierarchy is built.
#[derive(Clone, Copy, Debug, PartialEq)]
enum How {
    Phases(Way),
    Alone(&'static str),
}

struct Asked {
    refits: bool,
    how: How,
    settings: Settings,
    bend: f64,
    subtrees: usize,
    looked: Looked,
}

impl Asked {
    fn of(cell: &Cell, options: &Options) -> Result<Self, MeasureError> {
        let settings = JobSettings::of(cell);
        let ways = Way::ALL.into_iter().map(|(name, way)| (name, How::Phases(way)));
        let hows: Vec<_> =
            ways.chain(BUILDERS.iter().map(|about| (about.name, How::Alone(about.name)))).collect();
        let kinds: Vec<_> = KINDS.iter().map(|kind| (kind.name, kind.kind)).collect();
        let default = Settings::default();
        let asked = Asked {
            refits: settings.choice("what", &[("build", false), ("refit", true)])?,
            how: settings.choice("how", &hows)?,
            settings: Settings {
                bins: settings.number("bins", default.bins as f64, 2.0..=MOST_BINS as f64)? as usize,
                ..default
            },
            bend: settings.number("bend", 0.0, 0.0..=100.0)?,
            subtrees: settings.number("subtrees", SUBTREES as f64, 1.0..=1e6)? as usize,
            looked: Looked {
                kind: settings.choice("rays", &kinds)?,
                count: settings.number("count", 0.0, 0.0..=1e8)? as usize,
                seed: options.seed,
            },
        };
        settings.finish(cell)?;
        asked.check(cell)?;
        Ok(asked)
    }

    fn check(&self, cell: &Cell) -> Result<(), MeasureError> {
        let (scheme, machine) = (&cell.scheme, &cell.machine);
        if self.refits && !["serial", "fixed_tiles"].contains(&&**scheme) {
            let message = format!("expected `serial` or `fixed_tiles`, which refit, not `{scheme}`");
            return Err(MeasureError::Setting(format!("setting `job.what` is `refit`: {message}")));
        }
        match self.how {
            How::Alone(name) if !self.refits && (scheme != "serial" || machine != THREADS) => {
                let message = format!("expected `serial` on `{THREADS}`, found `{scheme}` on `{machine}`");
                Err(MeasureError::Setting(format!("setting `job.how` is `{name}`: {message}")))
            }
            _ => Ok(()),
        }
    }
}

pub(super) fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    let asked = Asked::of(cell, options)?;
    if options.path.is_some() {
        let message = "the job `build` looks at nothing: it takes no --path".to_owned();
        return Err(MeasureError::Words(message));
    }
    let one = cache.team(1)?;
    if cell.machine == THREADS {
        let team = cache.team(cell.processors)?;
        let answers = Answers::new(&asked, cell, Some(one))?;
        Ok(Box::new(BuildSubject::<_, Threads>::new(cell, team, Costs::default(), asked, answers, options)?))
    } else {
        let machine = simulated(cell, cache)?;
        let costs = Costs::measured_on(machine.model());
        let answers = Answers::new(&asked, cell, None)?;
        Ok(Box::new(BuildSubject::<_, Simulated>::new(cell, machine, costs, asked, answers, options)?))
    }
}

/// What builds.
enum Maker {
    Phases(Phased),
    Alone(Builder),
}

struct BuildSubject<H, M: Machine> {
    machine: H,
    scheme: Scheme<M>,
    processors: usize,
    serial: bool,
    costs: Costs,
    asked: Asked,
    flat: Surface,
    /// By frame.
    turns: Vec<f64>,
    maker: Maker,
    /// Built over the body as it lies flat, where that is refitted.
    refit: Option<(BinaryBvh, Refit<M>)>,
    bvh: BinaryBvh,
    /// The triangles' corners, renewed where the hierarchy is refitted.
    corners: Vec<[Vec3; 3]>,
    answers: Answers,
}

impl<H: Borrow<M>, M: Machine> BuildSubject<H, M> {
    fn new(
        cell: &Cell,
        machine: H,
        costs: Costs,
        asked: Asked,
        mut answers: Answers,
        options: &Options,
    ) -> Result<Self, MeasureError> {
        let on = machine.borrow();
        let processors = cell.processors as usize;
        let scheme = Scheme::new(&cell.scheme, on, processors, of_scheme(cell))
            .map_err(|error| MeasureError::Setting(error.to_string()))?;
        let flat = in_world(&staging::scene(cell)?).map_err(failed)?;
        if flat.1.is_empty() {
            return Err(MeasureError::Failed(format!("scene `{}` has no triangles", cell.scene)));
        }
        let serial = cell.scheme == "serial";
        let maker = match asked.how {
            How::Phases(way) => Maker::Phases(Phased::new(way, &asked.settings).map_err(failed)?),
            How::Alone(name) => Maker::Alone(Builder::new(name, &asked.settings).map_err(failed)?),
        };
        let refit = match asked.refits {
            true => {
                let bvh = answers.built(&boxes_of(&flat.0, &flat.1), &corners_of(&flat.0, &flat.1))?;
                let (processors, subtrees) = if serial { (1, 1) } else { (processors, asked.subtrees) };
                let refit = Refit::new(on, processors, subtrees, &bvh).charging(costs);
                Some((bvh, refit))
            }
            false => None,
        };
        let turns = turns(asked.bend, options.frames);
        let (bvh, corners) = (BinaryBvh::default(), corners_of(&flat.0, &flat.1));
        Ok(Self {
            machine,
            scheme,
            processors,
            serial,
            costs,
            asked,
            flat,
            turns,
            maker,
            refit,
            bvh,
            corners,
            answers,
        })
    }

    /// Builds over the corners as they are now.
    fn build(&mut self, boxes: &[Aabb]) -> Result<(), MeasureError> {
        let machine = self.machine.borrow();
        let input = Input { boxes, triangles: Some(&self.corners) };
        match &mut self.maker {
            Maker::Phases(phased) if self.serial => {
                let effort = phased.build_alone(&input, &mut self.bvh).map_err(failed)?;
                let cycles = self.costs.of_building(&effort);
                machine.alone(|cpu| cpu.charge(cycles)).map_err(failed)
            }
            Maker::Phases(phased) => {
                let mut crew = Crew::new(machine, &mut self.scheme, self.processors).charging(self.costs);
                phased.build(&input, &mut self.bvh, &mut crew).map_err(failed)
            }
            Maker::Alone(builder) => builder.build(&input, &mut self.bvh).map_err(failed),
        }
    }

    /// Refits to corners that are at these places now.
    fn refit(&mut self, places: &[Vec3]) -> Result<(), MeasureError> {
        let Some((_, refit)) = &self.refit else { return Ok(()) };
        let triangles = &self.flat.1;
        let corners: Vec<_> = self.corners.chunks_mut(PIECE).map(Mutex::new).collect();
        let bounds = |item: u32| Aabb::of_points(triangles[item as usize].map(|at| places[at as usize]));
        let renew = |piece: usize| {
            let mut corners = corners[piece].lock().unwrap_or_else(PoisonError::into_inner);
            let triangles = &triangles[piece * PIECE..][..corners.len()];
            for (corners, triangle) in corners.iter_mut().zip(triangles) {
                *corners = triangle.map(|at| places[at as usize]);
            }
            corners.len()
        };
        refit.run(self.machine.borrow(), &mut self.bvh, bounds, corners.len(), renew).map_err(failed)
    }
}

/// The corners of each triangle.
fn corners_of(places: &[Vec3], triangles: &[[u32; 3]]) -> Vec<[Vec3; 3]> {
    triangles.iter().map(|triangle| triangle.map(|at| places[at as usize])).collect()
}

/// The box around each triangle.
fn boxes_of(places: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Aabb> {
    triangles.iter().map(|triangle| Aabb::of_points(triangle.map(|at| places[at as usize]))).collect()
}

impl<H: Borrow<M>, M: Machine> Subject for BuildSubject<H, M> {
    fn sample(&mut self, _repeat: u32) -> Result<Vec<Sample>, MeasureError> {
        let (mut samples, mut all) = (Vec::new(), 0.0);
        let mut sums: Vec<(&'static str, f64)> = Vec::new();
        if let Some((flat, _)) = &self.refit {
            self.bvh.clone_from(flat);
        }
        for frame in 0..self.turns.len() {
            let places = rolled(&self.flat.0, self.turns[frame]);
            let (corners, boxes) = (corners_of(&places, &self.flat.1), boxes_of(&places, &self.flat.1));
            if !self.asked.refits {
                self.corners.clone_from(&corners);
            }
            let before = self.machine.borrow().now();
            if self.asked.refits {
                self.refit(&places)?
            } else {
                self.build(&boxes)?
            }
            let machine = self.machine.borrow();
            let time = (machine.now() - before) as f64 / machine.ticks_per_nanosecond();
            let from = self.refit.as_ref().map(|(flat, _)| flat);
            let answer = self.answers.of(self.turns[frame], from, &places, &self.flat.1)?;
            if self.bvh != answer.bvh || self.corners != corners {
                let message = "another hierarchy, or other corners, than one processor makes";
                return Err(MeasureError::Failed(format!("frame {frame}: {message}")));
            }
            samples.push(Sample::of_frame("frame_time", frame, time));
            sums.resize(answer.told.len(), ("", 0.0));
            for ((metric, value), sum) in answer.told.iter().zip(&mut sums) {
                samples.push(Sample::of_frame(metric, frame, *value));
                *sum = (metric, sum.1 + value);
            }
            all += time;
        }
        let frames = self.turns.len().max(1) as f64;
        samples.extend(sums.into_iter().map(|(metric, sum)| Sample::of_path(metric, sum / frames)));
        let rate = if self.asked.refits { "refit_rate" } else { "structure_rate" };
        let triangles = self.flat.1.len() as f64 * frames;
        samples.push(Sample::of_path(rate, triangles * 1e3 / all.max(1e-9)));
        samples.push(Sample::of_path("processors_used", self.processors as f64));
        Ok(samples)
    }
}
