//! House rules, held by tests: arrows between rooms, formatting, file length, experiments, README, no machine paths.

use apportion::measure::{Known, Shelf};
use std::path::{Path, PathBuf};
use std::process::Command;

/// No file may be longer, lines.
const LONGEST: usize = 400;
/// Which rooms a room may use, beside itself.
const ARROWS: &[(&str, &[&str])] = &[
    ("geometry", &[]),
    ("scene", &["geometry"]),
    ("structure", &["geometry", "scene"]),
    ("machine", &[]),
    ("sync", &["machine"]),
    ("scheme", &["machine", "sync"]),
    ("job", &["geometry", "scene", "structure", "machine", "scheme"]),
    ("measure", &["geometry", "scene", "structure", "machine", "sync", "scheme", "job", "record"]),
    ("record", &[]),
    ("report", &["record"]),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All files below a folder whose name ends in one of these, sorted; a folder that is absent has none.
fn files(folder: &Path, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            // What cargo builds below a package of its own is nobody's source.
            if path.file_name().is_some_and(|name| name == "target") {
                continue;
            }
            found.extend(files(&path, endings));
        } else if endings.iter().any(|ending| path.extension().is_some_and(|extension| extension == *ending))
        {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Every Rust file of the tree, whether or not a `mod` line the compiler's tools can see names it.
fn sources() -> Vec<PathBuf> {
    let folders = ["src", "tests", "benches", "examples"].map(|folder| root().join(folder));
    let mut sources: Vec<PathBuf> = folders.iter().flat_map(|folder| files(folder, &["rs"])).collect();
    sources.push(root().join("build.rs"));
    assert!(sources.len() > 20, "the tree was found");
    sources
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn name(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

/// The rooms named by `crate::room` in a text, also within `use crate::{room::..., room}`; comments are not code.
fn rooms_used(text: &str) -> Vec<String> {
    let code: Vec<&str> = text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect();
    let code = code.join("\n");
    let mut rooms = Vec::new();
    let word =
        |text: &str| text.chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect();
    for (at, start) in code.match_indices("crate::") {
        if code[..at].ends_with(|letter: char| letter.is_alphanumeric() || letter == '_') {
            continue;
        }
        let rest = &code[at + start.len()..];
        let Some(list) = rest.strip_prefix('{') else {
            rooms.push(word(rest));
            continue;
        };
        let mut depth = 0;
        let mut first = String::new();
        for letter in list.chars() {
            match letter {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' if depth == 0 => rooms.push(word(std::mem::take(&mut first).trim())),
                _ if depth == 0 => first.push(letter),
                _ => {}
            }
        }
        rooms.push(word(first.trim()));
    }
    rooms
}

#[test]
fn the_scanner_sees_rooms() {
    let text = "use crate::scene::Scene;\nuse crate::{job::{cull, trace}, sync};\n// crate::report\nlet a = crate::machine::x(); $crate::record!()";
    assert_eq!(rooms_used(text), ["scene", "job", "sync", "machine", "record"]);
}

#[test]
fn rooms_use_only_what_the_arrows_allow() {
    let mut wrong = Vec::new();
    for (room, allowed) in ARROWS {
        let files = files(&root().join("src").join(room), &["rs"]);
        assert!(!files.is_empty(), "room {room} is empty");
        for file in files {
            for used in rooms_used(&read(&file)) {
                let is_room = ARROWS.iter().any(|(other, _)| *other == used) || used == "command";
                if is_room && used != *room && !allowed.contains(&used.as_str()) {
                    wrong.push(format!("{}: {room} uses {used}", name(&file)));
                }
            }
        }
    }
    let rooms = std::fs::read_dir(root().join("src")).expect("src is there").flatten();
    for room in rooms.filter(|entry| entry.path().is_dir()) {
        let room = room.file_name().to_string_lossy().into_owned();
        if room != "command" && !ARROWS.iter().any(|(known, _)| *known == room) {
            wrong.push(format!("room {room} has no arrows here"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_file_is_formatted_also_those_only_a_macro_names() {
    let Ok(found) = Command::new("rustfmt").arg("--version").output() else {
        eprintln!("rustfmt is not there: formatting is not checked");
        return;
    };
    assert!(found.status.success() || !found.stderr.is_empty());
    if !found.status.success() {
        eprintln!("rustfmt does not run: formatting is not checked");
        return;
    }
    let mut command = Command::new("rustfmt");
    command.args(["--edition", "2024", "--check", "--config-path"]).arg(root().join("rustfmt.toml"));
    let output = command.args(sources()).output().expect("rustfmt runs");
    let said =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "run `cargo fmt`, and `rustfmt FILE` on those it does not see:\n{said}");
}

#[test]
fn no_file_is_too_long() {
    let lengths = sources().into_iter().map(|file| (read(&file).lines().count(), name(&file)));
    let long: Vec<_> = lengths.filter(|(lines, _)| *lines > LONGEST).collect();
    assert!(long.is_empty(), "over {LONGEST} lines: {long:?}");
}

#[test]
fn every_experiment_parses_and_can_be_planned() {
    let shelf = Shelf::open(&root().join("experiments")).expect("the folder can be read");
    let known = Known::here();
    assert!(shelf.names().count() > 0);
    for name in shelf.names() {
        let experiment = shelf.load(name, &known).unwrap_or_else(|error| panic!("{error}"));
        let scenes = if experiment.scenes.is_empty() { vec!["scene.glb".to_owned()] } else { Vec::new() };
        let selection = apportion::measure::Selection { scenes, ..Default::default() };
        let plan = apportion::measure::Plan::new(&experiment, &selection, &known, 2);
        plan.unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

/// The lines of the README's `sh` blocks.
fn readme_commands() -> Vec<String> {
    let path = root().join("README.md");
    let text = if path.exists() { read(&path) } else { String::new() };
    let mut inside = false;
    let mut commands = Vec::new();
    for line in text.lines() {
        if line.starts_with("```") {
            inside = line.trim() == "```sh";
        } else if inside {
            commands.push(line.trim_start_matches("$ ").trim().to_owned());
        }
    }
    commands
}

#[test]
fn the_readmes_commands_exist() {
    for line in readme_commands() {
        let words: Vec<&str> = line.split_whitespace().take_while(|word| !word.starts_with('#')).collect();
        let after = words.iter().position(|word| *word == "apportion").or_else(|| {
            let run = words.windows(2).any(|pair| pair == ["cargo", "run"]);
            run.then(|| words.iter().position(|word| *word == "--")).flatten()
        });
        let Some(action) = after.and_then(|at| words.get(at + 1)) else { continue };
        let output = Command::new(env!("CARGO_BIN_EXE_apportion")).args(["help", action]).output();
        assert!(
            output.expect("the program starts").status.success(),
            "README: `{line}`: no command {action}"
        );
        let shelf = Shelf::open(&root().join("experiments")).expect("the folder can be read");
        if ["run", "table"].contains(action) {
            for experiment in words.iter().skip_while(|word| *word != action).skip(1) {
                if experiment.starts_with('-') {
                    break;
                }
                assert!(shelf.names().any(|name| name == *experiment), "README: `{line}`: no {experiment}");
            }
        }
    }
}

#[test]
fn nothing_names_a_machines_own_folders() {
    // Put together here, so that this file does not hold them.
    let paths = ["work", "home", "root", "Users", "tmp/wt"].map(|folder| format!("/{folder}/"));
    let kinds = ["rs", "toml", "md", "json", "svg", "yml"];
    let folders =
        ["src", "tests", "benches", "examples", "experiments", "results"].map(|folder| root().join(folder));
    let mut all: Vec<PathBuf> = folders.iter().flat_map(|folder| files(folder, &kinds)).collect();
    all.extend(["README.md", "CONTRIBUTING.md", "Cargo.toml", ".ci/run"].map(|file| root().join(file)));
    for file in all.iter().filter(|file| file.exists() && is_committed(file)) {
        let text = String::from_utf8_lossy(&std::fs::read(file).expect("it can be read")).into_owned();
        for path in &paths {
            assert!(!text.contains(path.as_str()), "{} names {path}", name(file));
        }
    }
}

/// Local runs lie beside the reference runs and may say what they like.
fn is_committed(file: &Path) -> bool {
    let mut parts = file.strip_prefix(root()).unwrap_or(file).components().map(|part| part.as_os_str());
    parts.next().is_none_or(|first| first != "results") || parts.nth(1).is_some_and(|run| run == "reference")
}
