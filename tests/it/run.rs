//! The plan and the runner, with a mock in place of the jobs.

use crate::mock;
use apportion::measure::{Cell, Ending, MeasureError, Options, Plan, Selection, Subject, Until, run};
use apportion::record::{Row, RowLog, read_rows};
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

fn run_mock(path: &Path, stop_after: usize) -> Result<Ending, MeasureError> {
    let (mut log, kept) = RowLog::open(path)?;
    let stop = AtomicBool::new(stop_after == 0);
    let mut begun = 0;
    let mut watch = |_: apportion::measure::Progress<'_>| {
        begun += 1;
        stop.store(begun >= stop_after, Ordering::Relaxed);
    };
    let plan = mock::plan(&Selection::default());
    run(&plan, "id", (&mut log, &kept), &mut mock::open, &mut watch, &stop)
}

fn without_noise(rows: Vec<Row>) -> Vec<Row> {
    rows.into_iter().filter(|row| row.metric != "lost_time").collect()
}

#[test]
fn a_plan_has_each_cell_once_and_the_serial_one_first() {
    let plan = mock::plan(&Selection::default());
    let keys: HashSet<_> = plan.cells.iter().map(|cell| cell.key(0)).collect();
    assert_eq!(keys.len(), plan.cells.len());
    // e4000: serial, queue x 13, ring x 13 x 2 settings; threads: serial, queue x 2, ring x 2 x 2, stealing x 2.
    assert_eq!(plan.cells.len(), (1 + 13 + 26) + (1 + 2 + 4 + 2));
    for (index, cell) in plan.cells.iter().enumerate() {
        let serial = plan.serial_of(cell).expect("the experiment lists the serial scheme");
        let at = plan.cells.iter().position(|other| other == serial).expect("it is one of them");
        assert!(at <= index, "{serial} comes after {cell}");
        assert_eq!(serial.machine, cell.machine);
        assert_eq!(cell.settings.contains_key("ring.receivers"), cell.scheme == "ring");
    }
}

#[test]
fn a_selection_narrows_the_plan_and_keeps_the_serial_scheme() {
    let selection = Selection {
        machines: vec!["e4000".to_owned()],
        processors: Some("8".to_owned()),
        schemes: vec!["ring".to_owned()],
        quick: true,
        ..Selection::default()
    };
    let plan = mock::plan(&selection);
    let words: Vec<String> = plan.cells.iter().map(ToString::to_string).collect();
    assert_eq!(
        words,
        [
            "box serial on e4000 x 1 (job.work=300)",
            "box ring on e4000 x 8 (job.work=300;ring.receivers=1)",
            "box ring on e4000 x 8 (job.work=300;ring.receivers=2)",
        ]
    );
    assert_eq!((plan.options.frames, plan.options.seed), (2, 1));
}

#[test]
fn speedups_are_held_against_the_serial_cell_of_the_same_repeat() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("rows.jsonl");
    assert_eq!(run_mock(&path, usize::MAX).expect("it runs"), Ending::Complete);
    let rows = read_rows(&path).expect("the log is whole");
    let plan = mock::plan(&Selection::default());
    let mut speedups = HashMap::new();
    for row in rows.iter().filter(|row| row.metric == "speedup") {
        assert_eq!(speedups.insert(row.key(), row.value), None);
    }
    let mut count = 0;
    for cell in &plan.cells {
        for repeat in 0..plan.repeats(cell) {
            let expected = 1_000.0 / mock::frame_time(cell);
            assert!((speedups[&cell.key(repeat)] - expected).abs() < 1e-9, "{cell}");
            count += 1;
        }
    }
    assert_eq!(count, speedups.len());
    assert_eq!(count, rows.iter().filter(|row| row.metric == "cell_complete").count());
    let lost = rows.iter().filter(|row| row.metric == "lost_time");
    assert!(lost.clone().all(|row| row.machine == "threads"));
    assert_eq!(lost.count(), 9 * 3);
}

#[test]
fn a_stopped_run_is_taken_up_without_a_difference() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (whole, parts) = (folder.path().join("whole.jsonl"), folder.path().join("parts.jsonl"));
    run_mock(&whole, usize::MAX).expect("it runs");
    for stop_after in [1, 7, 30, 20] {
        let ending = run_mock(&parts, stop_after).expect("it runs");
        assert!(matches!(ending, Ending::Stopped { left } if left > 0), "{ending:?}");
    }
    assert_eq!(run_mock(&parts, usize::MAX).expect("it runs"), Ending::Complete);
    let [whole, parts] =
        [whole, parts].map(|path| without_noise(read_rows(&path).expect("the log is whole")));
    assert_eq!(whole, parts);
}

/// Runs the mock plan, slowly enough to be killed in the middle.
#[test]
#[ignore = "the child of another test"]
fn child_runs() {
    let Some(path) = std::env::var_os("LOG_OF_CHILD") else { return };
    let (mut log, kept) = RowLog::open(Path::new(&path)).expect("it opens");
    let plan = mock::plan(&Selection::default());
    let stop = AtomicBool::new(false);
    let mut watch = |_: apportion::measure::Progress<'_>| std::thread::sleep(Duration::from_millis(2));
    run(&plan, "id", (&mut log, &kept), &mut mock::open, &mut watch, &stop).expect("it runs");
}

#[test]
fn a_killed_run_is_taken_up_without_a_difference() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (whole, parts) = (folder.path().join("whole.jsonl"), folder.path().join("parts.jsonl"));
    run_mock(&whole, usize::MAX).expect("it runs");
    let program = std::env::current_exe().expect("a test has a program");
    let length = || std::fs::metadata(&parts).map_or(0, |file| file.len());
    for _ in 0..4 {
        let mut command = Command::new(&program);
        command.args(["--exact", "run::child_runs", "--ignored"]).env("LOG_OF_CHILD", &parts);
        let mut child = command.stdout(Stdio::null()).spawn().expect("the child starts");
        // Killed once it has written something, however slow the computer is.
        let before = length();
        while length() < before + 2_000 {
            assert!(child.try_wait().expect("it can be asked").is_none(), "it ended before it was killed");
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().expect("it can be killed");
        child.wait().expect("it ends");
    }
    let kept = read_rows(&parts).expect("the log is whole").len();
    assert!(kept > 0 && kept < read_rows(&whole).expect("the log is whole").len());
    assert_eq!(run_mock(&parts, usize::MAX).expect("it runs"), Ending::Complete);
    let [whole, parts] =
        [whole, parts].map(|path| without_noise(read_rows(&path).expect("the log is whole")));
    assert_eq!(whole, parts);
}

#[test]
fn a_failing_cell_is_named_and_the_rows_before_it_are_kept() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("rows.jsonl");
    let plan = mock::plan(&Selection::default());
    let (mut log, kept) = RowLog::open(&path).expect("it opens");
    let mut open = |cell: &_, options: &_| -> Result<Box<dyn Subject>, MeasureError> {
        let cell: &Cell = cell;
        if cell.scheme == "ring" {
            Err(MeasureError::Failed("boom".to_owned()))
        } else {
            mock::open(cell, options)
        }
    };
    let stop = AtomicBool::new(false);
    let error = run(&plan, "id", (&mut log, &kept), &mut open, &mut |_| {}, &stop).expect_err("ring fails");
    assert_eq!(error.to_string(), "box ring on e4000 x 1 (job.work=300;ring.receivers=1): boom");
    let complete = read_rows(&path).expect("the log is whole");
    assert_eq!(complete.iter().filter(|row| row.metric == "cell_complete").count(), 14);
}

/// Runs until the speedups are within 2 per cent; those of `ring` on threads never are.
fn run_until(path: &Path, at_most: Duration, stop_after: usize) -> Ending {
    struct Noisy(f64);
    impl Subject for Noisy {
        fn sample(&mut self, repeat: u32) -> Result<Vec<apportion::measure::Sample>, MeasureError> {
            let value = self.0 * (1.0 + f64::from(repeat % 4));
            Ok(vec![apportion::measure::Sample { metric: "frame_time", frame: Some(0), value }])
        }
    }
    let mut plan =
        mock::plan(&Selection { until: Some(2.0), processors: Some("2".to_owned()), ..Selection::default() });
    plan.options.until = plan.options.until.map(|until| Until { at_most, ..until });
    let mut open = |cell: &Cell, options: &Options| -> Result<Box<dyn Subject>, MeasureError> {
        if cell.scheme == "ring" && !cell.is_simulated() {
            return Ok(Box::new(Noisy(mock::frame_time(cell))));
        }
        mock::open(cell, options)
    };
    let (mut log, kept) = RowLog::open(path).expect("it opens");
    let stop = AtomicBool::new(false);
    let mut begun = 0;
    let mut watch = |_: apportion::measure::Progress<'_>| {
        begun += 1;
        stop.store(begun >= stop_after, Ordering::Relaxed);
    };
    run(&plan, "id", (&mut log, &kept), &mut open, &mut watch, &stop).expect("it runs")
}

/// How many repeats of serial cells there are, on threads and simulated.
fn repeats(path: &Path) -> [usize; 2] {
    let rows = read_rows(path).expect("the log is whole");
    let of = |machine: &str| {
        let complete = rows.iter().filter(|row| row.metric == "cell_complete" && row.scheme == "serial");
        complete.filter(|row| row.machine == machine).count()
    };
    [of("threads"), of("e4000")]
}

#[test]
fn until_goes_on_while_a_speedup_is_not_sure() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name);
    // Time is up at once: the repeats there have to be, 6 or more, and no other.
    assert_eq!(run_until(&path("late"), Duration::ZERO, usize::MAX), Ending::Complete);
    assert_eq!(repeats(&path("late")), [6, 1]);
    // There is time: it goes on until it is told to stop, on threads only, also when it is taken up.
    for _ in 0..2 {
        let ending = run_until(&path("noisy"), Duration::from_secs(3_600), 100);
        assert!(matches!(ending, Ending::Stopped { left } if (1..10).contains(&left)), "{ending:?}");
    }
    let [threads, simulated] = repeats(&path("noisy"));
    assert!(threads > 30 && simulated == 1, "{threads} and {simulated}");
    // The mock is always sure: 6 repeats do.
    let (mut log, kept) = RowLog::open(&path("sure")).expect("it opens");
    let plan = mock::plan(&Selection { until: Some(2.0), ..Selection::default() });
    let ending = run(&plan, "id", (&mut log, &kept), &mut mock::open, &mut |_| {}, &AtomicBool::new(false));
    assert_eq!((ending.expect("it runs"), repeats(&path("sure"))), (Ending::Complete, [6, 1]));
}

#[test]
fn a_machines_settings_hold_for_a_file_of_its_name() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("mine.toml").display().to_string();
    let text = apportion::measure::inspect::machine(Some("e4000"), &mut |_| {}).expect("there is one");
    std::fs::write(&file, format!("\u{feff}{text}")).expect("it is written");
    let experiment = mock::EXPERIMENT.replace("[settings]", "[settings]\n\"e4000.memory\" = 99");
    let experiment = apportion::measure::Experiment::parse("mock", "mock.toml", &experiment, &mock::known());
    let selection = Selection { machines: vec![file], ..Selection::default() };
    let plan = Plan::new(&experiment.expect("it is well-formed"), &selection, &mock::known(), 2);
    let cells = plan.expect("the processors of e4000 hold for it too").cells;
    assert_eq!(cells.iter().map(|cell| cell.processors).max(), Some(13));
    for cell in &cells {
        assert_eq!(
            cell.settings.get("machine.memory").map(ToString::to_string),
            Some("99".to_owned()),
            "{cell}"
        );
    }
}

#[test]
fn what_cannot_run_is_said_in_words() {
    let refused = |selection: Selection| {
        let error =
            Plan::new(&mock::experiment(), &selection, &mock::known(), 2).expect_err("it must be refused");
        assert!(error.is_usage(), "{error}");
        error.to_string()
    };
    let counts = |list: &str| Selection { processors: Some(list.to_owned()), ..Selection::default() };
    assert!(refused(counts("0")).contains("from 1 to 4096"));
    assert!(refused(counts("10000")).contains("from 1 to 4096"));
    assert!(refused(counts("300")).contains("real threads can have from 1 to 256"));
    let scheme = Selection { schemes: vec!["rings".to_owned()], ..Selection::default() };
    assert_eq!(refused(scheme), "there is no scheme `rings`; near ones: ring");
    let machine = Selection { machines: vec!["e400".to_owned()], ..Selection::default() };
    assert_eq!(refused(machine), "there is no machine `e400`; near ones: e4000");
    assert!(refused(Selection { frames: Some(0), ..Selection::default() }).contains("start at 1"));
}
