//! `advise`, and `auto`, which is the same choice made run by run.

use apportion::measure::advise::{Question, advise};
use apportion::record::read_rows;
use std::path::Path;
use std::process::{Command, Output};

fn apportion(folder: &Path, words: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_apportion")).args(words).current_dir(folder).output();
    output.expect("the program starts")
}

fn question(scene: &str, machine: &str, processors: Option<u32>) -> Question {
    Question { job: "cull".into(), scene: scene.into(), machine: machine.into(), processors }
}

#[test]
fn three_lines_and_the_ranking_for_those_who_ask() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let words = ["advise", "--scene", "factory-small", "--machine", "e4000", "--processors", "8"];
    let output = apportion(folder.path(), &words);
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).expect("text");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 3, "{text}");
    for (line, word) in lines.iter().zip(["use ", "expect ", "because "]) {
        assert!(line.starts_with(word), "{text}");
    }
    let output = apportion(folder.path(), &[&words[..], &["--explain"]].concat());
    let explained = String::from_utf8(output.stdout).expect("text");
    assert!(explained.starts_with(&text) && explained.contains("global_queue"), "{explained}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0, "advice writes nothing");
}

#[test]
fn words_that_are_off_end_with_two() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (words, expected) in [
        (&["--scene", "factory-larg"][..], "factory-large"),
        (&["--scene", "factory-small", "--machine", "e400"], "near ones: e4000"),
        (&["--scene", "factory-small", "--job", "cul"], "near ones: cull"),
        (&["--scene", "factory-small", "--processors", "0"], "from 1 to 256"),
        (&["--scene", "factory-small", "--machine", "e4000", "--processors", "5000"], "from 1 to 4096"),
        (&[], "--scene"),
    ] {
        let output = apportion(folder.path(), &[&["advise"], words].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{words:?}: {said}");
        assert!(said.contains(expected), "{words:?}: {said}");
    }
    let output = apportion(folder.path(), &["advise", "--scene", "nowhere.glb"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("nowhere.glb"));
}

#[test]
fn one_processor_is_an_answer() {
    for processors in [1, 2] {
        // A host on which a cache line takes a third of a millisecond from one processor to another.
        let folder = tempfile::tempdir().expect("a temporary folder");
        let slow = folder.path().join("slow.toml");
        let host = apportion(folder.path(), &["machine", "host"]).stdout;
        let host = String::from_utf8(host).expect("text");
        let lines = host.lines().map(|line| match line.split(' ').next() {
            Some("cache_to_cache") => "cache_to_cache = 1000000",
            _ => line,
        });
        std::fs::write(&slow, lines.collect::<Vec<_>>().join("\n")).expect("a file");
        let name = slow.display().to_string();
        let advice =
            advise(&question("factory-small", &name, Some(processors)), &mut |_| ()).expect("an advice");
        assert_eq!(advice.best, None, "{advice}");
        assert!(advice.to_string().starts_with("use      one processor"), "{advice}");
    }
}

#[test]
fn the_same_question_has_the_same_answer() {
    let ask = || advise(&question("factory-medium", "e4000", Some(4)), &mut |_| ()).expect("an advice");
    let (first, second) = (ask(), ask());
    assert_eq!(first.to_string(), second.to_string());
    assert_eq!(first.ranking(), second.ranking());
    let best = first.best.expect("four processors help here");
    let gain = best.predicted.expect("it was simulated");
    assert!(gain.low <= gain.median && gain.median <= gain.high && gain.low > 1.0, "{gain:?}");
    assert!(first.tried.iter().all(|choice| choice.processors <= 4));
}

/// On simulated machines, where every run is the same again.
#[test]
fn auto_is_near_the_best_choice_by_hand_and_never_worse_than_serial() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let words = ["run", "auto", "--scene", "factory-small", "--machine", "e4000,host"];
    let more = ["--processors", "1,2,4,16", "--out", "run", "--format", "json"];
    let output = apportion(folder.path(), &[&words[..], &more].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let rows = read_rows(&folder.path().join("run/rows.jsonl")).expect("the rows");
    let speedups = |machine: &str, processors: u32, auto: bool| {
        let rows = rows.iter().filter(move |row| row.metric == "speedup" && row.frame.is_none());
        rows.filter(|row| row.machine == machine && (row.scheme == "auto") == auto)
            .filter(|row| row.processors == processors || (!auto && row.scheme == "serial"))
            .map(|row| row.value)
            .fold(0.0, f64::max)
    };
    let mut near = 0;
    for machine in ["e4000", "host"] {
        for processors in [1, 2, 4, 16] {
            let (auto, best) = (speedups(machine, processors, true), speedups(machine, processors, false));
            assert!(auto >= 0.98, "{machine}, {processors}: {auto} of serial");
            near += usize::from(auto >= 0.95 * best);
        }
    }
    assert!(near >= 7, "near the best in {near} of 8 cases");
}
