//! Where experiments are found: in `./experiments`, else among those the program carries along.

use super::{Experiment, Known, MeasureError, near};
use std::collections::BTreeMap;
use std::path::Path;

const CARRIED: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/experiments.rs"));

/// All experiments there are, by name; a file in the folder hides the one carried along under the same name.
#[derive(Debug)]
pub struct Shelf {
    /// Name to what errors call the file, and its text.
    texts: BTreeMap<String, (String, String)>,
}

impl Shelf {
    /// Looks through the folder, which may be absent.
    ///
    /// # Errors
    /// A file of the folder cannot be read.
    pub fn open(folder: &Path) -> Result<Self, MeasureError> {
        let mut texts: BTreeMap<String, (String, String)> = CARRIED
            .iter()
            .map(|(name, text)| ((*name).to_owned(), (format!("{name}.toml"), (*text).to_owned())))
            .collect();
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                let text = std::fs::read_to_string(&path)
                    .map_err(|source| MeasureError::File { path: path.clone(), source })?;
                texts.insert(name, (path.display().to_string(), text));
            }
        }
        Ok(Self { texts })
    }

    /// The names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.texts.keys().map(String::as_str)
    }

    /// The experiment's file as text.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn text(&self, name: &str) -> Result<&str, MeasureError> {
        self.find(name).map(|(_, text)| text.as_str())
    }

    /// The experiment, read and checked.
    ///
    /// # Errors
    /// There is none of that name, or its file is off.
    pub fn load(&self, name: &str, known: &Known) -> Result<Experiment, MeasureError> {
        let (file, text) = self.find(name)?;
        Experiment::parse(name, file, text, known)
    }

    fn find(&self, name: &str) -> Result<&(String, String), MeasureError> {
        self.texts.get(name).ok_or_else(|| MeasureError::Unknown {
            kind: "experiment",
            name: name.to_owned(),
            near: near(name, self.names()),
        })
    }
}
