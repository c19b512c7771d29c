//! The job `collide`: one body against another, pose by pose. The scene is two, the moving one first, joined by
//! `" + "`: `robot + factory-large`. Of one alone, with `job.bend`, see [`bend`].
//!
//! Settings: `job.volume`, one of [`kinds::KINDS`]; `job.over` (`triangles`, `nodes`); `job.leaf`, triangles a leaf;
//! `job.query` (`all`, `first`); `job.reach`, in metres; `job.place` (see [`place`]) with `job.gap`;
//! `job.offset`, how far along each axis both bodies are moved from the origin, in metres, and `job.scale`, how large the
//! moving one is made, in its data; and for each
//! scheme `tasks` (`batches`, `pairs`).

mod bend;
mod kinds;
mod place;
mod stage;

use super::settings::{JobSettings, of_scheme};
use super::{
    Cell, FrameTrace, MeasureError, Nearest, Options, Sample, Subject, SubjectCache, TraversalShare, failed,
    load_imbalance,
};
use crate::geometry::{Overlap, Unit};
use crate::job::collide::{BatchWork, Contacts, Costs, PairWork, Query, SharedTree, contacts};
use crate::machine::{Layout, Machine, Shared, Word};
use crate::measure::plan::PAIR;
use crate::scheme::tree::Scheme;
use kinds::{KINDS, Kind};
use place::Place;
pub(super) use stage::PairStage;
use stage::{Body, Trees};
use std::borrow::Borrow;
use std::rc::Rc;
use std::sync::atomic::Ordering;

/// What the leaves of a body's tree are.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Over {
    /// Triangles, tested exactly.
    Triangles,
    /// Nodes of the scene graph: where their volumes overlap is a contact (Paper II sec. 5).
    Nodes,
}

#[derive(Clone, Copy)]
struct Asked {
    kind: &'static Kind,
    over: Over,
    leaf: usize,
    query: Query,
    place: Place,
    data: Data,
    by_pairs: bool,
}

/// What is done to the bodies' data before anything is built over them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Data {
    /// Along each axis, in metres.
    offset: f32,
    /// The moving body's size, as a share of what it was.
    scale: f32,
}

impl Asked {
    fn of(cell: &Cell) -> Result<Self, MeasureError> {
        let settings = JobSettings::of(cell);
        let kinds: Vec<_> = KINDS.iter().map(|kind| (kind.name, kind)).collect();
        let gap = settings.number("gap", 0.01, 0.0..=1000.0)?;
        let places = [
            ("here", Place::Here),
            ("gap", Place::Gap(gap)),
            ("deep", Place::Deep),
            ("graze", Place::Graze),
            ("apart", Place::Apart),
        ];
        let asked = Asked {
            kind: settings.choice("volume", &kinds)?,
            over: settings.choice("over", &[("triangles", Over::Triangles), ("nodes", Over::Nodes)])?,
            leaf: settings.number("leaf", 2.0, 1.0..=64.0)? as usize,
            query: Query {
                first: settings.choice("query", &[("all", false), ("first", true)])?,
                reach: settings.number("reach", 0.0, 0.0..=1e6)?,
            },
            place: settings.choice("place", &places)?,
            data: Data {
                offset: settings.number("offset", 0.0, -1e9..=1e9)? as f32,
                scale: settings.number("scale", 1.0, 1e-9..=1e9)? as f32,
            },
            by_pairs: settings.choice("tasks", &[("batches", false), ("pairs", true)])?,
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
    if cell.settings.contains_key("job.bend") && !cell.scene.contains(PAIR) {
        return bend::open(cell, options, cache);
    }
    let asked = Asked::of(cell)?;
    if options.path.is_some() {
        let message = "the job `collide` places its bodies itself: it takes no --path".to_owned();
        return Err(MeasureError::Words(message));
    }
    let Some((mover, other)) = cell.scene.split_once(PAIR) else {
        let message = format!(
            "the job `collide` takes two scenes, the moving one first: --scene MOVER --scene OTHER, not `{}` alone",
            cell.scene
        );
        return Err(MeasureError::Words(message));
    };
    let Asked { over, place, data, .. } = asked;
    let key = format!("{} {over:?} {place:?} {data:?} {} {}", cell.scene, options.frames, options.seed);
    let stage = match cache.pairs.get(&key) {
        Some(stage) => stage.clone(),
        None => {
            let mover = Body::new(super::scene(mover)?, data.scale, data.offset)?;
            let other = Body::new(super::scene(other)?, 1.0, data.offset)?;
            let stage = PairStage::new(mover, other, over, place, options.frames as usize, options.seed)?;
            let stage = Rc::new(stage);
            cache.pairs.insert(key, stage.clone());
            stage
        }
    };
    asked.kind.open(cell, &asked, stage, cache)
}

struct CollideSubject<H, M: Machine, V: Overlap> {
    machine: H,
    scheme: Scheme<M>,
    stage: Rc<PairStage>,
    trees: Rc<Trees<V>>,
    mover: SharedTree<V>,
    other: SharedTree<V>,
    /// Not 0 once a contact is found, where one is enough.
    stop: Shared<M::Word>,
    asked: Asked,
    costs: Costs,
}

impl<H: Borrow<M>, M: Machine, V: Overlap> CollideSubject<H, M, V> {
    fn new(
        cell: &Cell,
        machine: H,
        stage: Rc<PairStage>,
        trees: Rc<Trees<V>>,
        asked: Asked,
        costs: Costs,
    ) -> Result<Self, MeasureError> {
        let on = machine.borrow();
        let scheme = Scheme::new(&cell.scheme, on, cell.processors as usize, of_scheme(cell))
            .map_err(|error| MeasureError::Setting(error.to_string()))?;
        let mover = SharedTree::new(on, trees.mover.clone());
        let other = SharedTree::new(on, trees.other.clone());
        let stop = on.alloc(1, Layout::Padded, |_| M::Word::new(0));
        Ok(CollideSubject { machine, scheme, stage, trees, mover, other, stop, asked, costs })
    }

    /// Holds what was found in a frame against what there is.
    fn check(&self, frame: usize, found: &Contacts) -> Result<(), MeasureError> {
        let Query { first, reach } = self.asked.query;
        let answer = match self.asked.over {
            Over::Triangles => self.stage.answer(frame, reach)?,
            // What overlaps depends on the volumes, so on one processor it is to be the same.
            Over::Nodes => {
                let query = Query { first: false, reach };
                let pose = &self.stage.poses[frame];
                Rc::new(contacts(&self.trees.other, &self.trees.mover, pose, query).pairs)
            }
        };
        let right = if first {
            found.pairs.is_empty() == answer.is_empty()
                && found.pairs.iter().all(|pair| answer.binary_search(pair).is_ok())
        } else {
            found.pairs == *answer
        };
        if right {
            return Ok(());
        }
        let message =
            format!("frame {frame}: {} contacts found, {} expected", found.pairs.len(), answer.len());
        Err(MeasureError::Failed(message))
    }
}

impl<H: Borrow<M>, M: Machine, V: Overlap> Subject for CollideSubject<H, M, V> {
    fn sample(&mut self, repeat: u32) -> Result<Vec<Sample>, MeasureError> {
        let mut samples = self.go(None)?;
        // The same in all repeats.
        if repeat == 0 {
            samples.extend(self.stage.places());
        }
        Ok(samples)
    }

    fn trace(&mut self, time: f64) -> Result<Option<FrameTrace>, MeasureError> {
        let mut nearest = Nearest::new(time);
        self.go(Some(&mut nearest))?;
        Ok(nearest.found())
    }
}

impl<H: Borrow<M>, M: Machine, V: Overlap> CollideSubject<H, M, V> {
    /// Goes through the poses, with a trace of each frame or without, until the frame looked for is found.
    fn go(&mut self, mut trace: Option<&mut Nearest>) -> Result<Vec<Sample>, MeasureError> {
        let machine = self.machine.borrow();
        let mut samples = Vec::new();
        let mut traversal = TraversalShare::default();
        let mut total = Contacts::default();
        let (mut found, mut visited, mut imbalance, mut used, mut own) = (0, 0, 0.0, 0, 0);
        let (Query { first, reach }, unit) = (self.asked.query, Unit::best());
        for (frame, pose) in self.stage.poses.iter().enumerate() {
            // Relaxed: the last run is over, and the next one begins with the machine's own hand-over.
            self.stop[0].store(0, Ordering::Relaxed);
            let stop = first.then(|| &self.stop[0]);
            if trace.is_some() {
                machine.start_trace();
            }
            let before = machine.now();
            let pair = self.other.against(&self.mover, pose, reach, unit);
            let shares = match self.asked.by_pairs {
                true => self.scheme.run(machine, &PairWork::new(&pair, stop).costs(self.costs)),
                false => self.scheme.run(machine, &BatchWork::new(&pair, stop).costs(self.costs)),
            };
            let ticks = machine.now() - before;
            let traced = machine.take_trace();
            let shares = shares.map_err(failed)?;
            traversal.add(machine, shares.len(), ticks);
            own += ticks;
            let time = ticks as f64 / machine.ticks_per_nanosecond();
            samples.push(Sample::of_frame("frame_time", frame, time));
            let all = Contacts::gather(shares.iter().map(|share| &share.found));
            self.check(frame, &all)?;
            found += all.pairs.len();
            total.box_tests += all.box_tests;
            total.triangle_tests += all.triangle_tests;
            total.false_overlaps += all.false_overlaps;
            used += shares.len();
            visited += shares.iter().map(|share| share.visited).sum::<u64>();
            imbalance += load_imbalance(shares.iter().map(|share| share.visited));
            let tick = 1.0 / machine.ticks_per_nanosecond();
            if trace.as_mut().is_some_and(|nearest| nearest.look(time, frame, traced, tick)) {
                break;
            }
        }
        let frames = self.stage.poses.len() as f64;
        let ns = own as f64 / machine.ticks_per_nanosecond();
        let a_frame = |metric, count: u64| Sample::of_path(metric, count as f64 / frames);
        samples.push(a_frame("box_tests", total.box_tests));
        samples.push(a_frame("triangle_tests", total.triangle_tests));
        samples.push(a_frame("false_overlaps", total.false_overlaps));
        samples.push(a_frame("contacts", found as u64));
        samples.push(a_frame("nodes_visited", visited));
        samples.push(Sample::of_path("time_per_test", ns / total.box_tests.max(1) as f64));
        samples.push(Sample::of_path("tightness", self.trees.tightness));
        if machine.is_native() && self.asked.over == Over::Triangles {
            samples.push(Sample::of_path("tree_rate", self.trees.rate));
        }
        samples.push(Sample::of_path("load_imbalance", imbalance / frames));
        samples.push(Sample::of_path("processors_used", used as f64 / frames));
        samples.extend(traversal.sample());
        Ok(samples)
    }
}
