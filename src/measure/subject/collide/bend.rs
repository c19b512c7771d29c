//! One body that bends into itself, frame by frame: what it takes to fit its tree anew or to build another, and to find
//! which of its own triangles touch.
//!
//! Settings: `job.bend`, how often it is rolled up about its z axis in the last frame (flat in the first); `job.tree`
//! (`refit`, `rebuild`); `job.volume`, `job.leaf` and `job.reach` as of two bodies. On threads only: a frame's tree is
//! read where it is, not copied into a simulated memory.

use super::super::rolled::{Surface, rolled, turns};
use super::super::settings::{JobSettings, of_scheme};
use super::kinds::{KINDS, Kind};
use super::{
    Cell, MeasureError, Options, Sample, Subject, SubjectCache, TraversalShare, failed, load_imbalance,
};
use crate::geometry::{Overlap, Sphere, Unit};
use crate::job::collide::{BatchWork, Contacts, Pair, Query, own_contacts};
use crate::machine::{Machine, Threads};
use crate::record::THREADS;
use crate::scheme::tree::Scheme;
use crate::structure::VolumeTree;
use crate::structure::volume_tree::in_world;
use glam::Vec3;
use std::rc::Rc;

/// Triangles in the leaves of the trees that answers are held against.
const LEAF: usize = 4;
/// What is asked about a body that bends.
#[derive(Clone, Copy)]
pub(super) struct Asked {
    kind: &'static Kind,
    rebuilds: bool,
    leaf: usize,
    reach: f64,
    turns: f64,
}

impl Asked {
    fn of(cell: &Cell) -> Result<Self, MeasureError> {
        let settings = JobSettings::of(cell);
        let kinds: Vec<_> = KINDS.iter().map(|kind| (kind.name, kind)).collect();
        let asked = Asked {
            kind: settings.choice("volume", &kinds)?,
            rebuilds: settings.choice("tree", &[("refit", false), ("rebuild", true)])?,
            leaf: settings.number("leaf", 2.0, 1.0..=64.0)? as usize,
            reach: settings.number("reach", 0.0, 0.0..=1e6)?,
            turns: settings.number("bend", 1.0, 0.0..=100.0)?,
        };
        settings.finish(cell)?;
        Ok(asked)
    }
}

/// Makes a cell ready that names one body.
pub(super) fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    let asked = Asked::of(cell)?;
    if options.path.is_some() {
        return Err(MeasureError::Words(
            "a body that bends is looked at by no camera: it takes no --path".to_owned(),
        ));
    }
    if cell.machine != THREADS {
        let message = format!("a body that bends runs on {THREADS} only, not on {}", cell.machine);
        return Err(MeasureError::Setting(message));
    }
    let team = cache.team(cell.processors)?;
    (asked.kind.bend)(cell, asked, options, team)
}

/// What `open` of [`Kind`] is of one body.
pub(super) fn with_volume<V: Overlap>(
    cell: &Cell,
    asked: Asked,
    options: &Options,
    team: Rc<Threads>,
) -> Result<Box<dyn Subject>, MeasureError> {
    let scene = super::super::scene(&cell.scene)?;
    let flat = in_world(&scene).map_err(failed)?;
    if flat.1.is_empty() {
        return Err(MeasureError::Failed(format!("scene `{}` has no triangles", cell.scene)));
    }
    let turns = turns(asked.turns, options.frames);
    let scheme = Scheme::new(&cell.scheme, &*team, cell.processors as usize, of_scheme(cell))
        .map_err(|error| MeasureError::Setting(error.to_string()))?;
    let tree = tree::<V>(&flat.0, &flat, asked.leaf)?;
    Ok(Box::new(BendSubject { team, scheme, asked, flat, turns, tree, answers: Vec::new() }))
}

fn tree<V: Overlap>(
    places: &[Vec3],
    (_, triangles): &Surface,
    leaf: usize,
) -> Result<VolumeTree<V>, MeasureError> {
    VolumeTree::over_triangles(places, triangles, leaf).map_err(failed)
}

struct BendSubject<V: Overlap> {
    team: Rc<Threads>,
    scheme: Scheme<Threads>,
    asked: Asked,
    flat: Surface,
    /// By frame.
    turns: Vec<f64>,
    tree: VolumeTree<V>,
    /// The contacts of the frames gone through so far.
    answers: Vec<Vec<(u32, u32)>>,
}

impl<V: Overlap> BendSubject<V> {
    /// Holds what was found in a frame against what trees of spheres, built for it, find.
    fn check(&mut self, frame: usize, places: &[Vec3], found: &Contacts) -> Result<(), MeasureError> {
        if frame == self.answers.len() {
            let spheres = tree::<Sphere>(places, &self.flat, LEAF)?;
            let query = Query { first: false, reach: self.asked.reach };
            self.answers.push(own_contacts(&spheres, query).pairs);
            self.tree.validate().map_err(failed)?;
        }
        let answer = &self.answers[frame];
        if found.pairs == *answer {
            return Ok(());
        }
        let (found, expected) = (found.pairs.len(), answer.len());
        Err(MeasureError::Failed(format!("frame {frame}: {found} contacts found, {expected} expected")))
    }
}

impl<V: Overlap> Subject for BendSubject<V> {
    fn sample(&mut self, _repeat: u32) -> Result<Vec<Sample>, MeasureError> {
        let mut samples = Vec::new();
        let mut traversal = TraversalShare::default();
        let (mut sums, mut imbalance, mut used, mut visited) = ([0.0; 6], 0.0, 0, 0);
        let tick = 1.0 / self.team.ticks_per_nanosecond();
        // Each path begins with the tree that was built over the body as it lies flat.
        self.tree = tree(&self.flat.0, &self.flat, self.asked.leaf)?;
        for frame in 0..self.turns.len() {
            let places = rolled(&self.flat.0, self.turns[frame]);
            let before = self.team.now();
            if self.asked.rebuilds {
                self.tree = tree(&places, &self.flat, self.asked.leaf)?;
            } else {
                self.tree.refit(&places).map_err(failed)?;
            }
            let refit = (self.team.now() - before) as f64 * tick;

            let before = self.team.now();
            let pair = Pair::of_one(&self.tree, self.asked.reach, Unit::best());
            let work = BatchWork::<<Threads as Machine>::Word, V>::new(&pair, None);
            let shares = self.scheme.run(&*self.team, &work);
            let ticks = self.team.now() - before;
            let shares = shares.map_err(failed)?;
            traversal.add(&*self.team, shares.len(), ticks);

            let found = Contacts::gather_own(shares.iter().map(|share| &share.found));
            self.check(frame, &places, &found)?;
            used += shares.len();
            visited += shares.iter().map(|share| share.visited).sum::<u64>();
            imbalance += load_imbalance(shares.iter().map(|share| share.visited));
            samples.push(Sample::of_frame("frame_time", frame, ticks as f64 * tick));
            let values = [
                refit,
                found.box_tests as f64,
                found.triangle_tests as f64,
                found.false_overlaps as f64,
                found.pairs.len() as f64,
                self.tree.statistics().tightness,
            ];
            for ((metric, value), sum) in METRICS.into_iter().zip(values).zip(&mut sums) {
                samples.push(Sample::of_frame(metric, frame, value));
                *sum += value;
            }
        }
        let frames = self.turns.len().max(1) as f64;
        for (metric, sum) in METRICS.into_iter().zip(sums) {
            samples.push(Sample::of_path(metric, sum / frames));
        }
        samples.push(Sample::of_path("nodes_visited", visited as f64 / frames));
        samples.push(Sample::of_path("load_imbalance", imbalance / frames));
        samples.push(Sample::of_path("processors_used", used as f64 / frames));
        samples.extend(traversal.sample());
        Ok(samples)
    }
}

/// What is told of each frame, and of all of them on average.
const METRICS: [&str; 6] =
    ["refit_time", "box_tests", "triangle_tests", "false_overlaps", "contacts", "tightness"];
