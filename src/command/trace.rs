//! `run --trace FILE`.

use anyhow::Result;
use apportion::measure::Tracer;
use apportion::record::{RunFolder, TracedFrame, check_trace_place, write_trace};
use std::path::{Path, PathBuf};

/// The file that all experiments of a command go into.
pub(crate) struct TraceFile {
    path: PathBuf,
    frames: Vec<TracedFrame>,
}

impl TraceFile {
    /// Checks the place before anything runs.
    pub(crate) fn new(path: &Path) -> Result<Self> {
        check_trace_place(path)?;
        Ok(Self { path: path.to_path_buf(), frames: Vec::new() })
    }

    /// Adds the frames of a run, however it ended, to the file, and writes them into its folder; returns what was
    /// written. A run that traced nothing leaves its folder as it was.
    pub(crate) fn add(&mut self, tracer: &Tracer, folder: &RunFolder) -> Result<Vec<PathBuf>> {
        let frames = tracer.take();
        for frame in frames.iter().filter(|frame| frame.lost > 0) {
            eprintln!(
                "apportion: trace of {}: {} marks found no room; the end of its frame {} is missing",
                frame.cell, frame.lost, frame.frame
            );
        }
        let mut written = Vec::new();
        if !frames.is_empty() {
            write_trace(&folder.timeline(), &frames)?;
            written.push(folder.timeline());
        }
        self.frames.extend(frames);
        write_trace(&self.path, &self.frames)?;
        written.push(self.path.clone());
        Ok(written)
    }
}
