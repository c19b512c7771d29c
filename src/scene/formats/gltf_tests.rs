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

#[test]
fn materials_are_read_and_a_picture_that_is_not_there_is_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    let look = r#""materials":[{"name":"plain"},{"name":"red","alphaMode":"BLEND","pbrMetallicRoughness":{
        "baseColorFactor":[1,0.5,0,0.5],"metallicFactor":0,"roughnessFactor":0.1,"baseColorTexture":{"index":0}}}],
        "textures":[{"source":0}],"images":[{"uri":"gone%20away.png"}],"accessors""#;
    let text =
        json("").replace(r#""indices":1"#, r#""indices":1,"material":1"#).replace(r#""accessors""#, look);
    let scene = read(folder.path(), "a.glb", &glb(&text, &buffer())).unwrap();
    assert_eq!(scene.warnings, ["texture \"gone away.png\" is not there"]);
    assert_eq!(scene.meshes[0].shading.materials, Materials::One(1));
    let (plain, red) = (&scene.materials[0], &scene.materials[1]);
    // The default of glTF is rough metal.
    assert_eq!((plain.diffuse, plain.highlight, plain.mirror), (Vec3::ZERO, Vec3::ONE, Vec3::ZERO));
    assert_eq!((red.diffuse, red.transmission), (Vec3::new(0.5, 0.25, 0.0), Vec3::splat(0.5)));
    assert!(
        red.fresnel && red.mirror == Vec3::splat(0.04) && red.texture.is_none() && red.exponent == 10_000
    );
}

#[test]
fn normals_and_texture_coordinates_lie_beside_their_vertices() {
    let folder = tempfile::tempdir().unwrap();
    // The corners again, as normals; their first two numbers at the same stride, as texture coordinates.
    let more = r#""accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC2"},"#;
    let text = json("")
        .replace(r#""accessors":["#, more)
        .replace(r#""POSITION":0"#, r#""POSITION":1,"NORMAL":1,"TEXCOORD_0":0"#);
    let text = text
        .replace(r#""indices":1"#, r#""indices":2"#)
        .replace(r#""byteLength":48}"#, r#""byteLength":48,"byteStride":12}"#);
    let scene = read(folder.path(), "a.glb", &glb(&text, &buffer())).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let mesh = &scene.meshes[0];
    let vertices = mesh.triangles[1];
    assert_eq!(mesh.shading.normals.of(1, vertices), Some([0, 2, 3].map(|vertex| mesh.positions[vertex])));
    let expected = [Vec2::ZERO, Vec2::ONE, Vec2::Y];
    assert_eq!(mesh.shading.coordinates.of(1, vertices), Some(expected));
    // Normals of the wrong kind leave the shape as it is.
    let wrong = text.replace(r#""NORMAL":1"#, r#""NORMAL":0"#);
    let scene = read(folder.path(), "b.glb", &glb(&wrong, &buffer())).unwrap();
    assert!(scene.warnings.len() == 1 && scene.meshes[0].shading.normals.values.is_empty());
}
