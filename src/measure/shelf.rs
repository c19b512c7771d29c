//! Where experiments are found: in `./experiments`, else among those the program carries along.

use super::{Experiment, Known, MeasureError, near};
use std::collections::BTreeMap;
use std::io::{self, ErrorKind};
use std::path::Path;

const CARRIED: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/experiments.rs"));

/// All experiments there are, by name; a file in the folder hides the one carried along under the same name.
#[derive(Debug)]
pub struct Shelf {
    /// Name to what errors call the file, and its text or why there is none.
    texts: BTreeMap<String, (String, io::Result<String>)>,
}

impl Shelf {
    /// Looks through the folder, which may be absent. A file that cannot be read hides no other: it is told to
    /// who asks for it.
    ///
    /// # Errors
    /// The folder is there and cannot be listed.
    pub fn open(folder: &Path) -> Result<Self, MeasureError> {
        let mut texts: BTreeMap<String, (String, io::Result<String>)> = CARRIED
            .iter()
            .map(|(name, text)| ((*name).to_owned(), (format!("{name}.toml"), Ok((*text).to_owned()))))
            .collect();
        let failed = |source| MeasureError::File { path: folder.to_path_buf(), source };
        let entries = match std::fs::read_dir(folder) {
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => None,
            entries => Some(entries.map_err(failed)?),
        };
        for entry in entries.into_iter().flatten() {
            let path = entry.map_err(failed)?.path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                texts.insert(name, (path.display().to_string(), std::fs::read_to_string(&path)));
            }
        }
        Ok(Self { texts })
    }

    /// The names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.texts.keys().map(String::as_str)
    }

    /// What errors call an experiment's file.
    pub fn file<'a>(&'a self, name: &'a str) -> &'a str {
        self.texts.get(name).map_or(name, |(file, _)| file)
    }

    /// The experiment's file as text.
    ///
    /// # Errors
    /// There is none of that name, or its file cannot be read.
    pub fn text(&self, name: &str) -> Result<&str, MeasureError> {
        self.find(name).map(|(_, text)| text)
    }

    /// The experiment, read and checked.
    ///
    /// # Errors
    /// There is none of that name, or its file is off.
    pub fn load(&self, name: &str, known: &Known) -> Result<Experiment, MeasureError> {
        let (file, text) = self.find(name)?;
        Experiment::parse(name, file, text, known)
    }

    /// What errors call the experiment's file, and its text.
    fn find(&self, name: &str) -> Result<(&str, &str), MeasureError> {
        let (file, text) = self.texts.get(name).ok_or_else(|| MeasureError::Unknown {
            kind: "experiment",
            name: name.to_owned(),
            near: near(name, self.names()),
        })?;
        match text {
            Ok(text) => Ok((file, text)),
            Err(error) => Err(MeasureError::File {
                path: file.into(),
                source: io::Error::new(error.kind(), error.to_string()),
            }),
        }
    }
}
