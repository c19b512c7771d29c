//! `apportion render`: pictures as a user gets them.

use std::path::Path;
use std::process::{Command, Output};

fn apportion(folder: &Path, words: &[&str]) -> Output {
    let command = Command::new(env!("CARGO_BIN_EXE_apportion"))
        .args(words)
        .current_dir(folder)
        .env("APPORTION_CACHE", "off")
        .output();
    command.expect("the program starts")
}

#[test]
fn a_picture_is_written_whole_and_the_same_for_every_scheme() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut pictures = Vec::new();
    for (scheme, processors, levels) in
        [("serial", "1", "one"), ("decreasing_tiles", "2", "two"), ("interleaved", "3", "one")]
    {
        let words = ["render", "corner", "--size", "45x30", "--scheme", scheme, "--processors", processors];
        let words = [&words[..], &["--levels", levels]].concat();
        let output = apportion(folder.path(), &[&words[..], &["--out", "a.pfm"]].concat());
        let (said, wrong) =
            (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(output.status.success(), "{wrong}");
        assert!(said.starts_with("a.pfm: 45 x 30, ") && said.contains("(1350 eye, "), "{said}");
        pictures.push(std::fs::read(folder.path().join("a.pfm")).expect("it was written"));
    }
    assert_eq!(pictures[0].len(), "PF\n45 30\n-1.0\n".len() + 45 * 30 * 12);
    assert!(pictures[0] == pictures[1] && pictures[0] == pictures[2]);
    let output = apportion(folder.path(), &["render", "corner", "--size", "8x6"]);
    assert!(output.status.success());
    let png = std::fs::read(folder.path().join("corner.png")).expect("it is called after its scene");
    assert!(png.starts_with(b"\x89PNG"));
    let names = std::fs::read_dir(folder.path()).expect("it can be listed").count();
    assert_eq!(names, 2, "no other file is left");
}

#[test]
fn words_that_are_off_and_files_that_are_not_there_are_told() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (words, code, part) in [
        (&["corner", "--out", "a.gif"][..], 2, ".png, .pfm or .exr"),
        (&["cornre"], 2, "did you mean corner?"),
        (&["corner", "--scheme", "lock_free"], 2, "no scheme `lock_free` for tiles"),
        (&["corner", "--size", "0x5"], 2, "640x480"),
        (&["corner", "--levels", "three"], 2, "expected one or two"),
        (&["corner", "--camera", "1,2,3"], 2, "X,Y,Z:X,Y,Z"),
        (&["corner", "--camera", "1,2,3:1,2,3"], 2, "the point looked at is the eye"),
        (&["gone.obj"], 1, "gone.obj: cannot be read"),
    ] {
        let output = apportion(folder.path(), &[&["render"], words].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(code) && said.contains(part), "{words:?}: {said}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).expect("it can be listed").count(), 0);
}
