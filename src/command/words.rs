//! The words of the command line.

use apportion::measure::Selection;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Share graphics work out over processors, real and simulated, and show what that buys.
#[derive(Debug, Parser)]
#[command(name = "apportion", version, about)]
pub(crate) struct Words {
    /// What to do.
    #[command(subcommand)]
    pub(crate) action: Action,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Action {
    /// List the experiments, one a line, with the figure each reproduces.
    List,
    /// Run experiments: write rows and charts, print paper, simulated and measured side by side.
    Run(RunWords),
    /// Show the newest finished run of an experiment: paper, simulated and measured, with the error of each.
    Table(TableWords),
    /// Draw runs as one HTML page that needs nothing else: charts, tables, where the rows are from.
    ///
    /// Without folders: the newest finished run of each experiment in results/, committed reference runs included.
    #[command(after_help = REPORT_EXAMPLES)]
    Report(ReportWords),
    /// Tell which scheme to take, on how many processors, for a scene of yours, and why.
    Advise(AdviseWords),
    /// Tell what a scene holds.
    Scene {
        /// A file (glTF, GLB, OBJ) or the name of a generated scene.
        #[arg(value_name = "FILE|NAME")]
        scene: String,
    },
    /// Show the constants of the machines, or fit `host` to this computer.
    Machine {
        /// The machine; `calibrate` to fit `host`; `predict` to fit it and hold the speedups it foretells
        /// against measured ones (some minutes); all where absent.
        #[arg(value_name = "NAME|calibrate|predict")]
        machine: Option<String>,
    },
    /// Hold invariants under load on real threads.
    Stress {
        /// The scheme or primitive.
        what: String,
        /// How many workers; more than there are cores is welcome.
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=256))]
        processors: u32,
        /// For how long, in seconds.
        #[arg(long, value_name = "S", value_parser = clap::value_parser!(u64).range(1..))]
        seconds: u64,
    },
    /// Print completions for a shell.
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page.
    Man,
}

/// What `report --help` ends with.
const REPORT_EXAMPLES: &str = "\
Examples:
  apportion report                                 all experiments, to results/report.html
  apportion report --out cull.html results/cull-large/reference
  apportion report --charts results/tree-work/20260301T120000Z    its SVG and Vega-Lite files anew, too";

/// The words of `report`.
#[derive(Debug, Args)]
pub(crate) struct ReportWords {
    /// The page's file.
    #[arg(long, value_name = "FILE.html", default_value = "results/report.html")]
    pub(crate) out: PathBuf,
    /// Also draw the SVG files and Vega-Lite specifications of each run anew, beside its rows.
    #[arg(long)]
    pub(crate) charts: bool,
    /// Folders of runs.
    #[arg(value_name = "RUN_DIR")]
    pub(crate) runs: Vec<PathBuf>,
}

/// How a table is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For reading.
    Table,
    /// A JSON array of lines.
    Json,
    /// Comma-separated values with a header.
    Csv,
}

/// The words of `advise`.
#[derive(Debug, Args)]
pub(crate) struct AdviseWords {
    /// A file (glTF, GLB, OBJ) or the name of a generated scene.
    #[arg(long, value_name = "FILE|NAME")]
    pub(crate) scene: String,
    /// What is to be done with it.
    #[arg(long, default_value = "cull")]
    pub(crate) job: String,
    /// How many processors may be used [default: all the machine has].
    #[arg(long, value_name = "N")]
    pub(crate) processors: Option<u32>,
    /// The machine to use them on.
    #[arg(long, value_name = "threads|e4000|FILE.toml|...", default_value = "threads")]
    pub(crate) machine: String,
    /// Show all that was tried, the best first.
    #[arg(long)]
    pub(crate) explain: bool,
}

/// The words of `table`.
#[derive(Debug, Args)]
pub(crate) struct TableWords {
    /// The experiment.
    pub(crate) name: String,
    /// How to print the table.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

/// The words of `run`.
#[derive(Debug, Args)]
pub(crate) struct RunWords {
    /// The experiments, as `apportion list` names them.
    #[arg(required = true, value_name = "NAME")]
    pub(crate) names: Vec<String>,
    /// Machines in place of the experiment's; `all` for the experiment's.
    #[arg(long, value_name = "threads|e4000|FILE.toml|...", value_delimiter = ',')]
    machine: Vec<String>,
    /// Processor counts in place of the experiment's, such as 1,2,4-13 or 1-cores.
    #[arg(long, value_name = "LIST")]
    processors: Option<String>,
    /// Schemes in place of the experiment's; the serial one stays, as speedups are held against it.
    #[arg(long, value_delimiter = ',')]
    scheme: Vec<String>,
    /// A scene in place of the experiment's: a file or the name of a generated one.
    #[arg(long, value_name = "FILE|NAME")]
    scene: Option<String>,
    /// A recorded camera path.
    #[arg(long, value_name = "FILE")]
    path: Option<PathBuf>,
    /// Frames of the camera path.
    #[arg(long, value_name = "N")]
    frames: Option<u32>,
    /// Seed of all randomness [default: 1].
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Interleaved repeats on real threads.
    #[arg(long, value_name = "N")]
    repeats: Option<u32>,
    /// Fewer frames and repeats: to see that it runs, not how fast.
    #[arg(long)]
    quick: bool,
    /// Take up the newest run of the experiment that lacks cells, or the one in --out.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Folder for the run; with several experiments, a folder in it for each [default: results/NAME/TIME].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// How to print the table.
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub(crate) format: Format,
}

impl RunWords {
    /// What the run is narrowed to.
    pub(crate) fn selection(&self) -> Selection {
        Selection {
            machines: self.machine.clone(),
            processors: self.processors.clone(),
            schemes: self.scheme.clone(),
            scene: self.scene.clone(),
            path: self.path.clone(),
            frames: self.frames,
            seed: self.seed,
            repeats: self.repeats,
            quick: self.quick,
        }
    }
}
