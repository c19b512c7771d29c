//! Scenes as users get them: generated ones by name, real ones from files when they are there.

use std::path::PathBuf;

use apportion::scene::{self, Cache, CameraPath, GENERATORS, Origin, Scene, Shape};

/// A real scene, or `None` with a note: the package has to pass its tests without them.
fn real(file: &str) -> Option<Scene> {
    Some(scene::load(real_path(file)?).unwrap_or_else(|error| panic!("{error}")))
}

fn real_path(file: &str) -> Option<PathBuf> {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/scenes")).join(file);
    if !path.exists() {
        eprintln!("skipped: {} is not here", path.display());
        return None;
    }
    Some(path)
}

/// FNV-1a over everything a generated scene is made of.
fn fingerprint(scene: &Scene) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    let mut add = |bytes: &[u8]| {
        for byte in bytes {
            hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    for node in &scene.nodes {
        add(node.name.as_bytes());
        add(&node.parent.unwrap_or(u32::MAX).to_le_bytes());
        add(&node.mesh.unwrap_or(u32::MAX).to_le_bytes());
        // Adding 0 makes -0 and 0, which are the same place, the same bytes.
        node.transform.to_cols_array().iter().for_each(|number| add(&(number + 0.0).to_le_bytes()));
    }
    for node in scene.flocks.iter().flat_map(|flock| &flock.nodes) {
        add(&node.to_le_bytes());
    }
    let placed = scene.flocks.iter().flat_map(|flock| &flock.primitives);
    for primitive in scene.primitives.iter().chain(placed) {
        let numbers = match primitive.shape {
            Shape::Sphere(ball) => [ball.centre.to_array(), [ball.radius, 0.0, 0.0]].concat(),
            Shape::Cone(cone) => {
                [cone.base.to_array(), cone.tip.to_array(), [cone.base_radius, cone.tip_radius, 0.0]].concat()
            }
        };
        numbers.into_iter().for_each(|number| add(&(number + 0.0).to_le_bytes()));
    }
    for mesh in &scene.meshes {
        mesh.positions
            .iter()
            .flat_map(|p| p.to_array())
            .for_each(|number| add(&(number + 0.0).to_le_bytes()));
        mesh.triangles.iter().flatten().for_each(|vertex| add(&vertex.to_le_bytes()));
    }
    hash
}

#[test]
fn factories_have_the_counts_of_the_papers() {
    for (name, nodes, triangles) in [
        ("factory-large", 3932, 184_000),
        ("factory-medium", 1137, 52_000),
        ("factory-small", 254, 167_000),
        ("factory-model1", 3800, 184_000),
        ("factory-model2", 188, 167_000),
        ("factory-model3", 1274, 52_000),
    ] {
        let description = scene::describe(&scene::by_name(name).unwrap());
        assert_eq!((description.nodes, description.instanced_triangles), (nodes, triangles), "{name}");
    }
}

#[test]
fn generated_scenes_never_change() {
    let prints: Vec<(&str, u64)> = GENERATORS.iter().map(|g| (g.name, fingerprint(&g.generate()))).collect();
    // A change here changes every result measured on these scenes: say so in their meta data.
    let expected = [
        ("factory-large", 0xcbac75a0bd568767),
        ("factory-medium", 0x487f3e3237751212),
        ("factory-small", 0xac230c9066bfe6d1),
        ("factory-model1", 0xe88655b85b9384e4),
        ("factory-model2", 0xa3c1635132339b02),
        ("factory-model3", 0x67d5a4bedc6c9e70),
        ("dragon", 0xd9f5de484b23d1e7),
        ("dragons-split", 0x90f8fbc7a3ca966f),
        ("dragons-packed", 0x9de7802c93f02783),
        ("pompeii", 0xc2c0904729a42bc2),
        ("equal-centroids", 0xef050c113d07ec29),
        ("far-outlier", 0xf587e573ad9c701c),
        ("robot", 0xe60df19119cbabe9),
        ("shell", 0x34acd0d835864471),
        ("shell-5", 0xcde249e75b4d4876),
        ("shell-1", 0x42c60fd3d6159879),
        ("cloth", 0x670f720ebbdfe8b2),
        ("room", 0x24097d7c36635f6f),
        ("corner", 0xa102b96e9d7adba9),
        ("spheres-10k", 0x73a2e85b7cd79d0e),
        ("spheres-1m", 0x1c81f95c833c5aef),
        ("spheres-35m", 0xb80364af5812e6b7),
        ("noise-sphere", 0x6202a746a9127cbf),
        ("cylinder-196", 0xb6cdb833835065fb),
        ("cylinder-596", 0x4ca07a662e28c65c),
        ("cylinder-1996", 0x84ec2639853f5117),
        ("cylinder-3996", 0xb349b753b68ce595),
        ("cylinder-19996", 0xb43a3072b852edac),
    ];
    assert_eq!(prints, expected);
}

#[test]
fn unknown_names_and_formats_list_the_known() {
    let message = scene::by_name("factory-lrage").unwrap_err().to_string();
    assert_eq!(message, "unknown scene \"factory-lrage\"; did you mean factory-large?");
    assert!(scene::by_name("").unwrap_err().to_string().contains("factory-small"));
    let message = scene::load("model.step").unwrap_err().to_string();
    assert!(
        message.contains("model.step")
            && message.contains(".gltf, .glb, .obj, .ply, .stl, .urdf, or one of these with .gz"),
        "{message}"
    );
    let message = scene::load("missing.obj").unwrap_err().to_string();
    assert!(message.starts_with("missing.obj: cannot be read"), "{message}");
}

#[test]
fn every_scene_has_a_path() {
    for generator in GENERATORS {
        let scene = generator.generate();
        assert_eq!(CameraPath::for_scene(&scene, 50, 1).frames.len(), 50);
        let stranger = Scene { name: "stranger".to_string(), ..scene };
        assert_eq!(CameraPath::for_scene(&stranger, 50, 1).frames.len(), 50);
    }
}

#[test]
fn reciprocating_saw() {
    let Some(scene) = real("cad_recip_saw/ReciprocatingSaw.glb") else { return };
    let description = scene::describe(&scene);
    assert_eq!((description.nodes, description.meshes, description.depth), (368, 65, 8));
    assert_eq!((description.unique_triangles, description.instances), (139_594, 113));
    assert_eq!(description.instanced_triangles, 198_470);
    assert_eq!(description.aspect_p90.round(), 75.0);
    assert!((description.aspect_p99 - 808.0).abs() < 2.0);
}

#[test]
fn two_cylinder_engine() {
    let Some(scene) = real("cad_2cylinder_engine/2CylinderEngine.glb") else { return };
    let description = scene::describe(&scene);
    assert_eq!((description.nodes, description.meshes, description.depth), (82, 29, 6));
    assert_eq!((description.unique_triangles, description.instances), (75_730, 67));
    assert_eq!((description.instanced_triangles, description.zero_area), (121_496, 11_160));
}

#[test]
fn architecture_from_obj() {
    if let Some(scene) = real("sponza/sponza.obj") {
        let description = scene::describe(&scene);
        assert_eq!(description.unique_triangles, 66_450);
        assert_eq!(description.zero_area, 6);
        assert_eq!(description.depth, 2);
        assert_eq!((description.aspect_p50 * 10.0).round(), 76.0);
    }
    if let Some(scene) = real("building_fzk_haus/fzk_haus.obj") {
        let description = scene::describe(&scene);
        assert_eq!(description.unique_triangles, 36_290);
        assert_eq!((description.aspect_p90.round(), description.aspect_p99.round()), (1844.0, 3466.0));
    }
}

#[test]
fn scanned_models() {
    if let Some(scene) = real("stanford_bunny/bun_zipper.ply") {
        let description = scene::describe(&scene);
        assert_eq!((description.nodes, description.unique_triangles), (1, 69_451));
        assert_eq!(scene.meshes[0].positions.len(), 35_947);
    }
    if let Some(path) = real_path("stanford_dragon/dragon_vrip.ply.gz") {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::in_folder(folder.path());
        let (parsed, origin) = cache.load(&path).unwrap();
        assert_eq!(
            (scene::describe(&parsed).unique_triangles, parsed.meshes[0].positions.len()),
            (871_414, 437_645)
        );
        assert!(matches!(origin, Origin::Kept(_)), "{origin}");
        let (fetched, origin) = cache.load(&path).unwrap();
        assert!(matches!(origin, Origin::Cache(_)), "{origin}");
        assert_eq!(fingerprint(&parsed), fingerprint(&fetched));
    }
}

#[test]
fn robot_links_from_stl() {
    let Some(folder) = real_path("robots/fanuc/meshes/collision") else { return };
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let links = files.filter(|path| path.extension().is_some_and(|extension| extension == "stl"));
    let triangles = links.map(|path| scene::describe(&scene::load(path).unwrap()).unique_triangles);
    assert_eq!(triangles.sum::<usize>(), 6_934);
}

#[test]
fn robots_from_urdf() {
    for (file, links, deepest, depth, placed) in [
        ("robots/fanuc/fanuc.urdf", 9, 8, 8, (7, 6_934)),
        ("robots/panda/panda.urdf", 12, 11, 12, (11, 2_364)),
    ] {
        let Some(scene) = real(file) else { return };
        let description = scene::describe(&scene);
        assert_eq!((scene.instances(), description.depth, scene.roots.len()), (placed, depth, 1), "{file}");
        // A link is what has no mesh; the geometries hang below, and are no deeper than the deepest link's.
        let is_link = |node: &u32| scene.nodes[*node as usize].mesh.is_none();
        let order = scene.depth_first();
        assert_eq!(order.iter().filter(|node| is_link(node)).count(), links, "{file}");
        let above = |node: &u32| scene.nodes[*node as usize].parent;
        let depths = order.iter().filter(|node| is_link(node));
        let depths = depths.map(|node| std::iter::successors(Some(*node), above).count());
        assert_eq!(depths.max(), Some(deepest), "{file}");
        let size = scene.bounds().size();
        assert!(size.max_element() > 0.9 && size.max_element() < 2.0, "{file}: {size}");
    }
}
