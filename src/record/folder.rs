//! A run's folder: `results/<experiment>/<run id>`.

use super::{Meta, RecordError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The folder of one run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunFolder {
    path: PathBuf,
}

impl RunFolder {
    /// Makes the folder of a new run: `out` where given, else `results/<experiment>/<run>`.
    ///
    /// # Errors
    /// It cannot be made, or holds a run already.
    pub fn create(
        results: &Path,
        out: Option<&Path>,
        experiment: &str,
        run: &str,
    ) -> Result<Self, RecordError> {
        if let Some(out) = out {
            std::fs::create_dir_all(out).map_err(RecordError::file("create", out))?;
            let folder = Self::at(out);
            return if folder.rows().exists() || folder.meta().exists() {
                Err(RecordError::Taken { path: out.to_path_buf() })
            } else {
                Ok(folder)
            };
        }
        let parent = results.join(experiment);
        std::fs::create_dir_all(&parent).map_err(RecordError::file("create", &parent))?;
        // Two runs of the same second get a folder each: creating one is atomic, so the later of them goes on.
        for number in 1.. {
            let path = parent.join(if number == 1 { run.to_owned() } else { format!("{run}-{number}") });
            match std::fs::create_dir(&path) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                made => {
                    return made
                        .map(|()| Self { path: path.clone() })
                        .map_err(RecordError::file("create", &path));
                }
            }
        }
        unreachable!("folder names do not run out")
    }

    /// The folder at that place.
    pub fn at(path: &Path) -> Self {
        Self { path: path.to_path_buf() }
    }

    /// The newest run that still lacks cells.
    ///
    /// # Errors
    /// There is none.
    pub fn newest_unfinished(results: &Path, experiment: &str) -> Result<Self, RecordError> {
        Self::newest(results, experiment, "unfinished", |meta| meta.end.is_none())
    }

    /// The newest run that has all its cells; a committed reference run counts by its date, like the others.
    ///
    /// # Errors
    /// There is none.
    pub fn newest_finished(results: &Path, experiment: &str) -> Result<Self, RecordError> {
        Self::newest(results, experiment, "finished", |meta| meta.end.is_some())
    }

    fn newest(
        results: &Path,
        experiment: &str,
        what: &'static str,
        wanted: impl Fn(&Meta) -> bool,
    ) -> Result<Self, RecordError> {
        let path = results.join(experiment);
        let entries = std::fs::read_dir(&path).into_iter().flatten().flatten();
        let runs = entries.map(|entry| Self { path: entry.path() });
        runs.filter_map(|folder| Meta::read(&folder.meta()).ok().map(|meta| (meta, folder)))
            .filter(|(meta, _)| wanted(meta))
            .max_by(|(a, x), (b, y)| (&a.start, &x.path).cmp(&(&b.start, &y.path)))
            .map(|(_, folder)| folder)
            .ok_or_else(|| RecordError::NoRun { what, experiment: experiment.to_owned(), path })
    }

    /// The folder itself.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The log.
    pub fn rows(&self) -> PathBuf {
        self.path.join("rows.jsonl")
    }

    /// The table exported from the log.
    pub fn csv(&self) -> PathBuf {
        self.path.join("rows.csv")
    }

    /// What was run, where and when.
    pub fn meta(&self) -> PathBuf {
        self.path.join("meta.json")
    }

    /// What each processor did in one frame of each cell, if the run was traced.
    pub fn timeline(&self) -> PathBuf {
        self.path.join("timeline.json")
    }

    /// The experiment's file as it was when the run began.
    pub fn experiment(&self) -> PathBuf {
        self.path.join("experiment.toml")
    }
}
