//! What is measured: the way from a cell to the job, scheme and machine it names.

mod animate;
mod build;
mod collide;
mod cull;
mod cull_boxes;
mod draw;
mod rays;
mod rolled;
mod settings;
mod staging;
mod tiles;
mod trace;
mod tree;

use super::trace::Nearest;
use super::{Cell, FrameTrace, MeasureError, Options};
use crate::geometry::Camera;
use crate::machine::simulated::{Model, ModelError};
use crate::machine::threads::TeamSettings;
use crate::machine::{Machine, Simulated, Threads};
use crate::record::THREADS;
use crate::scene::{self, Cache, CameraPath, Movers, Origin, Scene};
use crate::scheme::{About, Shape};
use crate::structure::{AabbTree, SkipTree};
use std::collections::HashMap;
use std::fmt::Display;
use std::path::Path;
use std::rc::Rc;
use std::time::Duration;

/// One number a subject took.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// The metric's name, declared in [`METRICS`](crate::record::METRICS).
    pub metric: &'static str,
    /// The frame, from 0; none for a number of the whole camera path.
    pub frame: Option<u32>,
    /// The number, in the metric's unit.
    pub value: f64,
}

impl Sample {
    /// A number of one frame.
    pub(super) fn of_frame(metric: &'static str, frame: usize, value: f64) -> Self {
        Sample { metric, frame: u32::try_from(frame).ok(), value }
    }

    /// A number of the whole camera path.
    pub(super) fn of_path(metric: &'static str, value: f64) -> Self {
        Sample { metric, frame: None, value }
    }
}

/// A cell made ready to run, as often as the plan has repeats.
pub trait Subject {
    /// Runs the whole camera path once and returns what it took: a `frame_time` for each frame at least.
    ///
    /// # Errors
    /// The run failed, or its result is not the oracle's.
    fn sample(&mut self, repeat: u32) -> Result<Vec<Sample>, MeasureError>;

    /// Goes through the path once more, tracing each frame, and returns the one whose time comes nearest to
    /// `time` ns; none where traces cannot be had. It ends early where that is met exactly.
    ///
    /// # Errors
    /// As [`Subject::sample`].
    fn trace(&mut self, time: f64) -> Result<Option<FrameTrace>, MeasureError> {
        let _ = time;
        Ok(None)
    }
}

/// A subject that goes through its frames in the same way whether they are traced or not.
trait Walk {
    /// Goes through the frames, with a trace of each or without, until the one looked for is found.
    fn go(&mut self, trace: Option<&mut Nearest>) -> Result<Vec<Sample>, MeasureError>;
}

impl<W: Walk> Subject for W {
    fn sample(&mut self, _repeat: u32) -> Result<Vec<Sample>, MeasureError> {
        self.go(None)
    }

    fn trace(&mut self, time: f64) -> Result<Option<FrameTrace>, MeasureError> {
        let mut nearest = Nearest::new(time);
        self.go(Some(&mut nearest))?;
        Ok(nearest.found())
    }
}

/// The names there are: what experiments and the command line may ask for.
#[derive(Clone, Debug)]
pub struct Known {
    /// Words of the jobs.
    pub jobs: Vec<String>,
    /// Words of the schemes, of every shape.
    pub schemes: Vec<String>,
    /// Whether a scheme shares out work of the shape that a job has.
    pub suits: fn(job: &str, scheme: &str) -> bool,
    /// Words of the machines, real and simulated.
    pub machines: Vec<String>,
    /// Whether a scheme can run on a machine with so many processors; a plan leaves out what cannot.
    pub fits: fn(scheme: &str, machine: &str, processors: u32) -> bool,
    /// Whether a scheme learns from run to run, so that its first path tells of something else than later ones.
    pub learns: fn(scheme: &str) -> bool,
}

/// The jobs, by word: how each is made ready. The list is the table of contents.
type OpenJob = fn(&Cell, &Options, &mut SubjectCache) -> Result<Box<dyn Subject>, MeasureError>;
const JOBS: &[(&str, OpenJob)] = &[
    ("animate", animate::open),
    ("build", build::open),
    ("collide", collide::open),
    ("cull", cull::open),
    ("cull_boxes", cull_boxes::open),
    ("draw", draw::open),
    ("rays", rays::open),
    ("tiles", tiles::open),
    ("trace", trace::open),
    ("tree", tree::open),
];
/// The jobs made of independent pieces; the others descend a hierarchy.
const IN_PIECES: &[&str] = &["animate", "build", "cull_boxes", "rays", "tiles", "trace"];

/// All schemes, whatever their shape.
fn schemes() -> impl Iterator<Item = &'static About> {
    Shape::ALL.into_iter().flat_map(Shape::schemes)
}

impl Known {
    /// All that this version knows.
    pub fn here() -> Self {
        Self {
            jobs: JOBS.iter().map(|(word, _)| (*word).to_owned()).collect(),
            schemes: schemes().fold(Vec::new(), |mut names, scheme| {
                // `serial` exists in every shape.
                if !names.iter().any(|name| name == scheme.name) {
                    names.push(scheme.name.to_owned());
                }
                names
            }),
            suits: |job, scheme| {
                let shape = if IN_PIECES.contains(&job) { Shape::Tiles } else { Shape::Tree };
                shape.schemes().iter().any(|known| known.name == scheme)
            },
            machines: std::iter::once(THREADS).chain(Model::names()).map(str::to_owned).collect(),
            fits: |scheme, machine, _| {
                let native_only = schemes().any(|known| known.name == scheme && known.native_only);
                machine == THREADS || !native_only
            },
            learns: |scheme| schemes().any(|known| known.name == scheme && known.learns),
        }
    }
}

/// What cells share and is dear to make: scenes, structures, camera paths, teams of threads.
#[derive(Default)]
pub struct SubjectCache {
    scenes: HashMap<String, Rc<Stage>>,
    boxes: HashMap<String, Rc<cull_boxes::BoxStage>>,
    pairs: HashMap<String, Rc<collide::PairStage>>,
    animations: HashMap<String, Rc<animate::AnimateStage>>,
    pictures: HashMap<String, Rc<trace::TraceStage>>,
    hierarchies: HashMap<String, Rc<rays::Built>>,
    rays: HashMap<String, Rc<rays::RayStage>>,
    teams: HashMap<u32, Rc<Threads>>,
    models: HashMap<String, Model>,
    drawings: draw::Drawings,
}

impl Known {
    /// The schemes a job can have, for a message.
    pub(super) fn schemes_of(&self, job: &str) -> String {
        let suits = self.schemes.iter().filter(|scheme| (self.suits)(job, scheme));
        suits.map(String::as_str).collect::<Vec<_>>().join(", ")
    }
}

/// A scene ready to be gone through: it, its tree, a camera for each frame, and what moves.
struct Stage {
    scene: Scene,
    tree: SkipTree,
    cameras: Vec<Camera>,
    movers: Option<Movers>,
}

/// Near and far plane of a recorded path, which does not hold them, as shares of the scene's size.
const NEAR_SHARE: f32 = 1e-4;
const FAR_SHARE: f32 = 2.0;

impl SubjectCache {
    /// Lets a name stand for this simulated machine, whatever preset is called so.
    pub(super) fn provide(&mut self, name: &str, model: Model) {
        self.models.insert(name.to_owned(), model);
    }

    /// The stage of a cell.
    fn stage(&mut self, cell: &Cell, options: &Options) -> Result<Rc<Stage>, MeasureError> {
        settings::of_scene(cell)?;
        staging::check_moving(cell)?;
        let key = stage_key(cell, options);
        if let Some(stage) = self.scenes.get(&key) {
            return Ok(stage.clone());
        }
        let scene = staging::scene(cell)?;
        let path = cameras(cell, &scene, options)?;
        let tree = SkipTree::build(&AabbTree::build(&scene));
        tree.validate().map_err(failed)?;
        let movers = staging::movers(cell, &scene, &tree, options)?;
        let stage = Rc::new(Stage { scene, tree, cameras: path.frames, movers });
        self.scenes.insert(key, stage.clone());
        Ok(stage)
    }

    fn team(&mut self, processors: u32) -> Result<Rc<Threads>, MeasureError> {
        if let Some(team) = self.teams.get(&processors) {
            return Ok(team.clone());
        }
        let settings = TeamSettings { spin: SPIN, pin_caller: true, ..TeamSettings::default() };
        let team = Rc::new(Threads::with_settings(processors as usize, &settings).map_err(failed)?);
        self.teams.insert(processors, team.clone());
        Ok(team)
    }
}

/// The cameras of a cell: of a recorded path, or of the scene's kind of path.
fn cameras(cell: &Cell, scene: &Scene, options: &Options) -> Result<CameraPath, MeasureError> {
    let path = match &options.path {
        Some(file) if cell.settings.contains_key("scene.path") => {
            let message = format!("the experiment sets `scene.path`: it takes no --path {}", file.display());
            return Err(MeasureError::Words(message));
        }
        Some(file) => {
            let size = scene.bounds().size().length().max(1e-3);
            let path = CameraPath::read_csv(file, NEAR_SHARE * size, FAR_SHARE * size).map_err(failed)?;
            first_frames(path, file, options.path_frames)?
        }
        None => staging::path(cell, scene, options)?,
    };
    if path.frames.is_empty() {
        return Err(MeasureError::Failed(match &options.path {
            Some(file) => format!("{}: the camera path has no frames", file.display()),
            None => format!("scene `{}`: nothing in it that such a camera path could lead past", cell.scene),
        }));
    }
    Ok(path)
}

/// What tells one stage from another.
fn stage_key(cell: &Cell, options: &Options) -> String {
    let of_scene: Vec<_> = cell.settings.iter().filter(|(key, _)| key.starts_with("scene.")).collect();
    format!("{} {of_scene:?} {options:?}", cell.scene)
}

/// The frames asked for of a recorded path.
fn first_frames(mut path: CameraPath, file: &Path, asked: Option<u32>) -> Result<CameraPath, MeasureError> {
    if let Some(asked) = asked {
        let there = path.frames.len();
        if there < asked as usize {
            let message = format!("{}: {there} frames, where --frames asks for {asked}", file.display());
            return Err(MeasureError::Words(message));
        }
        path.frames.truncate(asked as usize);
    }
    Ok(path)
}

/// How long a measured team spins between frames: longer than the pauses of any experiment here, so
/// that what is measured is the scheme; `auto` is what one takes where teams fall asleep.
const SPIN: Duration = Duration::from_millis(20);

/// A scene by a generator's name or from a file.
///
/// # Errors
/// There is none of that name; the file cannot be read or is not what it should be.
pub(super) fn scene(name: &str) -> Result<Scene, MeasureError> {
    read_scene(name).map(|(scene, _)| scene)
}

/// As [`scene`], with where a file's was read from.
pub(super) fn read_scene(name: &str) -> Result<(Scene, Option<Origin>), MeasureError> {
    if name.contains(['.', '/', '\\']) {
        Cache::of_user().load(name).map(|(scene, origin)| (scene, Some(origin))).map_err(failed)
    } else {
        let scene = scene::by_name(name).map_err(|error| MeasureError::Words(error.to_string()))?;
        Ok((scene, None))
    }
}

/// The simulated machine a cell names, with the cell's settings.
fn simulated(cell: &Cell, cache: &SubjectCache) -> Result<Simulated, MeasureError> {
    let mut model = match cache.models.get(&cell.machine) {
        Some(model) => model.clone(),
        None => Model::named(&cell.machine).map_err(|error| match error {
            ModelError::Unknown { .. } => MeasureError::Words(error.to_string()),
            error => failed(error),
        })?,
    };
    let prefix = format!("{}.", cell.machine);
    for (key, value) in &cell.settings {
        let Some(constant) = key.strip_prefix("machine.").or_else(|| key.strip_prefix(&prefix)) else {
            continue;
        };
        let number = value.number().ok_or_else(|| {
            MeasureError::Setting(format!("setting `{key}` is `{value}`, expected a number"))
        })?;
        let wrong = |error: ModelError| MeasureError::Setting(format!("setting `{key}`: {error}"));
        model.set(constant, number).map_err(wrong)?;
    }
    Ok(Simulated::new(model))
}

/// Sums up how much of the processors' time was not charged as work, on machines that know (P2-24).
#[derive(Default)]
struct TraversalShare {
    all: u64,
    charged: u64,
}

impl TraversalShare {
    /// Adds the last run, which took `ticks` on `processors` processors.
    fn add<M: Machine>(&mut self, machine: &M, processors: usize, ticks: u64) {
        if let Some(charged) = machine.charged() {
            self.all += ticks * processors as u64;
            self.charged += charged;
        }
    }

    fn sample(&self) -> Option<Sample> {
        let share = 100.0 * (1.0 - self.charged as f64 / self.all as f64);
        (self.all > 0).then(|| Sample::of_path("traversal_share", share))
    }
}

/// How much more than the mean the busiest processor visited, per cent of the mean.
fn load_imbalance(visited: impl ExactSizeIterator<Item = u64> + Clone) -> f64 {
    let processors = visited.len() as f64;
    let (total, most) = (visited.clone().sum::<u64>(), visited.max().unwrap_or(0));
    if total == 0 { 0.0 } else { 100.0 * (most as f64 * processors / total as f64 - 1.0) }
}

fn failed(error: impl Display) -> MeasureError {
    MeasureError::Failed(error.to_string())
}

/// Makes a cell ready to run.
///
/// # Errors
/// The cell's job, scene, scheme, settings or machine cannot be had.
pub fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    match JOBS.iter().find(|(word, _)| *word == cell.job) {
        Some((_, open)) => open(cell, options, cache),
        None => Err(MeasureError::Words(format!("there is no job `{}`", cell.job))),
    }
}
