//! The job `animate`: the frames of a scene that moves (Lext, Assarsson and Möller 2000; P3-10 to P3-13).
//!
//! Settings: `job.size`, `job.tile`, `job.depth`, `job.builder`, `job.triangle` as of the job `trace`; `job.levels`
//! (`two`, `one`); `job.upkeep`, one of [`frames::SCHEMES`](crate::scheme::frames::SCHEMES), with `job.percent`;
//! `job.mode` (`interactive`, `predetermined`: schemes that look ahead may; P3-07); `job.approximation`, one of
//! [`APPROXIMATIONS`](crate::job::animate::APPROXIMATIONS), `NAME` or `NAME:KNOB`; `job.lights`, how many of the scene's
//! lights are lit (all). The frames of a cell are spread evenly over the scene's animation, first and last included; with
//! `job.frames` it has so many, of which the cell takes those in the middle: the more there are, the more has one in
//! common with the next. With `job.split` (`no`, `yes`) cells on real threads go through the frames once more, on one
//! processor, to tell what their time goes into.
//!
//! Every frame is held against the exact one that one processor makes: without an approximation it must be the same
//! picture bit for bit; with one, it is told how far it is from it. On a simulated machine what one processor does
//! before the tiles and after them takes the time it took here, and each tile what it took here, times the machine's
//! `cycles_per_measured_ns`.

mod asked;
mod split;

use super::settings::of_scheme;
use super::trace::film;
use super::{
    Cell, MeasureError, Nearest, Options, Sample, Subject, SubjectCache, Walk, failed, load_imbalance,
    simulated, stage_key, staging,
};
use crate::job::animate::{Animator, Made};
use crate::job::trace::{Costed, Counts, Film, Image, TileCosts, World};
use crate::machine::{Machine, Simulated, Threads};
use crate::record::THREADS;
use crate::record::statistics::{
    FrameTimes, average_pnsr, error_free_pnsr, mean_square_error, pnsr, structural_similarity,
};
use crate::scene::{Scene, describe};
use crate::scheme::frames::Upkeep;
use crate::scheme::tiles::Scheme;
use asked::Asked;
use std::borrow::Borrow;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Rounds of measuring a picture's tiles.
const ROUNDS: u32 = 3;

/// A scene that moves, the times of its frames, and what they should look like.
pub(super) struct AnimateStage {
    scene: Scene,
    times: Vec<f64>,
    /// What the scene takes, and how much there is in it for rays.
    bytes: usize,
    primitives: usize,
    reference: RefCell<Reference>,
}

/// The exact pictures, as far as they have been asked for.
struct Reference {
    animator: Animator,
    made: Vec<Exact>,
}

/// An exact picture, told shortly.
struct Exact {
    /// CRC-32 of all its bits.
    checksum: u32,
    /// Its colours coded in 8 bits.
    codes: Vec<u8>,
}

pub(super) fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    if options.path.is_some() {
        let message =
            "the job `animate` goes the way of the scene's own camera: it takes no --path".to_owned();
        return Err(MeasureError::Words(message));
    }
    let asked = Asked::of(cell)?;
    // Whatever makes no other exact picture.
    let picture = asked.picture;
    let exact = (picture.size, picture.depth, asked.lights, asked.frames, asked.levels, picture.triangle);
    let key = format!("{} {exact:?}", stage_key(cell, options));
    let stage = match cache.animations.get(&key) {
        Some(stage) => stage.clone(),
        None => {
            let stage = Rc::new(AnimateStage::new(&asked, cell, options)?);
            cache.animations.insert(key, stage.clone());
            stage
        }
    };
    let one = cache.team(1)?;
    if cell.machine == THREADS {
        let team = cache.team(cell.processors)?;
        Ok(Box::new(AnimateSubject::<_, Threads>::new(cell, team, asked, Way::Traced, stage, one)?))
    } else {
        let machine = simulated(cell, cache)?;
        let scale = machine.model().cycles_per_measured_ns;
        let way = Way::Charged { charges: charges(&asked, &stage, &one)?, scale };
        Ok(Box::new(AnimateSubject::<_, Simulated>::new(cell, machine, asked, way, stage, one)?))
    }
}

impl AnimateStage {
    fn new(asked: &Asked, cell: &Cell, options: &Options) -> Result<Self, MeasureError> {
        let mut scene = staging::scene(cell)?;
        if let Some(lights) = asked.lights {
            let there = scene.lights.len();
            if lights as usize > there {
                let message = format!(
                    "setting `job.lights` is `{lights}`, expected at most {there}: the scene has no more"
                );
                return Err(MeasureError::Setting(message));
            }
            scene.lights.truncate(lights as usize);
            scene.animation.lights.retain(|(light, _)| *light < lights);
        }
        let all = asked.frames.unwrap_or(options.frames);
        let before = all.checked_sub(options.frames).ok_or_else(|| {
            let least = options.frames;
            MeasureError::Setting(format!(
                "setting `job.frames` is `{all}`, expected at least {least}: those of the cell"
            ))
        })? / 2;
        let times = scene.animation.times(all).skip(before as usize).take(options.frames as usize).collect();
        let reference = Reference { animator: asked.animator(&scene, true)?, made: Vec::new() };
        let (bytes, primitives) = (describe(&scene).bytes, World::count(&scene));
        Ok(Self { scene, times, bytes, primitives, reference: RefCell::new(reference) })
    }

    /// Holds a picture against the exact one: whether it is the same bit for bit, its mean square error, and how many
    /// pixels are others, colours coded in 8 bits.
    fn compare(&self, frame: usize, image: &Image, one: &Threads) -> Result<Compared, MeasureError> {
        let mut reference = self.reference.borrow_mut();
        let Reference { animator, made } = &mut *reference;
        while made.len() <= frame {
            let mut scheme = Scheme::new("serial", one, 1, BTreeMap::new()).map_err(failed)?;
            let mut film = film(one, animator.traced())?;
            let exact = animator.next(self.times[made.len()], one, &mut scheme, &mut film).map_err(failed)?;
            let image = exact.image(&mut film);
            made.push(Exact { checksum: checksum(&image), codes: image.codes() });
        }
        let (exact, codes) = (&made[frame], image.codes());
        let error = mean_square_error(&codes, &exact.codes)
            .ok_or_else(|| MeasureError::Failed(format!("frame {frame}: a picture of another size")))?;
        let pixels = codes.chunks_exact(3).zip(exact.codes.chunks_exact(3));
        let others = pixels.filter(|(found, expected)| found != expected).count();
        // Of the same codes it is 1 without going through them.
        let alike = if others == 0 {
            Some(1.0)
        } else {
            structural_similarity(&codes, &exact.codes, image.width as usize)
        };
        Ok(Compared { same: checksum(image) == exact.checksum, error, others, alike })
    }
}

struct Compared {
    same: bool,
    error: f64,
    others: usize,
    alike: Option<f64>,
}

fn checksum(image: &Image) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    image.pixels.as_flattened().iter().for_each(|number| hasher.update(&number.to_bits().to_le_bytes()));
    hasher.finalize()
}

/// What a frame is charged on a simulated machine.
#[derive(Clone)]
struct Charge {
    /// Nanoseconds of what one processor does: the update, and all of it but the tiles.
    update: f64,
    alone: f64,
    tiles: TileCosts,
    upkeep: Upkeep,
    rays: Counts,
    image: Rc<Image>,
}

/// What the frames of a cell cost, made one after the other.
fn charges(asked: &Asked, stage: &AnimateStage, one: &Threads) -> Result<Vec<Charge>, MeasureError> {
    let mut animator = asked.animator(&stage.scene, false)?;
    animator.prepare(&stage.times).map_err(failed)?;
    let mut film = film(one, animator.traced())?;
    let tick = 1.0 / one.ticks_per_nanosecond();
    let charge = |time: &f64| {
        let (made, tiles) = animator.measure(*time, one, &mut film, ROUNDS).map_err(failed)?;
        let image = Rc::new(made.image(&mut film));
        let (update, alone) = (made.update_ticks as f64 * tick, made.ticks as f64 * tick);
        Ok(Charge { update, alone, tiles, upkeep: made.upkeep, rays: made.rays, image })
    };
    stage.times.iter().map(charge).collect()
}

/// How the pictures of a cell come about.
enum Way {
    /// Traced, by as many processors as the scheme has.
    Traced,
    /// Charged what they took here, times so many cycles a nanosecond.
    Charged { charges: Vec<Charge>, scale: f64 },
}

/// The rays of a frame by class; of a class that has none there is no row.
fn rays_of(frame: usize, rays: &Counts) -> impl Iterator<Item = Sample> + use<> {
    let classes = [
        ("rays_eye", rays.eye),
        ("rays_shadow", rays.shadow),
        ("rays_reflection", rays.reflection),
        ("rays_refraction", rays.refraction),
    ];
    let some = classes.into_iter().filter(|(_, count)| *count > 0);
    some.map(move |(metric, count)| Sample::of_frame(metric, frame, count as f64))
}

struct AnimateSubject<H, M: Machine> {
    machine: H,
    scheme: Scheme<M>,
    asked: Asked,
    way: Way,
    stage: Rc<AnimateStage>,
    /// Whom pictures are held against.
    one: Rc<Threads>,
}

/// What a frame came to; times in nanoseconds.
struct Outcome {
    time: f64,
    update: f64,
    upkeep: Upkeep,
    rays: Counts,
    tiles: Vec<u64>,
    image: Rc<Image>,
}

impl<H: Borrow<M>, M: Machine> AnimateSubject<H, M> {
    fn new(
        cell: &Cell,
        machine: H,
        asked: Asked,
        way: Way,
        stage: Rc<AnimateStage>,
        one: Rc<Threads>,
    ) -> Result<Self, MeasureError> {
        let scheme = Scheme::new(&cell.scheme, machine.borrow(), cell.processors as usize, of_scheme(cell))
            .map_err(|error| MeasureError::Setting(error.to_string()))?;
        Ok(Self { machine, scheme, asked, way, stage, one })
    }

    fn frame(
        &mut self,
        frame: usize,
        animator: &mut Animator,
        film: &mut Film<M>,
    ) -> Result<Outcome, MeasureError> {
        let machine = self.machine.borrow();
        let tick = 1.0 / machine.ticks_per_nanosecond();
        match &self.way {
            Way::Traced => {
                let time = self.stage.times[frame];
                let made = animator.next(time, machine, &mut self.scheme, film).map_err(failed)?;
                let image = Rc::new(made.image(film));
                let Made { upkeep, update_ticks, ticks, rays, tiles, .. } = made;
                let (time, update) = (ticks as f64 * tick, update_ticks as f64 * tick);
                Ok(Outcome { time, update, upkeep, rays, tiles, image })
            }
            Way::Charged { charges, scale } => {
                let Charge { update, alone, tiles, upkeep, rays, image } = charges[frame].clone();
                let before = machine.now();
                let tiles = TileCosts::new(tiles.nanoseconds().to_vec(), *scale);
                let shares = self.scheme.run(machine, &Costed(&tiles)).map_err(failed)?;
                let scale = scale * tick;
                let time = (machine.now() - before) as f64 * tick + alone * scale;
                let tiles = shares.iter().map(|share| share.visited).collect();
                Ok(Outcome { time, update: update * scale, upkeep, rays, tiles, image })
            }
        }
    }
}

impl<H: Borrow<M>, M: Machine> Walk for AnimateSubject<H, M> {
    fn go(&mut self, mut trace: Option<&mut Nearest>) -> Result<Vec<Sample>, MeasureError> {
        let mut animator = self.asked.animator(&self.stage.scene, false)?;
        let start = self.one.now();
        if let Way::Traced = self.way {
            animator.prepare(&self.stage.times).map_err(failed)?;
        }
        let preprocessing = (self.one.now() - start) as f64 / self.one.ticks_per_nanosecond();
        let mut film = match self.way {
            Way::Traced => film(self.machine.borrow(), animator.traced())?,
            // Nothing is traced.
            Way::Charged { .. } => film(self.machine.borrow(), (1, 1))?,
        };
        let frames = self.stage.times.len();
        let (mut samples, mut times, mut errors) = (Vec::new(), Vec::new(), Vec::new());
        let (mut rays, mut update, mut rebuilt, mut others, mut pixels) = (Counts::default(), 0.0, 0, 0, 0);
        let (mut imbalance, mut used, mut alike) = (0.0, 0, Vec::new());
        for frame in 0..frames {
            if trace.is_some() {
                self.machine.borrow().start_trace();
            }
            let outcome = self.frame(frame, &mut animator, &mut film)?;
            let machine = self.machine.borrow();
            let traced = machine.take_trace();
            let tick = 1.0 / machine.ticks_per_nanosecond();
            let compared = self.stage.compare(frame, &outcome.image, &self.one)?;
            if self.asked.is_exact() && !compared.same {
                let message = format!("frame {frame}: not the picture that one processor makes");
                return Err(MeasureError::Failed(message));
            }
            samples.push(Sample::of_frame("frame_time", frame, outcome.time));
            let of_image = outcome.image.pixels.len() as u64;
            let ratio = pnsr(compared.error).filter(|ratio| ratio.is_finite());
            // Exact pictures have none to tell.
            let ratio = ratio.or(error_free_pnsr(of_image)).filter(|_| !self.asked.is_exact());
            samples.extend(ratio.map(|ratio| Sample::of_frame("pnsr", frame, ratio)));
            samples.extend(rays_of(frame, &outcome.rays));
            times.push(outcome.time);
            errors.push(compared.error);
            alike.extend(compared.alike);
            rays += outcome.rays;
            update += outcome.update;
            rebuilt += usize::from(outcome.upkeep == Upkeep::Rebuilt);
            others += compared.others;
            pixels += outcome.image.pixels.len();
            used += outcome.tiles.len();
            imbalance += load_imbalance(outcome.tiles.into_iter());
            if trace.as_mut().is_some_and(|nearest| nearest.look(outcome.time, frame, traced, tick)) {
                break;
            }
        }
        let of_frames = |total: f64| total / times.len().max(1) as f64;
        let mut tell = |metric, value| samples.push(Sample::of_path(metric, value));
        tell("rays", of_frames(rays.rays() as f64));
        tell("rays_eye", of_frames(rays.eye as f64));
        tell("rays_shadow", of_frames(rays.shadow as f64));
        tell("rays_reflection", of_frames(rays.reflection as f64));
        tell("rays_refraction", of_frames(rays.refraction as f64));
        tell("ray_rate", rays.rays() as f64 * 1e3 / times.iter().sum::<f64>().max(1e-9));
        tell("update_time", of_frames(update));
        tell("rebuilt", of_frames(100.0 * rebuilt as f64));
        tell("primitives", self.stage.primitives as f64);
        tell("scene_bytes", self.stage.bytes as f64);
        if let Way::Traced = self.way {
            tell("preprocessing_time", preprocessing);
            tell("structure_bytes", animator.moving.hierarchy().bytes() as f64);
        }
        if let Some(FrameTimes { average, deviation, continuity, .. }) = FrameTimes::of(&times) {
            tell("frame_time_mean", average);
            deviation.into_iter().for_each(|deviation| tell("deviation", deviation));
            continuity.into_iter().for_each(|continuity| tell("continuity", continuity));
        }
        if let Some(ratio) = average_pnsr(&errors) {
            let most = error_free_pnsr((pixels / errors.len().max(1)) as u64).unwrap_or_default();
            tell("apnsr", ratio.min(most));
        }
        if alike.len() == times.len() && !alike.is_empty() {
            tell("ssim", alike.iter().sum::<f64>() / alike.len() as f64);
        }
        tell("pixels_other", 100.0 * others as f64 / pixels.max(1) as f64);
        tell("load_imbalance", of_frames(imbalance));
        tell("processors_used", of_frames(used as f64));
        if let (Way::Traced, true, true) = (&self.way, self.asked.split, trace.is_none()) {
            samples.extend(split::split(&self.asked, &self.stage, &self.one)?);
        }
        Ok(samples)
    }
}
