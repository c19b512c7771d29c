//! The job `tiles`: pieces with a set work each, frame after frame.
//!
//! Settings: `job.pieces`, `job.work_ns` (`LEAST-MOST` nanoseconds a piece, on average), `job.cost` (`spread`, or
//! `corner`: all of it in one), `job.frames_a_run` (1). Where there are more, a run goes through so many frames with a
//! barrier between each two, and what is told as a frame's time is a run's, start and end included, over their number.
//! The cell's frames are runs; its scene is called `synthetic`.

use super::settings::{JobSettings, of_scheme};
use super::{
    Cell, MeasureError, Nearest, Options, Sample, Subject, SubjectCache, TraversalShare, Walk, failed,
    load_imbalance, simulated,
};
use crate::job::synthetic_tiles::{Cost, SyntheticTiles};
use crate::machine::{Machine, Simulated, Threads};
use crate::record::THREADS;
use crate::scheme::tiles::Scheme;
use std::borrow::Borrow;

/// What its rows call the pieces.
const SCENE: &str = "synthetic";

struct Asked {
    pieces: usize,
    work_ns: std::ops::RangeInclusive<u32>,
    cost: Cost,
    frames_a_run: usize,
}

pub(super) fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    if cell.scene != SCENE || options.path.is_some() {
        let message = "the job `tiles` makes its own pieces: it takes no --scene and no --path".to_owned();
        return Err(MeasureError::Words(message));
    }
    let settings = JobSettings::of(cell);
    let asked = Asked {
        // A picture of 512 x 512 pixels has so many tiles of 32 x 4.
        pieces: settings.number("pieces", 2048.0, 0.0..=16_777_216.0)? as usize,
        work_ns: settings.range("work_ns", 1000..=3000)?,
        cost: settings.choice("cost", &[("spread", Cost::Spread), ("corner", Cost::Corner)])?,
        frames_a_run: settings.number("frames_a_run", 1.0, 1.0..=100_000.0)? as usize,
    };
    settings.finish(cell)?;
    if cell.machine == THREADS {
        let team = cache.team(cell.processors)?;
        Ok(Box::new(TilesSubject::<_, Threads>::new(cell, team, &asked, options)?))
    } else {
        let machine = simulated(cell, cache)?;
        Ok(Box::new(TilesSubject::<_, Simulated>::new(cell, machine, &asked, options)?))
    }
}

struct TilesSubject<H, M: Machine> {
    machine: H,
    work: SyntheticTiles,
    scheme: Scheme<M>,
    frames_a_run: usize,
    runs: usize,
}

impl<H: Borrow<M>, M: Machine> TilesSubject<H, M> {
    fn new(cell: &Cell, machine: H, asked: &Asked, options: &Options) -> Result<Self, MeasureError> {
        let on = machine.borrow();
        let scheme = Scheme::new(&cell.scheme, on, cell.processors as usize, of_scheme(cell))
            .map_err(|error| MeasureError::Setting(error.to_string()))?;
        let work = SyntheticTiles::new(on, asked.pieces, asked.work_ns.clone(), asked.cost, options.seed);
        let (frames_a_run, runs) = (asked.frames_a_run, options.frames as usize);
        Ok(TilesSubject { machine, work, scheme, frames_a_run, runs })
    }
}

impl<H: Borrow<M>, M: Machine> Walk for TilesSubject<H, M> {
    fn go(&mut self, mut trace: Option<&mut Nearest>) -> Result<Vec<Sample>, MeasureError> {
        let machine = self.machine.borrow();
        let works = vec![&self.work; self.frames_a_run];
        let frames = self.frames_a_run as u64;
        let pieces = frames * crate::scheme::tiles::TileWork::pieces(&self.work) as u64;
        let expected = self.work.expected().wrapping_mul(frames);
        let mut samples = Vec::new();
        let mut traversal = TraversalShare::default();
        let (mut imbalance, mut used) = (0.0, 0);
        for run in 0..self.runs {
            if trace.is_some() {
                machine.start_trace();
            }
            let before = machine.now();
            let shares = self.scheme.run_frames(machine, &works);
            let ticks = machine.now() - before;
            let traced = machine.take_trace();
            let shares = shares.map_err(failed)?;
            traversal.add(machine, shares.len(), ticks);
            let tick = 1.0 / machine.ticks_per_nanosecond();
            let time = ticks as f64 * tick / frames as f64;
            samples.push(Sample::of_frame("frame_time", run, time));
            let visited = shares.iter().map(|share| share.visited).sum::<u64>();
            let found = shares.iter().fold(0_u64, |sum, share| sum.wrapping_add(share.found));
            if visited != pieces || found != expected {
                return Err(MeasureError::Failed(format!(
                    "run {run}: {visited} pieces worked on where there are {pieces}, or not each once"
                )));
            }
            used += shares.len();
            imbalance += load_imbalance(shares.iter().map(|share| share.visited));
            if trace.as_mut().is_some_and(|nearest| nearest.look(time, run, traced, tick)) {
                break;
            }
        }
        let runs = self.runs.max(1) as f64;
        samples.push(Sample::of_path("load_imbalance", imbalance / runs));
        samples.push(Sample::of_path("processors_used", used as f64 / runs));
        samples.extend(traversal.sample());
        Ok(samples)
    }
}
