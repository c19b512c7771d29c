use std::path::Path;

use glam::DVec3;

use super::super::load;
use super::*;

/// A triangle on node 1, below node 0; node 0 is turned by rotations from a quarter turn about x to one about y, node 1
/// moves in steps and is scaled along a cubic. Buffer: corners, times 1 and 3, two rotations, two places, six scales.
fn text() -> String {
    const HALF: f32 = std::f32::consts::FRAC_1_SQRT_2;
    let floats: Vec<f32> = [
        &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0][..],
        &[1.0, 3.0],
        &[HALF, 0.0, 0.0, HALF, 0.0, HALF, 0.0, HALF],
        &[1.0, 2.0, 3.0, -1.0, 0.0, 5.0],
        // Coming to, scale, leaving: twice.
        &[9.0, 9.0, 9.0, 1.0, 1.0, 1.0, 0.0, 0.5, 1.0],
        &[0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 9.0, 9.0, 9.0],
        // To a length that three divides.
        &[0.0, 0.0],
    ]
    .concat();
    let bytes: Vec<u8> = floats.iter().flat_map(|number| number.to_le_bytes()).collect();
    let mut views = Vec::new();
    let mut accessors = Vec::new();
    for (start, count, kind, parts) in
        [(0, 3, "VEC3", 3), (9, 2, "SCALAR", 1), (11, 2, "VEC4", 4), (19, 2, "VEC3", 3), (25, 6, "VEC3", 3)]
    {
        let view = views.len();
        views.push(format!(
            r#"{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#,
            4 * start,
            4 * count * parts
        ));
        let bounds = if view == 0 { r#","min":[0,0,0],"max":[1,1,0]"# } else { "" };
        accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":5126,"count":{count},"type":"{kind}"{bounds}}}"#
        ));
    }
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"name":"arm","children":[1],"translation":[0,0,7]}},{{"name":"hand","mesh":0}},{{"name":"lost"}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "animations":[{{"channels":[
          {{"sampler":0,"target":{{"node":0,"path":"rotation"}}}},
          {{"sampler":1,"target":{{"node":1,"path":"translation"}}}},
          {{"sampler":2,"target":{{"node":1,"path":"scale"}}}},
          {{"sampler":1,"target":{{"node":2,"path":"translation"}}}}],
        "samplers":[{{"input":1,"output":2}},{{"input":1,"output":3,"interpolation":"STEP"}},
          {{"input":1,"output":4,"interpolation":"CUBICSPLINE"}}]}}],
        "accessors":[{}],"bufferViews":[{}],
        "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}]}}"#,
        accessors.join(","),
        views.join(","),
        bytes.len(),
        encoded(&bytes),
    )
}

/// RFC 4648, of a length that three divides.
pub(in super::super) fn encoded(bytes: &[u8]) -> String {
    let (threes, rest) = bytes.as_chunks::<3>();
    assert!(rest.is_empty(), "pad the buffer");
    let letters: Vec<u8> = (b'A'..=b'Z').chain(b'a'..=b'z').chain(b'0'..=b'9').chain(*b"+/").collect();
    let four = |[a, b, c]: &[u8; 3]| {
        let bits = u32::from_be_bytes([0, *a, *b, *c]);
        [18, 12, 6, 0].map(|shift| char::from(letters[(bits >> shift & 63) as usize]))
    };
    threes.iter().flat_map(four).collect()
}

fn read(folder: &Path, text: &str) -> Scene {
    let path = folder.join("moving.gltf");
    std::fs::write(&path, text).unwrap();
    load(&path).unwrap()
}

#[test]
fn nodes_turn_step_and_grow_as_the_standard_says() {
    let folder = tempfile::tempdir().unwrap();
    let scene = read(folder.path(), &text());
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let animation = &scene.animation;
    assert_eq!((animation.start, animation.end, animation.frames), (1.0, 3.0, 61));
    assert_eq!(animation.followers, [(0, 0), (1, 1)], "the lost node is not in the scene");
    let motions = &animation.motions;
    // Halfway between a quarter turn about x and one about y: a turn about (1, 1, 0), by the half angle's
    // tan = sqrt(1/2 * 1/2 + ...) of the sum (0.5, 0.5, 0, 1) / sqrt(1.5).
    let turn = motions[0].rotation.as_ref().unwrap().at(2.0).unwrap();
    let expected = [0.5, 0.5, 0.0, 1.0].map(|part| part / 1.5_f64.sqrt());
    assert!(turn.to_array().iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-7), "{turn}");
    assert_eq!(motions[0].moved(2.0), DVec3::new(0.0, 0.0, 7.0), "what no channel moves stays");
    let places = [0.0, 1.0, 2.9, 3.0, 9.0].map(|time| motions[1].moved(time).x);
    assert_eq!(places, [1.0, 1.0, 1.0, -1.0, -1.0]);
    // A cubic from 1 to 3 in 2 s; leaving at 0, 0.5 and 1 a second, it comes to its end at 0. Halfway of it
    // (1 + 3) / 2 and an eighth of 2 s times the slope.
    let grown = motions[1].scale.as_ref().unwrap().at(2.0).unwrap();
    assert!(grown.distance(DVec3::new(2.0, 2.125, 2.25)) < 1e-6, "{grown}");
    let pose = scene.pose(2.0);
    let corner = pose.world[1].transform_point3(Vec3::X);
    let local = DVec3::new(1.0 + 2.0, 2.0, 3.0);
    assert!(corner.as_dvec3().distance(turn * local + DVec3::Z * 7.0) < 1e-5, "{corner}");
}

#[test]
fn what_is_wrong_with_a_channel_leaves_the_shape_whole() {
    let folder = tempfile::tempdir().unwrap();
    for (from, to, part) in [
        (r#""input":1,"output":2"#, r#""input":1,"output":3"#, "accessor 3"),
        (r#""input":1,"output":2"#, r#""input":2,"output":2"#, "accessor 2"),
        (
            r#""output":4,"interpolation":"CUBICSPLINE""#,
            r#""output":4"#,
            "6 values; expected 1 for each of 2 times",
        ),
        (r#""byteOffset":36"#, r#""byteOffset":44"#, "times that are not in order"),
    ] {
        let whole = text();
        assert!(whole.contains(from));
        let scene = read(folder.path(), &whole.replace(from, to));
        assert!(scene.warnings.iter().any(|warning| warning.contains(part)), "{part}: {:?}", scene.warnings);
        assert_eq!(scene.instances(), (1, 1));
    }
}

#[test]
fn of_several_animations_the_first_is_played() {
    let folder = tempfile::tempdir().unwrap();
    let more = r#""animations":[{"name":"rest","channels":[],"samplers":[]},{"#;
    let scene = read(folder.path(), &text().replace(r#""animations":[{"#, more));
    assert!(scene.animation.is_still());
    assert!(scene.warnings[0].starts_with("animation 1 \"\" is not played"), "{:?}", scene.warnings);
}

#[test]
fn real_files_move() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/scenes/gltf_anim");
    if !Path::new(folder).exists() {
        eprintln!("skipped: {folder} is not here");
        return;
    }
    for (file, motions, left_out) in
        [("CesiumMan.glb", 19, 0), ("Fox.gltf", 20, 2), ("AnimatedMorphCube/AnimatedMorphCube.gltf", 0, 0)]
    {
        let scene = load(Path::new(folder).join(file)).unwrap();
        assert_eq!(scene.animation.motions.len(), motions, "{file}");
        let not_played = scene.warnings.iter().filter(|text| text.contains("is not played"));
        assert_eq!(not_played.count(), left_out, "{file}: {:?}", scene.warnings);
        for time in scene.animation.times(20) {
            assert!(scene.pose(time).world.iter().all(|world| world.is_finite()));
        }
        let (first, later) = (scene.pose(scene.animation.start), scene.pose(scene.animation.start + 0.3));
        assert_eq!(first.world != later.world, motions > 0, "{file}");
    }
}
