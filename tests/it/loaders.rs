//! An attack on everything that reads a file of the user's: damaged files are read or refused, with the file and the
//! place in it named, in bounded memory, and what is read is valid.

use crate::memory::most_of;
use apportion::scene::{self, CameraPath, Scene, SceneError};
use flate2::Compression;
use flate2::write::GzEncoder;
use proptest::prelude::*;
use proptest::sample::Index;
use std::io::Write;
use std::path::Path;

/// A file may take this many times its size in memory, and [`ALWAYS`]. The worst seen is a text of empty STL solids.
const MOST_TIMES: usize = 100;
/// What even an empty file may take, in bytes.
const ALWAYS: usize = 1 << 20;
/// What a small packed file may take: it may hold 16 MB unpacked, in a vector that doubles.
const PACKED: usize = 64 << 20;

const OBJ: &str = "# two objects\no floor\nv 0 0 0\nv 1 0 0 1\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n\
    f 1/1/1 2//1 3 4\ng roof\nusemtl tile\nf -4 -3 -2\nl 1 2\np 1\ns off\n";
const CSV: &str = "eye_x,eye_y,eye_z,look_x,look_y,look_z,up_x,up_y,up_z,fov_y\n0,0,0,1,0,0,0,1,0,60\n1,2,3,1,0,0,0,1,0,60\n";
const PLY: &str = "element vertex 4\nproperty float x\nproperty double y\nproperty short z\nproperty list uchar int tags\n\
    element face 2\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int vertex1\nend_header\n";
const FACET: &str =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1e0 0\nendloop\nendfacet\n";
const URDF: &str = "<?xml version=\"1.0\"?>\n<robot name=\"r\" xmlns:x=\"http://host\">\n<link name=\"a\">\n<collision>\n\
    <origin xyz=\"0 0.5 -1\" rpy=\"0 1.57 0\"/>\n<geometry><box size=\"1 2 3\"/></geometry>\n</collision>\n</link>\n\
    <link name=\"b\">\n<visual><geometry><mesh filename=\"text.stl\" scale=\"1 1 -2\"/></geometry></visual>\n\
    <visual><geometry><cylinder radius=\"0.1\" length=\"4\"/></geometry></visual>\n\
    <visual><geometry><sphere radius=\"2e0\"/></geometry></visual>\n</link>\n<!-- c -->\n\
    <joint name=\"j\" type=\"fixed\">\n<parent link=\"a\"/>\n<child link=\"b\"/>\n<origin xyz=\"1 2 3\"/>\n</joint>\n</robot>\n";

const AFF: &str = "v from 0 0 9 at 0 0 0 up 0 1 0 angle 40 hither 1 resolution 4 3\nb 0 0.5 1 am 1 1 1\n\
    l 1 2 3 0.5 0.5 0.5 la arm 0 0 1\na 0 2.5 7\nd 0 i 1 none.aff\nf 1 0 0 0.5 0.5 9 0 1\n\
    fm 1 1 1 0 1 0 0 0 1 30 0.9 1.5\nc 0 0 0 1 0 0 2 0.5 s 0 0 0 1\n\
    p 5 0 0 0 4 0 0 4 4 0 2 1 0 0 4 0\npp 3 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1\n\
    tt t.ppm 0 0 0 0 0 1 0 0 1 0 0 1 0 0 1\nxs 1 2 3 0 0 1 90 4 5 6 {\n\
    m vertices 3 0 0 0 1 0 0 0 1 0\nnormals 1 0 0 1\ntexturecoords 2 t.ppm 0 0 1 1\n\
    triangles 1 0 1 2 0 0 0 0 1 1\n}\nx arm {\ns 1 1 1 -1\n\
    tpa 2 0 0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1\n1 0 0 1 0 0 1 1 0 1 0 0 1 0 1 1 0 0 1\n}\n\
    k arm {\ntransl 4\n0 0 0 0 0 0 0\n1 1 0 0 0 0 0\n2 2 0 0 0 0 0\n3 3 0 0 0 0 0\n\
    rot 4 0 0 0 1 0 0 0 0 1 0 0 1 90 0 0 0 2 0 0 1 180 0 0 0 3 0 0 1 0 0 0 0\nvisibility 1 0 1\n}\n";

/// Good files, by name.
fn good() -> Vec<(&'static str, Vec<u8>)> {
    let text =
        format!("ply\nformat ascii 1.0\n{PLY}0 0 0 0\n1 0 0 1 5\n1 1 0 0\n0 1 0 0\n3 0 1 2\n4 0 1 2 3\n7\n");
    vec![
        ("text.ply", text.into_bytes()),
        ("little.ply", binary_ply("little", |bytes| bytes)),
        ("big.ply", binary_ply("big", |bytes| bytes.into_iter().rev().collect())),
        (
            "text.stl",
            format!("solid one\n{FACET}endsolid one\nsolid two\n{FACET}{FACET}endsolid\n").into_bytes(),
        ),
        ("binary.stl", binary_stl()),
        ("model.obj", OBJ.as_bytes().to_vec()),
        ("model.gltf", gltf(Some("AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA")).into_bytes()),
        ("model.glb", glb()),
        // It names the text.stl above, as damaged as that is.
        ("model.urdf", URDF.as_bytes().to_vec()),
        ("model.aff", AFF.as_bytes().to_vec()),
        ("model.nff", AFF.as_bytes().to_vec()),
        ("path.csv", CSV.as_bytes().to_vec()),
    ]
}

fn binary_ply(order: &str, arrange: impl Fn(Vec<u8>) -> Vec<u8>) -> Vec<u8> {
    let mut bytes = format!("ply\nformat binary_{order}_endian 1.0\n{PLY}").into_bytes();
    for [x, y] in [[0u8, 0], [1, 0], [1, 1], [0, 1]] {
        bytes.extend(arrange(f32::from(x).to_le_bytes().to_vec()));
        bytes.extend(arrange(f64::from(y).to_le_bytes().to_vec()));
        bytes.extend([0, 0, 1]);
        bytes.extend(arrange(9i32.to_le_bytes().to_vec()));
    }
    for face in [&[0i32, 1, 2][..], &[0, 1, 2, 3]] {
        bytes.push(face.len() as u8);
        face.iter().for_each(|corner| bytes.extend(arrange(corner.to_le_bytes().to_vec())));
    }
    bytes.extend([0; 4]);
    bytes
}

fn binary_stl() -> Vec<u8> {
    let mut bytes = b"solid of no text".to_vec();
    bytes.resize(80, 0);
    bytes.extend(2u32.to_le_bytes());
    for triangle in 0..2u8 {
        (0..12u8).for_each(|number| bytes.extend(f32::from(number % 5 + triangle).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// A triangle whose buffer is the binary chunk, or this data.
fn gltf(data: Option<&str>) -> String {
    let uri = data.map(|data| format!(r#""uri":"data:application/octet-stream;base64,{data}","#));
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{{}"byteLength":42}}],
"bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],
"accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,"min":[0,0,0],"max":[1,1,0]}},
{{"bufferView":1,"componentType":5123,"type":"SCALAR","count":3}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":4}}]}}],
"nodes":[{{"children":[1],"scale":[1,2,3]}},{{"mesh":0,"translation":[1,0,0]}}],"scenes":[{{"nodes":[0]}}],"scene":0}}"#,
        uri.unwrap_or_default()
    )
}

fn glb() -> Vec<u8> {
    let mut json = gltf(None).into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].as_flattened().to_vec();
    let mut binary: Vec<u8> = binary.drain(..).flat_map(f32::to_le_bytes).collect();
    binary.extend([0, 0, 1, 0, 2, 0, 0, 0]);
    let word = |number: usize| (number as u32).to_le_bytes();
    let head = [*b"glTF", word(2), word(28 + json.len() + binary.len()), word(json.len()), *b"JSON"].concat();
    [head, json, word(binary.len()).to_vec(), b"BIN\0".to_vec(), binary].concat()
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).expect("memory takes all");
    encoder.finish().expect("memory takes all")
}

/// Reads a file of a name that tells its format; of a camera path nothing but whether it is one.
fn read(path: &Path) -> Result<Scene, SceneError> {
    if path.to_string_lossy().contains(".csv") {
        return CameraPath::read_csv(path, 0.1, 100.0).map(|_| Scene::default());
    }
    scene::load(path)
}

/// Reads these bytes as a file and checks what must hold however damaged they are; tells whether they were accepted.
fn attack(folder: &Path, name: &str, bytes: &[u8], most: usize) -> Result<bool, TestCaseError> {
    let path = folder.join(name);
    std::fs::write(&path, bytes).expect("the file is written");
    let (read, held) = most_of(|| read(&path));
    prop_assert!(held <= most, "{name}: {} bytes took {held}", bytes.len());
    match &read {
        Ok(scene) => prop_assert!(scene.validate().is_ok(), "{name}: {:?}", scene.validate()),
        Err(error) => {
            let said = error.to_string();
            let place = said.strip_prefix(&format!("{}: ", path.display()));
            prop_assert!(
                place.is_some_and(|place| place.contains(": ") && place.contains("; expected ")),
                "{said}"
            );
        }
    }
    Ok(read.is_ok())
}

/// A way to damage a file.
#[derive(Clone, Debug)]
enum Damage {
    Byte(Index, u8),
    /// Four bytes in a row, as binary numbers are.
    Word(Index, u32),
    Cut(Index),
    DropLine(Index),
    DoubleLine(Index),
    /// A number in a text becomes another.
    Number(Index, &'static str),
}

const NUMBERS: [&str; 12] = [
    "4294967295",
    "-1",
    "0",
    "NaN",
    "inf",
    "1e40",
    "-1e-50",
    "18446744073709551616",
    "2147483648",
    "",
    "3",
    "-4",
];
const WORDS: [u32; 8] = [u32::MAX, 0, 1, 1 << 31, 0x7f80_0000, 0x7fc0_0000, 0x7f7f_ffff, 0xffff];

fn damage() -> impl Strategy<Value = Damage> {
    let at = any::<Index>;
    prop_oneof![
        2 => (at(), any::<u8>()).prop_map(|(at, byte)| Damage::Byte(at, byte)),
        2 => (at(), prop::sample::select(&WORDS[..])).prop_map(|(at, word)| Damage::Word(at, word)),
        1 => at().prop_map(Damage::Cut),
        1 => at().prop_map(Damage::DropLine),
        1 => at().prop_map(Damage::DoubleLine),
        3 => (at(), prop::sample::select(&NUMBERS[..])).prop_map(|(at, text)| Damage::Number(at, text)),
    ]
}

impl Damage {
    fn apply(&self, bytes: &mut Vec<u8>) {
        if bytes.is_empty() {
            return;
        }
        match self {
            Self::Byte(at, byte) => *at.get_mut(bytes.as_mut_slice()) = *byte,
            Self::Word(at, word) => {
                let start = at.index(bytes.len());
                bytes.iter_mut().skip(start).zip(word.to_le_bytes()).for_each(|(byte, new)| *byte = new);
            }
            Self::Cut(at) => bytes.truncate(at.index(bytes.len())),
            Self::DropLine(at) => Self::lines(bytes, at, 0),
            Self::DoubleLine(at) => Self::lines(bytes, at, 2),
            Self::Number(at, text) => {
                let is_part = |byte: &u8| byte.is_ascii_digit() || b".-+".contains(byte);
                let starts: Vec<usize> = (0..bytes.len())
                    .filter(|i| is_part(&bytes[*i]) && (*i == 0 || !is_part(&bytes[i - 1])))
                    .collect();
                if !starts.is_empty() {
                    let start = *at.get(&starts);
                    let length = bytes[start..].iter().take_while(|byte| is_part(byte)).count();
                    bytes.splice(start..start + length, text.bytes());
                }
            }
        }
    }

    /// Writes one line so many times.
    fn lines(bytes: &mut Vec<u8>, at: &Index, times: usize) {
        let lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
        let at = at.index(lines.len());
        let copies =
            lines.iter().enumerate().flat_map(|(i, line)| vec![*line; if i == at { times } else { 1 }]);
        *bytes = copies.collect::<Vec<_>>().concat();
    }
}

#[test]
fn the_files_that_are_damaged_are_good() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in good() {
        let most = MOST_TIMES * bytes.len() + ALWAYS;
        assert!(attack(folder.path(), name, &bytes, most).unwrap(), "{name} is refused");
        assert!(
            attack(folder.path(), &format!("{name}.gz"), &packed(&bytes), PACKED).unwrap(),
            "{name}.gz is refused"
        );
    }
}

proptest! {
    #[test]
    fn damaged_files_do_no_harm(damages in prop::collection::vec(damage(), 1..4)) {
        let folder = tempfile::tempdir().unwrap();
        for (name, good) in good() {
            let mut bytes = good.clone();
            damages.iter().for_each(|damage| damage.apply(&mut bytes));
            let accepted = attack(folder.path(), name, &bytes, MOST_TIMES * bytes.len() + ALWAYS)?;
            // Packing changes nothing about what is accepted.
            let (inside, mut outside) = (packed(&bytes), packed(&good));
            let name = format!("{name}.gz");
            prop_assert_eq!(attack(folder.path(), &name, &inside, PACKED)?, accepted);
            damages.iter().for_each(|damage| damage.apply(&mut outside));
            attack(folder.path(), &name, &outside, PACKED)?;
        }
    }
}

#[test]
fn many_small_things_take_memory_in_proportion() {
    let folder = tempfile::tempdir().unwrap();
    for (name, head, piece) in [
        ("solids.stl", "", "solid\nendsolid\n"),
        ("objects.obj", "v 0 0 0\n", "o a\nf 1 1 1\n"),
        ("polygon.obj", "v 0 0 0\nf", " 1"),
        ("braces.aff", "", "x a{}"),
        ("balls.nff", "", "f 1 1 1 1 1 1 1 1 s 0 0 0 1 "),
        ("polygons.aff", "", "p 3 0 0 0 1 0 0 0 1 0 "),
        ("meshes.aff", "", "m vertices 0 triangles 0 "),
        ("moving.aff", "", "k a{}x a{tpa 1 0 0 0 0 0 0 1 0 0 0 0 0 1 0 0 0 0 0 1}"),
        ("lines.csv", &CSV[..CSV.find('\n').unwrap() + 1], "0,0,0,1,0,0,0,1,0,9\n"),
    ] {
        let text = head.to_string() + &piece.repeat(50_000);
        let most = MOST_TIMES * text.len() + ALWAYS;
        assert!(attack(folder.path(), name, text.as_bytes(), most).unwrap(), "{name}");
    }
}

#[test]
fn many_links_and_meshes_of_a_robot_take_memory_in_proportion() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("text.stl"), format!("solid\n{}endsolid\n", FACET.repeat(1000)))
        .unwrap();
    let mut text = "<robot>\n<link name='0'/>\n".to_string();
    for number in 1..10_000 {
        let shape = ["<sphere radius='1'/>", "<mesh filename='text.stl'/>"][number % 2];
        text += &format!("<link name='{number}'><visual><geometry>{shape}</geometry></visual></link>\n");
        text += &format!(
            "<joint name='' type='fixed'><parent link='{}'/><child link='{number}'/></joint>\n",
            number / 2
        );
    }
    text += "</robot>\n";
    let most = MOST_TIMES * text.len() + ALWAYS;
    assert!(attack(folder.path(), "links.urdf", text.as_bytes(), most).unwrap());
    let nested = text.replace("</robot>", &"<a b=''>".repeat(50_000));
    let most = MOST_TIMES * nested.len() + ALWAYS;
    assert!(!attack(folder.path(), "nested.urdf", nested.as_bytes(), most).unwrap());
    // Every entity would double the one before.
    let entities: String = (1..40).map(|i| format!("<!ENTITY a{i} '&a{0};&a{0};'>", i - 1)).collect();
    let bomb = format!("<!DOCTYPE r [<!ENTITY a0 'a'>{entities}]>\n<robot><link name='&a39;'/></robot>");
    assert!(!attack(folder.path(), "bomb.urdf", bomb.as_bytes(), ALWAYS).unwrap());
    // Every element would take on the namespaces of all those around it.
    let inherited: String = (0..5000).map(|i| format!("<a xmlns:n{i}='{i}'>")).collect();
    let inherited = format!("<robot>{inherited}{}</robot>", "</a>".repeat(5000));
    assert!(!attack(folder.path(), "inherited.urdf", inherited.as_bytes(), ALWAYS).unwrap());
}

#[test]
fn accessors_that_share_a_buffer_cannot_multiply_it() {
    let folder = tempfile::tempdir().unwrap();
    let (vertices, accessors) = (60_000, 500);
    std::fs::write(folder.path().join("shared.bin"), vec![0; vertices * 12]).unwrap();
    let accessor = format!(
        r#"{{"bufferView":0,"componentType":5126,"type":"VEC3","count":{vertices},"min":[0,0,0],"max":[0,0,0]}}"#
    );
    let primitive = |number: usize| format!(r#"{{"attributes":{{"POSITION":{number}}}}}"#);
    let document = |accessors: usize| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"shared.bin","byteLength":{0}}}],
            "bufferViews":[{{"buffer":0,"byteLength":{0}}}],"accessors":[{1}],"meshes":[{{"primitives":[{2}]}}]}}"#,
            vertices * 12,
            vec![accessor.as_str(); accessors].join(","),
            (0..accessors).map(primitive).collect::<Vec<_>>().join(",")
        )
    };
    let (few, many) = (document(2), document(accessors));
    let most = MOST_TIMES * 4 * (many.len() + vertices * 12);
    assert!(!attack(folder.path(), "many.gltf", many.as_bytes(), most).unwrap());
    let said = scene::load(folder.path().join("many.gltf")).unwrap_err().to_string();
    assert!(said.contains("accessors that overlap too much"), "{said}");
    assert!(attack(folder.path(), "few.gltf", few.as_bytes(), most).unwrap());
}
