//! From an experiment and the words of the command line to the list of cells.

mod scenes;

use super::experiment::{SHARED, does_not_suit};
use super::until::FEWEST;
use super::{Experiment, Known, MeasureError, Until, Value, near, processor_list};
use crate::machine::simulated::Model;
use crate::record::{CellKey, THREADS};
pub(super) use scenes::PAIR;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// With `--quick` no more repeats than this: enough for a median.
const QUICK_REPEATS: u32 = 3;

/// One scheme, with its settings, over one scene, on one machine with so many processors.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// The experiment's name.
    pub experiment: String,
    /// The job's word.
    pub job: String,
    /// A generator's name or a file's path.
    pub scene: String,
    /// The structure built over the scene.
    pub structure: String,
    /// The scheme's word.
    pub scheme: String,
    /// Settings with their whole keys: `job.work`, `lock_free.receivers`.
    pub settings: BTreeMap<String, Value>,
    /// The machine's word.
    pub machine: String,
    /// How many processors take part.
    pub processors: u32,
}

/// What a run was narrowed to on the command line; kept in `meta.json` for a later `--resume`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Selection {
    /// Machines; none for the experiment's.
    pub machines: Vec<String>,
    /// A list of processor counts for every machine.
    pub processors: Option<String>,
    /// Schemes; none for the experiment's. The serial one stays, as every speedup is held against it.
    pub schemes: Vec<String>,
    /// Scenes in place of the experiment's; none for those. Where the experiment's are pairs, two make one.
    #[serde(rename = "scene", deserialize_with = "scenes::one_or_many")]
    pub scenes: Vec<String>,
    /// A recorded camera path.
    pub path: Option<PathBuf>,
    /// Frames in place of the experiment's.
    pub frames: Option<u32>,
    /// The seed of all randomness; 1 where absent.
    pub seed: Option<u64>,
    /// Repeats in place of the experiment's.
    pub repeats: Option<u32>,
    /// Repeats go on until no speedup's interval is wider than this many per cent of its median either way.
    pub until: Option<f64>,
    /// The time limit of that, seconds; [`Selection::AT_MOST`] where absent.
    pub at_most: Option<u64>,
    /// Fewer frames and repeats: to see that it runs, not how fast.
    pub quick: bool,
}

impl Selection {
    /// How long `until` goes on where nothing is said, seconds: as long as one waits with a cup of coffee.
    pub const AT_MOST: u64 = 300;
}

/// What holds for all cells of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Frames of the camera path.
    pub frames: u32,
    /// As many frames of a recorded path as were asked for; none for all it has.
    pub path_frames: Option<u32>,
    /// Interleaved repeats on real threads.
    pub repeats: u32,
    /// Whether and how long repeats go on beyond those.
    pub until: Option<Until>,
    /// The seed of all randomness.
    pub seed: u64,
    /// A recorded camera path.
    pub path: Option<PathBuf>,
}

/// The cells of a run, each serial one before those that are held against it.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The cells, in the order they run in within a repeat.
    pub cells: Vec<Cell>,
    /// What holds for all of them.
    pub options: Options,
    /// Whether simulated cells too are warmed up by a path that is not recorded: one of their schemes
    /// learns, and the others are to have the caches as warm.
    pub warms_up: bool,
}

impl Plan {
    /// The cells an experiment asks for, narrowed by a selection, on a computer with so many cores.
    ///
    /// # Errors
    /// An unknown name, a list that cannot be read, a scene the user has to bring and did not, or no cell left.
    pub fn new(
        experiment: &Experiment,
        selection: &Selection,
        known: &Known,
        cores: u32,
    ) -> Result<Self, MeasureError> {
        let options = options(experiment, selection)?;
        let scenes = scenes::of(experiment, &selection.scenes)?;
        if scenes.is_empty() {
            return Err(MeasureError::Words(format!(
                "experiment {} needs --scene FILE|NAME",
                experiment.name
            )));
        }
        let machines = machines(experiment, selection, known)?;
        let schemes = schemes(experiment, selection, known)?;
        let mut cells: Vec<Cell> = Vec::new();
        for (scene, machine) in
            scenes.iter().flat_map(|scene| machines.iter().map(move |machine| (scene, machine)))
        {
            let counts = counts(experiment, selection, machine, cores)?;
            let model = named_in_file(machine);
            for settings in combinations(experiment) {
                for scheme in &schemes {
                    let counts = if is_serial(scheme) { &[1][..] } else { &counts };
                    for &processors in counts.iter().filter(|&&count| (known.fits)(scheme, machine, count)) {
                        let cell = Cell {
                            experiment: experiment.name.clone(),
                            job: experiment.job.clone(),
                            scene: scene.clone(),
                            structure: experiment.structure.clone(),
                            scheme: scheme.clone(),
                            settings: own_settings(&settings, scheme, machine, model.as_deref()),
                            machine: machine.clone(),
                            processors,
                        };
                        // A sweep of one scheme's setting repeats the cells of the others.
                        if !cells.contains(&cell) {
                            cells.push(cell);
                        }
                    }
                }
            }
        }
        if cells.is_empty() {
            let message =
                format!("nothing of experiment {} can run on these machines and processors", experiment.name);
            return Err(MeasureError::Words(message));
        }
        let warms_up = cells.iter().any(|cell| (known.learns)(&cell.scheme));
        Ok(Self { cells, options, warms_up })
    }

    /// The serial cell that a cell's speedup is held against: same scene, machine and settings of the job and machine.
    pub fn serial_of(&self, cell: &Cell) -> Option<&Cell> {
        self.cells.iter().find(|other| {
            is_serial(&other.scheme)
                && other.processors == 1
                && (&other.scene, &other.machine) == (&cell.scene, &cell.machine)
                && other.common_settings().eq(cell.common_settings())
        })
    }

    /// The counts of processors an experiment asks for on a machine, on a computer with so many cores; none for a
    /// machine it says nothing of.
    pub fn whole_counts(experiment: &Experiment, machine: &str, cores: u32) -> Vec<u32> {
        counts(experiment, &Selection::default(), machine, cores).unwrap_or_default()
    }

    /// How often a cell runs at least: a simulated machine says the same each time.
    pub fn repeats(&self, cell: &Cell) -> u32 {
        if cell.is_simulated() { 1 } else { self.options.repeats }
    }
}

impl Cell {
    /// Whether its machine is a simulated one.
    pub fn is_simulated(&self) -> bool {
        self.machine != THREADS
    }

    /// The settings as rows hold them: `key=value;key=value`, sorted.
    pub fn settings_text(&self) -> String {
        let pairs: Vec<String> = self.settings.iter().map(|(key, value)| format!("{key}={value}")).collect();
        pairs.join(";")
    }

    /// The key of its rows in a repeat; a file of a scene or machine goes by its name, wherever it lies.
    pub fn key(&self, repeat: u32) -> CellKey {
        let named = |place: &str| {
            let name = Path::new(place).file_name().map(|name| name.to_string_lossy().into_owned());
            name.unwrap_or_else(|| place.to_owned())
        };
        CellKey {
            experiment: self.experiment.clone(),
            job: self.job.clone(),
            scene: self.scene.split(PAIR).map(named).collect::<Vec<_>>().join(PAIR),
            structure: self.structure.clone(),
            scheme: self.scheme.clone(),
            settings: self.settings_text(),
            machine: named(&self.machine),
            processors: self.processors,
            repeat,
        }
    }

    /// Settings that are not a scheme's.
    fn common_settings(&self) -> impl Iterator<Item = (&String, &Value)> {
        self.settings.iter().filter(|(key, _)| {
            let owner = key.split('.').next().unwrap_or_default();
            owner == self.machine || (owner != "scheme" && SHARED.contains(&owner))
        })
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} {} on {} x {}", self.scene, self.scheme, self.machine, self.processors)?;
        if self.settings.is_empty() { Ok(()) } else { write!(out, " ({})", self.settings_text()) }
    }
}

fn is_serial(scheme: &str) -> bool {
    scheme == "serial"
}

fn options(experiment: &Experiment, selection: &Selection) -> Result<Options, MeasureError> {
    let quick = selection.quick;
    let frames = if quick { experiment.quick_frames } else { experiment.frames };
    let repeats = if quick { experiment.repeats.min(QUICK_REPEATS) } else { experiment.repeats };
    let until = selection.until.map(|percent| Until {
        percent,
        at_most: Duration::from_secs(selection.at_most.unwrap_or(Selection::AT_MOST)),
    });
    if until.is_some_and(|until| !(until.percent > 0.0 && until.percent <= 100.0)) {
        return Err(MeasureError::Words("--until goes from above 0 to 100 per cent".to_owned()));
    }
    let repeats = selection.repeats.unwrap_or(repeats);
    let options = Options {
        frames: selection.frames.unwrap_or(frames),
        path_frames: selection.frames,
        repeats: if until.is_some() && repeats > 0 { repeats.max(FEWEST) } else { repeats },
        until,
        seed: selection.seed.unwrap_or(1),
        path: selection.path.clone(),
    };
    if options.frames == 0 || options.repeats == 0 {
        return Err(MeasureError::Words("--frames and --repeats start at 1".to_owned()));
    }
    Ok(options)
}

fn machines(
    experiment: &Experiment,
    selection: &Selection,
    known: &Known,
) -> Result<Vec<String>, MeasureError> {
    if selection.machines.is_empty() || selection.machines.iter().any(|machine| machine == "all") {
        return Ok(experiment.machines.clone());
    }
    let (files, names): (Vec<_>, Vec<_>) =
        selection.machines.iter().cloned().partition(|machine| machine.ends_with(".toml"));
    all_known("machine", &names, &known.machines)?;
    for file in &files {
        Model::named(file).map_err(|error| MeasureError::Failed(error.to_string()))?;
    }
    Ok(selection.machines.clone())
}

fn schemes(
    experiment: &Experiment,
    selection: &Selection,
    known: &Known,
) -> Result<Vec<String>, MeasureError> {
    let mut schemes = experiment.schemes.clone();
    if !selection.schemes.is_empty() {
        all_known("scheme", &selection.schemes, &known.schemes)?;
        let job = &experiment.job;
        if let Some(scheme) = selection.schemes.iter().find(|scheme| !(known.suits)(job, scheme)) {
            return Err(MeasureError::Words(does_not_suit(job, scheme, known)));
        }
        schemes.retain(|scheme| is_serial(scheme));
        schemes.extend(selection.schemes.iter().filter(|scheme| !is_serial(scheme)).cloned());
    }
    // Stable: the serial scheme first, the others as listed.
    schemes.sort_by_key(|scheme| !is_serial(scheme));
    Ok(schemes)
}

fn all_known(kind: &'static str, names: &[String], known: &[String]) -> Result<(), MeasureError> {
    match names.iter().find(|name| !known.contains(name)) {
        None => Ok(()),
        Some(name) => {
            let near = near(name, known.iter().map(String::as_str));
            Err(MeasureError::Unknown { kind, name: name.clone(), near })
        }
    }
}

fn counts(
    experiment: &Experiment,
    selection: &Selection,
    machine: &str,
    cores: u32,
) -> Result<Vec<u32>, MeasureError> {
    let lists = &experiment.processors;
    let list = selection.processors.as_ref().or_else(|| lists.get(machine));
    let of_model = || named_in_file(machine).and_then(|model| lists.get(&model));
    let list = list.or_else(of_model).or_else(|| lists.get("*"));
    let list = list.ok_or_else(|| {
        MeasureError::Words(format!(
            "experiment {} lists no processors for {machine}: add --processors",
            experiment.name
        ))
    })?;
    processor_list(list, cores, machine != THREADS).map_err(MeasureError::Words)
}

/// Every combination of the sweep's values, each with the settings that stay.
fn combinations(experiment: &Experiment) -> Vec<BTreeMap<String, Value>> {
    let mut all = vec![experiment.settings.clone()];
    for (key, values) in &experiment.sweep {
        let with = |settings: &BTreeMap<String, Value>, value: &Value| {
            let mut settings = settings.clone();
            settings.insert(key.clone(), value.clone());
            settings
        };
        all = all.iter().flat_map(|settings| values.iter().map(move |value| with(settings, value))).collect();
    }
    all
}

/// The settings without those of other schemes and machines. Those of the machine a file describes (`e4000.memory`
/// where the file's name is `mine.toml` and its `name` `e4000`) become those of the machine in use.
fn own_settings(
    settings: &BTreeMap<String, Value>,
    scheme: &str,
    machine: &str,
    model: Option<&str>,
) -> BTreeMap<String, Value> {
    let owner = |key: &str| key.split('.').next().unwrap_or_default().to_owned();
    let own = |key: &str| {
        let owner = owner(key);
        SHARED.contains(&&*owner) || owner == scheme || owner == machine
    };
    let pair = |(key, value): (&String, &Value)| (key.clone(), value.clone());
    let mut all: BTreeMap<String, Value> = settings.iter().filter(|(key, _)| own(key)).map(pair).collect();
    let of_model = settings.iter().filter(|(key, _)| model == Some(&*owner(key)));
    all.extend(of_model.map(|(key, value)| (key.replacen(&*owner(key), "machine", 1), value.clone())));
    all
}

/// The name that a machine's file gives it; none of a machine that is no file.
fn named_in_file(machine: &str) -> Option<String> {
    machine.ends_with(".toml").then(|| Model::named(machine).ok()).flatten().map(|model| model.name)
}
