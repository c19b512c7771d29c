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

/// A quad and a triangle of two materials in one object, and a third without any.
const LOOK: &str = "mtllib look.mtl\no thing\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n\
                    vn 0 1 0\nf 1 2 3\nusemtl red\nf 1/1/1 2/2/1 3/3/1 4/1/2\nusemtl tiles\nf 1/-1 2/2 3/1\no more\n\
                    f 1//2 2//-1 3//1\n";

fn read_look(mtl: Option<&str>, picture: bool) -> Result<Scene, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.obj");
    std::fs::write(&path, LOOK).unwrap();
    if let Some(mtl) = mtl {
        std::fs::write(folder.path().join("look.mtl"), mtl).unwrap();
    }
    if picture {
        let mut encoder =
            png::Encoder::new(std::fs::File::create(folder.path().join("t.png")).unwrap(), 1, 1);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_image_data(&[10, 20, 30]).unwrap();
    }
    load(&path).map_err(|error| error.to_string())
}

#[test]
fn faces_keep_their_materials_normals_and_texture_coordinates() {
    let mtl = "newmtl red\nKd 1 0 0\nnewmtl tiles\nmap_Kd t.png\n";
    let scene = read_look(Some(mtl), true).unwrap();
    assert_eq!((scene.meshes.len(), scene.instances()), (2, (2, 5)), "materials make no nodes");
    assert_eq!((&scene.warnings[..], scene.textures[0].pixels[0]), (&[][..], [10, 20, 30]));
    let thing = &scene.meshes[0];
    let materials: Vec<Option<u32>> = (0..4).map(|triangle| thing.shading.materials.of(triangle)).collect();
    assert_eq!(materials, [None, Some(0), Some(0), Some(1)]);
    assert_eq!(scene.materials[1].texture, Some(0));
    let normals = |triangle: usize| thing.shading.normals.of(triangle, thing.triangles[triangle]);
    use glam::{Vec2, Vec3};
    assert_eq!(normals(0), None);
    assert_eq!(normals(2), Some([Vec3::Z, Vec3::Z, Vec3::Y]));
    let at = |triangle: usize| thing.shading.coordinates.of(triangle, thing.triangles[triangle]);
    // v is turned over: 0 is the upper edge.
    assert_eq!(at(1), Some([Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0)]));
    assert_eq!(at(3), Some([Vec2::new(1.0, 0.0), Vec2::new(1.0, 1.0), Vec2::new(0.0, 1.0)]));
    let more = &scene.meshes[1];
    assert_eq!(more.shading.normals.of(0, more.triangles[0]), Some([Vec3::Y, Vec3::Y, Vec3::Z]));
    assert_eq!((more.shading.materials.of(0), more.shading.coordinates.of(0, [0, 1, 2])), (Some(1), None));
}

#[test]
fn what_is_not_there_is_a_warning_and_what_is_broken_an_error() {
    let scene = read_look(None, false).unwrap();
    assert_eq!(scene.warnings, ["materials \"look.mtl\" are not there: surfaces are grey"]);
    let scene = read_look(Some("newmtl tiles\nmap_Kd t.png\n"), false).unwrap();
    let expected =
        ["texture \"t.png\" is not there", "material \"red\" is in no library: its surfaces are grey"];
    assert_eq!(scene.warnings, expected);
    let error = read_look(Some("newmtl red\nKd 1 x\n"), false).unwrap_err();
    assert!(error.contains("look.mtl: line 2: \"x\"; expected a number"), "{error}");
}
