//! An experiment's file: one question, as data.

use super::{Known, MeasureError, Value, near, processor_list};
use crate::record::{PaperFigure, THREADS, metric, settings_pairs};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// Settings that concern every scheme and machine begin with one of these words and a point.
pub(crate) const SHARED: [&str; 5] = ["job", "scene", "structure", "machine", "scheme"];

/// An experiment, checked: its names are known, its lists can be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// Its name: the file's, without `.toml`.
    pub name: String,
    /// One line for `apportion list`.
    pub title: String,
    /// The paper and figure it reproduces; empty for a question of our own.
    pub reproduces: String,
    /// The job's word.
    pub job: String,
    /// The scenes; none where the user has to bring one.
    pub scenes: Vec<String>,
    /// The structure built over the scene.
    pub structure: String,
    /// Frames of the camera path.
    pub frames: u32,
    /// Frames where it has to be quick.
    pub quick_frames: u32,
    /// Interleaved repeats on real threads; a simulated machine runs once, for it says the same each time.
    pub repeats: u32,
    /// The machines.
    pub machines: Vec<String>,
    /// The list of processor counts of each machine, as written; `*` for those not named.
    pub processors: BTreeMap<String, String>,
    /// The schemes.
    pub schemes: Vec<String>,
    /// Settings that stay.
    pub settings: BTreeMap<String, Value>,
    /// Settings that vary: every combination is run.
    pub sweep: BTreeMap<String, Vec<Value>>,
    /// What the paper printed.
    pub paper: Vec<PaperFigure>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    title: String,
    #[serde(default)]
    reproduces: String,
    job: Spanned<String>,
    scene: Option<Scenes>,
    structure: Option<Spanned<String>>,
    frames: Spanned<u32>,
    quick_frames: Spanned<u32>,
    repeats: Spanned<u32>,
    machines: Vec<Spanned<String>>,
    processors: BTreeMap<String, Spanned<String>>,
    schemes: Vec<Spanned<String>>,
    #[serde(default)]
    settings: BTreeMap<String, Spanned<Value>>,
    #[serde(default)]
    sweep: BTreeMap<String, Spanned<Vec<Value>>>,
    #[serde(default)]
    paper: Vec<Spanned<PaperFigure>>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a scene's name or a list of them")]
enum Scenes {
    One(String),
    Many(Vec<String>),
}

/// The structures jobs go through, the one of an experiment that names none first.
const STRUCTURES: &[&str] = &["skip_tree", "boxes", "volume_tree", "bvh"];

impl Experiment {
    /// Reads and checks an experiment; `file` is what errors call it.
    ///
    /// # Errors
    /// Naming file and line: no TOML, an unknown key, a name that is not `known`, a list that cannot be read.
    pub fn parse(name: &str, file: &str, text: &str, known: &Known) -> Result<Self, MeasureError> {
        // Some editors begin a file with a byte order mark.
        let text = text.trim_start_matches('\u{feff}');
        let wrong = |at: usize, message: String| MeasureError::Experiment {
            file: file.to_owned(),
            line: text[..at.min(text.len())].matches('\n').count() + 1,
            message,
        };
        let parsed: File = toml::from_str(text)
            .map_err(|error| wrong(error.span().map_or(0, |span| span.start), error.message().to_owned()))?;
        check(&parsed, known).map_err(|(at, message)| wrong(at, message))?;
        Ok(Self {
            name: name.to_owned(),
            title: parsed.title,
            reproduces: parsed.reproduces,
            job: parsed.job.into_inner(),
            scenes: match parsed.scene {
                None => Vec::new(),
                Some(Scenes::One(scene)) => vec![scene],
                Some(Scenes::Many(scenes)) => scenes,
            },
            structure: parsed.structure.map_or_else(|| STRUCTURES[0].to_owned(), Spanned::into_inner),
            frames: parsed.frames.into_inner(),
            quick_frames: parsed.quick_frames.into_inner(),
            repeats: parsed.repeats.into_inner(),
            machines: parsed.machines.into_iter().map(Spanned::into_inner).collect(),
            processors: inner(parsed.processors),
            schemes: parsed.schemes.into_iter().map(Spanned::into_inner).collect(),
            settings: inner(parsed.settings),
            sweep: inner(parsed.sweep),
            paper: parsed.paper.into_iter().map(Spanned::into_inner).collect(),
        })
    }
}

fn inner<T>(map: BTreeMap<String, Spanned<T>>) -> BTreeMap<String, T> {
    map.into_iter().map(|(key, value)| (key, value.into_inner())).collect()
}

/// What to say of a scheme for work of another shape than a job has.
pub(super) fn does_not_suit(job: &str, scheme: &str, known: &Known) -> String {
    format!(
        "scheme `{scheme}` is for work of another shape than job `{job}` has; expected one of: {}",
        known.schemes_of(job)
    )
}

/// What is wrong, and at which byte of the file.
type Wrong = (usize, String);

fn check(file: &File, known: &Known) -> Result<(), Wrong> {
    one_of("job", &file.job, &known.jobs)?;
    if let Some(structure) = &file.structure {
        one_of("structure", structure, &STRUCTURES.iter().map(|&name| name.to_owned()).collect::<Vec<_>>())?;
    }
    for machine in &file.machines {
        one_of("machine", machine, &known.machines)?;
        if !file.processors.contains_key(machine.get_ref()) && !file.processors.contains_key("*") {
            let message =
                format!("`processors` says nothing of `{0}`: expected a key `{0}` or `*`", machine.get_ref());
            return Err((machine.span().start, message));
        }
    }
    for scheme in &file.schemes {
        one_of("scheme", scheme, &known.schemes)?;
        if !(known.suits)(file.job.get_ref(), scheme.get_ref()) {
            return Err((scheme.span().start, does_not_suit(file.job.get_ref(), scheme.get_ref(), known)));
        }
    }
    for (machine, list) in &file.processors {
        // `1-cores` must be a list on every computer, so it is checked as if there were the most cores threads can use.
        processor_list(list.get_ref(), 256, machine != THREADS)
            .map_err(|message| (list.span().start, message))?;
    }
    for count in [&file.frames, &file.quick_frames, &file.repeats] {
        if *count.get_ref() == 0 {
            return Err((count.span().start, "expected at least 1".to_owned()));
        }
    }
    let keys = file.settings.iter().map(|(key, value)| (key, value.span().start));
    let swept = file.sweep.iter().map(|(key, values)| (key, values.span().start));
    for (key, at) in keys.chain(swept) {
        let owners = file.schemes.iter().chain(&file.machines).map(|name| name.get_ref().as_str());
        let mut owners = SHARED.into_iter().chain(owners);
        if !key.split_once('.').is_some_and(|(owner, _)| owners.any(|other| other == owner)) {
            let message = format!(
                "setting `{key}`: expected `job.`, `scene.`, `structure.`, `machine.`, `scheme.`, or the name of a scheme or machine above, then its key"
            );
            return Err((at, message));
        }
    }
    if let Some((key, values)) = file.sweep.iter().find(|(_, values)| values.get_ref().is_empty()) {
        return Err((values.span().start, format!("sweep of `{key}`: expected at least one value")));
    }
    file.paper.iter().try_for_each(|figure| check_figure(figure, file))
}

fn check_figure(spanned: &Spanned<PaperFigure>, file: &File) -> Result<(), Wrong> {
    let (at, figure) = (spanned.span().start, spanned.get_ref());
    if !file.schemes.iter().any(|scheme| *scheme.get_ref() == figure.scheme) {
        return Err((at, format!("paper figure of `{}`: expected one of `schemes`", figure.scheme)));
    }
    if metric(&figure.metric).is_none_or(|metric| metric.unit != figure.unit) {
        return Err((at, format!("no metric `{}` in `{}` is declared", figure.metric, figure.unit)));
    }
    if settings_pairs(&figure.settings).any(|(_, value)| value.is_empty()) {
        return Err((at, format!("settings `{}`: expected `key=value;key=value`", figure.settings)));
    }
    Ok(())
}

fn one_of(kind: &str, name: &Spanned<String>, names: &[String]) -> Result<(), Wrong> {
    if names.contains(name.get_ref()) {
        return Ok(());
    }
    let near = near(name.get_ref(), names.iter().map(String::as_str));
    Err((name.span().start, format!("there is no {kind} `{}`{near}", name.get_ref())))
}
