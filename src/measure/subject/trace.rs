//! The job `trace`: pictures of a scene, frame by frame, in tiles.
//!
//! Settings: `job.size`, `WIDTHxHEIGHT` pixels; `job.tile`, `WIDTHxHEIGHT` pixels of a piece; `job.depth`, bounces
//! followed; `job.frames_a_run` (1), frames in one run with a barrier between each two, of which a frame's time is the mean; `job.builder`, one of [`BUILDERS`]; `job.triangle` (`watertight`,
//! `fast`); `job.levels` (`one`, `two`), whether the hierarchy is one over all triangles in the world or one over places of
//! meshes that have theirs. Cameras are those
//! of `scene.path` or of a recorded path; where neither is set, every frame is the scene's own view, or the whole of it.
//!
//! On threads every picture is held against the one that one processor makes. On a simulated machine a tile is charged
//! what it took here, traced by itself on one thread (the least of several rounds), times the machine's
//! `cycles_per_measured_ns`: such rows hang on the computer they were made on.

use super::settings::{JobSettings, of_scheme};
use super::{
    Cell, MeasureError, Nearest, Options, Sample, Subject, SubjectCache, TraversalShare, Walk, failed,
    load_imbalance, simulated, stage_key, staging,
};
use crate::job::trace::{
    Costed, Counts, Eye, Film, Frame, Hierarchy, Image, Levels, Look, MOST_DEPTH, MOST_PIXELS, TileCosts,
    Tiles, Tracer, TriangleKind, World, default_view,
};
use crate::machine::{Machine, RunError, Simulated, Threads};
use crate::record::THREADS;
use crate::scheme::tiles::{Scheme, Share, share};
use crate::structure::bvh::build::{BUILDERS, Builder, Settings};
use std::borrow::Borrow;
use std::cell::{OnceCell, RefCell};
use std::rc::Rc;

/// Rounds of measuring a picture's tiles.
const ROUNDS: u32 = 5;
/// The most pixels across or down.
const MOST: u32 = 16_384;

/// What pictures are made of, and what is known of each of them.
pub(super) struct TraceStage {
    world: World,
    hierarchy: Hierarchy,
    eyes: Vec<Eye>,
    look: Look,
    tile: (u32, u32),
    frames_a_run: usize,
    /// What one processor sees, by frame, once it has been asked.
    pictures: RefCell<Vec<Option<Rc<Image>>>>,
    costs: OnceCell<Vec<(TileCosts, Counts)>>,
    /// What there is to say of the hierarchy.
    told: [Sample; 2],
}

/// What pictures are to be, and what they are made by.
#[derive(Clone, Copy)]
pub(super) struct Pictured {
    pub(super) size: (u32, u32),
    pub(super) tile: (u32, u32),
    pub(super) depth: u32,
    pub(super) builder: &'static str,
    pub(super) triangle: TriangleKind,
}

impl Pictured {
    /// As the settings say.
    pub(super) fn of(settings: &JobSettings) -> Result<Self, MeasureError> {
        let pair = |most: u32| {
            move |text: &str| {
                let (across, down) = text.split_once('x')?;
                let number = |text: &str| text.parse().ok().filter(|number| (1..=most).contains(number));
                Some((number(across)?, number(down)?))
            }
        };
        let names: Vec<_> = BUILDERS.iter().map(|about| (about.name, about.name)).collect();
        let depth = f64::from(Look::default().depth);
        Ok(Self {
            size: settings.read("size", (512, 512), "WIDTHxHEIGHT, such as 640x480", pair(MOST))?,
            tile: settings.read("tile", Tiles::OF_PAPER, "WIDTHxHEIGHT, such as 32x4", pair(Tiles::MOST))?,
            depth: settings.number("depth", depth, 0.0..=f64::from(MOST_DEPTH))? as u32,
            builder: settings.choice("builder", &names)?,
            triangle: settings.choice("triangle", TriangleKind::ALL)?,
        })
    }
}

struct Asked {
    picture: Pictured,
    levels: Levels,
    frames_a_run: usize,
}

impl Asked {
    fn of(cell: &Cell) -> Result<Self, MeasureError> {
        let settings = JobSettings::of(cell);
        let asked = Asked {
            picture: Pictured::of(&settings)?,
            levels: settings.choice("levels", Levels::ALL)?,
            frames_a_run: settings.number("frames_a_run", 1.0, 1.0..=1000.0)? as usize,
        };
        settings.finish(cell)?;
        Ok(asked)
    }
}

pub(super) fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    let asked = Asked::of(cell)?;
    let of_job: Vec<_> = cell.settings.iter().filter(|(key, _)| key.starts_with("job.")).collect();
    let key = format!("{} {of_job:?}", stage_key(cell, options));
    let one = cache.team(1)?;
    let stage = match cache.pictures.get(&key) {
        Some(stage) => stage.clone(),
        None => {
            let stage = Rc::new(TraceStage::new(&asked, cell, options, &one)?);
            cache.pictures.insert(key, stage.clone());
            stage
        }
    };
    if cell.machine == THREADS {
        let team = cache.team(cell.processors)?;
        let way = Way::Traced(film(&*team, asked.picture.size)?);
        Ok(Box::new(PictureSubject::<_, Threads>::new(cell, team, way, stage, one)?))
    } else {
        let machine = simulated(cell, cache)?;
        let costs = stage.costs(&one)?.iter().map(|(costs, _)| costs.clone().on(machine.model())).collect();
        Ok(Box::new(PictureSubject::<_, Simulated>::new(cell, machine, Way::Charged(costs), stage, one)?))
    }
}

impl TraceStage {
    fn new(asked: &Asked, cell: &Cell, options: &Options, one: &Threads) -> Result<Self, MeasureError> {
        let scene = staging::scene(cell)?;
        let (width, height) = asked.picture.size;
        let cameras = if options.path.is_some() || cell.settings.contains_key("scene.path") {
            super::cameras(cell, &scene, options)?.frames
        } else {
            let view = default_view(&scene, width as f32 / height as f32).ok_or_else(|| {
                MeasureError::Failed(format!("scene `{}`: there is nothing in it to look at", cell.scene))
            })?;
            vec![view; options.frames as usize]
        };
        let items = World::count(&scene);
        if u32::try_from(items).is_err() {
            let most = u64::from(u32::MAX);
            let message = format!("scene `{}`: {items} triangles and spheres, more than {most}", scene.name);
            return Err(MeasureError::Failed(message));
        }
        let (look, world) = (Look::of(&scene), World::new(scene));
        let mut builder = Builder::new(asked.picture.builder, &Settings::default()).map_err(failed)?;
        let before = one.now();
        let hierarchy =
            Hierarchy::of(&world, asked.levels, &mut builder, asked.picture.triangle).map_err(failed)?;
        let time = (one.now() - before) as f64 / one.ticks_per_nanosecond();
        let told = [
            Sample::of_path("hierarchy_time", time),
            Sample::of_path("structure_bytes", hierarchy.bytes() as f64),
        ];
        Ok(Self {
            told,
            world,
            hierarchy,
            pictures: RefCell::new(vec![None; cameras.len()]),
            eyes: cameras.iter().map(|camera| Eye::new(camera, width, height)).collect(),
            look: Look { depth: asked.picture.depth, ..look },
            tile: asked.picture.tile,
            frames_a_run: asked.frames_a_run,
            costs: OnceCell::new(),
        })
    }

    /// The picture of a frame, to be shared out.
    fn frame<'a, M: Machine>(&'a self, frame: usize, film: &'a mut Film<M>) -> Frame<'a, M> {
        let tracer = Tracer::new(&self.world, &self.hierarchy, self.look);
        Frame::new(tracer, self.eyes[frame], self.tile, film)
    }

    /// How many tiles a frame has.
    fn tiles(&self, frame: usize) -> usize {
        Tiles::new(self.eyes[frame].size(), self.tile).count()
    }

    /// What each tile takes on one thread, and what rays, by frame.
    fn costs(&self, team: &Threads) -> Result<&[(TileCosts, Counts)], MeasureError> {
        if self.costs.get().is_none() {
            let mut film = film(team, self.eyes.first().map_or((1, 1), Eye::size))?;
            let mut all: Vec<(TileCosts, Counts)> = Vec::new();
            for (number, eye) in self.eyes.iter().enumerate() {
                // A view that stays is measured once.
                let same = self.eyes[..number].iter().position(|before| before == eye);
                all.push(match same {
                    Some(same) => all[same].clone(),
                    None => {
                        TileCosts::measure(team, &self.frame(number, &mut film), ROUNDS).map_err(failed)?
                    }
                });
            }
            let _ = self.costs.set(all);
        }
        Ok(self.costs.get().map_or(&[], Vec::as_slice))
    }

    /// What one processor sees in a frame.
    fn picture(&self, frame: usize, team: &Threads) -> Result<Rc<Image>, MeasureError> {
        if let Some(picture) = &self.pictures.borrow()[frame] {
            return Ok(picture.clone());
        }
        let mut film = film(team, self.eyes[frame].size())?;
        share("serial", team, 1, &self.frame(frame, &mut film)).map_err(failed)?;
        let picture = Rc::new(film.image());
        self.pictures.borrow_mut()[frame] = Some(picture.clone());
        Ok(picture)
    }
}

/// A film of so many pixels across and down.
pub(super) fn film<M: Machine>(machine: &M, (width, height): (u32, u32)) -> Result<Film<M>, MeasureError> {
    Film::new(machine, width, height).ok_or_else(|| {
        MeasureError::Setting(format!(
            "setting `job.size` is `{width}x{height}`, expected at most {MOST_PIXELS} pixels"
        ))
    })
}

/// How the pictures of a cell come about.
enum Way<M: Machine> {
    /// Traced, by as many processors as the scheme has.
    Traced(Film<M>),
    /// Charged tile by tile what they took, by frame.
    Charged(Vec<TileCosts>),
}

struct PictureSubject<H, M: Machine> {
    machine: H,
    scheme: Scheme<M>,
    way: Way<M>,
    stage: Rc<TraceStage>,
    /// Whom pictures are held against.
    one: Rc<Threads>,
}

/// What a frame came to: tiles by processor, and rays.
type Outcome = (Vec<u64>, Counts);

impl<H: Borrow<M>, M: Machine> PictureSubject<H, M> {
    fn new(
        cell: &Cell,
        machine: H,
        way: Way<M>,
        stage: Rc<TraceStage>,
        one: Rc<Threads>,
    ) -> Result<Self, MeasureError> {
        let scheme = Scheme::new(&cell.scheme, machine.borrow(), cell.processors as usize, of_scheme(cell))
            .map_err(|error| MeasureError::Setting(error.to_string()))?;
        Ok(Self { machine, scheme, way, stage, one })
    }

    fn share_out(&mut self, frame: usize) -> Result<Outcome, RunError> {
        let machine = self.machine.borrow();
        match &mut self.way {
            Way::Traced(film) => {
                let picture = self.stage.frame(frame, film);
                let works = vec![&picture; self.stage.frames_a_run];
                let shares = self.scheme.run_frames(machine, &works)?;
                let mut rays = Counts::default();
                shares.iter().for_each(|share| rays += share.found);
                Ok((visited(&shares), rays))
            }
            Way::Charged(costs) => {
                let works = vec![Costed(&costs[frame]); self.stage.frames_a_run];
                let shares = self.scheme.run_frames(machine, &works)?;
                let mut rays = Counts::default();
                let one = self.stage.costs.get().map_or(Counts::default(), |all| all[frame].1);
                works.iter().for_each(|_| rays += one);
                Ok((visited(&shares), rays))
            }
        }
    }

    /// Holds what a frame came to against what one processor gets.
    fn check(&mut self, frame: usize, tiles: &[u64]) -> Result<(), MeasureError> {
        let stage = &self.stage;
        let expected = (stage.tiles(frame) * stage.frames_a_run) as u64;
        let done = tiles.iter().sum::<u64>();
        if done != expected {
            return Err(MeasureError::Failed(format!("frame {frame}: {done} tiles done of {expected}")));
        }
        let Way::Traced(film) = &mut self.way else { return Ok(()) };
        let (found, expected) = (film.image(), stage.picture(frame, &self.one)?);
        let pairs = found.pixels.as_flattened().iter().zip(expected.pixels.as_flattened());
        let other = pairs.filter(|(found, expected)| found.to_bits() != expected.to_bits()).count();
        if other > 0 {
            return Err(MeasureError::Failed(format!(
                "frame {frame}: {other} numbers of the picture are not those that one processor gets"
            )));
        }
        Ok(())
    }
}

fn visited<F>(shares: &[Share<F>]) -> Vec<u64> {
    shares.iter().map(|share| share.visited).collect()
}

impl<H: Borrow<M>, M: Machine> Walk for PictureSubject<H, M> {
    fn go(&mut self, mut trace: Option<&mut Nearest>) -> Result<Vec<Sample>, MeasureError> {
        let mut samples = Vec::new();
        let mut traversal = TraversalShare::default();
        let (mut rays, mut all, mut imbalance, mut used) = (Counts::default(), 0.0, 0.0, 0);
        let frames = self.stage.eyes.len();
        for frame in 0..frames {
            if trace.is_some() {
                self.machine.borrow().start_trace();
            }
            let before = self.machine.borrow().now();
            let outcome = self.share_out(frame);
            let machine = self.machine.borrow();
            let ticks = machine.now() - before;
            let traced = machine.take_trace();
            let (tiles, counts) = outcome.map_err(failed)?;
            traversal.add(machine, tiles.len(), ticks);
            let tick = 1.0 / machine.ticks_per_nanosecond();
            let a_run = self.stage.frames_a_run as f64;
            let time = ticks as f64 * tick / a_run;
            self.check(frame, &tiles)?;
            samples.push(Sample::of_frame("frame_time", frame, time));
            all += time * a_run;
            rays += counts;
            used += tiles.len();
            imbalance += load_imbalance(tiles.into_iter());
            if trace.as_mut().is_some_and(|nearest| nearest.look(time, frame, traced, tick)) {
                break;
            }
        }
        // Of all runs.
        let traced = (frames * self.stage.frames_a_run).max(1) as f64;
        let frames = frames.max(1) as f64;
        let a_frame = |metric, count: u64| Sample::of_path(metric, count as f64 / traced);
        samples.push(a_frame("rays", rays.rays()));
        samples.push(a_frame("rays_shadow", rays.shadow));
        samples.push(a_frame("rays_reflection", rays.reflection));
        samples.push(a_frame("rays_refraction", rays.refraction));
        samples.push(Sample::of_path("ray_rate", rays.rays() as f64 * 1e3 / all.max(1e-9)));
        samples.extend(self.stage.told.iter().cloned());
        samples.push(Sample::of_path("load_imbalance", imbalance / frames));
        samples.push(Sample::of_path("processors_used", used as f64 / frames));
        samples.extend(traversal.sample());
        Ok(samples)
    }
}
