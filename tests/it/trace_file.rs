//! `run --trace FILE`: the format, read back; the rows beside it; bad weather.

use serde_json::Value;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::process::{Command, Output};

/// What a viewer can be told.
const NAMES: [&str; 5] = ["working", "sending", "waiting", "idle", "barrier"];

fn run(folder: &Path, words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_apportion"));
    command.arg("run").args(words).current_dir(folder).output().expect("the program starts")
}

#[track_caller]
fn done(folder: &Path, words: &[&str]) -> String {
    let output = run(folder, words);
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A frame of a cell as read back.
#[derive(Default)]
struct Cell {
    name: String,
    /// When the frame ends, microseconds.
    end: f64,
    frame: u64,
    /// (name, start, length) of each processor's events.
    processors: BTreeMap<u64, Vec<(String, f64, f64)>>,
    named: usize,
}

/// Reads a trace, and checks of each event the fields that the format asks for.
fn cells(path: &Path) -> Vec<Cell> {
    let file: Value = serde_json::from_str(&read(path)).expect("it is JSON");
    let mut cells: BTreeMap<u64, Cell> = BTreeMap::new();
    for event in file["traceEvents"].as_array().expect("a list of events") {
        let number = |key: &str| event[key].as_f64().unwrap_or_else(|| panic!("`{key}` of {event}"));
        let name = event["name"].as_str().expect("every event has a name");
        let cell = cells.entry(event["pid"].as_u64().expect("every event has a process")).or_default();
        let tid = event["tid"].as_u64().expect("every event has a thread");
        match event["ph"].as_str().expect("every event has a kind") {
            "M" if name == "process_name" => cell.name = event["args"]["name"].as_str().unwrap().to_owned(),
            "M" if name == "thread_name" => {
                assert_eq!(event["args"]["name"], format!("processor {tid}"));
                cell.named += 1;
            }
            "M" => assert_eq!(name, "process_sort_index"),
            "i" => {
                assert_eq!(event["s"], "p", "an instant of the process");
                cell.frame = event["args"]["frame"].as_u64().expect("which frame");
                cell.end = cell.end.max(number("ts"));
            }
            "X" => {
                assert!(NAMES.contains(&name), "{name}");
                let (start, length) = (number("ts"), number("dur"));
                assert!(start >= 0.0 && length > 0.0, "{event}");
                cell.processors.entry(tid).or_default().push((name.to_owned(), start, length));
            }
            other => panic!("an event of kind {other}"),
        }
    }
    cells.into_values().collect()
}

/// On each processor one event after the other, without gap or overlap, from 0 to the frame's end.
fn assert_whole(cell: &Cell) {
    assert_eq!(cell.named, cell.processors.len(), "{}", cell.name);
    assert!(cell.processors.keys().copied().eq(0..cell.named as u64), "{}", cell.name);
    for (tid, events) in &cell.processors {
        let mut now = 0.0;
        for (name, start, length) in events {
            assert!((start - now).abs() < 2e-6, "{}, {tid}: {name} at {start} after {now}", cell.name);
            now = start + length;
        }
        assert!((now - cell.end).abs() < 2e-6, "{}, {tid}: ends at {now} of {}", cell.name, cell.end);
    }
}

/// Frame times of a run's cells in the first repeat, ns, by what a viewer calls the cell.
fn frame_times(rows: &Path) -> HashMap<String, Vec<f64>> {
    let mut times: HashMap<String, Vec<f64>> = HashMap::new();
    for line in read(rows).lines() {
        let row: apportion::record::Row = serde_json::from_str(line).expect("a row");
        if row.metric == "frame_time" && row.repeat == 0 {
            let words = [row.scheme, row.settings].join(" ");
            let name =
                format!("{} on {}, P={}, {}", words.trim_end(), row.machine, row.processors, row.scene);
            times.entry(name).or_default().push(row.value);
        }
    }
    times
}

/// The lines of a log without the run's own name and what the weather was like.
fn rows_of(folder: &Path) -> Vec<String> {
    let lines = read(&folder.join("rows.jsonl"));
    let rows = lines.lines().map(|line| serde_json::from_str::<apportion::record::Row>(line).expect("a row"));
    rows.map(|row| format!("{:?}", apportion::record::Row { run: String::new(), ..row })).collect()
}

#[test]
fn simulated_cells_are_traced_at_their_median_and_their_rows_stay() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let words = ["cull-small", "--quick", "--machine", "e4000", "--processors", "1,3", "--format", "csv"];
    done(folder.path(), &[&words[..], &["--out", "plain"]].concat());
    let table = done(folder.path(), &[&words[..], &["--out", "traced", "--trace", "t.json"]].concat());
    assert!(table.starts_with("figure,"), "the table stays alone on standard output: {table}");
    let [plain, traced] = ["plain", "traced"].map(|name| folder.path().join(name));
    assert_eq!(rows_of(&plain), rows_of(&traced), "tracing changes nothing");
    assert!(!plain.join("timeline.json").exists());
    assert_eq!(read(&folder.path().join("t.json")), read(&traced.join("timeline.json")));

    let mut times = frame_times(&traced.join("rows.jsonl"));
    let cells = cells(&folder.path().join("t.json"));
    for cell in &cells {
        assert_whole(cell);
        let times = times.remove(&cell.name).unwrap_or_else(|| panic!("no rows of {}", cell.name));
        let time = times[cell.frame as usize];
        assert!((time / 1e3 - cell.end).abs() < 1e-3, "{}: {time} ns, traced {} us", cell.name, cell.end);
        let below = times.iter().filter(|&&other| other < time).count();
        let above = times.iter().filter(|&&other| other > time).count();
        let half = times.len() / 2;
        assert!(below <= half && above <= half, "{}: {time} is no median of {times:?}", cell.name);
    }
    assert!(times.is_empty(), "every cell is traced: {times:?}");
}

#[test]
fn cells_on_threads_are_traced_too_and_experiments_share_a_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let words = ["cull-small", "cull-medium", "--quick", "--machine", "threads", "--processors", "1,4"];
    let said = done(folder.path(), &[&words[..], &["--out", "all", "--trace", "t.json"]].concat());
    assert!(said.contains("wrote t.json"), "{said}");
    let together = cells(&folder.path().join("t.json"));
    let apart = ["cull-small", "cull-medium"]
        .map(|name| cells(&folder.path().join("all").join(name).join("timeline.json")));
    assert_eq!(together.len(), apart[0].len() + apart[1].len());
    for cell in &together {
        assert_whole(cell);
        let count = cell.name.split("P=").nth(1).and_then(|rest| rest.split(',').next());
        assert_eq!(count.map(str::to_owned), Some(cell.named.to_string()), "{}", cell.name);
    }
    assert!(together.iter().any(|cell| cell.name.contains("factory-medium")), "both are there");
}

#[test]
fn a_trace_that_cannot_be_written_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("there")).expect("it is made");
    for (file, why) in
        [("there", "it is a folder"), ("nowhere/t.json", "cannot write nowhere/t.json"), ("..", "folder")]
    {
        let output = run(folder.path(), &["cull-small", "--quick", "--trace", file]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains(why), "{file}: {said}");
    }
    #[cfg(unix)]
    {
        let output = run(folder.path(), &["cull-small", "--quick", "--trace", "/dev/null"]);
        assert_eq!(output.status.code(), Some(1), "a device is not put a file in the place of");
    }
    assert!(!folder.path().join("results").exists(), "nothing has run");
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("it can be read").count(),
        1,
        "nothing is left behind"
    );
}

#[test]
fn a_resumed_run_traces_what_is_left() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let words = ["cull-small", "--quick", "--machine", "e4000", "--processors", "2", "--format", "csv"];
    done(folder.path(), &[&words[..], &["--out", "whole", "--trace", "t.json"]].concat());
    // As a run that was killed while it wrote its last cell.
    let rows = folder.path().join("whole").join("rows.jsonl");
    let text = read(&rows);
    let last = text.trim_end().rfind('\n').expect("more than a line");
    std::fs::write(&rows, &text[..=last]).expect("it is written");
    let all = cells(&folder.path().join("t.json"));
    done(
        folder.path(),
        &["cull-small", "--resume", "--out", "whole", "--format", "csv", "--trace", "t.json"],
    );
    let again = cells(&folder.path().join("t.json"));
    assert_eq!(again.len(), 1, "the others have run before");
    assert_eq!(again[0].name, all[all.len() - 1].name);
    let before = read(&folder.path().join("whole").join("timeline.json"));
    done(
        folder.path(),
        &["cull-small", "--resume", "--out", "whole", "--format", "csv", "--trace", "t.json"],
    );
    assert!(cells(&folder.path().join("t.json")).is_empty());
    assert_eq!(before, read(&folder.path().join("whole").join("timeline.json")), "nothing new, nothing lost");
}
