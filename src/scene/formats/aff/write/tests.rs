use glam::{Affine3A, Mat3A, Quat, Vec2, Vec3};
use proptest::prelude::*;

use super::super::super::super::{
    Animation, Bend, BendKey, Corners, Curve, HermiteKey, Material, Materials, Mesh, Motion, PointLight,
    Primitive, Scene, SplineKey, Texture, View, by_name,
};
use super::super::super::load;
use super::*;

/// The scene as it is read back.
fn back(written: &Written) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.aff");
    std::fs::write(&path, &written.text).unwrap();
    for (name, bytes) in &written.pictures {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    load(path).unwrap_or_else(|error| panic!("{error}\n{}", &written.text[..written.text.len().min(2000)]))
}

/// What a material is once it has been through AFF, of what the tests use.
fn plain(scene: &Scene, number: Option<u32>) -> Material {
    let known = number.map(|number| scene.materials[number as usize].clone());
    let material = known.unwrap_or_default();
    let ambient = material.ambient.filter(|ambient| *ambient != material.diffuse);
    Material { name: String::new(), ambient, texture: None, ..material }
}

/// A triangle as it is seen: corners in the world, material, normals, texture coordinates, texture.
type Seen = ([Vec3; 3], Material, Option<[Vec3; 3]>, Option<([Vec2; 3], Vec<[u8; 3]>)>);

fn triangles(scene: &Scene) -> Vec<Seen> {
    let mut seen = Vec::new();
    let world = scene.world_transforms();
    for node in scene.depth_first() {
        let Some(mesh) = scene.nodes[node as usize].mesh.map(|mesh| &scene.meshes[mesh as usize]) else {
            continue;
        };
        for (number, vertices) in mesh.triangles.iter().enumerate() {
            let corners = vertices.map(|v| world[node as usize].transform_point3(mesh.positions[v as usize]));
            let material = mesh.shading.materials.of(number);
            let texture = material.and_then(|material| scene.materials[material as usize].texture);
            let coordinates = mesh.shading.coordinates.of(number, *vertices);
            let pixels = texture.map(|texture| scene.textures[texture as usize].pixels.clone());
            let normals = mesh.shading.normals.of(number, *vertices);
            seen.push((corners, plain(scene, material), normals, coordinates.zip(pixels)));
        }
    }
    seen
}

/// Equal but for rounding of places in the world.
fn check_same(scene: &Scene, found: &Scene) {
    let (expected, found_triangles) = (triangles(scene), triangles(found));
    assert_eq!(expected.len(), found_triangles.len());
    let size = scene.bounds().half_diagonal().max(scene.bounds().centre().abs().max_element());
    for (a, b) in expected.iter().zip(&found_triangles) {
        let near = a.0.iter().zip(b.0).all(|(a, b)| a.distance(b) <= 3e-6 * size);
        assert!(near && (&a.1, &a.2, &a.3) == (&b.1, &b.2, &b.3), "{a:?}\n{b:?}");
    }
    let primitives = |scene: &Scene| -> Vec<_> {
        scene.primitives.iter().map(|p| (p.shape, plain(scene, p.material))).collect()
    };
    assert_eq!(primitives(scene), primitives(found));
    assert_eq!(scene.lights, found.lights);
    assert_eq!((scene.background, scene.ambient), (found.background, found.ambient));
}

fn one_triangle() -> Mesh {
    Mesh::new("m", vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])
}

/// A scene of some of everything that AFF can say.
fn full() -> Scene {
    let mut scene = Scene::new("full \n of it");
    (scene.background, scene.ambient) = (Some(Vec3::new(0.1, 1e-12, 3e20)), Some(Vec3::ONE));
    let pixels = vec![[1, 2, 3], [b'#', b'\n', 0]];
    scene.textures.push(Texture { name: "a b/wood.png".into(), width: 1, height: 2, pixels: pixels.clone() });
    scene.textures.push(Texture { name: "wood.jpg".into(), width: 2, height: 1, pixels });
    let bright =
        Material { ambient: Some(Vec3::Z), ..Material::metal("met\nal", Vec3::new(0.3, 0.2, 0.1), 97) };
    scene.add_material(bright.clone());
    scene.add_material(Material { texture: Some(1), ..Material::matt("wood", Vec3::ONE) });
    scene.add_material(Material { texture: Some(0), index: 1.5, transmission: Vec3::splat(0.85), ..bright });
    let mut mesh = Mesh::new("m", vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE, Vec3::Z], vec![[0, 1, 2]; 4]);
    mesh.triangles[1..].copy_from_slice(&[[2, 1, 3], [3, 4, 2], [0, 4, 1]]);
    mesh.shading.materials = Materials::Each(vec![2, u32::MAX, 1, 2]);
    mesh.shading.normals = Corners {
        values: vec![Vec3::Z, Vec3::new(0.0, 1.0, 7.0)],
        triangles: Some(vec![[0; 3], [0, 1, 0], [u32::MAX; 3], [1; 3]]),
    };
    mesh.shading.coordinates =
        Corners::of_vertices(vec![Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::splat(-3.5), Vec2::ONE]);
    let mesh = scene.add_mesh(mesh);
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.3, -1.2, 2.5);
    let node = scene.add_node(
        None,
        "n",
        Affine3A::from_scale_rotation_translation(Vec3::new(2.0, -0.5, 3.0), turn, Vec3::new(1e3, 0.1, 0.0)),
        Some(mesh),
    );
    scene.add_node(Some(node), "", Affine3A::from_translation(Vec3::Z), Some(mesh));
    scene.add_node(None, "", Affine3A::IDENTITY, Some(mesh));
    let ball = crate::geometry::Sphere { centre: Vec3::new(0.1, 1e-30, -7e12), radius: 2.5 };
    let cone = crate::geometry::hit::Cone { base: Vec3::X, base_radius: 0.0, tip: Vec3::Y, tip_radius: 1e-7 };
    scene.primitives = vec![
        Primitive { shape: Shape::Sphere(ball), material: Some(0) },
        Primitive { shape: Shape::Cone(cone), material: None },
    ];
    scene.lights.push(PointLight { position: Vec3::NEG_X, colour: Vec3::new(0.3, 0.3, 0.1) });
    scene.view = Some(View { eye: Vec3::Z * 9.0, look: Vec3::ZERO, up: Vec3::Y, fov_y: 0.7 });
    scene.validate().unwrap();
    scene
}

#[test]
fn everything_aff_can_say_comes_back() {
    let mut scene = full();
    // What no texture lies on needs no coordinates.
    scene.meshes[0].shading.coordinates.triangles =
        Some(vec![[0, 1, 2], [u32::MAX; 3], [3, 4, 2], [0, 4, 1]]);
    let written = to_aff(&scene, "my out");
    assert_eq!(written.warnings, ["1 meshes are placed several times: written out each time"]);
    let names: Vec<&str> = written.pictures.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["my_out-wood.ppm", "my_out-wood_2.ppm"]);
    let found = back(&written);
    let (expected, view) = (scene.view.unwrap(), found.view.unwrap());
    assert_eq!((view.eye, view.look, view.up), (expected.eye, expected.look, expected.up));
    assert!((view.fov_y - expected.fov_y).abs() <= f32::EPSILON);
    // Kinds are put together, which changes the order within a mesh.
    let sorted = |scene: &Scene| {
        let mut all = triangles(scene);
        all.sort_by(|a, b| format!("{:?}", (&a.1, a.2, &a.3)).cmp(&format!("{:?}", (&b.1, b.2, &b.3))));
        all.into_iter().map(|t| (t.1, t.2, t.3)).collect::<Vec<_>>()
    };
    assert_eq!(sorted(&scene), sorted(&found));
    assert_eq!((scene.instances().1, found.instances().1), (12, 12));
    assert_eq!(scene.primitives.len(), found.primitives.len());
    assert_eq!(scene.lights, found.lights);
    assert_eq!((scene.background, scene.ambient), (found.background, found.ambient));
    let (a, b) = (scene.bounds(), found.bounds());
    assert!(a.min.distance(b.min).max(a.max.distance(b.max)) <= 1e-6 * a.half_diagonal(), "{a:?} {b:?}");
}

#[test]
fn generated_scenes_come_back() {
    for name in ["room", "corner", "cylinder-196", "shell-1", "spheres-10k", "robot"] {
        let mut scene = by_name(name).unwrap();
        (scene.background, scene.ambient) = (Some(Vec3::X), Some(Vec3::Y));
        // The looks that AFF can say.
        for material in &mut scene.materials {
            material.highlight = material.mirror;
            (material.fresnel, material.absorption) = (false, Vec3::ZERO);
        }
        let written = to_aff(&scene, "out");
        check_same(&scene, &back(&written));
    }
}

#[test]
fn what_aff_cannot_say_is_told() {
    let mut scene = by_name("room").unwrap();
    scene.add_material(Material { highlight: Vec3::X, ..Material::matt("unused", Vec3::ONE) });
    let warnings = to_aff(&scene, "out").warnings.join("\n");
    for part in
        ["background or ambient", "highlight otherwise than they mirror", "mirror the more", "absorb light"]
    {
        assert!(warnings.contains(part), "{warnings}");
    }
    assert!(!warnings.contains("unused"));
    let warnings = to_aff(&full(), "out").warnings;
    assert!(
        warnings.contains(&"3 triangles have texture coordinates and no texture: left out".to_owned()),
        "{warnings:?}"
    );
    let mut scene = Scene::new("tinted");
    scene.add_material(Material { transmission: Vec3::X, ..Material::matt("red", Vec3::ONE) });
    scene.primitives.push(Primitive { shape: full().primitives[0].shape, material: Some(0) });
    let warnings = to_aff(&scene, "out").warnings.join("\n");
    assert!(warnings.contains("1 materials, \"red\" the first, colour what they let through"), "{warnings}");
}

/// A mesh that bends, on a node that moves, a light that moves and a camera.
fn moving(translation: Curve<Vec3>, rotation: Curve<Quat>) -> Scene {
    let mut scene = Scene::new("moving");
    (scene.background, scene.ambient) = (Some(Vec3::ZERO), Some(Vec3::ONE));
    let mut mesh = one_triangle();
    mesh.shading.normals = Corners::of_vertices(vec![Vec3::Z; 3]);
    let mesh = scene.add_mesh(mesh);
    scene.add_node(None, "still", Affine3A::IDENTITY, None);
    let node = scene.add_node(Some(0), "moves", Affine3A::IDENTITY, Some(mesh));
    scene.lights.push(PointLight { position: Vec3::X, colour: Vec3::ONE });
    let motion = |name: &str| Motion {
        name: name.to_owned(),
        translation: Some(translation.clone()),
        rotation: Some(rotation.clone()),
        scale: None,
        visibility: vec![(0.5, true), (1.5, false)],
    };
    let key = |time: f64, z: f32| BendKey {
        time,
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y].into_iter().map(|v| v + Vec3::Z * z).collect(),
        normals: vec![Vec3::Z, Vec3::X, Vec3::Y],
    };
    scene.animation = Animation {
        start: -0.5,
        end: 2.25,
        frames: 12,
        motions: vec![motion("a b"), motion("camera"), motion("the camera's own"), motion("a/b")],
        followers: vec![(node, 1)],
        camera: Some(2),
        lights: vec![(0, 3)],
        bends: vec![Bend { mesh, keys: vec![key(0.0, 0.0), key(0.1, 1.0)] }],
    };
    scene.validate().unwrap();
    scene
}

fn spline<T: Copy>(values: &[T]) -> Curve<T> {
    let key = |(at, value): (usize, &T)| SplineKey {
        time: at as f64 * 0.1,
        value: *value,
        tension: 0.5,
        continuity: -0.25,
        bias: at as f32,
    };
    Curve::Spline(values.iter().enumerate().map(key).collect())
}

#[test]
fn motions_come_back() {
    let turns: Vec<Quat> = [0.0, 1.0, 3.0, 5.0, 6.2].map(|angle: f32| Quat::from_rotation_x(angle)).to_vec();
    let places = [Vec3::X, Vec3::Y, Vec3::new(0.1, -3e-9, 4e12), Vec3::ONE];
    let scene = moving(spline(&places), spline(&turns));
    let written = to_aff(&scene, "out");
    assert!(written.warnings.is_empty(), "{:?}", written.warnings);
    let (found, expected) = (back(&written).animation, &scene.animation);
    assert_eq!((found.start, found.end, found.frames), (expected.start, expected.end, expected.frames));
    let names: Vec<&str> = found.motions.iter().map(|motion| motion.name.as_str()).collect();
    assert_eq!(names, ["a_b", "camera_2", "camera", "a_b_2"]);
    assert_eq!((found.camera, &found.lights, found.followers.len()), (Some(2), &expected.lights, 1));
    assert_eq!(found.followers[0].1, 1);
    for (found, expected) in found.motions.iter().zip(&expected.motions) {
        assert_eq!((&found.translation, &found.visibility), (&expected.translation, &expected.visibility));
        let (Some(Curve::Spline(found)), Some(Curve::Spline(expected))) =
            (&found.rotation, &expected.rotation)
        else {
            panic!("{found:?}")
        };
        for (found, expected) in found.iter().zip(expected) {
            assert_eq!((found.time, found.bias), (expected.time, expected.bias));
            assert!(found.value.abs_diff_eq(expected.value, 2e-7), "{found:?} {expected:?}");
        }
    }
    assert_eq!(found.bends, expected.bends);
}

/// A point of a Kochanek-Bartels curve by the formulas of AFF's description, in f64.
fn on_spline(keys: &[SplineKey<Vec3>], time: f64) -> f64 {
    let segment = (1..keys.len() - 2).rfind(|at| keys[*at].time <= time).unwrap_or(1);
    let [a, b, c, d] = [0, 1, 2, 3].map(|at| &keys[segment - 1 + at]);
    let [p0, p1, p2, p3] = [a, b, c, d].map(|key| f64::from(key.value.x));
    let span = c.time - b.time;
    if span == 0.0 {
        return p2;
    }
    let part = |key: &SplineKey<Vec3>| [key.tension, key.continuity, key.bias].map(f64::from);
    let ([t, k, s], [u, l, r]) = (part(b), part(c));
    let leaving = span / (c.time - a.time)
        * (1.0 - t)
        * ((1.0 + k) * (1.0 + s) * (p1 - p0) + (1.0 - k) * (1.0 - s) * (p2 - p1));
    let arriving = span / (d.time - b.time)
        * (1.0 - u)
        * ((1.0 - l) * (1.0 + r) * (p2 - p1) + (1.0 + l) * (1.0 - r) * (p3 - p2));
    let x = ((time - b.time) / span).clamp(0.0, 1.0);
    p1 + x
        * (leaving
            + x * (3.0 * (p2 - p1) - 2.0 * leaving - arriving + x * (leaving + arriving - 2.0 * (p2 - p1))))
}

#[test]
fn straight_lines_and_steps_are_said_by_splines() {
    let keys = [(0.0, 1.0), (0.5, 3.0), (2.5, -1.0), (2.6, 4.0), (2.6, 8.0), (9.0, 8.5)];
    let keys: Vec<(f64, Vec3)> = keys.iter().map(|(time, x)| (*time, Vec3::splat(*x))).collect();
    let straight = |time: f64| {
        let at = keys.iter().rposition(|key| key.0 <= time).unwrap_or(0);
        let Some(next) = keys.get(at + 1) else { return f64::from(keys[at].1.x) };
        let share = ((time - keys[at].0) / (next.0 - keys[at].0)).max(0.0);
        f64::from(keys[at].1.x) * (1.0 - share) + f64::from(next.1.x) * share
    };
    let steps = |time: f64| f64::from(keys[keys.iter().rposition(|key| key.0 <= time).unwrap_or(0)].1.x);
    type Expected<'a> = &'a dyn Fn(f64) -> f64;
    let cases: [(Curve<Vec3>, Expected<'_>); 2] =
        [(Curve::Linear(keys.clone()), &straight), (Curve::Steps(keys.clone()), &steps)];
    for (curve, expected) in cases {
        let found = back(&to_aff(&moving(curve, Curve::Linear(vec![(0.0, Quat::IDENTITY)])), "out"));
        let Some(Curve::Spline(found)) = &found.animation.motions[1].translation else { panic!() };
        for step in -10..200 {
            let time = f64::from(step) * 0.05 + 0.001;
            let (found, expected) = (on_spline(found, time), expected(time));
            assert!((found - expected).abs() < 1e-5, "{time}: {found} {expected}");
        }
    }
    let slope = |time: f64| HermiteKey { time, value: Vec3::X, arriving: Vec3::Y, leaving: Vec3::Y };
    let curved =
        moving(Curve::Hermite(vec![slope(0.0), slope(1.0)]), Curve::Linear(vec![(0.0, Quat::IDENTITY)]));
    assert!(to_aff(&curved, "out").warnings[0].starts_with("4 curves have slopes of their own"));
}

/// Whether a transform is read back as it was.
fn check_transform(numbers: [f32; 12]) {
    let [x, y, z, w] = [0, 3, 6, 9].map(|at| Vec3::from_slice(&numbers[at..at + 3]));
    let transform =
        Affine3A { matrix3: Mat3A::from_cols(x.into(), y.into(), z.into()), translation: w.into() };
    let mut scene = Scene::new("t");
    let mesh = scene.add_mesh(one_triangle());
    scene.add_node(None, "", transform, Some(mesh));
    let found = back(&to_aff(&scene, "out"));
    let world = found.world_transforms();
    let placed = found.nodes.iter().position(|node| node.mesh.is_some()).unwrap();
    assert!(world[placed].abs_diff_eq(transform, 4e-6), "{:?}\n{:?}", world[placed], transform);
}

/// On a line, where rounding makes up directions that are not there; on a point; of very different lengths.
#[test]
fn flat_transforms_come_back() {
    check_transform([0.0, 0.0, 0.0, 0.0, 0.0, -1.3421617, 0.0, 0.0, -2.0402052, 0.0, 0.0, 0.0]);
    check_transform([1.0, 2.0, 3.0, 2.0, 4.0, 6.0, -0.5, -1.0, -1.5, 1.0, 1.0, 1.0]);
    check_transform([0.0; 12]);
    check_transform([1e-30, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 1e-20, 0.0, 0.0, 0.0]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    /// Sheared, mirrored and flat ones, too.
    #[test]
    fn any_transform_comes_back(
        numbers in prop::array::uniform12(prop_oneof![-3f32..3.0, Just(0.0), Just(1.0), -1e-3f32..1e-3]),
    ) {
        check_transform(numbers);
    }
}
