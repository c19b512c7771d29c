//! The progress bar: on standard error, and only where that is a terminal.

use apportion::measure::Progress;
use indicatif::{ProgressBar, ProgressStyle};

/// A bar over the cells of a run, or the tiles of a picture.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    /// A bar that begins to show with the first cell.
    pub(crate) fn new(experiment: &str) -> Self {
        let style =
            ProgressStyle::with_template("{prefix} [{bar:30}] {pos}/{len} {elapsed}, {eta} left: {msg}");
        let bar = ProgressBar::no_length().with_prefix(experiment.to_owned());
        Self(bar.with_style(style.expect("the template is a constant that a test draws")))
    }

    /// A bar over the tiles of a picture.
    pub(crate) fn of_tiles(picture: &str, count: usize) -> Self {
        let Self(bar) = Self::new(picture);
        bar.set_length(count as u64);
        bar.set_message("tracing");
        Self(bar)
    }

    /// Shows that one more is done; any thread may say so.
    pub(crate) fn more(&self) {
        self.0.inc(1);
    }

    /// Shows which cell is next.
    pub(crate) fn show(&self, progress: Progress<'_>) {
        self.0.set_length(progress.total as u64);
        self.0.set_position(progress.done as u64);
        self.0.set_message(progress.cell.to_string());
    }

    /// Clears the line.
    pub(crate) fn end(&self) {
        self.0.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_template_can_be_read() {
        super::Bar::new("cull-large").end();
        let bar = super::Bar::of_tiles("room", 2);
        bar.more();
        bar.end();
    }
}
