//! The log: torn tails, unfinished cells, kills, full disks.

use apportion::record::{RecordError, Row, RowLog, RunFolder, export_csv, read_rows, write_whole};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

fn row(repeat: u32, metric: &str, value: f64) -> Row {
    let word = |word: &str| word.to_owned();
    Row {
        run: word("id"),
        experiment: word("log"),
        job: word("none"),
        scene: word("a, \"b\""),
        structure: word("tree"),
        scheme: word("serial"),
        settings: word("job.x=1;job.y=2"),
        machine: word("threads"),
        processors: 1,
        repeat,
        frame: (metric == "frame_time").then_some(3),
        metric: word(metric),
        unit: word("ns"),
        value,
    }
}

/// A log with a finished cell and one that lacks its last row.
fn log_with_two_cells(path: &Path) {
    let (mut log, _) = RowLog::open(path).expect("it opens");
    for row in [row(0, "frame_time", 0.1), row(0, "cell_complete", 1.0), row(1, "frame_time", 2.5)] {
        log.append(&row).expect("it is written");
    }
}

#[test]
fn a_torn_tail_is_cut_back_and_an_unfinished_cell_is_dropped() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("rows.jsonl");
    log_with_two_cells(&path);
    let whole = std::fs::read(&path).expect("it can be read");
    for cut in 1..whole.len() {
        std::fs::write(&path, &whole[..cut]).expect("it can be written");
        let (log, rows) = RowLog::open(&path).expect("a torn tail is no error");
        let finished = log.is_finished(&row(0, "", 0.0).key());
        assert_eq!(rows.len(), if finished { 2 } else { 0 }, "cut at byte {cut}");
        assert!(!log.is_finished(&row(1, "", 0.0).key()));
        assert_eq!(read_rows(&path).expect("it is whole"), rows);
    }
}

#[test]
fn a_log_is_written_by_one_at_a_time() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("rows.jsonl");
    // Also by one who had to write the file anew, without the unfinished cell.
    for _ in 0..2 {
        let (mut log, _) = RowLog::open(&path).expect("nobody else has it open");
        let error = RowLog::open(&path).expect_err("it is open").to_string();
        assert_eq!(
            error,
            format!("{} is being written by another run: wait for it to end", folder.path().display())
        );
        log.append(&row(0, "cell_complete", 1.0)).expect("it is written");
        log.append(&row(1, "frame_time", 1.0)).expect("it is written");
    }
    assert_eq!(RowLog::open(&path).expect("it is closed").1.len(), 2);
}

#[test]
fn a_line_that_is_no_record_is_an_error_that_names_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("rows.jsonl");
    log_with_two_cells(&path);
    let mut file = std::fs::OpenOptions::new().append(true).open(&path).expect("it opens");
    file.write_all(b"{\"run\": 3}\n").expect("it is written");
    let error = RowLog::open(&path).expect_err("the line is whole, and wrong").to_string();
    assert!(error.contains("rows.jsonl, line 4: expected one record in JSON"), "{error}");
}

#[test]
fn what_is_no_number_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("rows.jsonl");
    let (mut log, _) = RowLog::open(&path).expect("it opens");
    for value in [f64::NAN, f64::INFINITY] {
        let error = log.append(&row(0, "speedup", value)).expect_err("it must be refused");
        assert!(matches!(error, RecordError::NotFinite { .. }), "{error}");
    }
    assert_eq!(std::fs::read(&path).expect("it can be read"), b"");
}

#[test]
fn the_csv_is_written_whole_with_quotes_where_needed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (path, csv) = (folder.path().join("rows.jsonl"), folder.path().join("rows.csv"));
    log_with_two_cells(&path);
    export_csv(&path, &csv).expect("it is written");
    let text = std::fs::read_to_string(&csv).expect("it can be read");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 4);
    assert_eq!(lines[0], Row::COLUMNS.join(","));
    assert_eq!(
        lines[1],
        "id,log,none,\"a, \"\"b\"\"\",tree,serial,job.x=1;job.y=2,threads,1,0,3,frame_time,ns,0.1"
    );
    let failed = write_whole(&csv, |out| {
        out.write_all(b"half")?;
        Err(std::io::Error::other("no space left"))
    });
    let error = failed.expect_err("the body failed").to_string();
    assert!(error.contains("cannot write") && error.contains("rows.csv: no space left"), "{error}");
    assert_eq!(std::fs::read_to_string(&csv).expect("it can be read"), text, "the old table stays");
    assert_eq!(std::fs::read_dir(folder.path()).expect("it lists").count(), 2, "no half file is left");
}

#[test]
fn two_runs_of_one_second_get_a_folder_each() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let first = RunFolder::create(folder.path(), None, "log", "id").expect("it is made");
    let second = RunFolder::create(folder.path(), None, "log", "id").expect("it is made");
    assert_ne!(first, second);
    log_with_two_cells(&first.rows());
    let error =
        RunFolder::create(folder.path(), Some(first.path()), "log", "id").expect_err("it holds a run");
    assert!(error.to_string().contains("holds a run already"), "{error}");
    assert!(
        RunFolder::newest_unfinished(folder.path(), "log").is_err(),
        "a folder without meta.json is no run"
    );
}

/// Runs this very test program again, for one of its ignored tests.
fn child(test: &str, path: &Path) -> Command {
    let mut command = Command::new(std::env::current_exe().expect("a test has a program"));
    command.args(["--exact", test, "--ignored", "--nocapture"]).env("LOG_OF_CHILD", path);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Appends cells of three rows for as long as it can.
#[test]
#[ignore = "the child of other tests"]
fn child_appends() {
    let Some(path) = std::env::var_os("LOG_OF_CHILD") else { return };
    let (mut log, rows) = RowLog::open(Path::new(&path)).expect("it opens");
    let first = rows.last().map_or(0, |row| row.repeat + 1);
    for repeat in first..first + 1_000_000 {
        for metric in ["frame_time", "total_time", "cell_complete"] {
            log.append(&row(repeat, metric, f64::from(repeat))).expect("there is room");
        }
    }
}

#[test]
fn twenty_kills_lose_no_finished_cell_and_tear_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("rows.jsonl");
    let mut cells = 0;
    for round in 0..20 {
        let mut child = child("record::child_appends", &path).spawn().expect("the child starts");
        std::thread::sleep(std::time::Duration::from_millis(15 + round));
        child.kill().expect("it can be killed");
        child.wait().expect("it ends");
        let (_, rows) = RowLog::open(&path).expect("what is left can be opened");
        let finished = rows.iter().filter(|row| row.metric == "cell_complete").count();
        assert_eq!(rows.len(), 3 * finished, "only whole cells");
        assert!(
            rows.iter().enumerate().all(|(at, row)| row.repeat as usize == at / 3),
            "each once, in order"
        );
        assert!(finished >= cells, "no finished cell is lost");
        cells = finished;
    }
    assert!(cells > 0, "the children wrote something");
}

/// A limit on the size of files stands in for a full disk: the write fails in the middle of a record.
#[test]
#[cfg(unix)]
fn a_full_disk_is_an_error_and_leaves_a_log_that_can_be_taken_up() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("rows.jsonl");
    let program = std::env::current_exe().expect("a test has a program");
    let output = Command::new("sh")
        .args([
            "-c",
            "trap '' XFSZ; ulimit -f 8; exec \"$0\" --exact record::child_appends --ignored --nocapture",
        ])
        .arg(program)
        .env("LOG_OF_CHILD", &path)
        .output()
        .expect("sh runs");
    assert!(!output.status.success());
    let words =
        String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    assert!(words.contains("rows.jsonl"), "the error names the file: {words}");
    let bytes = std::fs::read(&path).expect("it can be read");
    assert_eq!(bytes.last(), Some(&b'\n'), "the torn record is cut off again");
    let (mut log, rows) = RowLog::open(&path).expect("it can be taken up");
    assert!(!rows.is_empty() && rows.len().is_multiple_of(3));
    log.append(&row(9_999, "frame_time", 1.0)).expect("there is room again");
}
