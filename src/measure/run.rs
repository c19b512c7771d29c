//! The runner: every cell of a plan, repeat by repeat, each row written as soon as it is known.

use super::noise::lost_time;
use super::summary::summary;
use super::until::Tightness;
use super::{Cell, MeasureError, Options, Plan, Sample, Subject};
use crate::record::{CellKey, Row, RowLog, THREADS, metric};
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};

/// How a cell is made ready; [`subject::open`](super::subject::open) in the program, a mock in tests.
pub type Open<'a> = dyn FnMut(&Cell, &Options) -> Result<Box<dyn Subject>, MeasureError> + 'a;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// All cells are in the log.
    Complete,
    /// It was told to stop; `--resume` takes up the rest.
    Stopped {
        /// How many cells, counted once a repeat, are missing.
        left: usize,
    },
}

/// How far a run is: told before each cell.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Cells in the log, counted once a repeat.
    pub done: usize,
    /// Cells of the plan, counted once a repeat.
    pub total: usize,
    /// The one that is next.
    pub cell: &'a Cell,
    /// Its repeat.
    pub repeat: u32,
}

/// Runs the plan's cells that are not in the log yet; `kept` are the rows that are.
///
/// Repeats are interleaved: all cells once, then all again, so that a slow minute of the computer falls on all of them.
/// Cells on real threads, and all where one of the schemes learns, are warmed up by one path that is not recorded.
/// Beyond the plan's repeats those on threads go on as long as [`Until`](super::Until) wants; its time counts anew
/// for a run that is taken up. `stop` ends the run after the cell in hand.
///
/// # Errors
/// A cell cannot be opened or fails, or a row cannot be written; the rows of all cells before it are kept.
pub fn run(
    plan: &Plan,
    id: &str,
    (log, kept): (&mut RowLog, &[Row]),
    open: &mut Open<'_>,
    watch: &mut dyn FnMut(Progress<'_>),
    stop: &AtomicBool,
) -> Result<Ending, MeasureError> {
    let total: usize = plan.cells.iter().map(|cell| plan.repeats(cell) as usize).sum();
    let totals =
        kept.iter().filter(|row| row.metric == "total_time").map(|row| (row.key(), row.value)).collect();
    let mut tightness = Tightness::new(plan.options.until);
    for row in kept.iter().filter(|row| row.metric == "speedup" && row.machine == THREADS) {
        tightness.add(&row.key(), row.value);
    }
    let rounds = plan.options.repeats;
    let mut runner = Runner { plan, id, log, open, totals, tightness, rounds, ready: HashMap::new() };
    let (mut done, mut repeat) = (0, 0);
    while repeat < rounds || runner.tightness.wants_more() {
        runner.rounds = rounds.max(repeat + 1);
        for (index, cell) in plan.cells.iter().enumerate().filter(|(_, cell)| runs_in(cell, repeat)) {
            if !runner.log.is_finished(&cell.key(repeat)) {
                if repeat >= rounds && runner.tightness.is_late() {
                    return Ok(Ending::Complete);
                }
                // Relaxed: the flag carries no data, and a cell more or less makes no difference.
                if stop.load(Ordering::Relaxed) {
                    return Ok(Ending::Stopped { left: runner.left() });
                }
                watch(Progress { done, total: total.max(done + 1), cell, repeat });
                runner.cell(index, repeat)?;
            }
            done += 1;
        }
        repeat += 1;
    }
    Ok(Ending::Complete)
}

/// Whether a cell runs in a repeat: a simulated machine says the same each time.
fn runs_in(cell: &Cell, repeat: u32) -> bool {
    repeat == 0 || !cell.is_simulated()
}

struct Runner<'a, 'b> {
    plan: &'a Plan,
    id: &'a str,
    log: &'a mut RowLog,
    open: &'a mut Open<'b>,
    /// Total time of each finished cell, ns: what speedups are made of.
    totals: HashMap<CellKey, f64>,
    tightness: Tightness,
    /// How many repeats there are to be as far as is known.
    rounds: u32,
    /// Measured cells stay open from repeat to repeat, warm.
    ready: HashMap<usize, Box<dyn Subject>>,
}

impl Runner<'_, '_> {
    fn left(&self) -> usize {
        let cells = self.plan.cells.iter();
        let all = cells.flat_map(|cell| {
            (0..self.rounds).filter(|&repeat| runs_in(cell, repeat)).map(|repeat| cell.key(repeat))
        });
        all.filter(|key| !self.log.is_finished(key)).count()
    }

    fn cell(&mut self, index: usize, repeat: u32) -> Result<(), MeasureError> {
        let cell = &self.plan.cells[index];
        let failed = |error: MeasureError| match error {
            // Words that are off stay so, whichever cell found out.
            error if error.is_usage() => error,
            error => MeasureError::Cell { cell: cell.to_string(), message: error.to_string() },
        };
        let mut samples = self.take(index, repeat).map_err(failed)?;
        let key = cell.key(repeat);
        samples.extend(summary(&samples));
        if let Some(total) =
            samples.iter().find(|sample| sample.metric == "total_time").map(|sample| sample.value)
        {
            self.totals.insert(key.clone(), total);
            let speedups = self.speedups(cell, repeat, total);
            if let Some(speedup) = speedups.iter().find(|speedup| speedup.metric == "speedup")
                && !cell.is_simulated()
            {
                self.tightness.add(&key, speedup.value);
            }
            samples.extend(speedups);
        }
        let complete = Sample { metric: "cell_complete", frame: None, value: samples.len() as f64 };
        for sample in samples.into_iter().chain([complete]) {
            self.log.append(&row(self.id, &key, &sample).map_err(failed)?)?;
        }
        Ok(())
    }

    fn take(&mut self, index: usize, repeat: u32) -> Result<Vec<Sample>, MeasureError> {
        let cell = &self.plan.cells[index];
        if cell.is_simulated() {
            let mut subject = (self.open)(cell, &self.plan.options)?;
            if self.plan.warms_up {
                subject.sample(repeat)?;
            }
            return subject.sample(repeat);
        }
        if !self.ready.contains_key(&index) {
            let mut subject = (self.open)(cell, &self.plan.options)?;
            subject.sample(repeat)?;
            self.ready.insert(index, subject);
        }
        let lost = Sample { metric: "lost_time", frame: None, value: lost_time() };
        let subject = self.ready.get_mut(&index).expect("it was made ready above");
        let mut samples = subject.sample(repeat)?;
        samples.push(lost);
        Ok(samples)
    }

    fn speedups(&self, cell: &Cell, repeat: u32, total: f64) -> Vec<Sample> {
        let against = |metric, base: &Cell| {
            let base = self.totals.get(&base.key(repeat))?;
            Some(Sample { metric, frame: None, value: base / total })
        };
        let alone = Cell { processors: 1, ..cell.clone() };
        let serial = self.plan.serial_of(cell).and_then(|serial| against("speedup", serial));
        serial.into_iter().chain(against("speedup_self", &alone)).collect()
    }
}

fn row(id: &str, key: &CellKey, sample: &Sample) -> Result<Row, MeasureError> {
    let declared = metric(sample.metric).ok_or_else(|| {
        MeasureError::Failed(format!("metric `{}` is not declared in record", sample.metric))
    })?;
    Ok(Row {
        run: id.to_owned(),
        experiment: key.experiment.clone(),
        job: key.job.clone(),
        scene: key.scene.clone(),
        structure: key.structure.clone(),
        scheme: key.scheme.clone(),
        settings: key.settings.clone(),
        machine: key.machine.clone(),
        processors: key.processors,
        repeat: key.repeat,
        frame: sample.frame,
        metric: declared.name.to_owned(),
        unit: declared.unit.to_owned(),
        value: sample.value,
    })
}
