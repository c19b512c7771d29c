use std::path::Path;

use super::super::load;
use super::*;

/// Four vertices and six indices: a square of two triangles.
fn buffer() -> Vec<u8> {
    let corners = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut bytes: Vec<u8> = corners.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    bytes
}

fn json(buffer: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"name":"top","children":[1,2]}},{{"mesh":0,"translation":[0,0,5]}},{{"mesh":0}}],
        "meshes":[{{"name":"square","primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",
          "min":[0,0,0],"max":[1,1,0]}},{{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":48}},
          {{"buffer":0,"byteOffset":48,"byteLength":12}}],
        "buffers":[{{{buffer}"byteLength":60}}]}}"#
    )
}

fn glb(json: &str, buffer: &[u8]) -> Vec<u8> {
    let glb = gltf::Glb {
        header: gltf::binary::Header { magic: *b"glTF", version: 2, length: 0 },
        json: json.as_bytes().into(),
        bin: Some(buffer.into()),
    };
    glb.to_vec().unwrap()
}

fn read(folder: &Path, name: &str, bytes: &[u8]) -> Result<Scene, String> {
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    load(&path).map_err(|error| error.to_string())
}

#[test]
fn buffers_from_all_three_places() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a b.bin"), buffer()).unwrap();
    let inside = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMA";
    let data = format!(r#""uri":"data:application/octet-stream;base64,{inside}","#);
    for scene in [
        read(folder.path(), "a.glb", &glb(&json(""), &buffer())),
        read(folder.path(), "a.gltf", json(r#""uri":"a%20b.bin","#).as_bytes()),
        read(folder.path(), "b.gltf", json(&data).as_bytes()),
    ] {
        let scene = scene.unwrap();
        assert_eq!((scene.nodes.len(), scene.meshes.len(), scene.instances()), (3, 1, (2, 4)));
        assert_eq!(scene.bounds().max, Vec3::new(1.0, 1.0, 5.0));
    }
}

#[test]
fn strips_and_fans_keep_their_winding() {
    let indices = [7, 8, 9, 10];
    let of = |mode| assemble(mode, &indices).collect::<Vec<_>>();
    assert_eq!(of(Mode::Triangles), [[7, 8, 9]]);
    assert_eq!(of(Mode::TriangleStrip), [[7, 8, 9], [8, 10, 9]]);
    assert_eq!(of(Mode::TriangleFan), [[8, 9, 7], [9, 10, 7]]);
    assert_eq!(assemble(Mode::TriangleFan, &[1]).count(), 0);
}

#[test]
fn faults_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let edited = |from: &str, to: &str| {
        let text = json("");
        assert!(text.contains(from));
        glb(&text.replace(from, to), &buffer())
    };
    let mut nan = buffer();
    nan[4..8].copy_from_slice(&f32::NAN.to_le_bytes());
    let mut wild = buffer();
    wild[50] = 9;
    for (bytes, part) in [
        (edited(r#""count":6"#, r#""count":600"#), "accessor 1: 600 items"),
        (edited(r#""count":6"#, r#""count":18446744073709551615"#), "accessor 1"),
        (edited(r#""count":6"#, r#""count":5"#), "5 indices; expected a multiple of three"),
        (edited("48,\"byteLength\":12", "480,\"byteLength\":12"), "buffer view past the end"),
        (
            edited("48,\"byteLength\":12", "18446744073709551615,\"byteLength\":12"),
            "buffer view past the end",
        ),
        (edited(r#""byteLength":60"#, r#""byteLength":61000"#), "buffer 0: only 60 bytes"),
        (
            edited(r#""POSITION":0"#, r#""POSITION":7"#),
            "POSITION in accessor 7; expected an accessor below 2",
        ),
        (edited(r#""children":[1,2]"#, r#""children":[1,0]"#), "node 0 \"top\": it is reached twice"),
        (edited(r#""children":[1,2]"#, r#""children":[1,9]"#), "document: invalid glTF"),
        (edited("5126", "5123"), "accessor 0"),
        (glb(&json(""), &nan), "mesh 0 \"square\": vertex 0"),
        (glb(&json(""), &wild), "vertex index 9; expected indices below 4"),
        (glb(&json(r#""uri":"http://x/y.bin","#), &buffer()), "expected a file beside the document"),
        (glb(&json(r#""uri":"none.bin","#), &buffer()), "buffer 0: file \"none.bin\", which cannot be read"),
        (glb("{", &buffer()), "document"),
        (b"glTF".to_vec(), "header: no usable length"),
        (b"glTF\x02\0\0\0\x01\0\0\0".to_vec(), "header: no usable length"),
    ] {
        let error = read(folder.path(), "bad.glb", &bytes).unwrap_err();
        assert!(error.contains(part), "{error:?} lacks {part:?}");
    }
    let whole = glb(&json(""), &buffer());
    let error = read(folder.path(), "cut.glb", &whole[..whole.len() - 1]).unwrap_err();
    assert!(error.contains("cut.glb: header: ") && error.contains("it declares"), "{error}");
}

#[test]
fn cut_or_garbled_files_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let whole = glb(&json(""), &buffer());
    for end in 0..whole.len() {
        assert!(read(folder.path(), "cut.glb", &whole[..end]).is_err());
    }
    for at in 0..whole.len() {
        for byte in [0, 0x39, 0xff] {
            let mut garbled = whole.clone();
            garbled[at] = byte;
            let _ = read(folder.path(), "garbled.glb", &garbled);
        }
    }
}

#[test]
fn deeply_nested_nodes_do_not_overflow_the_stack() {
    let folder = tempfile::tempdir().unwrap();
    let count = 50_000;
    let nodes: Vec<String> = (0..count)
        .map(|i| if i + 1 < count { format!(r#"{{"children":[{}]}}"#, i + 1) } else { "{}".into() })
        .collect();
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{}]}}"#,
        nodes.join(",")
    );
    assert_eq!(read(folder.path(), "deep.gltf", text.as_bytes()).unwrap().nodes.len(), count);
}
