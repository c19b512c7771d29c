//! What a figure shows, worked out before a line is drawn: one file a kind of figure.

mod accuracy;
mod balance;
mod baseline;
mod by_frame;
mod curves;
mod frames;
mod plane;
mod sharing;
mod speedup;
mod time;
mod timeline;
mod words;

pub(crate) use time::unit;
pub(crate) use timeline::{ACTIVITIES, shares, wrong};
pub(crate) use words::{bare, number};

use super::Run;
use super::choices::{Choices, choices, compared};
use super::group::Group;
use super::marker::Look;

/// Every kind of figure, in the order of a page; each gives as many as the rows have to show.
const KINDS: &[fn(&Material<'_>) -> Vec<Figure>] = &[
    plane::figures,
    baseline::figures,
    speedup::figures,
    time::figures,
    accuracy::figures,
    balance::figures,
    sharing::figures,
    frames::figures,
    by_frame::figures,
    by_frame::rays,
    by_frame::parts,
    timeline::figures,
];

/// The figures of a run.
pub(crate) fn figures(run: &Run) -> Vec<Figure> {
    let material = Material::new(run);
    KINDS.iter().flat_map(|kind| kind(&material)).filter(|figure| !figure.panels.is_empty()).collect()
}

/// A run's rows, gathered once for all figures.
pub(crate) struct Material<'a> {
    pub(crate) run: &'a Run,
    /// Speedups, each simulated group followed by its measured twin.
    pub(crate) groups: Vec<Group>,
    /// The cells of a run in which nothing is shared out.
    pub(crate) choices: Vec<Choices>,
}

impl<'a> Material<'a> {
    fn new(run: &'a Run) -> Self {
        let mut groups = compared(&run.rows);
        let pairs: Vec<_> = groups.iter().map(pair).collect();
        let first = |group: &Group| pairs.iter().position(|other| *other == pair(group));
        // Stable: within a pair the order of the rows stays, simulated machines before real ones.
        groups.sort_by_key(|group| (first(group), group.machine == crate::record::THREADS));
        Self { run, groups, choices: choices(&run.rows) }
    }
}

/// What a simulated group and its measured twin share.
pub(crate) fn pair(group: &Group) -> (String, String) {
    (group.scene.clone(), group.portable_settings())
}

/// One question put to the rows: panels that share a legend.
#[derive(Clone, Debug)]
pub(crate) struct Figure {
    /// A word for files and anchors: `speedup`.
    pub(crate) kind: String,
    /// The heading.
    pub(crate) title: String,
    /// What to see, from the rows.
    pub(crate) says: String,
    /// How it is drawn, where that does not go without saying.
    pub(crate) how: String,
    pub(crate) legend: Vec<Entry>,
    pub(crate) panels: Vec<Panel>,
}

/// A line of the legend.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) label: String,
    pub(crate) look: Look,
}

/// One drawing.
#[derive(Clone, Debug)]
pub(crate) struct Panel {
    /// What tells it from the others: `e4000, work_ns=20-60`.
    pub(crate) heading: String,
    /// The same in full, for where it stands alone: `factory-large on e4000, simulated, history=distances`;
    /// empty where it never does.
    pub(crate) place: String,
    /// The same in full, for the name of a file: `e4000-factory-large-job.history-distances`.
    pub(crate) file: String,
    pub(crate) machine: String,
    /// Its place among the run's groups; none where it gathers several.
    pub(crate) group: Option<usize>,
    /// Panels of the same number stand side by side.
    pub(crate) pair: usize,
    /// What a reader has to know of this panel alone.
    pub(crate) note: String,
    pub(crate) body: Body,
}

/// What is drawn in a panel.
#[derive(Clone, Debug)]
pub(crate) enum Body {
    Plot(Plot),
    Field(Field),
    Bars(Bars),
}

/// Points over two axes.
#[derive(Clone, Debug)]
pub(crate) struct Plot {
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) series: Vec<Series>,
}

/// An axis: its numbers run from `low` to `high`, both finite and apart.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) scale: Scale,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// How an axis runs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Scale {
    Even,
    /// In powers of two.
    Doubling,
    /// Places 0, 1, 2, ... that have names.
    Names(Vec<String>),
}

/// Points that belong together.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    pub(crate) style: Style,
    /// The line of the legend; none for what has no scheme.
    pub(crate) entry: Option<usize>,
    pub(crate) points: Vec<Point>,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Style {
    /// A line with marks.
    Curve,
    /// Marks alone.
    Scatter,
    /// Marks, which a line joins in their order, whatever their places.
    Joined,
    /// Hollow marks: a paper's.
    Paper,
    /// A dashed line: what could be hoped for.
    Ideal,
    /// The line around the best.
    Front,
}

/// A point, finite.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// None for a paper's peak, of which the count of processors is not known.
    pub(crate) x: Option<f64>,
    pub(crate) y: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// What else its row says: the setting chosen.
    pub(crate) note: String,
}

impl Point {
    /// A point without an interval.
    pub(crate) fn bare(x: f64, y: f64) -> Self {
        Self { x: Some(x), y, low: y, high: y, note: String::new() }
    }
}

/// A plane of cells.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    /// The name of the columns' setting, then its values.
    pub(crate) columns: (String, Vec<String>),
    /// The name of the lines' setting, then its values, from the top.
    pub(crate) lines: (String, Vec<String>),
    pub(crate) cells: Vec<Cell>,
}

/// A cell of a plane.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    pub(crate) column: usize,
    pub(crate) line: usize,
    /// The winner's line in the legend.
    pub(crate) entry: usize,
    /// What is written in it: `+34 %`.
    pub(crate) text: String,
    /// What its rows say.
    pub(crate) note: String,
}

/// What each processor did, over time.
#[derive(Clone, Debug)]
pub(crate) struct Bars {
    /// The processors, from the top.
    pub(crate) lanes: Vec<String>,
    /// The last moment, microseconds.
    pub(crate) end: f64,
    pub(crate) spans: Vec<Span>,
}

/// One thing one processor did, in microseconds from the first.
#[derive(Clone, Debug)]
pub(crate) struct Span {
    pub(crate) lane: usize,
    /// A place in [`ACTIVITIES`].
    pub(crate) activity: usize,
    pub(crate) from: f64,
    pub(crate) to: f64,
}
