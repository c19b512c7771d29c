//! The words of the command line.

use super::list::EXPERIMENTS;
use super::render::{RENDER_EXAMPLES, RenderWords};
use apportion::measure::{Known, MeasureError, Selection, Shelf};
use apportion::record::METRICS;
use apportion::scheme::tiles;
use clap::builder::PossibleValuesParser;
use clap::{Args, Command, CommandFactory, Parser, Subcommand, ValueEnum};
use std::path::{Path, PathBuf};

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
    #[command(after_help = "Examples:\n  apportion list\n  apportion list | grep 'Fig. 1'")]
    List,
    /// Run experiments: write rows and charts, print paper, simulated and measured side by side.
    #[command(after_help = RUN_EXAMPLES)]
    Run(RunWords),
    /// Show the newest finished run of an experiment: paper, simulated and measured, with the error of each.
    #[command(
        after_help = "Examples:\n  apportion table cull-large\n  apportion table cull-large --format csv > cull-large.csv"
    )]
    Table(TableWords),
    /// Draw runs as one HTML page that needs nothing else: charts, tables, where the rows are from.
    ///
    /// Without folders: the newest finished run of each experiment in results/, committed reference runs included.
    #[command(after_help = REPORT_EXAMPLES)]
    Report(ReportWords),
    /// Tell which scheme to take, on how many processors, for a scene of yours, and why.
    #[command(
        after_help = "Examples:\n  apportion advise --scene assembly.glb\n  apportion advise --scene factory-large --machine e4000 --processors 8 --explain"
    )]
    Advise(AdviseWords),
    /// Hold two runs against each other: for each cell a ratio, its interval and a verdict.
    #[command(after_help = COMPARE_EXAMPLES)]
    Compare(CompareWords),
    /// Trace a picture of a scene.
    ///
    /// Without --camera it is seen from its own view; if it has none, from within where walls close in on its middle, as a
    /// building's do, and from above its right front corner elsewhere. Where it has no lights, one is put beside the eye.
    #[command(after_help = RENDER_EXAMPLES)]
    Render(RenderWords),
    /// Tell what a scene holds.
    ///
    /// Large files are kept, parsed, in the user's cache folder and are read from there the next time, until they
    /// change. The variable APPORTION_CACHE names another folder, or says `off`.
    #[command(
        after_help = "Examples:\n  apportion scene assembly.glb\n  apportion scene dragon.ply.gz\n  apportion scene factory-large\n  apportion scene assembly.glb --save assembly.aff"
    )]
    Scene {
        /// A file (glTF, GLB, OBJ, PLY, STL, URDF, AFF, NFF; also .gz) or the name of a generated scene.
        #[arg(value_name = "FILE|NAME")]
        scene: String,
        /// Write it to this file instead, as AFF, with its textures as PPM beside it; what AFF cannot say is told.
        #[arg(long, value_name = "FILE.aff")]
        save: Option<PathBuf>,
    },
    /// Show the constants of the machines, or fit `host` to this computer.
    #[command(
        after_help = "Examples:\n  apportion machine\n  apportion machine e4000 > mine.toml\n  apportion machine calibrate > host.toml"
    )]
    Machine {
        /// The machine; `calibrate` to fit `host`; `predict` to fit it and hold the speedups it foretells
        /// against measured ones (some minutes); all where absent.
        #[arg(value_name = "NAME|calibrate|predict")]
        machine: Option<String>,
    },
    /// Hold invariants under load on real threads.
    #[command(
        after_help = "Examples:\n  apportion stress lock_free --processors 8 --seconds 60\n  apportion stress in_queue --processors 2 --seconds 10"
    )]
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
    #[command(
        after_help = "Examples:\n  apportion completions bash > ~/.local/share/bash-completion/completions/apportion\n  apportion completions zsh > ~/.zfunc/_apportion\n  apportion completions fish > ~/.config/fish/completions/apportion.fish"
    )]
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or write it and one for each subcommand.
    #[command(
        after_help = "Examples:\n  apportion man --out ~/.local/share/man/man1\n  apportion man | man -l -"
    )]
    Man {
        /// Write a page for each subcommand to this folder.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
}

const RUN_EXAMPLES: &str = "Examples:
  apportion run cull-large
  apportion run cull-scene --scene assembly.glb --processors 1-cores
  apportion run tree-work --machine threads --scheme lock_free,work_stealing --until 2 --at-most 120
  apportion run cull-large --resume";

const COMPARE_EXAMPLES: &str = "Examples:
  apportion run tree-work --machine threads --out before
  apportion run tree-work --machine threads --out after
  apportion compare before after
  apportion compare results/cull-large/reference cull-large --metric speedup

Each run is cut into blocks of repeats, each block summed up by the lower quartile of its frames' times, and the \
ratio is the median of all ratios between blocks. All intervals hold at once with 95 %; a verdict needs the whole \
interval beyond 1 by 2 %, for two runs of one program differ by as much. Simulated cells are exact.";

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
    /// A file (glTF, GLB, OBJ, PLY, STL, URDF, AFF, NFF; also .gz) or the name of a generated scene.
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

/// The words of `compare`.
#[derive(Debug, Args)]
pub(crate) struct CompareWords {
    /// The run before: its folder, or an experiment for its newest finished run.
    #[arg(value_name = "RUN_A")]
    pub(crate) a: String,
    /// The run after.
    #[arg(value_name = "RUN_B")]
    pub(crate) b: String,
    /// What to compare by; `frame_time` compares the quieter frames, `frame_time_p90` the slow ones.
    #[arg(long, value_name = "METRIC", default_value = "frame_time")]
    pub(crate) metric: String,
    /// How to print the comparison.
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
    /// A scene in place of the experiment's: a file or the name of a generated one. May be given several times; an
    /// experiment with two bodies takes them two by two, the one that moves first.
    #[arg(long, value_name = "FILE|NAME")]
    scene: Vec<String>,
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
    /// Go on repeating what runs on threads until the 95 % interval of every speedup lies within so many per
    /// cent of its median, either way; at least 6 repeats.
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub(crate) until: Option<f64>,
    /// Time limit of --until, seconds [default: 300]. The experiment's own repeats are made in any case; a
    /// resumed run has this time anew.
    #[arg(long, value_name = "SECONDS", requires = "until", value_parser = clap::value_parser!(u64).range(1..))]
    at_most: Option<u64>,
    /// Fewer frames and repeats: to see that it runs, not how fast.
    #[arg(long)]
    quick: bool,
    /// Take up the newest run of the experiment that lacks cells, or the one in --out.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Folder for the run; with several experiments, a folder in it for each [default: results/NAME/TIME].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Write what each processor did to FILE, for Perfetto or chrome://tracing (Trace Event format), and into
    /// the run's folder as timeline.json: one frame a cell, that of median time. Rows are taken without a
    /// trace, so each cell goes through its path once more. With --resume, only cells run now are traced.
    #[arg(long, value_name = "FILE")]
    pub(crate) trace: Option<PathBuf>,
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
            scenes: self.scene.clone(),
            path: self.path.clone(),
            frames: self.frames,
            seed: self.seed,
            repeats: self.repeats,
            until: self.until,
            at_most: self.at_most,
            quick: self.quick,
        }
    }
}

/// The command with the names there are as values, for completions; the program itself answers an unknown name with
/// the near ones, which a parser of possible values would not do for experiments and machines that are files.
pub(crate) fn with_names() -> Result<Command, MeasureError> {
    let shelf = Shelf::open(Path::new(EXPERIMENTS))?;
    let known = Known::here();
    let experiments: Vec<String> = shelf.names().map(str::to_owned).collect();
    let metrics: Vec<String> = METRICS.iter().map(|metric| metric.name.to_owned()).collect();
    let hint = |command: Command, subcommand: &str, words: &'static str, values: &[String]| {
        let values = PossibleValuesParser::new(values.iter().cloned());
        command
            .mut_subcommand(subcommand, |command| command.mut_arg(words, |words| words.value_parser(values)))
    };
    let command = hint(Words::command(), "run", "names", &experiments);
    let command = hint(command, "run", "machine", &known.machines);
    let command = hint(command, "run", "scheme", &known.schemes);
    let command = hint(command, "table", "name", &experiments);
    let tiles: Vec<String> = tiles::SCHEMES.iter().map(|scheme| scheme.name.to_owned()).collect();
    let command = hint(command, "render", "scheme", &tiles);
    let command = hint(command, "machine", "machine", &known.machines);
    let command = hint(command, "stress", "what", &known.schemes);
    Ok(hint(command, "compare", "metric", &metrics))
}

fn percent(text: &str) -> Result<f64, String> {
    let percent = text.trim_end_matches('%').trim_end().parse().ok();
    let within = percent.filter(|percent| *percent > 0.0 && *percent <= 100.0);
    within.ok_or_else(|| "expected per cent, above 0 and up to 100".to_owned())
}
