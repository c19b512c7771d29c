use super::super::super::{Mesh, PointLight};
use super::super::{Animation, Bend, BendKey, HermiteKey, SplineKey};
use super::*;

fn good() -> Scene {
    let mut scene = Scene::new("good");
    let mesh = scene.add_mesh(Mesh::new("m", vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]));
    scene.add_node(None, "a", glam::Affine3A::IDENTITY, Some(mesh));
    scene.lights.push(PointLight { position: Vec3::ZERO, colour: Vec3::ONE });
    let key = |time: f64| SplineKey { time, value: Vec3::X, tension: 0.0, continuity: 0.0, bias: 0.0 };
    let hermite = HermiteKey { time: 0.0, value: Vec3::ONE, arriving: Vec3::X, leaving: Vec3::X };
    let bend = |time: f64| BendKey { time, positions: vec![Vec3::ONE; 3], normals: Vec::new() };
    let motion = Motion {
        name: "lift".into(),
        translation: Some(Curve::Spline([0.0, 0.0, 2.0, 3.0].map(key).to_vec())),
        rotation: Some(Curve::Linear(vec![(0.0, Quat::IDENTITY), (1.0, Quat::IDENTITY)])),
        scale: Some(Curve::Hermite(vec![hermite])),
        visibility: vec![(1.0, false)],
    };
    scene.animation = Animation {
        start: 0.0,
        end: 1.0,
        frames: 2,
        motions: vec![motion],
        followers: vec![(0, 0)],
        camera: Some(0),
        lights: vec![(0, 0)],
        bends: vec![Bend { mesh: 0, keys: vec![bend(0.0), bend(1.0)] }],
    };
    scene
}

fn message(change: impl FnOnce(&mut Animation)) -> String {
    let mut scene = good();
    scene.validate().unwrap();
    change(&mut scene.animation);
    scene.validate().unwrap_err().to_string()
}

#[test]
fn each_fault_is_named() {
    fn spline(animation: &mut Animation) -> &mut Vec<SplineKey<Vec3>> {
        let Some(Curve::Spline(keys)) = &mut animation.motions[0].translation else { panic!("a spline") };
        keys
    }
    let turn =
        |turn: Quat| move |a: &mut Animation| a.motions[0].rotation = Some(Curve::Steps(vec![(0.0, turn)]));
    let cases = [
        (message(|a| a.end = -1.0), "from 0 to -1 s"),
        (message(|a| a.start = f64::NAN), "from NaN to 1 s"),
        (message(|a| a.end = f64::INFINITY), "from 0 to inf s"),
        (message(|a| spline(a).truncate(3)), "motion 0 \"lift\": 3 key frames; expected four at least"),
        (message(|a| spline(a)[1].time = 2.5), "times that are not in order"),
        (message(|a| spline(a)[3].time = f64::NAN), "times that are not in order"),
        (message(|a| spline(a)[3].time = 1e19), "times that are not in order"),
        (message(|a| spline(a)[2].value.y = f32::NAN), "no transform"),
        (message(|a| spline(a)[2].bias = f32::INFINITY), "no transform"),
        (message(turn(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0))), "rotations of some length"),
        (message(turn(Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0))), "rotations of some length"),
        (message(|a| a.motions[0].rotation = Some(Curve::Linear(Vec::new()))), "0 key frames; expected one"),
        (message(|a| a.motions[0].visibility = vec![(2.0, true), (1.0, true)]), "not in order"),
        (message(|a| a.followers[0].1 = 1), "animation of node 0: motion 1; expected a motion below 1"),
        (message(|a| a.followers[0].0 = 5), "animation of node 5: node 5; expected one below 1"),
        (message(|a| a.followers.push((0, 0))), "a second motion"),
        (message(|a| a.lights[0].0 = 1), "animation of light 1: light 1; expected one below 1"),
        (message(|a| a.camera = Some(1)), "camera: motion 1; expected a motion below 1"),
        (message(|a| a.bends[0].mesh = 1), "bend 0: mesh 1; expected a mesh below 1"),
        (message(|a| a.bends.push(a.bends[0].clone())), "mesh 0, which bends already"),
        (message(|a| a.bends[0].keys.clear()), "bend 0: 0 key frames"),
        (message(|a| a.bends[0].keys.swap(0, 1)), "not in order"),
        (
            message(|a| a.bends[0].keys[1].positions.push(Vec3::X)),
            "4 positions and 0 normals; expected the mesh's 3",
        ),
        (message(|a| a.bends[0].keys[1].normals.push(Vec3::X)), "3 positions and 1 normals"),
        (message(|a| a.bends[0].keys[1].positions[1].x = f32::NAN), "a vertex at 1 s"),
    ];
    for (message, part) in &cases {
        assert!(message.starts_with("good: ") && message.contains(part), "{message:?} lacks {part:?}");
    }
    assert!(
        message(|a| {
            let Some(Curve::Hermite(keys)) = &mut a.motions[0].scale else { panic!("a Hermite curve") };
            keys[0].leaving.z = f32::NAN;
        })
        .contains("no transform")
    );
}
