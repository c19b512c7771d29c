//! The runs behind an advice.

use super::{Choice, FRAMES, Question};
use crate::machine::Threads;
use crate::machine::simulated::Model;
use crate::measure::noise::lost_time;
use crate::measure::subject::{open, scene};
use crate::measure::{
    Cell, Known, MeasureError, Options, Sample, Subject, SubjectCache, calibrate, near, processor_list,
};
use crate::record::THREADS;
use crate::record::statistics::{Interval, interval, median, ratio_interval};
use crate::scheme::tree::{SCHEMES, processor_levels};
use crate::structure::{AabbTree, SkipTree, TreeStatistics};
use std::collections::BTreeMap;

/// Interleaved repeats on real threads.
const REPEATS: u32 = 25;
/// Paths that `auto` learns from before it is measured.
const LESSONS: usize = 8;
/// Times as long as at its best that a scheme may take on more processors.
const HOPELESS: f64 = 1.5;
/// Beyond so much of a core lost to other work, per cent, what is measured tells of that work.
const BUSY: f64 = 10.0;
const SEED: u64 = 1;
/// Jobs that go through a scene.
const JOBS: [&str; 1] = ["cull"];
/// What a model fitted on the spot is called here.
const FITTED: &str = "host";

/// A scene, made ready to be tried.
pub(super) struct Probe {
    question: Question,
    /// The simulated machine that predicts.
    simulated: String,
    /// Processors that may be used.
    pub(super) processors: u32,
    pub(super) shape: TreeStatistics,
    pub(super) notes: Vec<String>,
    options: Options,
    cache: SubjectCache,
}

/// The serial run.
pub(super) struct Serial {
    /// Nodes visited a frame, mean.
    pub(super) visited: f64,
    /// A frame, mean, nanoseconds.
    pub(super) frame: f64,
}

impl Probe {
    pub(super) fn new(
        question: &Question,
        progress: &mut (dyn FnMut(&str) + Send),
    ) -> Result<Self, MeasureError> {
        if !JOBS.contains(&question.job.as_str()) {
            let (kind, name) = ("job that goes through a scene", question.job.clone());
            return Err(MeasureError::Unknown { kind, near: near(&name, JOBS), name });
        }
        if let Some(count) = question.processors {
            let simulated = question.machine != THREADS;
            processor_list(&count.to_string(), count, simulated).map_err(MeasureError::Words)?;
        }
        let mut cache = SubjectCache::default();
        let mut notes = Vec::new();
        let (simulated, there) = if question.machine == THREADS {
            progress("fitting the model of this computer");
            match calibrate::calibrate(&mut |_| ()) {
                Ok(fitted) => cache.provide(FITTED, fitted.model),
                Err(error) => notes.push(format!("predicted with the preset `{FITTED}`: {error}")),
            }
            (FITTED.to_owned(), Threads::cores())
        } else {
            let name = &question.machine;
            let model = Model::named(name).map_err(|error| {
                if name.ends_with(".toml") {
                    return MeasureError::Failed(error.to_string());
                }
                let known = Known::here().machines;
                let near = near(name, known.iter().map(String::as_str));
                MeasureError::Unknown { kind: "machine", name: name.clone(), near }
            })?;
            (name.clone(), model.processors)
        };
        progress("reading the scene");
        let shape = TreeStatistics::of(&SkipTree::build(&AabbTree::build(&scene(&question.scene)?)));
        Ok(Probe {
            question: question.clone(),
            simulated,
            processors: question.processors.unwrap_or(there as u32),
            shape,
            notes,
            options: Options {
                frames: FRAMES,
                path_frames: None,
                repeats: 1,
                until: None,
                seed: SEED,
                path: None,
            },
            cache,
        })
    }

    /// Cores of this computer.
    pub(super) fn cores(&self) -> u32 {
        Threads::cores() as u32
    }

    fn open(
        &mut self,
        scheme: &str,
        machine: &str,
        processors: u32,
    ) -> Result<Box<dyn Subject>, MeasureError> {
        let cell = Cell {
            experiment: "advise".to_owned(),
            job: self.question.job.clone(),
            scene: self.question.scene.clone(),
            structure: "skip_tree".to_owned(),
            scheme: scheme.to_owned(),
            settings: BTreeMap::new(),
            machine: machine.to_owned(),
            processors,
        };
        open(&cell, &self.options, &mut self.cache)
    }

    /// The serial run on the machine asked for.
    pub(super) fn serial(&mut self) -> Result<Serial, MeasureError> {
        let machine = self.question.machine.clone();
        let mut subject = self.open("serial", &machine, 1)?;
        // The first warms up.
        subject.sample(0)?;
        let samples = subject.sample(0)?;
        let times = frame_times(&samples);
        let visited = samples.iter().find(|sample| sample.metric == "nodes_visited");
        Ok(Serial {
            visited: visited.map_or(0.0, |sample| sample.value),
            frame: times.iter().sum::<f64>() / times.len().max(1) as f64,
        })
    }

    /// Every scheme that can be simulated, on 2, 4, 8, … processors, until it takes [`HOPELESS`] times as
    /// long as at its best: beyond, nothing is to be had, and to simulate it takes longer and longer.
    pub(super) fn predict(
        &mut self,
        progress: &mut (dyn FnMut(&str) + Send),
    ) -> Result<Vec<Choice>, MeasureError> {
        let machine = self.simulated.clone();
        let serial = frame_times(&self.open("serial", &machine, 1)?.sample(0)?);
        let mut all = Vec::new();
        for about in SCHEMES.iter().filter(|about| !about.native_only && !about.learns) {
            if about.name == "serial" {
                continue;
            }
            let mut most = 0.0_f64;
            for processors in processor_levels(self.processors as usize) {
                progress(&format!("{} on {processors} processors, simulated", about.name));
                let processors = processors as u32;
                let times = frame_times(&self.open(about.name, &machine, processors)?.sample(0)?);
                let predicted = ratio_interval(&serial, &times, SEED);
                all.push(Choice { scheme: about.name, processors, predicted, measured: None });
                let speedup = predicted.map_or(0.0, |interval| interval.median);
                most = most.max(speedup);
                if HOPELESS * speedup < most {
                    break;
                }
            }
        }
        Ok(all)
    }

    /// Runs some of the choices on real threads, interleaved; returns what `auto` reached beside them.
    pub(super) fn check(
        &mut self,
        tried: &mut [Choice],
        which: &[usize],
        progress: &mut (dyn FnMut(&str) + Send),
    ) -> Result<Option<Interval>, MeasureError> {
        let most = self.processors.min(self.cores());
        if which.is_empty() || most < 2 {
            return Ok(None);
        }
        progress("the best few on real threads");
        let mut subjects = vec![self.open("serial", THREADS, 1)?, self.open("auto", THREADS, most)?];
        for &choice in which {
            let Choice { scheme, processors, .. } = tried[choice];
            subjects.push(self.open(scheme, THREADS, processors)?);
        }
        for subject in &mut subjects {
            subject.sample(0)?;
        }
        for _ in 0..LESSONS {
            subjects[1].sample(0)?;
        }
        let mut speedups = vec![Vec::new(); subjects.len()];
        let mut lost = Vec::new();
        for repeat in 0..REPEATS {
            lost.push(lost_time());
            let mut totals = Vec::new();
            for subject in &mut subjects {
                // The first path warms up again: the caches hold what the others left.
                subject.sample(repeat)?;
                totals.push(frame_times(&subject.sample(repeat)?).iter().sum::<f64>());
            }
            for (speedups, total) in speedups.iter_mut().zip(&totals) {
                speedups.push(totals[0] / total);
            }
        }
        let lost = median(&lost).unwrap_or_default();
        if lost > BUSY {
            self.notes
                .push(format!("other work takes {lost:.0} % of a core here: ask again when it is done"));
        }
        for (&choice, speedups) in which.iter().zip(&speedups[2..]) {
            tried[choice].measured = interval(speedups, SEED);
        }
        Ok(interval(&speedups[1], SEED))
    }
}

fn frame_times(samples: &[Sample]) -> Vec<f64> {
    samples.iter().filter(|sample| sample.metric == "frame_time").map(|sample| sample.value).collect()
}
