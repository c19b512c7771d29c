use glam::Vec3;
use proptest::prelude::*;

use super::super::load;
use crate::scene::Scene;

fn read(bytes: &[u8]) -> Result<Scene, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.stl");
    std::fs::write(&path, bytes).unwrap();
    load(&path).map_err(|error| error.to_string())
}

fn binary(title: &str, triangles: &[[Vec3; 3]]) -> Vec<u8> {
    let mut bytes = title.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flat_map(|c| c.to_array()).flat_map(f32::to_le_bytes));
        bytes.extend([7, 7]);
    }
    bytes
}

fn text(triangles: &[[Vec3; 3]]) -> String {
    let facet = |corners: &[Vec3; 3]| {
        let vertices = corners.map(|c| format!("vertex {} {} {}\n", c.x, c.y, c.z)).concat();
        format!("facet normal 0 nan 1\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    format!("solid of facets\n{}endsolid of facets\n", triangles.iter().map(facet).collect::<String>())
}

const SQUARE: [[Vec3; 3]; 2] =
    [[Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0)], [Vec3::new(-0.0, 0.0, -0.0), Vec3::ONE, Vec3::Y]];

#[test]
fn binary_is_told_by_size_not_by_its_first_word() {
    for title in ["solid facet", "anything"] {
        let scene = read(&binary(title, &SQUARE)).unwrap();
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 3, 4]], "-0 is where 0 is");
        assert_eq!(scene.nodes[0].name, "model");
    }
    assert!(read(&binary("", &[])).unwrap().meshes[0].triangles.is_empty());
}

#[test]
fn solids_of_a_text_become_nodes() {
    let one = text(&SQUARE);
    let scene = read(one.as_bytes()).unwrap();
    assert_eq!((scene.nodes.len(), scene.nodes[0].name.as_str()), (1, "model"));
    let two = format!(" {}SOLID second\r\nendsolid\n", one.to_uppercase().replace("NAN", "-1e-9"));
    let scene = read(two.as_bytes()).unwrap();
    let names: Vec<&str> = scene.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!((names, scene.instances()), (vec!["model", "OF FACETS", "second"], (2, 2)));
}

#[test]
fn faults_are_named_with_their_place() {
    let good = text(&SQUARE);
    for (from, to, part) in [
        ("outer loop", "outer", "line 4: \"vertex\"; expected loop"),
        ("normal 0 nan 1", "normal 0 nan", "line 3: \"loop\"; expected outer"),
        ("vertex 1 0 0", "vertex 1 0", "line 6: \"vertex\"; expected a finite number"),
        ("vertex 1 0 0", "vertex 1 0 inf", "line 5: \"inf\"; expected a finite number"),
        ("vertex 1 0 0", "vertex 1 0 1e39", "line 5: \"1e39\""),
        ("endloop", "vertex 0 0 0\nendloop", "line 7: \"vertex\"; expected endloop"),
        ("endsolid of facets\n", "", "line 16: the end of the file; expected facet or endsolid"),
        ("endsolid of facets", "endsolid\nsold", "line 17: \"sold\"; expected solid"),
        ("solid of", "sold of", "bytes; expected 84 and 50 for each of"),
    ] {
        let bad = good.replacen(from, to, 1);
        assert_ne!(bad, good);
        let error = read(bad.as_bytes()).unwrap_err();
        assert!(error.contains("model.stl: ") && error.contains(part), "{error:?} lacks {part:?}");
    }
    let good = binary("solid", &SQUARE);
    assert!(
        read(&good[..good.len() - 1]).unwrap_err().contains("183 bytes; expected 84 and 50 for each of 2")
    );
    assert!(
        read(&good[..9]).unwrap_err().contains("line 1: the end of the file; expected facet or endsolid")
    );
    assert!(read(b"").unwrap_err().contains("header: 0 bytes; expected at least 84"));
    let mut absurd = good.clone();
    absurd[80..84].fill(0xff);
    assert!(read(&absurd).unwrap_err().contains("4294967295 triangles"));
    let lost = [[Vec3::ZERO, Vec3::X, Vec3::ZERO], [Vec3::X, Vec3::new(0.0, f32::NAN, 0.0), Vec3::Y]];
    assert!(read(&binary("", &lost)).unwrap_err().contains("triangle 1, corner 2: [0, NaN, 0]"));
}

proptest! {
    /// Welding changes no triangle and leaves no two vertices in one place.
    #[test]
    fn welding_keeps_every_corner_in_its_place(
        corners in prop::collection::vec(prop::array::uniform3(-2i8..3), 0..90),
        is_text in any::<bool>(),
        shift in prop::sample::select(vec![0.0f32, 1e6, 1e-40]),
    ) {
        let corners: Vec<Vec3> =
            corners.iter().map(|c| Vec3::from(c.map(|c| f32::from(c) * 0.1)) + shift).collect();
        let triangles: Vec<[Vec3; 3]> = corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        let bytes = if is_text { text(&triangles).into_bytes() } else { binary("", &triangles) };
        let scene = read(&bytes).unwrap();
        let mesh = &scene.meshes[0];
        let placed: Vec<[Vec3; 3]> =
            mesh.triangles.iter().map(|t| t.map(|corner| mesh.positions[corner as usize])).collect();
        prop_assert_eq!(placed, triangles);
        for (i, a) in mesh.positions.iter().enumerate() {
            prop_assert!(mesh.positions[..i].iter().all(|b| a != b), "{} twice", a);
        }
    }
}
