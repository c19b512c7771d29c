//! The program as a user meets it: words, exit codes, bad weather.

use std::path::Path;
use std::process::{Command, Output};

/// Runs the program in a folder.
fn apportion(folder: &Path, words: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_apportion")).args(words).current_dir(folder).output();
    output.expect("the program starts")
}

fn out(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What it said on standard error, and that it ended with this code.
#[track_caller]
fn refused(folder: &Path, words: &[&str], code: i32) -> String {
    let output = apportion(folder, words);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{words:?}: {said}");
    assert!(output.stdout.is_empty(), "{words:?} printed {}", out(&output));
    assert!(!said.contains("panicked"), "{said}");
    said
}

fn empty() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

#[test]
fn lists_the_experiments_from_anywhere() {
    let folder = empty();
    let output = apportion(folder.path(), &["list"]);
    assert!(output.status.success());
    let list = out(&output);
    assert!(list.contains("Paper II\n  collide-aabb ") && list.contains("\n  cull-large "), "{list}");
    assert!(list.contains("Fig. 1a") && list.contains("\nQuestions of our own\n"), "{list}");
    assert!(list.lines().all(|line| line.chars().count() <= 80), "{list}");
}

#[test]
fn an_unknown_experiment_lists_the_near_ones() {
    let folder = empty();
    for words in [["run", "cul-large"], ["table", "cul-large"]] {
        let said = refused(folder.path(), &words, 2);
        assert!(said.contains("there is no experiment `cul-large`; near ones: cull-large"), "{said}");
    }
    assert!(!folder.path().join("results").exists(), "nothing is written for words that are off");
}

#[test]
fn words_that_are_off_end_with_two() {
    let folder = empty();
    for (words, expected) in [
        (&["run", "cull-large", "--processors", "0"][..], "from 1 to 4096"),
        (&["run", "cull-large", "--processors", "10000"], "from 1 to 4096"),
        (&["run", "cull-large", "--machine", "threads", "--processors", "257"], "from 1 to 256"),
        (&["run", "cull-large", "--processors", "1-"], "expected a list like `1,2,4-13`"),
        (&["run", "cull-large", "--scheme", "lockfree"], "near ones: lock_free"),
        (&["run", "cull-large", "--machine", "e400"], "near ones: e4000"),
        (&["run", "cull-large", "--frames", "0"], "start at 1"),
        (&["run", "cull-large", "--scene", "factory-larg"], "did you mean factory-large"),
        (&["run", "tree-work", "--scene", "factory-large"], "takes no --scene"),
        (&["run", "cull-large", "cull-small", "cull-large", "--out", "x"], "cull-large is named twice"),
        (&["run", "cull-large", "--until", "0"], "above 0 and up to 100"),
        (&["run", "cull-large", "--until", "five"], "above 0 and up to 100"),
        (&["run", "cull-large", "--at-most", "9"], "--until"),
        (&["compare", "cul-large", "x"], "near ones: cull-large"),
        (&["compare", ".", "."], ". holds no run"),
        (&["compare", "x", "y", "--metric", "frame_tim"], "near ones: frame_time"),
        (&["run"], "NAME"),
        (&["runn"], "run"),
        (&["stress", "lock_free", "--processors", "0", "--seconds", "1"], "1..=256"),
    ] {
        let said = refused(folder.path(), words, 2);
        assert!(said.contains(expected), "{words:?}: {said}");
    }
    assert!(!folder.path().join("results").exists(), "nothing is written for words that are off");
}

#[test]
fn a_malformed_experiment_names_file_and_line() {
    let folder = empty();
    let experiments = folder.path().join("experiments");
    std::fs::create_dir(&experiments).expect("it is made");
    std::fs::write(experiments.join("bad.toml"), "title = \"x\"\njob = [\n").expect("it is written");
    let said = refused(folder.path(), &["run", "bad"], 1);
    assert!(said.contains("bad.toml, line "), "{said}");
    let listed = apportion(folder.path(), &["list"]);
    assert_eq!(listed.status.code(), Some(1));
    assert!(out(&listed).contains("cull-large"), "one bad file does not hide the others");
}

#[test]
fn an_experiment_that_is_no_text_hides_no_other() {
    let folder = empty();
    let experiments = folder.path().join("experiments");
    std::fs::create_dir(&experiments).expect("it is made");
    std::fs::write(experiments.join("bad.toml"), b"\xff\xfe").expect("it is written");
    let said = refused(folder.path(), &["run", "bad"], 1);
    assert_eq!(said.matches("valid UTF-8").count(), 1, "the cause is told once: {said}");
    refused(folder.path(), &["table", "cull-large"], 1);
    assert!(out(&apportion(folder.path(), &["list"])).contains("cull-large"));
}

#[test]
fn a_setting_that_is_off_names_file_and_key() {
    let folder = empty();
    let experiments = folder.path().join("experiments");
    std::fs::create_dir(&experiments).expect("it is made");
    let small = include_str!("../../experiments/cull-small.toml");
    for (setting, expected) in [
        ("\"job.pause_ms\" = \"long\"", "setting `job.pause_ms` is `long`"),
        ("\"job.pauses\" = 1", "job `cull` has no setting `job.pauses`; near ones: pause_ms"),
        ("\"lock_free.frobs\" = 1", "scheme `lock_free` has no setting `frobs`"),
        ("\"e4000.memory\" = 0.5", "setting `e4000.memory`: machine `e4000`"),
        ("\"machine.memry\" = 5", "no constant `memry`"),
        (
            "\"scene.path\" = \"spin\"",
            "setting `scene.path` is `spin`, expected one of: walk, both, rotation",
        ),
        ("\"scene.pth\" = \"walk\"", "no setting `scene.pth`; near ones: path"),
    ] {
        let text = small.replace("[settings]\n", &format!("[settings]\n{setting}\n"));
        // With the byte order mark some editors begin a file with.
        std::fs::write(experiments.join("odd.toml"), format!("\u{feff}{text}")).expect("it is written");
        let said = refused(folder.path(), &["run", "odd", "--quick"], 2);
        assert!(said.contains("odd.toml: ") && said.contains(expected), "{said}");
    }
    assert!(!folder.path().join("results").exists(), "nothing is written for words that are off");
}

#[test]
fn a_path_has_as_many_frames_as_are_asked_for() {
    let folder = empty();
    let path = "eye_x,eye_y,eye_z,look_x,look_y,look_z,up_x,up_y,up_z,fov_y\n0,2,0,9,2,0,0,1,0,60\n1,2,0,9,2,0,0,1,0,60\n";
    std::fs::write(folder.path().join("walk.csv"), path).expect("it is written");
    let words = ["run", "cull-small", "--machine", "e4000", "--processors", "2", "--scheme", "hybrid"];
    let words: Vec<&str> =
        words.into_iter().chain(["--path", "walk.csv", "--out", "run", "--frames"]).collect();
    let run = |frames| -> Vec<&str> { words.iter().copied().chain([frames]).collect() };
    let said = refused(folder.path(), &run("3"), 2);
    assert!(said.contains("walk.csv: 2 frames, where --frames asks for 3"), "{said}");
    assert!(apportion(folder.path(), &run("1")).status.success());
    // Without --frames it is as long as it is; and the two runs can be held against each other.
    let mut words = words[..words.len() - 1].to_vec();
    words.pop();
    words.push("other");
    assert!(apportion(folder.path(), &words).status.success());
    let output = apportion(folder.path(), &["compare", "run", "other"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(out(&output).contains("all together"), "{}", out(&output));
    assert!(!out(&output).contains('\u{1b}'), "colours only on a terminal");
}

#[test]
fn an_unknown_structure_is_refused() {
    let folder = empty();
    let experiments = folder.path().join("experiments");
    std::fs::create_dir(&experiments).expect("it is made");
    let small = include_str!("../../experiments/cull-small.toml");
    std::fs::write(experiments.join("odd.toml"), format!("structure = \"bvh9\"\n{small}"))
        .expect("it is written");
    let said = refused(folder.path(), &["run", "odd", "--quick"], 1);
    assert!(said.contains("odd.toml, line 1: there is no structure `bvh9`"), "{said}");
}

#[test]
fn a_scene_that_cannot_be_run_leaves_no_folder() {
    let folder = empty();
    std::fs::write(folder.path().join("nan.obj"), "v nan 0 0\n").expect("it is written");
    std::fs::write(folder.path().join("empty.obj"), "").expect("it is written");
    for (scene, expected) in
        [("nan.obj", "line 1"), ("empty.obj", "nothing in it"), ("none.glb", "cannot be read")]
    {
        let said = refused(folder.path(), &["run", "cull-scene", "--quick", "--scene", scene], 1);
        assert!(said.contains(expected), "{said}");
    }
    assert!(!folder.path().join("results").exists(), "there is nothing to resume");
}

#[test]
fn a_machine_may_be_a_file() {
    let folder = empty();
    let text = out(&apportion(folder.path(), &["machine", "e4000"]));
    std::fs::write(folder.path().join("mine.toml"), &text).expect("it is written");
    std::fs::write(folder.path().join("off.toml"), text.replace("l1_hit", "l1_hits")).expect("it is written");
    let run = |machine| {
        ["run", "cull-small", "--quick", "--machine", machine, "--processors", "2", "--scheme", "lock_free"]
    };
    let said = refused(folder.path(), &run("off.toml"), 1);
    assert!(said.contains("off.toml") && said.contains("l1_hits"), "{said}");
    let output = apportion(folder.path(), &run("mine.toml"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(out(&output).contains("speedup on mine.toml, factory-small"), "{}", out(&output));
}

#[test]
fn an_unwritable_results_folder_is_named() {
    let folder = empty();
    std::fs::write(folder.path().join("results"), "a file where a folder should be").expect("it is written");
    let said = refused(folder.path(), &["run", "cull-large"], 1);
    assert!(said.contains("cannot create results/cull-large"), "{said}");
    let said = refused(folder.path(), &["run", "cull-large", "--out", "/dev/null/x"], 1);
    assert!(said.contains("cannot create /dev/null/x"), "{said}");
}

#[test]
fn nothing_to_resume_or_to_show_is_said() {
    let folder = empty();
    let said = refused(folder.path(), &["run", "cull-large", "--resume"], 1);
    assert!(said.contains("no unfinished run of cull-large in results/cull-large"), "{said}");
    let said = refused(folder.path(), &["table", "cull-large"], 1);
    assert!(said.contains("no finished run of cull-large"), "{said}");
}

#[test]
fn completions_and_manual_are_printed() {
    let folder = empty();
    for (words, expected) in
        [(&["completions", "bash"][..], "complete"), (&["man"], ".TH apportion"), (&["help"], "stress")]
    {
        let output = apportion(folder.path(), words);
        assert!(output.status.success() && out(&output).contains(expected), "{words:?}");
    }
    assert!(apportion(folder.path(), &["man", "--out", "man1"]).status.success());
    for page in ["apportion.1", "apportion-run.1", "apportion-compare.1"] {
        assert!(folder.path().join("man1").join(page).exists(), "no {page}");
    }
    for shell in ["bash", "zsh", "fish"] {
        let text = out(&apportion(folder.path(), &["completions", shell]));
        // Fish is not told the values of words without a dash.
        let experiment = if shell == "fish" { "compare" } else { "cull-large" };
        for word in [experiment, "lock_free", "e4000", "frame_time_p90"] {
            assert!(text.contains(word), "{shell} does not offer {word}");
        }
        std::fs::write(folder.path().join(shell), &text).expect("it is written");
        // A shell that is not there checks nothing.
        if let Ok(checked) = Command::new(shell).arg("-n").arg(folder.path().join(shell)).output() {
            assert!(checked.status.success(), "{shell}: {}", String::from_utf8_lossy(&checked.stderr));
        }
    }
}

#[test]
fn every_help_has_examples() {
    let folder = empty();
    for word in
        ["list", "run", "table", "compare", "render", "scene", "machine", "stress", "completions", "man"]
    {
        let text = out(&apportion(folder.path(), &["help", word]));
        let examples = text.split_once("Examples:\n").map_or("", |(_, examples)| examples);
        assert!(examples.contains(&format!("  apportion {word}")), "{text}");
    }
}

#[test]
fn a_report_needs_a_run_and_links_to_its_files() {
    let folder = empty();
    let said = refused(folder.path(), &["report"], 1);
    assert!(said.contains("no finished run in results: run an experiment first"), "{said}");
    let said = refused(folder.path(), &["report", "nowhere"], 1);
    assert!(said.contains("cannot read nowhere"), "{said}");
    assert!(!folder.path().join("results").exists(), "nothing is written where there is nothing to show");
    let words =
        ["run", "cull-small", "--quick", "--machine", "e4000", "--processors", "2", "--scheme", "lock_free"];
    assert!(apportion(folder.path(), &words).status.success());
    let output = apportion(folder.path(), &["report", "--out", "pages/a b/report.html"]);
    assert!(out(&output).contains("wrote pages/a b/report.html: 1 run, "), "{}", out(&output));
    let page = folder.path().join("pages/a b/report.html");
    let html = std::fs::read_to_string(&page).expect("the page was written");
    // Every file it names is there: what `run` writes and what the page promises are the same.
    let links: Vec<&str> =
        html.split("href=\"../").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert!(links.len() > 8, "{links:?}");
    for link in links {
        let file = page.parent().expect("it lies in a folder").join("..").join(link);
        assert!(file.is_file(), "{link} is not there");
    }
}

#[test]
fn an_experiment_can_ask_for_every_kind_of_camera_path() {
    let folder = empty();
    let experiments = folder.path().join("experiments");
    std::fs::create_dir(&experiments).expect("it is made");
    let kinds: Vec<&str> = apportion::scene::PATHS.iter().map(|kind| kind.name).collect();
    let text = format!(
        "title = \"Paths\"\njob = \"cull\"\nscene = \"factory-small\"\nframes = 30\nquick_frames = 5\nrepeats = 1\n\
         machines = [\"threads\"]\nprocessors = {{ threads = \"1\" }}\nschemes = [\"serial\"]\n\
         [sweep]\n\"scene.path\" = {kinds:?}\n"
    );
    std::fs::write(experiments.join("paths.toml"), text).expect("it is written");
    let output = apportion(folder.path(), &["run", "paths", "--format", "csv"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    let csv = out(&output);
    for kind in kinds {
        assert!(csv.contains(&format!("scene.path={kind},")), "no rows of {kind}: {csv}");
    }
    let said = refused(folder.path(), &["run", "paths", "--path", "walk.csv"], 2);
    assert!(said.contains("sets `scene.path`: it takes no --path walk.csv"), "{said}");
}

#[test]
fn a_scene_is_saved_as_aff_with_what_could_not_be_told() {
    let folder = empty();
    let output = apportion(folder.path(), &["scene", "room", "--save", "copy.aff"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && said.contains("mirror the more the flatter"), "{said}");
    let text = std::fs::read_to_string(folder.path().join("copy.aff")).expect("it was written");
    let pictures = text.split_whitespace().filter(|word| word.ends_with(".ppm"));
    let pictures: std::collections::BTreeSet<&str> = pictures.collect();
    assert!(!pictures.is_empty());
    for picture in pictures {
        assert!(folder.path().join(picture).is_file(), "{picture} is not there");
    }
    let described = |name: &str| {
        let text = out(&apportion(folder.path(), &["scene", name]));
        let line =
            text.lines().find(|line| line.starts_with("placed")).expect("a line of triangles").to_owned();
        line.rsplit(", ").next().unwrap_or_default().to_owned()
    };
    assert_eq!(described("copy.aff"), described("room"));
    let left = std::fs::read_dir(folder.path()).expect("the folder is there").flatten();
    assert!(
        left.map(|entry| entry.path()).all(|path| path.extension().is_some_and(|e| e == "aff" || e == "ppm"))
    );
    for (words, part, code) in [
        (&["scene", "room", "--save", "copy.obj"][..], "ends in .aff", 2),
        (&["scene", "rom", "--save", "copy.aff"], "room", 2),
        (&["scene", "room", "--save", "none/copy.aff"], "none", 1),
    ] {
        let said = String::from_utf8_lossy(&apportion(folder.path(), words).stderr).into_owned();
        assert!(said.contains(part), "{words:?}: {said}");
        assert_eq!(apportion(folder.path(), words).status.code(), Some(code), "{words:?}");
    }
}
