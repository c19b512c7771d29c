use std::path::Path;

use glam::Vec3;

use super::super::load;
use crate::scene::{Scene, describe};

const TRIANGLE: &str = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
const TWO_PARTS: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\no floor\nf 1 2 3\no roof\nf 1 3 2\n";

fn write(folder: &Path, name: &str, text: &str) {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, text).unwrap();
}

/// Reads a robot from a folder with some meshes.
fn read(text: &str) -> Result<Scene, String> {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "one.stl", TRIANGLE);
    write(folder.path(), "two.obj", TWO_PARTS);
    write(folder.path(), "bad.stl", "solid\nfacet\n");
    write(folder.path(), "robot.urdf", text);
    load(folder.path().join("robot.urdf")).map_err(|error| error.to_string())
}

fn robot(inside: &str) -> String {
    format!("<robot name='r'>\n{inside}\n</robot>")
}

fn joint(parent: &str, child: &str, inside: &str) -> String {
    format!(
        "<joint name='to {child}' type='revolute'><parent link='{parent}'/><child link='{child}'/>{inside}</joint>\n"
    )
}

/// A link of one collision geometry.
fn link(name: &str, shape: &str) -> String {
    format!("<link name='{name}'><collision><geometry>{shape}</geometry></collision></link>\n")
}

fn names(scene: &Scene) -> Vec<&str> {
    scene.depth_first().iter().map(|node| scene.nodes[*node as usize].name.as_str()).collect()
}

#[test]
fn links_hang_under_their_parents_with_their_geometries_below() {
    let text = "<link name='b'/><link name='a'><visual><geometry><mesh filename='missing.dae'/></geometry></visual>\
        <collision name='named'><geometry><box size='1 2 3'/></geometry></collision>\
        <collision><geometry><mesh filename='two.obj'/></geometry></collision></link>\
        <link name='c'><visual><geometry><mesh filename='one.stl'/></geometry></visual></link>\
        <x:link name='d' xmlns:x='other'/><transmission><joint name='none'/></transmission>";
    let scene = read(&robot(&(text.to_string() + &joint("a", "c", "") + &joint("a", "b", "")))).unwrap();
    assert_eq!(names(&scene), ["a", "named", "two", "two", "floor", "roof", "c", "one", "b"]);
    assert_eq!((scene.roots.len(), scene.instances(), describe(&scene).depth), (1, (4, 15), 4));
}

#[test]
fn origins_turn_about_the_fixed_axes_in_order_then_move() {
    let (roll, pitch, yaw) = (0.3f64, -1.1f64, 2.0f64);
    let origin = format!("<origin xyz='1 -2 3.5' rpy='{roll} {pitch} {yaw}'/>");
    let scene =
        read(&robot(&("<link name='a'/><link name='b'/>".to_string() + &joint("a", "b", &origin)))).unwrap();
    let world = scene.world_transforms()[1];
    for point in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(0.2, -3.0, 7.0)] {
        // Roll, pitch and yaw one after the other, each written out.
        let [x, y, z] = point.to_array().map(f64::from);
        let (x, y, z) = (x, y * roll.cos() - z * roll.sin(), y * roll.sin() + z * roll.cos());
        let (x, y, z) = (x * pitch.cos() + z * pitch.sin(), y, z * pitch.cos() - x * pitch.sin());
        let (x, y) = (x * yaw.cos() - y * yaw.sin(), x * yaw.sin() + y * yaw.cos());
        let expected = Vec3::new((x + 1.0) as f32, (y - 2.0) as f32, (z + 3.5) as f32);
        assert!(world.transform_point3(point).distance(expected) < 1e-5, "{point}");
    }
}

#[test]
fn shapes_have_their_sizes_about_the_origin_and_are_shared() {
    let shapes = ["<box size='1 2 3'/>", "<sphere radius='2'/>", "<cylinder radius='.5' length='4'/>"];
    let halves = [Vec3::new(0.5, 1.0, 1.5), Vec3::splat(2.0), Vec3::new(0.5, 0.5, 2.0)];
    for (shape, half) in shapes.into_iter().zip(halves) {
        let text = link("a", shape) + &link("b", shape) + &joint("a", "b", "<origin xyz='0 0 0'/>");
        let scene = read(&robot(&text)).unwrap();
        assert_eq!((scene.meshes.len(), scene.instances().0), (1, 2));
        let bounds = scene.bounds();
        assert!((bounds.max - half).abs().max_element() < 0.01 * half.max_element(), "{shape}: {bounds:?}");
        assert!(bounds.max.cmple(half + 1e-6).all(), "{shape}: {bounds:?}");
        assert!((bounds.min + bounds.max).length() < 0.02, "{shape}: {bounds:?}");
        // The enclosed volume: positive where triangles face outward, and a little less than the shape's own.
        let (mesh, place) = (&scene.meshes[0], scene.world_transforms()[1]);
        let volume: f32 = mesh
            .triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| place.transform_point3(mesh.positions[corner as usize]));
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        let whole = match half.z {
            1.5 => 6.0,
            _ if half.x == 2.0 => 4.0 / 3.0 * std::f32::consts::PI * 8.0,
            _ => std::f32::consts::PI * 0.25 * 4.0,
        };
        assert!(volume > 0.985 * whole && volume < 1.0001 * whole, "{shape}: {volume} of {whole}");
    }
}

#[test]
fn meshes_are_scaled_and_a_file_is_read_once() {
    let mesh = "<mesh filename='one.stl' scale='2 -3 1e-3'/>";
    let text = link("a", mesh) + &link("b", "<mesh filename='./../X/one.stl'/>") + &joint("a", "b", "");
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "X/one.stl", TRIANGLE);
    write(folder.path(), "X/robot.urdf", &robot(&text));
    let scene = load(folder.path().join("X/robot.urdf")).unwrap();
    assert_eq!((scene.meshes.len(), scene.instances()), (1, (2, 2)));
    assert_eq!(
        (scene.bounds().min, scene.bounds().max),
        (Vec3::new(0.0, -3.0, 0.0), Vec3::new(2.0, 1.0, 0.0))
    );
}

#[test]
fn packages_are_found_upward() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let named = |name: &str| format!("<package><name> {name} </name></package>");
    write(at, "package.xml", &named("far"));
    write(at, "m/one.stl", TRIANGLE);
    write(at, "own/package.xml", &named("near"));
    write(at, "own/m/one.stl", TRIANGLE);
    write(at, "own/urdf/package.xml", "no XML at all <");
    write(at, "beside/m/one.stl", TRIANGLE);
    let path = at.join("own/urdf/robot.urdf");
    let try_one = |filename: &str| {
        std::fs::write(&path, robot(&link("a", &format!("<mesh filename='{filename}'/>")))).unwrap();
        load(&path).map_err(|error| error.to_string())
    };
    let absolute = at.join("m/one.stl").display().to_string();
    let encoded = format!("file://{}", absolute.replace("one", "%6fne"));
    for good in [
        "package://near/m/one.stl",
        "package://far/m/one.stl",
        "package://far/own/m/one.stl",
        "package://beside/m/one.stl",
        "package://own/m/one.stl",
        "../m/one.stl",
        absolute.as_str(),
        encoded.as_str(),
    ] {
        assert_eq!(try_one(good).unwrap().instances(), (1, 1), "{good}");
    }
    for (bad, part) in [
        ("package://nea/m/one.stl", "none has a package.xml that names \"nea\", or has nea/m/one.stl in it"),
        ("package://near/m/two.stl", "which cannot be read ("),
        ("package://beside/one.stl", "or has beside/one.stl in it"),
        ("http://host/one.stl", "an address; expected a path, file:// or package://"),
    ] {
        let error = try_one(bad).unwrap_err();
        assert!(
            error.contains("robot.urdf: line 2: mesh ") && error.contains(part),
            "{error:?} lacks {part:?}"
        );
    }
}

#[test]
fn faults_are_named_with_their_line() {
    let (a, b) = ("<link name='a'/>\n", "<link name='b'/>\n");
    let two = format!("{a}{b}");
    let circle = two.clone() + &joint("a", "b", "") + &joint("b", "a", "");
    let beside = format!("{two}<link name='c'/>\n") + &joint("b", "b", "") + &joint("b", "c", "");
    let own = link("a", "<mesh filename='robot.urdf'/>");
    for (text, part) in [
        ("".to_string(), "line 1: "),
        ("<urdf/>".to_string(), "line 1: element <urdf>; expected <robot>"),
        ("<robot>\n<link name='a'>\n".to_string(), "line 2: "),
        ("<robot>\n<link name='a'>\n</robot>".to_string(), "line 3: "),
        ("<!DOCTYPE x [<!ENTITY a 'aa'>]>\n<robot>&a;</robot>".to_string(), "line 1: "),
        (format!("<robot {}/>", "xmlns:a='a' ".repeat(65)), "65 times `xmlns`; expected at most 64"),
        (robot(""), "line 1: no link; expected one or more"),
        (robot(&two), "line 3: links \"a\" and \"b\" have no parent; expected one root"),
        (robot(&circle), "line 5: by joint \"to a\", link \"a\" hangs on itself; expected a tree"),
        (robot(&beside), "line 5: by joint \"to b\", link \"b\" hangs on itself"),
        (robot(&format!("{a}{a}")), "line 3: a second link \"a\""),
        (robot("<link/>"), "line 2: <link> without \"name\""),
        (
            robot(&(two.clone() + &joint("a", "b", "") + &joint("a", "b", ""))),
            "line 5: link \"b\" is held by joints",
        ),
        (
            robot(&(a.to_string() + &joint("a", "b", ""))),
            "line 3: joint \"to b\" to \"b\"; expected the name of a link",
        ),
        (
            robot(&(two.clone() + &joint("a", "b", "").replace("revolute", "ball"))),
            "line 4: joint \"to b\" of type \"ball\"",
        ),
        (
            robot(&(two.clone() + "<joint name='j' type='fixed'><parent link='a'/></joint>")),
            "line 4: <joint> without <child>",
        ),
        (
            robot(&(two.clone() + &joint("a", "b", "<origin xyz='0 0'/>"))),
            "line 4: xyz=\"0 0\"; expected 3 finite numbers",
        ),
        (
            robot(&(two.clone() + &joint("a", "b", "<origin rpy='0 nan 0'/>"))),
            "line 4: rpy=\"0 nan 0\"; expected 3 finite",
        ),
        (
            robot(&(two.clone() + &joint("a", "b", "<origin xyz='0 0 1e39'/>"))),
            "line 4: xyz=\"0 0 1e39\"; expected 3 finite",
        ),
        (robot(&(two.clone() + &joint("a", "b", "<origin/><origin/>"))), "line 4: a second <origin>"),
        (robot("<link name='a'><visual/></link>"), "line 2: <visual> without <geometry>"),
        (robot(&link("a", "")), "line 2: <geometry> of no shape or several"),
        (robot(&link("a", "<capsule radius='1'/>")), "line 2: shape <capsule>; expected box, cylinder"),
        (robot(&link("a", "<box size='1 inf 1'/>")), "line 2: size=\"1 inf 1\"; expected 3 finite numbers"),
        (robot(&link("a", "<sphere radius='-1'/>")), "line 2: radius=\"-1\"; expected no negative size"),
        (robot(&link("a", "<cylinder radius='1'/>")), "line 2: <cylinder> without \"length\""),
        (robot(&link("a", "<mesh/>")), "line 2: <mesh> without \"filename\""),
        (
            robot(&link("a", "<mesh filename='x.dae'/>")),
            "line 2: mesh \"x.dae\" of format \"dae\"; expected a file of .gltf",
        ),
        (robot(&own), "line 2: mesh \"robot.urdf\" of format \"urdf\""),
        (robot(&link("a", "<mesh filename='no.stl'/>")), "line 2: mesh \"no.stl\", which cannot be read ("),
        (robot(&link("a", "<mesh filename='bad.stl'/>")), "line 2: mesh \"bad.stl\", which cannot be read ("),
        (robot(&link("a", "<mesh filename='one.stl' scale='2'/>")), "line 2: scale=\"2\"; expected 3 finite"),
        (
            robot(
                &(link("a", "")
                    + &link("b", "<sphere radius='3e38'/>")
                    + &joint("a", "b", "<origin xyz='3e38 0 0'/>")),
            )
            .replacen("<collision><geometry></geometry></collision>", "", 1),
            "its place in the world overflows",
        ),
    ] {
        let error = read(&text).unwrap_err();
        assert!(error.contains("robot.urdf: ") && error.contains(part), "{error:?} lacks {part:?}");
    }
}

#[test]
fn chains_and_nesting_may_be_deep() {
    let count = 20_000;
    let links: String = (0..count).map(|i| format!("<link name='{i}'/>\n")).collect();
    let joints: String = (1..count).map(|i| joint(&(i - 1).to_string(), &i.to_string(), "")).collect();
    assert_eq!(describe(&read(&robot(&(links + &joints))).unwrap()).depth, count);
    let nested = "<gazebo>".repeat(count) + &"</gazebo>".repeat(count);
    assert_eq!(read(&robot(&format!("<link name='a'/>{nested}"))).unwrap().nodes.len(), 1);
}

#[test]
fn a_file_of_many_nodes_cannot_be_multiplied_without_end() {
    let folder = tempfile::tempdir().unwrap();
    let many: String = (0..2000).map(|i| format!("o {i}\nf 1 1 1\n")).collect();
    write(folder.path(), "many.obj", &("v 0 0 0\n".to_string() + &many));
    let mesh = "<collision><geometry><mesh filename='many.obj'/></geometry></collision>\n";
    let path = folder.path().join("robot.urdf");
    for (times, is_good) in [(30, true), (40, false)] {
        std::fs::write(&path, robot(&format!("<link name='a'>{}</link>", mesh.repeat(times)))).unwrap();
        let read = load(&path);
        assert_eq!(read.is_ok(), is_good);
        assert!(is_good || read.unwrap_err().to_string().contains("line 34: more than 65536 nodes"));
    }
}
