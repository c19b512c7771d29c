use std::path::PathBuf;

use super::super::load;
use crate::scene::Scene;

const GOOD: &str = "# two objects\no floor\nv 0 0 0\nv 1 0 0\nv 1 1 0 1\nv 0 1 0\nvt 0 0\nvn 0 0 1\n\
                    f 1/1/1 2//1 3 4\no roof\nf -4 -3 -2\nl 1 2\n";

fn read(text: &[u8]) -> Result<Scene, String> {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join("model.obj");
    std::fs::write(&path, text).unwrap();
    load(&path).map_err(|error| error.to_string())
}

#[test]
fn objects_become_children_of_one_root() {
    let scene = read(GOOD.as_bytes()).unwrap();
    let names: Vec<&str> = scene.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["model", "floor", "roof"]);
    assert_eq!(scene.roots, [0]);
    assert_eq!(scene.instances(), (2, 3));
}

#[test]
fn faults_are_named_with_their_line() {
    for (text, part) in [
        ("v 0 0\n", "line 1: 2 numbers; expected at least 3"),
        ("v 0 0 0\nv 1 nan 0\n", "line 2: \"nan\"; expected a finite number"),
        ("v 0 0 1e99\n", "line 1: \"1e99\""),
        ("v 0 0 0\nf 1 1 2\n", "line 2: corner \"2\"; expected a vertex index among the 1 given so far"),
        ("v 0 0 0\nf 1 1 -2\n", "line 2: corner \"-2\""),
        ("v 0 0 0\nf 1 0 1\n", "line 2: corner \"0\""),
        ("v 0 0 0\nvt 0 0\nf 1/1 1/-9223372036854775808 1\n", "line 3: corner"),
        ("v 0 0 0\nf 1/1/1/1 1 1\n", "line 2: corner"),
        ("v 0 0 0\nf\n", "line 2: no corners"),
        ("v 0 0 0 0\n", "line 1: w is 0"),
        ("v 0 0 0 1 1\n", "line 1: 5 numbers"),
        ("v 0 0 0\nv 0 0 1 .5 .5 .5\n", "line 2: a vertex with a colour; expected a colour for all"),
        ("v 0 0 0 1 1 1\nv 0 0 1 1\n", "line 2: a vertex without a colour"),
    ] {
        let error = read(text.as_bytes()).unwrap_err();
        assert!(error.contains("model.obj: ") && error.contains(part), "{error:?} lacks {part:?}");
    }
    assert!(read(b"v 0 0 0\n\xff\xfe").unwrap_err().contains("line 2: a byte that is not UTF-8"));
}

#[test]
fn cut_or_garbled_files_never_panic() {
    let good = GOOD.as_bytes();
    for end in 0..good.len() {
        let _ = read(&good[..end]);
    }
    for at in 0..good.len() {
        for byte in [b'-', b'9', b'/', b' ', b'\n', b'o', 0xff] {
            let mut garbled = good.to_vec();
            garbled[at] = byte;
            let _ = read(&garbled);
        }
    }
}
