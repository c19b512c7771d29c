use std::path::Path;

use super::super::gltf_motion::tests::encoded;
use super::super::load;
use super::*;

/// Puts numbers into a buffer, and a view and an accessor to each list of them.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl File {
    fn add(&mut self, kind: &str, parts: usize, numbers: &[f32]) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        self.add_bytes(kind, 5126, numbers.len() / parts, &bytes)
    }

    fn add_bytes(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let (start, length) = (self.bytes.len(), bytes.len());
        self.bytes.extend(bytes);
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{length}}}"#));
        let view = self.accessors.len();
        self.accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":{component},"count":{count},"type":"{kind}","min":[0,0,0],"max":[1,1,1]}}"#
        ));
        view
    }

    fn read(mut self, rest: &str) -> Scene {
        while !self.bytes.len().is_multiple_of(3) {
            self.bytes.push(0);
        }
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},{rest},"accessors":[{}],"bufferViews":[{}],
            "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}]}}"#,
            self.accessors.join(","),
            self.views.join(","),
            self.bytes.len(),
            encoded(&self.bytes)
        );
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bending.gltf");
        std::fs::write(&path, text).unwrap();
        load(&path).unwrap()
    }
}

#[test]
fn absurd_times_and_counts_leave_the_mesh_still() {
    for (times, weights, works) in [
        (vec![0.0, 3e38], vec![0.0, 1.0], true),
        (vec![0.0, f32::NAN], vec![0.0, 1.0], false),
        (vec![1.0, 0.0, 1.0], vec![0.0, 1.0, 2.0], true),
        (vec![0.0, 1.0], vec![0.0, f32::NAN], false),
        (vec![0.0, 1.0], vec![0.0], false),
    ] {
        let mut file = File::default();
        file.add("VEC3", 3, &CORNERS);
        file.add("VEC3", 3, &CORNERS);
        file.add("SCALAR", 1, &times);
        file.add("SCALAR", 1, &weights);
        let scene = file.read(
            r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":1}]}]}],
            "animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],"samplers":[{"input":2,"output":3}]}]"#,
        );
        assert_eq!(scene.warnings.is_empty(), works, "{times:?} {weights:?}: {:?}", scene.warnings);
        assert!(scene.pose(0.5).bent.iter().flat_map(|bent| &bent.positions).all(|at| at.is_finite()));
    }
}

const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

#[test]
fn weights_that_go_straight_bend_exactly_by_their_own_key_frames() {
    let mut file = File::default();
    file.add("VEC3", 3, &CORNERS);
    // Two targets: all up by 1, the first corner out along -x by 2.
    file.add("VEC3", 3, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    file.add("VEC3", 3, &[-2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    file.add("SCALAR", 1, &[0.0, 2.0, 3.0]);
    file.add("SCALAR", 1, &[0.0, 1.0, 4.0, 0.0, 4.0, 0.5]);
    let scene = file.read(
        r#""nodes":[{"mesh":0,"translation":[5,0,0]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":1},{"POSITION":2}]}]}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],"samplers":[{"input":3,"output":4}]}]"#,
    );
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!((scene.animation.start, scene.animation.end, scene.animation.frames), (0.0, 3.0, 91));
    assert_eq!(scene.animation.bends[0].keys.len(), 3);
    let at = |time: f64| scene.pose(time).bent[0].positions.clone();
    assert_eq!(at(0.0), [Vec3::new(-2.0, 0.0, 0.0), Vec3::X, Vec3::Y]);
    assert_eq!(at(1.0), [Vec3::new(-1.0, 0.0, 2.0), Vec3::new(1.0, 0.0, 2.0), Vec3::new(0.0, 1.0, 2.0)]);
    assert_eq!(at(9.0)[0], Vec3::new(-1.0, 0.0, 4.0));
    assert_eq!(scene.pose(1.0).world[0].translation, glam::Vec3A::X * 5.0);
}

/// Corners follow the first joint, the second, and half of each; the second turns by half a turn about z in 1 s.
fn skinned() -> Scene {
    let mut file = File::default();
    file.add("VEC3", 3, &CORNERS);
    file.add_bytes("VEC4", 5121, 3, &[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    file.add("VEC4", 4, &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]);
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    // The second joint stands at (0, 0, 3): to its space is 3 down.
    let mut down = identity;
    down[14] = -3.0;
    file.add("MAT4", 16, &[identity, down].concat());
    file.add("SCALAR", 1, &[0.0, 0.5, 1.0]);
    let half = 0.5_f32.sqrt();
    file.add("VEC4", 4, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half, 0.0, 0.0, 1.0, 0.0]);
    file.read(
        r#""nodes":[{"mesh":0,"skin":0,"translation":[70,0,0]},{"children":[2]},{"translation":[0,0,3]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}]}],
        "skins":[{"joints":[1,2],"inverseBindMatrices":3}],
        "animations":[{"channels":[{"sampler":0,"target":{"node":2,"path":"rotation"}}],"samplers":[{"input":4,"output":5}]}]"#,
    )
}

#[test]
fn skins_follow_their_joints_as_near_as_they_say() {
    let scene = skinned();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let keys = scene.animation.bends[0].keys.len();
    assert!((5..=65).contains(&keys), "{keys} key frames of a turn");
    for step in 0..=100 {
        let time = f64::from(step) * 0.01;
        let (sin, cos) = (time * std::f64::consts::PI).sin_cos();
        let expected =
            [DVec3::ZERO, DVec3::new(cos, sin, 0.0), (DVec3::Y + DVec3::new(-sin, cos, 0.0)) * 0.5];
        let pose = scene.pose(time);
        // The last node is the mesh's own: the place of the one it was on counts for nothing.
        assert_eq!(pose.world[3], Affine3A::IDENTITY);
        for (found, expected) in pose.bent[0].positions.iter().zip(expected) {
            assert!(found.as_dvec3().distance(expected) < 2.0 * CLOSE, "{time}: {found} {expected}");
        }
    }
    assert_eq!(scene.instances(), (1, 1));
}

#[test]
fn real_files_bend() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/scenes/gltf_anim");
    if !Path::new(folder).exists() {
        eprintln!("skipped: {folder} is not here");
        return;
    }
    for (file, triangles) in [
        ("CesiumMan.glb", 4_672),
        ("Fox.gltf", 576),
        ("AnimatedMorphCube/AnimatedMorphCube.gltf", 12),
        ("AnimatedMorphSphere/AnimatedMorphSphere.gltf", 960),
    ] {
        let scene = load(Path::new(folder).join(file)).unwrap();
        let bends = &scene.animation.bends;
        assert!(bends.len() == 1 && scene.instances().1 == triangles, "{file}: {:?}", scene.warnings);
        let (start, end) = (scene.animation.start, scene.animation.end);
        let shape = |share: f64| scene.pose(start + (end - start) * share).bent[0].clone();
        let moved = shape(0.1).positions.iter().zip(&shape(0.35).positions).filter(|(a, b)| a != b).count();
        assert!(moved > 0, "{file}");
        // It stays in one piece: no box about it is ten times another.
        let size = |share: f64| shape(share).bounds.half_diagonal();
        assert!((0..20).all(|step| size(f64::from(step) / 20.0) < 10.0 * size(0.0)), "{file}");
        eprintln!(
            "{file}: {} key frames, {} bytes",
            bends[0].keys.len(),
            crate::scene::describe(&scene).bytes
        );
    }
}
