//! The job `cull`: a camera path through a scene, frame by frame.
//!
//! Settings: `job.steps`, the steps of the test joined by `+` (see [`STEPS`](crate::geometry::culling::STEPS)); `job.volume`, one of
//! [`VOLUME_KINDS`]; `job.descent` (`pruned`, `whole_tree`, `no_work`); `job.history` (`plane`, `distances`);
//! `job.baseline`, steps to be timed in turn with those of the cell; `job.accuracy` (`false`, `true`): what the test
//! gives up, held against the exact one; `job.pause_ms` between frames on threads; and for each scheme `tasks`
//! (`ranges`, `nodes`). With `scene.moving` (see [`staging`](super::staging)) objects move between frames; the
//! time for bringing the tree up to date is a metric of its own.

mod moving;
mod truth;

use super::settings::{JobSettings, of_scheme};
use super::{
    Cell, MeasureError, Nearest, Options, Sample, Stage, Subject, SubjectCache, TraversalShare, Walk, failed,
    load_imbalance, simulated,
};
use crate::geometry::Frustum;
use crate::geometry::culling::{Octant, Space, Steps};
use crate::job::cull::{Costs, CullTree, Descent, Frame, History};
use crate::machine::{Machine, Simulated, Threads};
use crate::record::THREADS;
use crate::scheme::tree::Scheme;
use crate::structure::{VOLUME_KINDS, VolumeKind, Volumes};
use moving::Moving;
use std::borrow::Borrow;
use std::rc::Rc;
use std::time::Duration;
use truth::Truth;

#[derive(Clone, Copy)]
struct Asked {
    descent: Descent,
    history: History,
    steps: Steps,
    volume: &'static VolumeKind,
    baseline: Option<Steps>,
    accuracy: bool,
    by_nodes: bool,
    pause: Duration,
}

impl Asked {
    fn of(cell: &Cell) -> Result<Self, MeasureError> {
        let settings = JobSettings::of(cell);
        let descents =
            [("pruned", Descent::Pruned), ("whole_tree", Descent::WholeTree), ("no_work", Descent::NoWork)];
        let kinds: Vec<_> = VOLUME_KINDS.iter().map(|kind| (kind.name, kind)).collect();
        let steps: Steps = settings.parsed("steps")?.unwrap_or(Steps::ADVISED);
        let mut histories = [("plane", History::Plane), ("distances", History::Distances)];
        if steps.translation {
            // It is nothing without them.
            histories.reverse();
        }
        let asked = Asked {
            descent: settings.choice("descent", &descents)?,
            history: settings.choice("history", &histories)?,
            steps,
            volume: settings.choice("volume", &kinds)?,
            baseline: settings.parsed("baseline")?,
            accuracy: settings.choice("accuracy", &[("false", false), ("true", true)])?,
            by_nodes: settings.choice("tasks", &[("ranges", false), ("nodes", true)])?,
            pause: Duration::from_secs_f64(settings.number("pause_ms", 0.0, 0.0..=10_000.0)? / 1000.0),
        };
        settings.finish(cell)?;
        Ok(asked)
    }

    /// Whether a serial basic test finds the very same nodes: its verdicts are those of the steps asked for, down to
    /// the last bit.
    fn is_basic_at_heart(&self) -> bool {
        let steps = &self.steps;
        steps.space == Space::World
            && !steps.rotation
            && !steps.translation
            && steps.octant != Octant::AsPublished
    }
}

pub(super) fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    let asked = Asked::of(cell)?;
    let stage = cache.stage(cell, options)?;
    if cell.machine == THREADS {
        let team = cache.team(cell.processors)?;
        Ok(Box::new(CullSubject::<_, Threads>::new(cell, team, stage, asked, Costs::default())?))
    } else {
        let machine = simulated(cell, cache)?;
        let costs = Costs::measured_on(machine.model());
        Ok(Box::new(CullSubject::<_, Simulated>::new(cell, machine, stage, asked, costs)?))
    }
}

struct CullSubject<H, M: Machine> {
    machine: H,
    tree: CullTree<M>,
    scheme: Scheme<M>,
    stage: Rc<Stage>,
    asked: Asked,
    costs: Costs,
    truth: Truth,
    baseline: Option<Baseline<M>>,
    moving: Option<Moving>,
}

/// A test that is timed in turn with the cell's own, by the serial scheme.
struct Baseline<M: Machine> {
    tree: CullTree<M>,
    scheme: Scheme<M>,
    steps: Steps,
}

impl<H: Borrow<M>, M: Machine> CullSubject<H, M> {
    fn new(
        cell: &Cell,
        machine: H,
        stage: Rc<Stage>,
        asked: Asked,
        costs: Costs,
    ) -> Result<Self, MeasureError> {
        let on = machine.borrow();
        let scheme = Scheme::new(&cell.scheme, on, cell.processors as usize, of_scheme(cell))
            .map_err(|error| MeasureError::Setting(error.to_string()))?;
        let volumes = asked.volume.fit(&stage.scene, &stage.tree);
        let moving = Moving::of(&stage, asked.volume);
        let (boxes, at_rest) = match &moving {
            Some(moving) => (moving.tree().tree(), moving.tree().volumes()),
            None => (&stage.tree, &volumes),
        };
        let tree = CullTree::with_volumes(on, boxes, at_rest, asked.history);
        let truth = Truth::of(&stage, &volumes, &asked)?;
        let baseline = asked.baseline.map(|steps| {
            let history = if steps.translation { History::Distances } else { History::Plane };
            let tree = CullTree::new(on, boxes, history);
            let serial = Scheme::new("serial", on, 1, Default::default());
            serial.map(|scheme| Baseline { tree, scheme, steps })
        });
        let baseline = baseline.transpose().map_err(failed)?;
        Ok(CullSubject { machine, tree, scheme, stage, asked, costs, truth, baseline, moving })
    }
}

impl<M: Machine> Baseline<M> {
    /// Culls a frame; ticks it took.
    fn go(
        &mut self,
        machine: &M,
        number: usize,
        frustum: &Frustum,
        costs: Costs,
    ) -> Result<u64, MeasureError> {
        let frame = Frame::new(&self.tree, number, frustum, self.steps).map_err(failed)?.costs(costs);
        let before = machine.now();
        self.scheme.run(machine, &frame.ranges()).map_err(failed)?;
        Ok(machine.now() - before)
    }
}

impl<H: Borrow<M>, M: Machine> Walk for CullSubject<H, M> {
    fn go(&mut self, mut trace: Option<&mut Nearest>) -> Result<Vec<Sample>, MeasureError> {
        let machine = self.machine.borrow();
        let mut samples = Vec::new();
        let mut traversal = TraversalShare::default();
        let (mut visited, mut visible, mut imbalance, mut used) = (0, 0, 0.0, 0);
        let (mut own, mut others) = (0, 0);
        let (mut refit, mut refitted) = (0, 0);
        for (number, camera) in self.stage.cameras.iter().enumerate() {
            let frustum = Frustum::new(camera);
            if let Some(moving) = &mut self.moving {
                moving.prepare(number);
                let before = machine.now();
                moving.refit();
                self.tree.refit(moving.tree());
                refit += machine.now() - before;
                refitted += moving.tree().changed().len();
                if let Some(baseline) = &mut self.baseline {
                    baseline.tree.refit(moving.tree());
                }
            }
            if let Some(baseline) = &mut self.baseline {
                others += baseline.go(machine, number, &frustum, self.costs)?;
            }
            let frame = Frame::new(&self.tree, number, &frustum, self.asked.steps).map_err(failed)?;
            let frame = frame.descent(self.asked.descent).costs(self.costs);
            if !self.asked.pause.is_zero() && machine.is_native() {
                std::thread::sleep(self.asked.pause);
            }
            if trace.is_some() {
                machine.start_trace();
            }
            let before = machine.now();
            let shares = match self.asked.by_nodes {
                true => self.scheme.run(machine, &frame.nodes()),
                false => self.scheme.run(machine, &frame.ranges()),
            };
            let ticks = machine.now() - before;
            let traced = machine.take_trace();
            let shares = shares.map_err(failed)?;
            traversal.add(machine, shares.len(), ticks);
            own += ticks;
            let time = ticks as f64 / machine.ticks_per_nanosecond();
            samples.push(Sample::of_frame("frame_time", number, time));
            let found = self.tree.visible(shares.iter().map(|share| &share.found));
            self.truth.check(number, &found).map_err(MeasureError::Failed)?;
            visible += found.len();
            used += shares.len();
            visited += shares.iter().map(|share| share.visited).sum::<u64>();
            imbalance += load_imbalance(shares.iter().map(|share| share.visited));
            let tick = 1.0 / machine.ticks_per_nanosecond();
            if trace.as_mut().is_some_and(|nearest| nearest.look(time, number, traced, tick)) {
                break;
            }
        }
        let frames = self.stage.cameras.len() as f64;
        samples.push(Sample::of_path("nodes_visited", visited as f64 / frames));
        samples.push(Sample::of_path("nodes_visible", visible as f64 / frames));
        let ns = own as f64 / machine.ticks_per_nanosecond();
        samples.push(Sample::of_path("time_per_visit", ns / visited.max(1) as f64));
        if self.baseline.is_some() {
            samples.push(Sample::of_path("speedup_over_baseline", others as f64 / own.max(1) as f64));
        }
        if self.moving.is_some() {
            let ns = refit as f64 / machine.ticks_per_nanosecond();
            samples.push(Sample::of_path("refit_time", ns / frames));
            samples.push(Sample::of_path("nodes_refitted", refitted as f64 / frames));
        }
        samples.extend(self.truth.given_up());
        samples.push(Sample::of_path("load_imbalance", imbalance / frames));
        samples.push(Sample::of_path("processors_used", used as f64 / frames));
        samples.extend(traversal.sample());
        Ok(samples)
    }
}
