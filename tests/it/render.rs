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
        (&["bart-museum-3", "--frames", "..3"], 2, "--out"),
        (&["bart-museum-3", "--frames", "..3", "--frame", "1", "--out", "a.y4m"], 2, "cannot be used with"),
        (&["bart-museum-3", "--frames", "3..1", "--out", "a.y4m"], 2, "the lesser first"),
        (&["bart-museum-3", "--frames", "200..300", "--out", "a.y4m"], 2, "from 0 to 299"),
        (&["corner", "--frames", "0..1", "--out", "a.y4m"], 2, "from 0 to 0"),
        (&["bart-museum-3", "--frames", "..", "--out", "a.png"], 2, "%04d"),
        (&["bart-museum-3", "--frames", "..", "--out", "a-%04d.gif"], 2, ".png, .pfm or .exr"),
        (&["bart-museum-3", "--out", "a.y4m"], 2, "a film takes --frames"),
    ] {
        let output = apportion(folder.path(), &[&["render"], words].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(code) && said.contains(part), "{words:?}: {said}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).expect("it can be listed").count(), 0);
}

#[test]
fn a_film_holds_the_frames_that_are_rendered_one_by_one() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let render = |words: &[&str]| {
        let output = apportion(
            folder.path(),
            &[&["render", "bart-museum-3", "--size", "17x12", "--depth", "2"], words].concat(),
        );
        assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
        output.stdout
    };
    let read = |name: &str| std::fs::read(folder.path().join(name)).expect("it was written");
    let said = String::from_utf8(render(&["--frames", "148..150", "--out", "a.y4m"])).expect("it is text");
    assert!(said.starts_with("a.y4m: 3 frames at 49.8333 a second, 17 x 12, "), "{said}");
    let film = read("a.y4m");
    let head = b"YUV4MPEG2 W17 H12 F299:6 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\n";
    let body = film.strip_prefix(head).expect("it begins so");
    // A word, a byte a pixel, and two for each square of four.
    assert_eq!(body.len(), 3 * (6 + 17 * 12 + 2 * 9 * 6));
    assert!(body.chunks(6 + 17 * 12 + 2 * 9 * 6).all(|frame| frame.starts_with(b"FRAME\n")));
    assert!(
        render(&["--frames", "148..150", "--out", "-"]) == film,
        "the same to standard output, and nothing else"
    );
    render(&["--frames", "148..150", "--out", "b%03d.pfm"]);
    render(&["--frames", "149..149", "--out", "c/"]);
    render(&["--frame", "149", "--out", "one.pfm"]);
    assert!(read("b149.pfm") == read("one.pfm"), "bit for bit that of the frame by itself");
    assert!(read("b148.pfm") != read("b149.pfm") && read("b150.pfm") != read("b149.pfm"), "it moves");
    assert!(read("c/bart-museum-3-0149.png").starts_with(b"\x89PNG"));
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("it can be listed").count(),
        6,
        "no other file is left"
    );
}
