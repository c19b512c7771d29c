//! The job `cull`: a camera path through a scene, frame by frame.
//!
//! Settings: `job.descent` (`pruned`, `whole_tree`, `no_work`), `job.history` (`plane`, `distances`),
//! `job.plane_coherency`, `job.octant` (`true`, `false`), `job.pause_ms` between frames on threads, and
//! for each scheme `tasks` (`ranges`, `nodes`).

use super::settings::{JobSettings, of_scheme};
use super::{
    Cell, FrameTrace, MeasureError, Nearest, Options, Sample, Stage, Subject, SubjectCache, TraversalShare,
    failed, load_imbalance, simulated,
};
use crate::geometry::{Frustum, culling};
use crate::job::cull::{Costs, CullTree, Descent, Frame, History, Tests};
use crate::machine::{Machine, Simulated, Threads};
use crate::record::THREADS;
use crate::scheme::tree::Scheme;
use std::borrow::Borrow;
use std::rc::Rc;
use std::time::Duration;

#[derive(Clone, Copy)]
struct Asked {
    descent: Descent,
    history: History,
    tests: Tests,
    by_nodes: bool,
    pause: Duration,
}

pub(super) fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    let settings = JobSettings::of(cell);
    let descents =
        [("pruned", Descent::Pruned), ("whole_tree", Descent::WholeTree), ("no_work", Descent::NoWork)];
    let yes = [("true", true), ("false", false)];
    let asked = Asked {
        descent: settings.choice("descent", &descents)?,
        history: settings
            .choice("history", &[("plane", History::Plane), ("distances", History::Distances)])?,
        tests: Tests {
            plane_coherency: settings.choice("plane_coherency", &yes)?,
            octant: settings.choice("octant", &yes)?,
        },
        by_nodes: settings.choice("tasks", &[("ranges", false), ("nodes", true)])?,
        pause: Duration::from_secs_f64(settings.number("pause_ms", 0.0, 0.0..=10_000.0)? / 1000.0),
    };
    settings.finish(cell)?;
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
    /// Nodes that must be found in each frame.
    expected: Vec<Vec<u32>>,
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
        let tree = CullTree::new(on, &stage.tree, asked.history);
        let expected =
            stage.cameras.iter().map(|camera| expected(&stage, &Frustum::new(camera), asked.descent));
        let expected = expected.collect();
        Ok(CullSubject { machine, tree, scheme, stage, asked, costs, expected })
    }
}

/// The serial answer by the basic test alone, node by node, without any of the job's own code.
fn expected(stage: &Stage, frustum: &Frustum, descent: Descent) -> Vec<u32> {
    let nodes = &stage.tree.nodes;
    let (mut seen, mut node) = (Vec::new(), 0);
    // Up to here every node lies inside.
    let mut inside = 0;
    while node < nodes.len() {
        let side = match node < inside {
            true => culling::Side::Inside,
            false => culling::basic(&nodes[node].bounds, frustum).side,
        };
        if nodes[node].triangles > 0 && !matches!(side, culling::Side::Outside(_)) {
            seen.push(node as u32);
        }
        node = match side {
            culling::Side::Outside(_) if descent != Descent::WholeTree => nodes[node].end as usize,
            culling::Side::Inside if descent != Descent::WholeTree => {
                inside = inside.max(nodes[node].end as usize);
                node + 1
            }
            _ => node + 1,
        };
    }
    seen
}

impl<H: Borrow<M>, M: Machine> Subject for CullSubject<H, M> {
    fn sample(&mut self, _repeat: u32) -> Result<Vec<Sample>, MeasureError> {
        self.go(None)
    }

    fn trace(&mut self, time: f64) -> Result<Option<FrameTrace>, MeasureError> {
        let mut nearest = Nearest::new(time);
        self.go(Some(&mut nearest))?;
        Ok(nearest.found())
    }
}

impl<H: Borrow<M>, M: Machine> CullSubject<H, M> {
    /// Goes through the path, with a trace of each frame or without, until the frame looked for is found.
    fn go(&mut self, mut trace: Option<&mut Nearest>) -> Result<Vec<Sample>, MeasureError> {
        let machine = self.machine.borrow();
        let mut samples = Vec::new();
        let mut traversal = TraversalShare::default();
        let (mut visited, mut visible, mut imbalance, mut used) = (0, 0, 0.0, 0);
        for (number, camera) in self.stage.cameras.iter().enumerate() {
            let frustum = Frustum::new(camera);
            let frame = Frame::new(&self.tree, number, &frustum, self.asked.tests).map_err(failed)?;
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
            let time = ticks as f64 / machine.ticks_per_nanosecond();
            samples.push(Sample::of_frame("frame_time", number, time));
            let found = self.tree.visible(shares.iter().map(|share| &share.found));
            if found != self.expected[number] {
                let (found, expected) = (found.len(), self.expected[number].len());
                return Err(MeasureError::Failed(format!(
                    "frame {number}: {found} visible nodes where the serial oracle finds {expected}"
                )));
            }
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
        samples.push(Sample::of_path("load_imbalance", imbalance / frames));
        samples.push(Sample::of_path("processors_used", used as f64 / frames));
        samples.extend(traversal.sample());
        Ok(samples)
    }
}
