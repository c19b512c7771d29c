//! A run as the report sees it: what its folder holds, and what is drawn from that.

use super::draw::sheet;
use super::escape::anchor;
use super::figure::{self, Figure, Panel};
use super::{ReportError, vega};
use crate::record::{Meta, Question, RecordError, Row, RunFolder, read_rows};

/// A run that is to be shown.
#[derive(Clone, Debug)]
pub struct Run {
    /// What was run, where and when.
    pub meta: Meta,
    /// What it asked, and what the paper printed.
    pub question: Question,
    /// Its rows.
    pub rows: Vec<Row>,
    /// Its `timeline.json`, where it was traced.
    pub timeline: Option<String>,
    /// The way from the page to the run's folder, with slashes.
    pub link: String,
}

/// A file drawn from a run, to lie beside its rows.
#[derive(Clone, Debug)]
pub struct Chart {
    /// What to call it: `speedup-e4000-factory-large.svg`.
    pub file_name: String,
    /// What is in it: SVG, or a Vega-Lite specification.
    pub text: String,
}

impl Run {
    /// Reads a run's folder; the link is the folder's path until the caller sets another.
    ///
    /// # Errors
    /// One of its files cannot be read, or holds something else.
    pub fn read(folder: &RunFolder) -> Result<Self, ReportError> {
        let path = folder.timeline();
        let timeline = match std::fs::read_to_string(&path) {
            Ok(text) => Some(text),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
            Err(source) => return Err(RecordError::File { what: "read", path, source }.into()),
        };
        if let Some(message) = timeline.as_deref().and_then(figure::wrong) {
            return Err(ReportError::Timeline { path, message });
        }
        Ok(Self {
            meta: Meta::read(&folder.meta())?,
            question: Question::read(&folder.experiment())?,
            rows: read_rows(&folder.rows())?,
            timeline,
            link: folder.path().display().to_string(),
        })
    }

    /// The files that lie beside its rows: a chart a file, and a specification a kind of chart.
    ///
    /// # Errors
    /// The drawing library refused.
    pub fn charts(&self) -> Result<Vec<Chart>, ReportError> {
        let mut charts = Vec::new();
        for figure in figure::figures(self) {
            for (file_name, panels) in files(&figure) {
                charts.push(Chart { file_name, text: sheet(&self.question.title, &figure, &panels)? });
            }
            if let Some(text) = vega::specification(&self.question.title, &figure) {
                charts.push(Chart { file_name: vega_name(&figure), text });
            }
        }
        Ok(charts)
    }
}

/// The SVG files of a figure. Those of speedups hold a panel each, to be shown by themselves.
pub(crate) fn files(figure: &Figure) -> Vec<(String, Vec<&Panel>)> {
    if figure.kind != "speedup" {
        return vec![(format!("{}.svg", anchor(&figure.kind)), figure.panels.iter().collect())];
    }
    figure.panels.iter().map(|panel| (format!("speedup-{}.svg", panel.file), vec![panel])).collect()
}

/// The file of a figure's specification.
pub(crate) fn vega_name(figure: &Figure) -> String {
    format!("{}.vl.json", anchor(&figure.kind))
}
