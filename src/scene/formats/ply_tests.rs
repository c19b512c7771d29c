use glam::Vec3;
use proptest::prelude::*;

use super::super::load;
use crate::scene::Scene;

fn read(bytes: &[u8]) -> Result<Scene, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.ply");
    std::fs::write(&path, bytes).unwrap();
    load(&path).map_err(|error| error.to_string())
}

/// A text with faults put in by replacing.
const GOOD: &str = "ply\r\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty uchar red\n\
    property double z\nproperty float x\nproperty list uchar int tags\nproperty float y\nelement edge 1\n\
    property int a\nelement face 3\nproperty list uchar uint vertex_index\nproperty float area\nend_header\n\
    9 0 0 2 5 6 0\n9 0 1 0 0\n\n9 0 1 0 1e0\n9 0 0 1 7 1\n-3\n3 0 1 2 .5\n2 0 1 0\n4 0 1 2 3 1";

#[test]
fn extra_properties_and_elements_are_passed_over_and_polygons_cut() {
    let scene = read(GOOD.as_bytes()).unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 1, 2], [0, 2, 3]]);
    assert_eq!(
        (scene.nodes.len(), scene.nodes[0].name.as_str(), scene.name.as_str()),
        (1, "model", "model.ply")
    );
}

#[test]
fn faults_are_named_with_their_place() {
    for (from, to, part) in [
        ("ply\r", "plyx", "line 1: \"plyx\"; expected ply"),
        ("ascii", "asci", "line 2: \"asci\"; expected ascii, binary_little_endian"),
        ("format ascii 1.0", "", "the header ends without a format"),
        ("vertex 4", "vertex -4", "line 4: count \"-4\"; expected a whole number"),
        ("vertex 4", "vertex 4294967295", "line 4: 4294967295 of element `vertex`; expected at most"),
        ("vertex 4", "vertex 99999999999999999999", "line 4: count"),
        ("face 3", "face 2000000", "line 12: 2000000 of element `face`; expected at most"),
        ("vertex 4", "vertices 4", "no element `vertex`"),
        ("element face", "element faces", "no element `face`; expected a mesh, not a cloud"),
        ("float y", "float yy", "line 4: no number `y`; expected x, y and z"),
        ("float y", "float x", "line 9: a second property \"x\" of vertex"),
        ("element edge", "element vertex", "line 10: a second element \"vertex\""),
        ("property int a\n", "", "line 10: element \"edge\" without properties"),
        ("vertex_index", "corners", "line 12: no list of corners"),
        ("uchar uint", "uchar float", "line 12: no list of corners"),
        ("uchar uint", "float uint", "a count that is no whole number"),
        ("uchar uint", "uchar unit", "line 13: type \"unit\""),
        ("end_header", "end_headr", "line 15: \"end_headr\""),
        ("1 0 1e0", "1 0 1e40", "line 19, vertex 2: \"1e40\"; expected a finite number"),
        ("1 0 1e0", "1 0 NaN", "line 19, vertex 2: \"NaN\""),
        ("1 0 1e0", "1 0", "line 19, vertex 2: the line ends; expected a coordinate"),
        ("1 0 1e0", "1 0 1 1", "line 19, vertex 3: \"1\" more; expected the end of the line"),
        ("2 5 6 0", "200 5 6 0", "line 16, vertex 0: the line ends; expected one more number"),
        ("3 0 1 2 .5", "3 0 1 4 .5", "line 22, face 0: vertex index 4; expected an index below 4"),
        ("3 0 1 2 .5", "3 0 1 -1 .5", "line 22, face 0: \"-1\"; expected a whole number"),
        ("3 0 1 2 .5", "3 0 1 4294967296 .5", "line 22, face 0: \"4294967296\""),
        ("\n4 0 1 2 3 1", "", "line 23, face 2: the file ends; expected more lines"),
        ("3 1", "3 1\n7", "line 25: a line more than the header counts"),
    ] {
        assert!(GOOD.contains(from));
        let error = read(GOOD.replacen(from, to, 1).as_bytes()).unwrap_err();
        assert!(error.contains("model.ply: ") && error.contains(part), "{error:?} lacks {part:?}");
    }
    assert!(read(b"").unwrap_err().contains("line 1: the file ends within its header"));
}

#[test]
fn binary_faults_are_named_with_their_byte() {
    let header = "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
                  property float z\nelement face 1\nproperty list char short vertex_indices\nend_header\n";
    let with = |body: &[u8]| read(&[header.as_bytes(), body].concat());
    let vertex = [1.0f32, 2.0, 3.0].map(f32::to_be_bytes).concat();
    let face = [3, 0, 0, 0, 0, 0, 0];
    let scene = with(&[&vertex[..], &face].concat()).unwrap();
    assert_eq!(scene.meshes[0].positions, [Vec3::new(1.0, 2.0, 3.0)]);
    let at = |body: usize| format!("byte {}", header.len() + body);
    for (body, part) in [
        (vertex.clone(), "line 7: 1 of element `face`; expected at most the 0".to_string()),
        ([&vertex[..], &[3, 0]].concat(), format!("{}, face 0: the file ends 1 bytes on", at(13))),
        ([&vertex[..], &[255]].concat(), format!("{}, face 0: -1; expected a whole number", at(13))),
        ([&vertex[..], &[1, 0, 1]].concat(), "face 0: vertex index 1".to_string()),
        ([&vertex[..], &[1, 255, 255]].concat(), "face 0: -1".to_string()),
        ([&vertex[..], &face, &[0]].concat(), format!("{}: 1 bytes more", at(19))),
        ([&[0x7f, 0x80, 0, 0], &vertex[4..], &face].concat(), "vertex 0: inf".to_string()),
    ] {
        let error = with(&body).unwrap_err();
        assert!(error.contains(&part), "{error:?} lacks {part:?}");
    }
}

/// A number as a file may give it: its type's word and the number.
#[derive(Clone, Copy, Debug)]
struct Typed(&'static str, f64);

impl Typed {
    /// The oracle: what is written is told by the type's word alone.
    fn write(self, encoding: &str, out: &mut Vec<u8>) {
        let Self(kind, number) = self;
        let mut bytes = match kind {
            _ if encoding == "ascii" => return out.extend(format!("{number} ").bytes()),
            "char" | "int8" => (number as i8).to_be_bytes().to_vec(),
            "uchar" | "uint8" => (number as u8).to_be_bytes().to_vec(),
            "short" | "int16" => (number as i16).to_be_bytes().to_vec(),
            "ushort" | "uint16" => (number as u16).to_be_bytes().to_vec(),
            "int" | "int32" => (number as i32).to_be_bytes().to_vec(),
            "uint" | "uint32" => (number as u32).to_be_bytes().to_vec(),
            "float" | "float32" => (number as f32).to_be_bytes().to_vec(),
            _ => number.to_be_bytes().to_vec(),
        };
        if encoding == "binary_little_endian" {
            bytes.reverse();
        }
        out.extend(bytes);
    }
}

const WHOLE: [&str; 12] = [
    "char", "uchar", "short", "ushort", "int", "uint", "int8", "uint8", "int16", "uint16", "int32", "uint32",
];
const ANY: [&str; 8] = ["float", "double", "float32", "float64", "char", "uchar", "short", "uint"];

proptest! {
    #[test]
    fn what_was_written_is_read(
        encoding in prop::sample::select(vec!["ascii", "binary_little_endian", "binary_big_endian"]),
        [x, y, z] in [prop::sample::select(&ANY[..]), prop::sample::select(&ANY[..]), prop::sample::select(&ANY[..])],
        (count, index, extra) in (prop::sample::select(&WHOLE[..]), prop::sample::select(&WHOLE[..]), prop::sample::select(&WHOLE[..])),
        vertices in prop::collection::vec(prop::array::uniform3(0u8..100), 1..100),
        faces in prop::collection::vec(prop::collection::vec(0usize..100, 0..9), 0..40),
        (before, tagged) in (any::<bool>(), any::<bool>()),
    ) {
        let faces: Vec<Vec<usize>> = faces.into_iter().map(|face| face.into_iter().map(|i| i % vertices.len()).collect()).collect();
        let (mut vertex_body, mut face_body) = (Vec::new(), Vec::new());
        // Floats also between the whole numbers.
        let scale = |kind: &str| if kind.contains("float") || kind == "double" { 1.0 / 3.0 } else { 1.0 };
        for vertex in &vertices {
            for (kind, number) in [x, y, z].into_iter().zip(vertex) {
                Typed(kind, f64::from(*number) * scale(kind)).write(encoding, &mut vertex_body);
            }
            if tagged {
                Typed(extra, 2.0).write(encoding, &mut vertex_body);
                (0..2).for_each(|tag| Typed("double", f64::from(tag)).write(encoding, &mut vertex_body));
            }
            if encoding == "ascii" { vertex_body.push(b'\n') }
        }
        for face in &faces {
            Typed(count, face.len() as f64).write(encoding, &mut face_body);
            face.iter().for_each(|corner| Typed(index, *corner as f64).write(encoding, &mut face_body));
            if encoding == "ascii" { face_body.push(b'\n') }
        }
        let tags = if tagged { format!("property list {extra} double tags\n") } else { String::new() };
        let vertex = format!("element vertex {}\nproperty {x} x\nproperty {y} y\nproperty {z} z\n{tags}", vertices.len());
        let face = format!("element face {}\nproperty list {count} {index} vertex_indices\n", faces.len());
        // Faces may come before the vertices they name.
        let (elements, bodies) = match before {
            true => (face + &vertex, [face_body, vertex_body].concat()),
            false => (vertex + &face, [vertex_body, face_body].concat()),
        };
        let file = [format!("ply\nformat {encoding} 1.0\n{elements}end_header\n").into_bytes(), bodies].concat();
        let scene = read(&file).unwrap();
        let positions: Vec<Vec3> = vertices
            .iter()
            .map(|v| {
                // A text is rounded once, to f32; so is a number that was a float in the file.
                let number = |axis: usize, kind: &str| (f64::from(v[axis]) * scale(kind)) as f32;
                Vec3::new(number(0, x), number(1, y), number(2, z))
            })
            .collect();
        let triangles: Vec<[u32; 3]> = faces
            .iter()
            .flat_map(|face| (2..face.len()).map(|i| [face[0], face[i - 1], face[i]].map(|corner| corner as u32)))
            .collect();
        prop_assert_eq!(&scene.meshes[0].positions, &positions);
        prop_assert_eq!(&scene.meshes[0].triangles, &triangles);
    }
}

#[test]
fn normals_are_kept_where_all_three_are_given() {
    let text = |names: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float nx\nproperty float y\n\
             property float z\nproperty float ny\nproperty float {names}\nelement face 1\n\
             property list uchar int vertex_indices\nend_header\n\
             0 0.5 0 0 0.25 1\n1 nan 0 0 0 1\n0 0 1 0 0 -2\n3 0 1 2\n"
        )
    };
    let read = |text: String| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.ply");
        std::fs::write(&path, text).unwrap();
        load(&path).unwrap().meshes.remove(0)
    };
    let mesh = read(text("nz"));
    let expected = [Vec3::new(0.5, 0.25, 1.0), Vec3::ZERO, Vec3::new(0.0, 0.0, -2.0)];
    assert_eq!(mesh.shading.normals.of(0, mesh.triangles[0]), Some(expected), "NaN is none");
    assert_eq!(mesh.positions[2], Vec3::Y);
    assert_eq!(read(text("other")).shading.normals.of(0, [0, 1, 2]), None);
}
