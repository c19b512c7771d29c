use super::*;

/// A PLY file worth keeping: a strip of triangles, long settled.
fn strip(folder: &Path, vertices: usize) -> PathBuf {
    let path = folder.join("strip.ply");
    write(&path, vertices, 100);
    path
}

fn write(path: &Path, vertices: usize, age: u64) {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices - 2
    );
    for vertex in 0..vertices {
        text += &format!("{:.9} {} -0.0\n", vertex as f32 * 0.1, vertex % 2);
    }
    (2..vertices).for_each(|corner| text += &format!("3 {} {} {corner}\n", corner - 2, corner - 1));
    std::fs::write(path, text).unwrap();
    set_age(path, age);
}

fn set_age(path: &Path, seconds: u64) {
    let file = std::fs::File::options().append(true).open(path).unwrap();
    file.set_modified(SystemTime::now() - Duration::from_secs(seconds)).unwrap();
}

/// All of a scene: Debug tells -0 from 0 and prints each f32 as no other.
fn print(scene: &Scene) -> String {
    format!("{scene:?}")
}

#[test]
fn what_comes_back_is_bit_for_bit_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let path = strip(folder.path(), 40_000);
    let cache = Cache::in_folder(folder.path().join("new/folder"));
    let (parsed, origin) = cache.load(&path).unwrap();
    let Origin::Kept(kept) = origin else { panic!("{origin}") };
    let (fetched, origin) = cache.load(&path).unwrap();
    assert_eq!(origin, Origin::Cache(kept.clone()));
    assert!(print(&parsed) == print(&fetched) && fetched.name == "strip.ply");
    let files: Vec<_> = std::fs::read_dir(kept.parent().unwrap()).unwrap().collect();
    assert_eq!(files.len(), 1, "no temporary file is left: {files:?}");
}

#[test]
fn small_fresh_and_changed_files_are_parsed() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Cache::in_folder(folder.path().join("cache"));
    let path = strip(folder.path(), 100);
    assert_eq!(cache.load(&path).unwrap().1, Origin::File, "it is small");
    write(&path, 40_000, 0);
    assert_eq!(cache.load(&path).unwrap().1, Origin::File, "it is fresh");
    write(&path, 40_000, 100);
    assert!(matches!(cache.load(&path).unwrap().1, Origin::Kept(_)));
    write(&path, 40_001, 100);
    assert_eq!(cache.load(&path).unwrap().0.meshes[0].positions.len(), 40_001, "it has another size");
    assert!(matches!(cache.load(&path).unwrap().1, Origin::Cache(_)));
    set_age(&path, 50);
    assert!(matches!(cache.load(&path).unwrap().1, Origin::Kept(_)), "it has another time");
    std::fs::remove_file(&path).unwrap();
    assert!(cache.load(&path).is_err(), "it is gone");
    let none = Cache { folder: None };
    assert_eq!(none.load(strip(folder.path(), 40_000)).unwrap().1, Origin::File);
}

#[test]
fn a_folder_that_cannot_be_written_does_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let path = strip(folder.path(), 40_000);
    // A file where the folder should be; permissions would not stop root.
    let cache = Cache::in_folder(path.join("below"));
    assert_eq!(cache.load(&path).unwrap().1, Origin::File);
}

#[test]
fn damaged_kept_files_are_made_anew() {
    let folder = tempfile::tempdir().unwrap();
    let path = strip(folder.path(), 40_000);
    let cache = Cache::in_folder(folder.path().join("cache"));
    let (parsed, origin) = cache.load(&path).unwrap();
    let Origin::Kept(kept) = origin else { panic!("{origin}") };
    let good = std::fs::read(&kept).unwrap();
    type Damage<'a> = &'a dyn Fn(&mut Vec<u8>);
    let damages: [Damage<'_>; 7] = [
        &|bytes| bytes.clear(),
        &|bytes| bytes.truncate(bytes.len() - 1),
        &|bytes| bytes.push(0),
        &|bytes| bytes[0] ^= 1,
        &|bytes| bytes[MAGIC_LENGTH] ^= 1,
        &|bytes| *bytes.last_mut().unwrap() ^= 0x80,
        &|bytes| bytes[good.len() / 2] ^= 4,
    ];
    for damage in damages {
        let mut bytes = good.clone();
        damage(&mut bytes);
        std::fs::write(&kept, &bytes).unwrap();
        let (scene, origin) = cache.load(&path).unwrap();
        assert_eq!(origin, Origin::Kept(kept.clone()));
        assert!(print(&scene) == print(&parsed));
        assert!(std::fs::read(&kept).unwrap() == good, "it is mended");
    }
    // The kept file of another path, under this one's name.
    let other = folder.path().join("other.ply");
    std::fs::copy(&path, &other).unwrap();
    set_age(&other, 100);
    std::fs::write(cache.kept(&other).unwrap(), &good).unwrap();
    assert!(matches!(cache.load(&other).unwrap().1, Origin::Kept(_)));
}

/// Where the version stands.
const MAGIC_LENGTH: usize = 16;

#[test]
fn changed_buffers_of_gltf_are_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let (path, buffer) = (folder.path().join("model.gltf"), folder.path().join("model.bin"));
    let triangles = 30_000;
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"model.bin","byteLength":{0}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{0}}}],"accessors":[{{"bufferView":0,"componentType":5126,
        "type":"VEC3","count":{1},"min":[0,0,0],"max":[1,1,1]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{{"mesh":0}}]}}"#,
        triangles * 36,
        triangles * 3
    );
    std::fs::write(&path, text).unwrap();
    set_age(&path, 100);
    let fill = |byte: u8, age: u64| {
        std::fs::write(&buffer, vec![byte; triangles * 36]).unwrap();
        set_age(&buffer, age);
    };
    let cache = Cache::in_folder(folder.path().join("cache"));
    fill(1, 100);
    let first = cache.load(&path).unwrap();
    assert!(matches!(first.1, Origin::Kept(_)) && matches!(cache.load(&path).unwrap().1, Origin::Cache(_)));
    fill(2, 50);
    let second = cache.load(&path).unwrap();
    assert!(matches!(second.1, Origin::Kept(_)), "{}", second.1);
    assert_ne!(first.0.meshes[0].positions, second.0.meshes[0].positions);
    std::fs::remove_file(&buffer).unwrap();
    assert!(cache.load(&path).is_err());
}

#[test]
fn changed_meshes_of_robots_and_nearer_packages_are_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let (own, above) = (folder.path().join("a/b"), folder.path().join("a"));
    std::fs::create_dir_all(&own).unwrap();
    let path = own.join("robot.urdf");
    let description = "<package><name>p</name></package>";
    std::fs::write(above.join("package.xml"), description).unwrap();
    let mesh = "<mesh filename='package://p/strip.ply'/>";
    let link = format!("<link name='a'><visual><geometry>{mesh}</geometry></visual></link>");
    std::fs::write(&path, format!("<robot>{link}</robot>")).unwrap();
    write(&above.join("strip.ply"), 40_000, 100);
    set_age(&path, 100);
    set_age(&above.join("package.xml"), 100);
    let cache = Cache::in_folder(folder.path().join("cache"));
    let vertices = || {
        let (scene, origin) = cache.load(&path).unwrap();
        (scene.meshes[0].positions.len(), matches!(origin, Origin::Cache(_)))
    };
    assert_eq!([vertices(), vertices()], [(40_000, false), (40_000, true)]);
    write(&above.join("strip.ply"), 40_001, 100);
    assert_eq!([vertices(), vertices()], [(40_001, false), (40_001, true)], "its mesh was changed");
    // A package.xml that was not there before is nearer, and then says something else.
    write(&own.join("strip.ply"), 40_002, 100);
    assert_eq!(vertices(), (40_001, true));
    std::fs::write(own.join("package.xml"), description).unwrap();
    set_age(&own.join("package.xml"), 100);
    assert_eq!([vertices(), vertices()], [(40_002, false), (40_002, true)], "there is a nearer package");
    std::fs::write(own.join("package.xml"), description.replace('p', "q")).unwrap();
    set_age(&own.join("package.xml"), 90);
    assert_eq!([vertices(), vertices()], [(40_001, false), (40_001, true)], "it is another package");
    std::fs::remove_file(above.join("strip.ply")).unwrap();
    assert!(cache.load(&path).is_err());
}

#[test]
fn what_is_wrong_behind_a_right_checksum_is_refused_too() {
    let path = Path::new("/a/b.ply");
    let mut scene = Scene::new("");
    let mesh = scene.add_mesh(super::super::Mesh::new("m", vec![glam::Vec3::ONE; 3], vec![[0, 1, 2]]));
    let root = scene.add_node(None, "r", glam::Affine3A::IDENTITY, None);
    scene.add_node(Some(root), "n", glam::Affine3A::IDENTITY, Some(mesh));
    be_seen(&mut scene);
    let stamp = Stamp { name: "b.ply".into(), size: 9, modified: Some(SystemTime::UNIX_EPOCH + SETTLED) };
    let good = layout::encode(path, &[stamp], &scene).unwrap();
    assert_eq!(print(&layout::decode(&good, path).unwrap().1), print(&scene));
    let body = good.len() - 4;
    let mut accepted = 0;
    for at in 0..body {
        for byte in [0, 1, 0x7f, 0xff] {
            let mut bytes = good.clone();
            bytes[at] = byte;
            let checksum = crc32fast::hash(&bytes[..body]);
            bytes[body..].copy_from_slice(&checksum.to_le_bytes());
            if let Some((_, scene)) = layout::decode(&bytes, path) {
                // Numbers and indices may be any: validation looks at those.
                accepted += usize::from(scene.validate().is_ok());
            }
        }
    }
    assert!(accepted > 0 && accepted < 4 * body);
}

/// Gives a scene of one mesh some of everything it can be seen with.
fn be_seen(scene: &mut Scene) {
    use super::super::{Corners, Flock, Material, Materials, PointLight, Primitive, Shape, Texture, View};
    use crate::geometry::{Sphere, hit::Cone};
    use glam::{Vec2, Vec3};
    scene.add_material(Material { texture: Some(0), ..Material::polished("coat", Vec3::X, 1.5) });
    scene.add_material(Material { ambient: Some(Vec3::Y), ..Material::dielectric("glass", 1.3) });
    let shading = &mut scene.meshes[0].shading;
    shading.materials = Materials::Each(vec![1]);
    shading.normals = Corners::of_vertices(vec![Vec3::Y; 3]);
    shading.coordinates = Corners { values: vec![Vec2::X], triangles: Some(vec![[0, 0, u32::MAX]]) };
    scene.textures.push(Texture {
        name: "t".into(),
        width: 1,
        height: 2,
        pixels: vec![[1, 2, 3], [4, 5, 6]],
    });
    scene.lights.push(PointLight { position: Vec3::Z, colour: Vec3::ONE });
    let ball = Sphere { centre: Vec3::Z, radius: 2.0 };
    let cone = Cone { base: Vec3::X, base_radius: 1.0, tip: Vec3::Y, tip_radius: 0.0 };
    scene.primitives = vec![
        Primitive { shape: Shape::Sphere(ball), material: None },
        Primitive { shape: Shape::Cone(cone), material: Some(1) },
    ];
    // Placed by the one node there is.
    let flock = vec![Primitive { shape: Shape::Sphere(ball), material: Some(0) }];
    scene.flocks.push(Flock { name: "f".into(), primitives: flock, nodes: vec![0] });
    scene.view = Some(View { eye: Vec3::X, look: Vec3::Y, up: Vec3::Z, fov_y: 0.5 });
    (scene.background, scene.ambient) = (Some(Vec3::Z), None);
    scene.warnings.push("something is not there".into());
    move_about(scene);
    scene.validate().unwrap();
}

/// Gives a scene with a light and a mesh some of every movement.
fn move_about(scene: &mut Scene) {
    use super::super::{Animation, Bend, BendKey, Curve, HermiteKey, Motion, SplineKey};
    use glam::{Quat, Vec3};
    let key = |at: u8| SplineKey {
        time: f64::from(at),
        value: Quat::from_xyzw(0.5, -0.5, 0.5, 0.5),
        tension: 0.1,
        continuity: 0.2,
        bias: -0.3,
    };
    let hermite = HermiteKey { time: -1.0, value: Vec3::ONE, arriving: Vec3::X, leaving: Vec3::Y };
    let first = Motion {
        name: "first".into(),
        translation: Some(Curve::Linear(vec![(0.1, Vec3::X), (0.2, -Vec3::ZERO)])),
        rotation: Some(Curve::Spline((0..4).map(key).collect())),
        scale: Some(Curve::Hermite(vec![hermite])),
        visibility: vec![(0.5, true), (0.7, false)],
    };
    let second = Motion { rotation: Some(Curve::Steps(vec![(3.0, Quat::IDENTITY)])), ..Motion::default() };
    let bend = BendKey { time: 2.0, positions: vec![Vec3::X; 3], normals: vec![Vec3::Z; 3] };
    scene.animation = Animation {
        start: -0.5,
        end: 2.0,
        frames: 9,
        motions: vec![first, second],
        followers: vec![(1, 0)],
        camera: Some(1),
        lights: vec![(0, 0)],
        bends: vec![Bend { mesh: 0, keys: vec![bend] }],
    };
}
