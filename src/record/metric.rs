//! The list of metrics: each is declared here, once, with its name, its unit and a sentence.

/// Which way a metric is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// More is better: a speedup.
    Higher,
    /// Less is better: a time.
    Lower,
}

/// What a number says a method gave up for its speed; never two kinds on one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccuracyKind {
    /// The result itself is another: missed hits, a coarser picture.
    Answer,
    /// The same result, for more work: boxes called intersecting that are not, tests a ray.
    Structure,
    /// An older result: age in frames.
    Timeliness,
}

impl AccuracyKind {
    /// The kinds, in the order they are shown.
    pub const ALL: [Self; 3] = [Self::Answer, Self::Structure, Self::Timeliness];

    /// The kind in a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Answer => "answer",
            Self::Structure => "structure",
            Self::Timeliness => "timeliness",
        }
    }
}

/// A metric: what a row's number means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Metric {
    /// The word in the column `metric`.
    pub name: &'static str,
    /// The word in the column `unit`.
    pub unit: &'static str,
    /// Which way is better.
    pub better: Better,
    /// What it is, in a sentence.
    pub sentence: &'static str,
    /// What it says was given up for speed; none where it is no measure of that.
    pub accuracy: Option<AccuracyKind>,
}

/// The metric of that name.
pub fn metric(name: &str) -> Option<&'static Metric> {
    METRICS.iter().find(|metric| metric.name == name)
}

const fn declare(name: &'static str, unit: &'static str, better: Better, sentence: &'static str) -> Metric {
    Metric { name, unit, better, sentence, accuracy: None }
}

impl Metric {
    /// The same metric, as one that says what was given up for speed.
    const fn gives_up(self, kind: AccuracyKind) -> Self {
        Self { accuracy: Some(kind), ..self }
    }
}

/// Every metric there is.
pub const METRICS: &[Metric] = {
    use Better::{Higher, Lower};
    &[
        declare(
            "frame_time",
            "ns",
            Lower,
            "Time from giving a frame to the scheme to its last processor done.",
        ),
        declare("frame_time_p50", "ns", Lower, "Half of the cell's frames took no longer."),
        declare("frame_time_p90", "ns", Lower, "Nine tenths of the cell's frames took no longer."),
        declare("frame_time_p99", "ns", Lower, "99 in 100 of the cell's frames took no longer."),
        declare("frame_time_max", "ns", Lower, "The cell's slowest frame."),
        declare("total_time", "ns", Lower, "The sum of the cell's frame times."),
        declare("speedup", "x", Higher, "Serial total time over this cell's, both of the same repeat."),
        declare(
            "speedup_self",
            "x",
            Higher,
            "The scheme's own total time on one processor over this cell's, both of the same repeat.",
        ),
        declare(
            "load_imbalance",
            "%",
            Lower,
            "How much longer the busiest processor worked than the mean of all, as a share of the mean.",
        ),
        declare(
            "traversal_share",
            "%",
            Lower,
            "Share of the processors' time that went into finding and handing over work, not into the work itself.",
        ),
        declare(
            "processors_used",
            "processors",
            Lower,
            "Processors that took part in a frame, on average: a scheme may leave some out.",
        ),
        declare("nodes_visited", "nodes", Lower, "Nodes of the structure the job looked at.")
            .gives_up(AccuracyKind::Structure),
        declare("nodes_visible", "nodes", Higher, "Leaf nodes found visible."),
        declare("boxes_visible", "boxes", Lower, "Boxes not found to be outside."),
        declare("time_per_box", "ns", Lower, "The median frame's time over the boxes there are."),
        declare("bytes_per_second", "B/s", Higher, "Bytes of all boxes over the median frame's time."),
        declare("stream_time", "ns", Lower, "Median time to read the boxes' memory, shared out alike."),
        declare(
            "stream_ratio",
            "x",
            Lower,
            "The median frame's time over that of reading the boxes' memory.",
        ),
        declare(
            "lost_time",
            "%",
            Lower,
            "Share of one core that other work took away, seen by spinning on the clock just before the cell.",
        ),
        declare(
            "cell_complete",
            "rows",
            Higher,
            "The cell's last row: how many rows it has before this one.",
        ),
    ]
};
