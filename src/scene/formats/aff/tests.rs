use std::path::Path;

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::super::super::{Curve, Materials, PointLight, Scene, SceneError, Shape, SplineKey, View};
use super::super::load;

/// What is read from files in a folder of their own, the first being the scene's.
fn scene_of(files: &[(&str, &[u8])]) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), files);
    load(folder.path().join(files[0].0))
}

fn write(folder: &Path, files: &[(&str, &[u8])]) {
    for (name, bytes) in files {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
}

fn read(text: &str) -> Scene {
    scene_of(&[("s.aff", text.as_bytes())]).unwrap_or_else(|error| panic!("{error}"))
}

/// The error without the folder.
fn error(files: &[(&str, &[u8])]) -> String {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), files);
    let error = load(folder.path().join(files[0].0)).unwrap_err().to_string();
    error.replace(&format!("{}{}", folder.path().display(), std::path::MAIN_SEPARATOR), "")
}

const SQUARE: &str = "vertices 4 0 0 0 1 0 0 1 1 0 0 1 0 ";

#[test]
fn light_background_and_view_are_read() {
    let scene = read(
        "v from 1 2 3 at 4 5 6 up 0 1 0 angle 40 hither 1e-5 resolution 800 600\n\
         b .5 0.25 1 am 2.5 2 1 l 1 2 3 l 1 0 0 0.5 .5 0.25 # not a colour: 1 1 1\n a -1 20.5 800",
    );
    let eye = Vec3::new(1.0, 2.0, 3.0);
    let fov_y = 40f64.to_radians() as f32;
    assert_eq!(scene.view, Some(View { eye, look: Vec3::new(4.0, 5.0, 6.0), up: Vec3::Y, fov_y }));
    assert_eq!(scene.background, Some(Vec3::new(0.5, 0.25, 1.0)));
    assert_eq!(scene.ambient, Some(Vec3::new(2.5, 2.0, 1.0)));
    let dim = PointLight { position: Vec3::X, colour: Vec3::new(0.5, 0.5, 0.25) };
    assert_eq!(scene.lights, [PointLight { position: eye, colour: Vec3::ONE }, dim]);
    let time = (scene.animation.start, scene.animation.end, scene.animation.frames);
    assert_eq!(time, (-1.0, 20.5, 800));
    let nothing = read("% nothing at all");
    assert_eq!((nothing.background, nothing.ambient), (Some(Vec3::ZERO), Some(Vec3::ONE)));
    assert_eq!((nothing.view, nothing.nodes.len(), nothing.meshes.len()), (None, 1, 0));
    let blind = read("v from 1 1 1 at 1 2 1 up 0 5 0 angle 40 hither 1 resolution 8 8");
    assert_eq!((blind.view, blind.warnings.len()), (None, 1));
}

#[test]
fn nff_shares_brightness_out_and_leaves_ambient_light_open() {
    let scene = scene_of(&[("s.nff", b"l 0 0 1 l 0 1 0 l 0 0 0 1 1 0.5 l 1 0 0 l 2 0 0 s 0 0 0 1")]).unwrap();
    let colours: Vec<Vec3> = scene.lights.iter().map(|light| light.colour).collect();
    let half = Vec3::splat(0.5);
    assert_eq!(colours, [half, half, Vec3::new(1.0, 1.0, 0.5), half, half]);
    assert_eq!((scene.ambient, scene.background), (None, Some(Vec3::ZERO)));
}

#[test]
fn materials_hold_until_the_next_also_beyond_files() {
    let scene = scene_of(&[
        (
            "s.aff",
            b"s 0 0 0 1 f 1 .5 0 .5 .25 9.6 .5 1.5 s 1 0 0 1 i 0 glass.aff s 2 0 0 1 i 0 glass.aff s 3 0 0 1",
        ),
        ("glass.aff", b"fm .1 .1 .1  .2 .2 .2  .3 .4 .5  0 .85 0 # said by \xe5\xe4\xf6"),
    ])
    .unwrap();
    let of = |at: usize| scene.primitives[at].material;
    assert_eq!([of(0), of(1), of(2), of(3)], [None, Some(0), Some(1), Some(1)]);
    let [fill, glass] = &scene.materials[..] else { panic!("{:?}", scene.materials) };
    assert_eq!((fill.diffuse, fill.ambient), (Vec3::new(0.5, 0.25, 0.0), None));
    assert_eq!((fill.highlight, fill.mirror, fill.exponent), (Vec3::splat(0.25), Vec3::splat(0.25), 10));
    assert_eq!((fill.transmission, fill.index, fill.fresnel), (Vec3::splat(0.5), 1.5, false));
    assert_eq!((glass.diffuse, glass.ambient), (Vec3::splat(0.2), Some(Vec3::splat(0.1))));
    assert_eq!((glass.exponent, glass.index, glass.name.as_str()), (1, 1.0, "glass"));
}

#[test]
fn meshes_have_their_normals_and_coordinates() {
    let text = format!(
        "f 1 1 1 1 0 1 0 1 m {SQUARE} normals 1 0 0 5 texturecoords 3 a.ppm 0 0 1 0 1 1 triangles 2 \
         0 1 2 0 0 0 0 1 2  0 2 3 0 0 0 0 2 1 m {SQUARE} triangles 1 3 2 1 \
         m {SQUARE} normals 4 1 0 0 0 1 0 0 0 1 1 1 1 triangles 1 0 1 2 0 1 2"
    );
    let files = [("s.aff", text.as_bytes()), ("a.ppm", b"P3 1 1 255 9 8 7")];
    let scene = scene_of(&files).unwrap();
    let [full, bare, by_vertex] = &scene.meshes[..] else { panic!("{}", scene.meshes.len()) };
    assert_eq!(full.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert_eq!(full.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(full.shading.normals.of(1, full.triangles[1]), Some([Vec3::Z * 5.0; 3]));
    assert_eq!(full.shading.coordinates.of(1, full.triangles[1]), Some([Vec2::ZERO, Vec2::ONE, Vec2::X]));
    assert_eq!(bare.shading.normals.of(0, bare.triangles[0]), None);
    assert_eq!(by_vertex.shading.normals.triangles, None);
    assert_eq!((&full.shading.materials, &bare.shading.materials), (&Materials::One(0), &Materials::One(1)));
    assert_eq!((scene.materials[0].texture, scene.materials[1].texture), (Some(0), None));
    assert_eq!(scene.textures[0].pixels, [[9, 8, 7]]);
    assert!(scene.warnings.is_empty());
}

#[test]
fn faces_in_a_row_are_one_mesh() {
    let text = "p 3 0 0 0 1 0 0 0 1 0 f 1 0 0 1 0 1 0 1 s 0 0 0 1 \
                pp 3 0 0 0 0 0 1  1 0 0 0 1 1  0 1 0 1 0 1 \
                tt t.ppm 0 0 0 0 1  1 0 0 1 1  0 1 0 0 0 f 0 1 0 1 0 1 0 1 \
                ttp t.ppm 0 0 0 0 0 1 0 1  1 0 0 0 0 1 1 1  0 1 0 0 0 1 0 0 \
                p 4 0 0 0 4 4 0 0 8 0 2 4 0 \
                xs 1 1 1 0 0 0 0 0 0 0 { p 3 0 0 0 1 0 0 0 1 0 }";
    let scene = scene_of(&[("s.aff", text.as_bytes()), ("t.ppm", b"P3 1 1 1 1 1 1")]).unwrap();
    assert_eq!(scene.meshes.len(), 2);
    let mesh = &scene.meshes[0];
    assert_eq!((mesh.triangles.len(), mesh.positions.len()), (6, 16));
    let normals: Vec<_> = (0..6).map(|at| mesh.shading.normals.of(at, mesh.triangles[at])).collect();
    assert_eq!(normals[1], Some([Vec3::Z, Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 0.0, 1.0)]));
    assert_eq!((normals[0], normals[2], normals[3], normals[4]), (None, None, Some([Vec3::Z; 3]), None));
    let at = |triangle: usize| mesh.shading.coordinates.of(triangle, mesh.triangles[triangle]);
    assert_eq!((at(2), at(3)), (Some([Vec2::Y, Vec2::ONE, Vec2::ZERO]), at(2)));
    assert_eq!((at(1), at(4)), (None, None));
    let colour = |at: usize| {
        let material = &scene.materials[mesh.shading.materials.of(at)? as usize];
        Some((material.diffuse, material.texture))
    };
    let (red, green) = (Vec3::X, Vec3::Y);
    let expected = [None, Some((red, None)), Some((red, Some(0))), Some((green, Some(0)))];
    assert_eq!([colour(0), colour(1), colour(2), colour(3)], expected);
    assert_eq!((colour(4), colour(5)), (Some((green, None)), colour(4)));
    // What was inside braces has the material that held there.
    assert_eq!(scene.meshes[1].shading.materials, Materials::One(scene.materials.len() as u32 - 1));
    assert_eq!(scene.primitives[0].material.map(|m| scene.materials[m as usize].diffuse), Some(red));
}

#[test]
fn textures_that_cannot_be_had_are_warnings() {
    let bare = read("tt none.ppm 0 0 0 0 0 1 0 0 0 0 0 1 0 0 0 tt none.ppm 0 0 0 0 0 1 0 0 0 0 0 1 0 0 0");
    assert_eq!(bare.warnings, ["texture \"none.ppm\" is not there"]);
    assert_eq!(bare.meshes[0].shading.materials, Materials::Unknown);
    let outside = read("tt ../t.ppm 0 0 0 0 0 1 0 0 0 0 0 1 0 0 0");
    assert!(outside.warnings[0].contains("outside of the scene's folder"), "{:?}", outside.warnings);
}

#[test]
fn transforms_are_nodes() {
    let text =
        "xs 2 3 4  0 0 9 90  10 20 30 { m vertices 3 1 0 0 0 1 0 0 0 1 triangles 1 0 1 2 x arm{ }} x arm {}";
    let scene =
        read(&format!("{text} k arm {{ transl 4 0 1 1 1 0 0 0 0 1 1 1 0 0 0 1 1 1 1 0 0 0 1 1 1 1 0 0 0 }}"));
    let names: Vec<_> = scene.nodes.iter().map(|node| (node.name.as_str(), node.parent, node.mesh)).collect();
    assert_eq!(
        names,
        [
            ("s", None, None),
            ("", Some(0), None),
            ("s", Some(1), Some(0)),
            ("arm", Some(1), None),
            ("arm", Some(0), None)
        ]
    );
    let placed = scene.world_transforms()[2].transform_point3(Vec3::X);
    assert!(placed.abs_diff_eq(Vec3::new(10.0, 22.0, 30.0), 1e-6), "{placed}");
    assert_eq!(scene.animation.followers, [(3, 0), (4, 0)]);
    let still = read("x arm { s 0 0 0 1 }");
    assert_eq!((still.animation.followers.len(), still.primitives.len()), (0, 1));
    assert_eq!(still.nodes[1].transform, Affine3A::IDENTITY);
}

#[test]
fn key_frames_are_curves() {
    let scene = read(
        "k lamp { visibility 2 -1 0 1.5 1 rot 4 0 0 0 2 90 .1 .2 .3 1 0 1 0 0 0 0 0 1 0 0 0 0 0 0 0 2 1 0 0 540 0 0 0 \
         scale 4 0 1 2 3 0 0 0 1 1 1 1 0 0 0 2 1 1 1 0 0 0 3 1 1 1 0 0 0 } \
         k camera { transl 4 0 1 2 3 0 0 0 0 1 1 1 0 0 0 2 1 1 1 0 0 0 3 1 1 1 0 0 0 } k camera { visibility 1 0 1 } \
         la lamp 1 2 3 .5 .5 .5 la nobody 0 0 0",
    );
    let animation = &scene.animation;
    assert_eq!(
        (animation.motions.len(), animation.camera, &animation.lights[..]),
        (2, Some(1), &[(0, 0)][..])
    );
    let lamp = &animation.motions[0];
    assert_eq!(lamp.visibility, [(-1.0, false), (1.5, true)]);
    let Some(Curve::Spline(turns)) = &lamp.rotation else { panic!("{lamp:?}") };
    let first = turns[0];
    assert!(first.value.abs_diff_eq(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2), 1e-6));
    assert_eq!((first.time, first.tension, first.continuity, first.bias), (0.0, 0.1, 0.2, 0.3));
    assert_eq!(turns[1].value, Quat::IDENTITY);
    assert!(
        turns[3].value.abs_diff_eq(Quat::from_xyzw(-1.0, 0.0, 0.0, 0.0), 1e-6),
        "more than a turn stays more"
    );
    let Some(Curve::Spline(sizes)) = &lamp.scale else { panic!("{lamp:?}") };
    let value = Vec3::new(1.0, 2.0, 3.0);
    assert_eq!(sizes[0], SplineKey { time: 0.0, value, tension: 0.0, continuity: 0.0, bias: 0.0 });
    let late = read(
        "k a { transl 6 0 0 0 0 0 0 0 1 1 0 0 0 0 0 3 3 0 0 0 0 0 2 9 0 0 0 0 0 3 4 0 0 0 0 0 4 5 0 0 0 0 0 }",
    );
    let Some(Curve::Spline(keys)) = &late.animation.motions[0].translation else { panic!() };
    assert_eq!(keys.iter().map(|key| key.value.x).collect::<Vec<_>>(), [0.0, 1.0, 3.0, 4.0, 5.0]);
    assert_eq!(late.warnings, ["1 keys of \"a\" are earlier than one before them: left out"]);
    // The last keys of a name count, wherever it is used.
    assert_eq!((&animation.motions[1].translation, animation.motions[1].visibility.len()), (&None, 1));
    assert_eq!(scene.lights.len(), 2);
}

#[test]
fn triangles_that_move_alike_are_one_mesh() {
    let triangle = |times: &str, at: f32| {
        let keys = times.split(' ').enumerate();
        let keys = keys.map(|(key, time)| {
            let z = at + key as f32;
            format!("{time} 0 0 {z} 0 0 1  1 0 {z} 0 0 2  0 1 {z} 0 0 3 ")
        });
        format!("tpa {} {}", times.split(' ').count(), keys.collect::<String>())
    };
    let text =
        [triangle("0 1 2", 0.0), triangle("0 1 2", 10.0), triangle("0 2", 20.0), triangle("0 2", 30.0)];
    let text = format!("{} f 1 1 1 1 1 1 1 1 {} x n {{ {} }}", text[..3].join(" "), text[3], text[3]);
    let scene = read(&text);
    let bends = &scene.animation.bends;
    let counts: Vec<_> = bends.iter().map(|bend| (bend.keys.len(), bend.keys[0].positions.len())).collect();
    assert_eq!(counts, [(3, 6), (2, 3), (2, 3), (2, 3)]);
    let mesh = &scene.meshes[bends[0].mesh as usize];
    assert_eq!((mesh.triangles.len(), &mesh.positions), (2, &bends[0].keys[0].positions));
    assert_eq!(mesh.shading.normals.values, bends[0].keys[0].normals);
    assert_eq!(bends[0].keys[1].positions[4], Vec3::new(1.0, 0.0, 11.0));
    assert_eq!((bends[0].keys[2].time, bends[0].keys[2].normals[5]), (2.0, Vec3::Z * 3.0));
}

#[test]
fn files_are_included_in_place_and_by_level() {
    let part = format!("m {SQUARE} triangles 1 0 1 2");
    let files: [(&str, &[u8]); 4] = [
        ("s.aff", b"f 1 1 1 1 0 1 0 1 i 0 deep/a.aff xs 1 1 1 0 0 0 0 5 0 0 { i 0 ./deep//a.aff } \
                    i 1 none.aff d 2 i 1 b.aff i 3 none.aff d -1 i 0 none.aff f 0 1 0 1 0 1 0 1 i -1 deep\\a.aff"),
        ("deep/a.aff", part.as_bytes()),
        ("b.aff", b"i 2 c.aff d 1"),
        ("c.aff", b"s 0 0 0 1"),
    ];
    let scene = scene_of(&files).unwrap();
    let meshes: Vec<_> = scene.nodes.iter().filter_map(|node| node.mesh).collect();
    assert_eq!(meshes, [0, 0, 1], "shared where the material is the same");
    assert_eq!((scene.meshes.len(), scene.primitives.len()), (2, 1));
    assert_eq!(scene.meshes[0].positions, scene.meshes[1].positions);
    assert_eq!(scene.meshes[0].name, "a");
}

#[test]
fn negative_radii_are_told() {
    let scene = read("s 1 2 3 -4 c 0 0 0 -1 0 0 2 -.5");
    assert_eq!(scene.warnings.len(), 1);
    let Shape::Sphere(sphere) = scene.primitives[0].shape else { panic!() };
    let Shape::Cone(cone) = scene.primitives[1].shape else { panic!() };
    assert_eq!((sphere.radius, cone.base_radius, cone.tip_radius), (4.0, 1.0, 0.5));
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let wrong: [(&str, &str); 37] = [
        ("l 1 2", "line 1, column 6: the file ends; expected a number"),
        ("\n\n  q 1", "line 3, column 3: \"q\"; expected a statement ("),
        ("b 1 2 x", "line 1, column 7: \"x\"; expected a number"),
        ("b 1 nan 2", "line 1, column 5: \"nan\"; expected a number"),
        ("b 1 1e39 2", "line 1, column 5: \"1e39\"; expected a number within the range of f32"),
        ("# \u{e9}\nv to", "line 2, column 3: \"to\"; expected `from`"),
        ("v from 0 0 0 at 1 0 0 up 0 1 0 angle 180", "column 38: \"180\"; expected an angle"),
        ("p 2 0 0 0 1 1 1", "column 3: \"2\"; expected at least 3 corners"),
        ("p 4000000000 0 0 0", "column 19: the file ends; expected a number"),
        ("p -3 0 0 0", "column 3: \"-3\"; expected a whole number"),
        ("m triangles", "column 3: \"triangles\"; expected `vertices`"),
        ("m vertices 4294967295 1 2 3", "column 28: the file ends; expected a number"),
        ("m vertices 0 normals 0 x", "column 24: \"x\"; expected `texturecoords` or `triangles`"),
        ("m vertices 0 texturecoords 0 t normals 0", "column 32: \"normals\"; expected `triangles`"),
        ("m vertices 1 0 0 0 triangles 1\n0 0 1", "line 2, column 5: \"1\"; expected an index below 1"),
        (
            "m vertices 1 0 0 0 normals 0 triangles 1 0 0 0 0",
            "expected an index below 0, the number of normals",
        ),
        ("m vertices 1 0 0 0 texturecoords 1 t 0 0 triangles 1 0 0 0 1", "the number of texture coordinates"),
        ("xs 1 1 1 0 0 0 1 0 0 0 {}", "column 16: \"1\"; expected an angle of 0, or an axis"),
        ("xs 1 1 1 0 0 1 0 0 0 0 m", "column 24: \"m\"; expected `{`"),
        ("xs 1 1 1e200 0 0 1 0 0 0 0 {}", "expected a transform within the range of f32"),
        ("x {", "column 3: \"{\"; expected a transform's name"),
        ("\n x a { x b { }", "line 2, column 6: a `{` that nothing closes; expected `}` before"),
        ("}", "column 1: \"}\"; expected no `}`"),
        ("k a b", "column 5: \"b\"; expected `{`"),
        ("k a { move", "column 7: \"move\"; expected `transl`, `scale`, `rot`, `visibility` or `}`"),
        ("k a { transl 3", "column 14: \"3\"; expected at least 4 keys"),
        ("k a { visibility 0", "expected at least 1 key"),
        ("k a { visibility 1 0 2", "column 22: \"2\"; expected 0 or 1"),
        ("k a { visibility 2 0 1 -1 1", "column 24: \"-1\"; expected a time not before 0"),
        (
            "k a { visibility 1 0 1 visibility 1 0 1",
            "column 24: \"visibility\"; expected each kind of keys once",
        ),
        (
            "k a { transl 4 0 0 0 0 0 0 0 1 1 0 0 0 0 0 2 0 0 0 0 0 0 1 0 0 0 0 0 0",
            "in the order of their times",
        ),
        ("tpa 0", "column 5: \"0\"; expected at least 1 key"),
        ("a 1 0 5", "column 5: \"0\"; expected an end not before the start, 1"),
        ("a 0 1 0", "column 7: \"0\"; expected at least 1 frame"),
        ("c 0 0 0 1 0 0 1 -1", "column 17: \"-1\"; expected two radii of one sign"),
        ("d 0.5", "column 3: \"0.5\"; expected a level of detail"),
        ("i 0 none.aff", "line 1, column 5: \"none.aff\" cannot be read as none.aff: "),
    ];
    for (text, part) in wrong {
        let message = error(&[("s.aff", text.as_bytes())]);
        assert!(
            message.starts_with("s.aff: line ") && message.contains(part),
            "{text:?}: {message:?} lacks {part:?}"
        );
    }
    let message = error(&[("s.aff", b"b 1 \xe9 1")]);
    assert_eq!(message, "s.aff: line 1, column 5: \"\u{fffd}\"; expected a number");
    let message = error(&[("s.aff", b"x \xe9 {}")]);
    assert_eq!(message, "s.aff: line 1, column 3: \"\u{fffd}\"; expected a transform's name, in UTF-8");
}

#[test]
fn includes_that_lead_nowhere_are_refused() {
    for name in ["../s.aff", "/etc/passwd", "a/../../s.aff", "..", "."] {
        let message = error(&[("s.aff", format!("\n i 0 {name}").as_bytes())]);
        assert_eq!(
            message,
            format!("s.aff: line 2, column 6: {name:?}; expected a file in the scene's folder")
        );
    }
    let message = error(&[("s.aff", b"i 0 a.aff"), ("a.aff", b"i 0 b.aff"), ("b.aff", b"i 0 ./a.aff")]);
    assert!(message.starts_with("b.aff: line 1, column 5: \"./a.aff\" includes itself"), "{message}");
    assert!(error(&[("s.aff", b"i 0 s.aff")]).contains("includes itself"));
    let message = error(&[("s.aff", b"i 0 a.aff"), ("a.aff", b"\nx q {")]);
    assert!(message.starts_with("a.aff: line 2, column 5: a `{` that nothing closes"), "{message}");
    let names: Vec<String> = (0..80).map(|at| format!("{at}.aff")).collect();
    let texts: Vec<String> = (1..81).map(|at| format!("i 0 {at}.aff")).collect();
    let chain: Vec<(&str, &[u8])> =
        names.iter().map(String::as_str).zip(texts.iter().map(String::as_bytes)).collect();
    assert!(error(&chain).contains("a file in 64 others"));
}

#[test]
fn files_that_unfold_without_end_are_refused() {
    // Each includes the next one ten times: a tenth of a gigabyte of triangles out of a few hundred bytes.
    let names: Vec<String> = (0..9).map(|at| format!("{at}.aff")).collect();
    let mut texts: Vec<String> = (1..9).map(|at| format!("i 0 {at}.aff ").repeat(10)).collect();
    texts.push("p 3 0 0 0 1 0 0 0 1 0".to_owned());
    let files: Vec<(&str, &[u8])> =
        names.iter().map(String::as_str).zip(texts.iter().map(String::as_bytes)).collect();
    assert!(error(&files).contains("too large a scene"));
}

#[test]
fn braces_may_nest_as_deep_as_they_like() {
    let depth = 200_000;
    let scene = read(&format!("{}s 0 0 0 1{}", "xs 1 1 1 0 0 1 0 0 0 0{".repeat(depth), "}".repeat(depth)));
    assert_eq!((scene.nodes.len(), scene.primitives.len()), (depth + 1, 1));
}
