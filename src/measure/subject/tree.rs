//! The job `tree`: a generated unbalanced tree with a set work a node, run after run.
//!
//! Settings: `job.nodes`, `job.work_ns` (`LEAST-MOST` nanoseconds a node), `job.pause_ms` between runs on
//! threads. The cell's frames are runs; its scene is called `synthetic`.

use super::settings::{JobSettings, of_scheme};
use super::{
    Cell, MeasureError, Nearest, Options, Sample, Subject, SubjectCache, TraversalShare, Walk, failed,
    load_imbalance, simulated,
};
use crate::job::synthetic::Synthetic;
use crate::machine::{Machine, Simulated, Threads};
use crate::record::THREADS;
use crate::scheme::tree::Scheme;
use std::borrow::Borrow;
use std::time::Duration;

/// What its rows call the tree.
const SCENE: &str = "synthetic";

struct Asked {
    nodes: u32,
    work_ns: std::ops::RangeInclusive<u32>,
    pause: Duration,
}

pub(super) fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    if cell.scene != SCENE || options.path.is_some() {
        let message = "the job `tree` makes its own tree: it takes no --scene and no --path".to_owned();
        return Err(MeasureError::Words(message));
    }
    let settings = JobSettings::of(cell);
    let asked = Asked {
        nodes: settings.number("nodes", 4001.0, 0.0..=10_000_000.0)? as u32,
        work_ns: settings.range("work_ns", 100..=300)?,
        pause: Duration::from_secs_f64(settings.number("pause_ms", 0.0, 0.0..=10_000.0)? / 1000.0),
    };
    settings.finish(cell)?;
    if cell.machine == THREADS {
        let team = cache.team(cell.processors)?;
        Ok(Box::new(TreeSubject::<_, Threads>::new(cell, team, &asked, options)?))
    } else {
        let machine = simulated(cell, cache)?;
        Ok(Box::new(TreeSubject::<_, Simulated>::new(cell, machine, &asked, options)?))
    }
}

struct TreeSubject<H, M: Machine> {
    machine: H,
    work: Synthetic,
    scheme: Scheme<M>,
    pause: Duration,
    runs: usize,
}

impl<H: Borrow<M>, M: Machine> TreeSubject<H, M> {
    fn new(cell: &Cell, machine: H, asked: &Asked, options: &Options) -> Result<Self, MeasureError> {
        let on = machine.borrow();
        let scheme = Scheme::new(&cell.scheme, on, cell.processors as usize, of_scheme(cell))
            .map_err(|error| MeasureError::Setting(error.to_string()))?;
        let work = Synthetic::new(on, asked.nodes, asked.work_ns.clone(), options.seed);
        let pause = if on.is_native() { asked.pause } else { Duration::ZERO };
        Ok(TreeSubject { machine, work, scheme, pause, runs: options.frames as usize })
    }
}

impl<H: Borrow<M>, M: Machine> Walk for TreeSubject<H, M> {
    fn go(&mut self, mut trace: Option<&mut Nearest>) -> Result<Vec<Sample>, MeasureError> {
        let machine = self.machine.borrow();
        let mut samples = Vec::new();
        let mut traversal = TraversalShare::default();
        let (mut visited, mut imbalance, mut used) = (0, 0.0, 0);
        for run in 0..self.runs {
            if !self.pause.is_zero() {
                std::thread::sleep(self.pause);
            }
            if trace.is_some() {
                machine.start_trace();
            }
            let before = machine.now();
            let shares = self.scheme.run(machine, &self.work);
            let ticks = machine.now() - before;
            let traced = machine.take_trace();
            let shares = shares.map_err(failed)?;
            traversal.add(machine, shares.len(), ticks);
            let time = ticks as f64 / machine.ticks_per_nanosecond();
            samples.push(Sample::of_frame("frame_time", run, time));
            let nodes = shares.iter().map(|share| share.visited).sum::<u64>();
            let found = shares.iter().fold(0, |sum, share| sum ^ share.found);
            if nodes != self.work.len() as u64 || found != self.work.expected() {
                let expected = self.work.len();
                return Err(MeasureError::Failed(format!(
                    "run {run}: {nodes} visits where there are {expected} nodes, or not each node once"
                )));
            }
            visited += nodes;
            used += shares.len();
            imbalance += load_imbalance(shares.iter().map(|share| share.visited));
            let tick = 1.0 / machine.ticks_per_nanosecond();
            if trace.as_mut().is_some_and(|nearest| nearest.look(time, run, traced, tick)) {
                break;
            }
        }
        let runs = self.runs.max(1) as f64;
        samples.push(Sample::of_path("nodes_visited", visited as f64 / runs));
        samples.push(Sample::of_path("load_imbalance", imbalance / runs));
        samples.push(Sample::of_path("processors_used", used as f64 / runs));
        samples.extend(traversal.sample());
        Ok(samples)
    }
}
