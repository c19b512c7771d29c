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
    // Five frames stand for what moves.
    for time in scene.animation.times(if scene.animation.is_still() { 0 } else { 5 }) {
        let pose = scene.pose(time);
        let view = pose.view.expect("what is animated here has a camera");
        let bent = pose.bent.iter().flat_map(|bent| bent.positions.iter().chain(&bent.normals));
        let points = bent.chain([&view.eye, &view.look, &view.up]).flat_map(|point| point.to_array());
        let placed = pose.world.iter().flat_map(|world| world.to_cols_array());
        points.chain(placed).for_each(|number| add(&(number + 0.0).to_le_bytes()));
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
        ("bart-museum-3", 0x74e29dc287f5bd55),
        ("bart-museum-4", 0x45f496fe729a8572),
        ("bart-museum-5", 0xef5b330c7a0b8e81),
        ("bart-museum-6", 0x708daeba2a384a59),
        ("bart-museum-7", 0xd3af01e439a4fc79),
        ("bart-museum-8", 0xbcac9237c9d3bdfe),
        ("bart-robots", 0x7cf745b970c1e879),
        ("bart-kitchen", 0xfccf22cd6faa26ba),
        ("bart-kitchen-1", 0xfccf22cd6faa26ba),
        ("bart-kitchen-2", 0xfccf22cd6faa26ba),
        ("bart-kitchen-3", 0xfccf22cd6faa26ba),
        ("bart-kitchen-4", 0xfccf22cd6faa26ba),
        ("bart-kitchen-5", 0xfccf22cd6faa26ba),
        ("bart-kitchen-6", 0xfccf22cd6faa26ba),
        ("bart-kitchen-7", 0xfccf22cd6faa26ba),
        ("bart-kitchen-8", 0xfccf22cd6faa26ba),
        ("bart-kitchen-9", 0xfccf22cd6faa26ba),
        ("bart-kitchen-10", 0xfccf22cd6faa26ba),
        ("bart-stress-1", 0x5489160179028f28),
        ("bart-stress-2", 0x9e3b895c0911bbeb),
        ("bart-stress-3", 0x70fa7057687a3f76),
        ("bart-stress-4", 0xddc582c9f237e614),
        ("bart-stress-5", 0xfef05f0e6e04268e),
        ("bart-stress-5-small", 0xafafe2c40e5ed052),
        ("bart-stress-6", 0xfab32ac7274c56a1),
        ("bart-stress-7", 0x5b604c881b26cd39),
        ("bart-stress-8", 0x7cff68ee332bcad6),
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
            && message.contains(".gltf, .glb, .obj, .ply, .stl, .urdf, .aff, .nff, or one of these with .gz"),
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

/// The published counts of BART (Lext et al. 2000, Table 1), and what its files say.
#[test]
fn bart_from_aff() {
    for (file, meshes, triangles, transforms, moving, still_moving) in [
        ("bart/kitchen/kitchen.aff", 393, 110_561, 416 + 7, 5, 0),
        ("bart/robot/Robot.aff", 1849, 71_708, 521 + 190, 1, 0),
        ("bart/museum/museum5.aff", 0, 10_284 + 1_024, 0, 0, 1),
    ] {
        let Some(scene) = real(file) else { return };
        let description = scene::describe(&scene);
        assert_eq!(description.instanced_triangles, triangles, "{file}");
        if transforms > 0 {
            assert_eq!(description.instances, meshes, "{file}");
            assert_eq!(scene.nodes.len(), 1 + transforms + meshes, "{file}");
            assert!(description.meshes <= meshes && scene.animation.followers.len() >= moving, "{file}");
        }
        let animation = &scene.animation;
        assert_eq!(animation.bends.len(), still_moving, "{file}");
        assert!(animation.camera.is_some() && animation.frames >= 300, "{file}");
        assert!(scene.view.is_some() && !scene.textures.is_empty(), "{file}");
    }
    let kitchen = real("bart/kitchen/kitchen.aff").unwrap();
    assert_eq!((kitchen.lights.len(), kitchen.ambient), (6, Some(glam::Vec3::splat(2.5))));
    let time = (kitchen.animation.start, kitchen.animation.end, kitchen.animation.frames);
    assert_eq!(time, (0.0, 20.0, 800));
    let robots = real("bart/robot/Robot.aff").unwrap();
    // Six names have no keys: what they hold stands still.
    let named = robots.nodes.iter().filter(|node| !node.name.is_empty() && node.mesh.is_none()).count() - 1;
    assert_eq!(named, 190);
    assert!(robots.animation.followers.len() < named);
    let museum = real("bart/museum/museum5.aff").unwrap();
    assert_eq!(museum.primitives.len(), 8);
    let bend = &museum.animation.bends[0];
    assert_eq!((museum.meshes[bend.mesh as usize].triangles.len(), bend.keys.len()), (1024, 5));
    assert_eq!((bend.keys[0].time, bend.keys[4].time), (0.0, 4.0));
}

/// The counts of the SPD's own Readme: a polygon of n corners is n - 2 triangles.
#[test]
fn standard_procedural_databases_from_nff() {
    for (file, triangles, primitives) in [
        ("balls_s4", 2, 7381),
        ("balls_s5", 2, 66_430),
        ("gears_s4", 36_610, 0),
        ("mount_s6", 8192, 4),
        ("rings_s7", 2, 8400),
        ("tetra_s6", 4096, 0),
        ("tetra_s8", 65_536, 0),
        ("tree_s11", 2, 8190),
    ] {
        let Some(scene) = real(&format!("spd_nff/{file}.nff")) else { return };
        let description = scene::describe(&scene);
        assert_eq!(
            (description.instanced_triangles, description.primitives),
            (triangles, primitives),
            "{file}"
        );
        assert!(scene.view.is_some() && !scene.lights.is_empty() && scene.warnings.is_empty(), "{file}");
    }
}

#[test]
fn bart_comes_back_as_it_was_written() {
    for file in ["bart/museum/museum5.aff", "bart/kitchen/kitchen.aff", "bart/robot/Robot.aff"] {
        let Some(scene) = real(file) else { return };
        let folder = tempfile::tempdir().unwrap();
        let written = scene::to_aff(&scene, "out");
        std::fs::write(folder.path().join("out.aff"), &written.text).unwrap();
        for (name, bytes) in &written.pictures {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        let found = scene::load(folder.path().join("out.aff")).unwrap();
        let (a, b) = (scene::describe(&scene), scene::describe(&found));
        assert_eq!(
            (a.instanced_triangles, a.primitives, a.textures, a.lights),
            (b.instanced_triangles, b.primitives, b.textures, b.lights),
            "{file}"
        );
        assert!(found.warnings.is_empty(), "{file}: {:?}", found.warnings);
        let frames = |scene: &Scene| (scene.animation.start, scene.animation.end, scene.animation.frames);
        assert_eq!(frames(&scene), frames(&found), "{file}");
        assert_eq!(scene.animation.followers.len(), found.animation.followers.len(), "{file}");
        for (a, b) in scene.animation.bends.iter().zip(&found.animation.bends) {
            assert!(a.keys == b.keys, "{file}: a mesh that bends otherwise");
        }
        assert_eq!(scene.animation.bends.len(), found.animation.bends.len(), "{file}");
        let (a, b) = (scene.bounds(), found.bounds());
        assert!(a.min.distance(b.min).max(a.max.distance(b.max)) <= 1e-5 * a.half_diagonal(), "{file}");
    }
}
