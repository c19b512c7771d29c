//! Frames held against the scene standing still as it is then.

use std::collections::BTreeMap;

use glam::{Affine3A, Quat, Vec3};

use super::*;
use crate::geometry::hit::Cone;
use crate::job::trace::{Hierarchy, Levels, TriangleKind, World};
use crate::machine::simulated::Model;
use crate::machine::{Simulated, Threads};
use crate::scene::{
    Animation, Bend, BendKey, Corners, Curve, Material, Materials, Mesh, Motion, PointLight, Primitive,
    Scene, Shape, SplitMix64, View,
};
use crate::scheme::frames::{Kept, SCHEMES};
use crate::structure::bvh::build::{Builder, Settings};

const SIZE: (u32, u32) = (50, 38);
const TIMES: [f64; 5] = [0.0, 0.4, 0.7, 1.6, 2.0];

fn heap(random: &mut SplitMix64, name: &str) -> Mesh {
    let mut point = || Vec3::from_array(std::array::from_fn(|_| random.between(-1.0, 1.0) as f32));
    let positions: Vec<Vec3> = (0..60)
        .flat_map(|_| {
            let at = point();
            [at, at + 0.6 * point(), at + 0.6 * point()]
        })
        .collect();
    let triangles = (0..60).map(|at| [3 * at, 3 * at + 1, 3 * at + 2]).collect();
    Mesh::new(name, positions, triangles)
}

/// A heap that turns and comes and goes, one whose triangles fly apart, one that stands, a cone, a mirror, five lights.
fn scene() -> Scene {
    let mut random = SplitMix64::new(21);
    let mut scene = Scene::new("moves");
    let shiny = scene.add_material(Material::metal("m", Vec3::new(0.9, 0.8, 0.6), 20));
    let heaps = ["turning", "bending", "standing"].map(|name| {
        let mut mesh = heap(&mut random, name);
        if name == "standing" {
            mesh.shading.materials = Materials::One(shiny);
        }
        scene.add_mesh(mesh)
    });
    let frame = scene.add_node(None, "frame", Affine3A::from_translation(Vec3::new(-2.0, 0.0, 0.0)), None);
    let turning = scene.add_node(Some(frame), "turning", Affine3A::IDENTITY, Some(heaps[0]));
    scene.add_node(None, "bending", Affine3A::IDENTITY, Some(heaps[1]));
    scene.add_node(None, "standing", Affine3A::from_translation(Vec3::new(2.5, 0.2, -1.0)), Some(heaps[2]));
    let cone = Cone {
        base: Vec3::new(0.0, -2.0, 0.0),
        base_radius: 0.5,
        tip: Vec3::new(0.0, 2.0, -1.0),
        tip_radius: 0.1,
    };
    scene.primitives.push(Primitive { shape: Shape::Cone(cone), material: None });
    scene.lights = (0..5)
        .map(|at| PointLight {
            position: Vec3::new(at as f32 * 2.0 - 4.0, 5.0, 4.0),
            colour: Vec3::splat(0.2),
        })
        .collect();
    scene.view = Some(View { eye: Vec3::new(0.0, 1.0, 7.0), look: Vec3::ZERO, up: Vec3::Y, fov_y: 0.7 });
    let turn = |angle: f32| Quat::from_rotation_z(angle);
    let motions = vec![
        Motion {
            name: "turn".into(),
            rotation: Some(Curve::Linear(vec![(0.0, turn(0.0)), (2.0, turn(3.0))])),
            visibility: vec![(0.5, false), (1.0, true)],
            ..Motion::default()
        },
        Motion {
            name: "camera".into(),
            translation: Some(Curve::Linear(vec![
                (0.0, Vec3::new(-0.5, 0.5, 7.0)),
                (2.0, Vec3::new(0.6, 0.4, 6.0)),
            ])),
            ..Motion::default()
        },
    ];
    let mesh = &mut scene.meshes[heaps[1] as usize];
    let normals = vec![Vec3::Z; mesh.positions.len()];
    mesh.shading.normals = Corners::of_vertices(normals.clone());
    let apart = |factor: f32| mesh.positions.iter().map(|at| *at * factor + Vec3::Y * at.x).collect();
    let keys = [(0.0, 1.0), (1.0, 0.3), (2.0, 1.7)];
    let keys =
        keys.map(|(time, factor)| BendKey { time, positions: apart(factor), normals: normals.clone() });
    let bends = vec![Bend { mesh: heaps[1], keys: keys.to_vec() }];
    let followers = vec![(turning, 0)];
    scene.animation = Animation {
        start: 0.0,
        end: 2.0,
        frames: 5,
        motions,
        followers,
        camera: Some(1),
        bends,
        ..Animation::default()
    };
    scene.validate().unwrap();
    scene
}

fn builder() -> Builder {
    Builder::new("binned_sah", &Settings::default()).unwrap()
}

fn animator(scene: Scene, upkeep: &str, levels: Levels, method: Approximation) -> Animator {
    let moving = Moving::new(scene, builder(), levels, TriangleKind::Watertight);
    let upkeep = frames::Scheme::new(upkeep, BTreeMap::new(), frames::Mode::Predetermined).unwrap();
    Animator::new(moving, upkeep, method, Look::default(), SIZE, (8, 4))
}

fn exact() -> Approximation {
    Approximation::new("exact", None).unwrap()
}

/// The pictures of some times, by a scheme on some processors of a machine.
fn pictures<M: Machine>(
    mut animator: Animator,
    times: &[f64],
    machine: &M,
    scheme: &str,
    processors: usize,
) -> Vec<Image> {
    let mut scheme = tiles::Scheme::new(scheme, machine, processors, BTreeMap::new()).unwrap();
    let (width, height) = animator.traced();
    let mut film = Film::new(machine, width, height).unwrap();
    animator.prepare(times).unwrap();
    let made = times.iter().map(|time| {
        let made = animator.next(*time, machine, &mut scheme, &mut film).unwrap();
        assert!(made.update_ticks <= made.ticks);
        made.image(&mut film)
    });
    made.collect()
}

fn one_by_one(animator: Animator, times: &[f64]) -> Vec<Image> {
    pictures(animator, times, &Threads::new(1).unwrap(), "serial", 1)
}

/// The picture of the scene standing still as it is at a time, by a hierarchy made for it.
fn still(scene: &Scene, time: f64) -> Image {
    let world = World::new(scene.still(time));
    let hierarchy = Hierarchy::new(world.items(), &mut builder(), TriangleKind::Watertight).unwrap();
    let machine = Threads::new(1).unwrap();
    let mut film = Film::new(&machine, SIZE.0, SIZE.1).unwrap();
    let view = world.scene().view.unwrap();
    let eye = Eye::of_view(&view, SIZE.0 as f32 / SIZE.1 as f32, SIZE).unwrap();
    let tracer = Tracer::new(&world, &hierarchy, Look::default());
    tiles::share("serial", &machine, 1, &Frame::new(tracer, eye, (8, 4), &mut film)).unwrap();
    film.image()
}

/// Pixels of which a colour differs by more than a hundredth.
fn others(a: &Image, b: &Image) -> usize {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let differs = |(a, b): &(&[f32; 3], &[f32; 3])| a.iter().zip(*b).any(|(a, b)| (a - b).abs() > 0.01);
    a.pixels.iter().zip(&b.pixels).filter(differs).count()
}

#[test]
fn what_a_frames_time_goes_into_changes_no_picture() {
    for method in ["exact", "pixel_reuse", "lower_resolution"] {
        let make = || {
            animator(scene(), "rebuild_on_threshold", Levels::Two, Approximation::new(method, None).unwrap())
        };
        let expected = one_by_one(make(), &TIMES);
        let (mut animator, machine) = (make(), Threads::new(1).unwrap());
        let (width, height) = animator.traced();
        let mut film = Film::new(&machine, width, height).unwrap();
        for (time, expected) in TIMES.iter().zip(&expected) {
            let (picture, split) = animator.split(*time, &machine, &mut film).unwrap();
            assert!(picture == *expected, "{method} at {time}");
            // Twice a question, which is of up to 512 rays.
            let asked = u64::from(width * height).div_ceil(512);
            assert!(split.readings % 2 == 0 && split.readings > 2 * asked / 16, "{split:?}");
            assert!(
                split.rebuild_ticks > 0 && split.visibility_ticks > 0 && split.shading_ticks > 0,
                "{split:?}"
            );
        }
    }
}

#[test]
fn every_frame_is_that_of_the_scene_standing_still() {
    let scene = scene();
    let expected: Vec<Image> = TIMES.iter().map(|time| still(&scene, *time)).collect();
    let changes = expected.windows(2).map(|pair| others(&pair[0], &pair[1])).min().unwrap();
    assert!(changes > 200, "between frames {changes} pixels change");
    for about in SCHEMES {
        let flat = one_by_one(animator(scene.clone(), about.name, Levels::One, exact()), &TIMES);
        assert!(flat == expected, "{}, one level", about.name);
        // Rays are rounded in a mesh's space, so a ray along an edge may go another way.
        let two = one_by_one(animator(scene.clone(), about.name, Levels::Two, exact()), &TIMES);
        for (number, (two, expected)) in two.iter().zip(&expected).enumerate() {
            let other = others(two, expected);
            assert!(other <= 6, "{}, two levels, frame {number}: {other} pixels", about.name);
        }
    }
}

#[test]
fn frames_that_are_foretold_cost_least_as_they_come() {
    // The expected costs of its frames, and of what it was told of those it makes structures for, by each scheme.
    let times: Vec<f64> = (0..12).map(|number| f64::from(number) / 6.0).collect();
    let total = |name: &str, percent: &str| {
        let settings = match name {
            "rebuild_when_best" | "rebuild_on_threshold" => {
                BTreeMap::from([("percent".to_owned(), percent.to_owned())])
            }
            _ => BTreeMap::new(),
        };
        let moving = Moving::new(scene(), builder(), Levels::One, TriangleKind::Watertight);
        let upkeep = frames::Scheme::new(name, settings, frames::Mode::Predetermined).unwrap();
        let mut animator = Animator::new(moving, upkeep, exact(), Look::default(), SIZE, (8, 4));
        animator.prepare(&times).unwrap();
        let (mut sum, mut rebuilt) = (0.0, 0);
        for (number, time) in times.iter().enumerate() {
            let upkeep = animator.update(*time).unwrap();
            let cost = animator.moving.cost();
            let is_anew = number > 0 && upkeep == Upkeep::Rebuilt;
            rebuilt += usize::from(is_anew);
            sum += cost * if is_anew { 1.02 } else { 1.0 };
        }
        (sum, rebuilt)
    };
    let (best, rebuilt) = total("rebuild_when_best", "2");
    assert!((1..times.len()).contains(&rebuilt), "made anew {rebuilt} times");
    for percent in ["100", "102", "110", "130", "200"] {
        let (other, _) = total("rebuild_on_threshold", percent);
        assert!(best <= other * (1.0 + 1e-9), "{best}, but {other} by a threshold of {percent} %");
    }
    for name in ["rebuild_each_frame", "refit_only"] {
        let (other, _) = total(name, "");
        assert!(best <= other * (1.0 + 1e-9), "{best}, but {other} by {name}");
    }
}

#[test]
fn frames_are_the_same_whoever_makes_them_and_in_whatever_order() {
    let scene = scene();
    for levels in [Levels::One, Levels::Two] {
        let make = |upkeep: &str| animator(scene.clone(), upkeep, levels, exact());
        let expected = one_by_one(make("rebuild_each_frame"), &TIMES);
        for about in SCHEMES {
            assert!(one_by_one(make(about.name), &TIMES) == expected, "{}", about.name);
            let back: Vec<f64> = TIMES.iter().rev().copied().collect();
            let mut found = one_by_one(make(about.name), &back);
            found.reverse();
            assert!(found == expected, "{} backwards", about.name);
        }
        for (scheme, processors) in [("decreasing_tiles", 3), ("work_stealing", 2), ("static_blocks", 7)] {
            let threads = Threads::new(processors).unwrap();
            let found = pictures(make("refit_only"), &TIMES, &threads, scheme, processors);
            assert!(found == expected, "{scheme} on {processors} threads");
        }
        let simulated = Simulated::new(Model::named("origin2000").unwrap());
        let found = pictures(make("rebuild_on_threshold"), &TIMES[..2], &simulated, "fixed_tiles", 5);
        assert!(found == expected[..2], "on a simulated machine");
    }
}

#[test]
fn turned_off_every_approximation_is_exact() {
    let scene = scene();
    let expected = one_by_one(animator(scene.clone(), "refit_only", Levels::Two, exact()), &TIMES);
    let off = [
        ("exact", 0.0),
        ("pixel_reuse", 0.0),
        ("reprojection", 16.0),
        ("lower_depth", 64.0),
        ("fewer_lights", 5.0),
        ("lower_resolution", 1.0),
    ];
    assert_eq!(off.len(), APPROXIMATIONS.len());
    for (name, knob) in off {
        let method = Approximation::new(name, Some(knob)).unwrap();
        let found = one_by_one(animator(scene.clone(), "refit_only", Levels::Two, method), &TIMES);
        assert!(found == expected, "{name}");
    }
}

#[test]
fn the_further_an_approximation_goes_the_more_differs() {
    let scene = scene();
    let exact = one_by_one(animator(scene.clone(), "refit_only", Levels::One, exact()), &TIMES);
    let differs = |name: &str, knob: f64| -> usize {
        let method = Approximation::new(name, Some(knob)).unwrap();
        let found = one_by_one(animator(scene.clone(), "refit_only", Levels::One, method), &TIMES);
        found.iter().zip(&exact).map(|(found, exact)| others(found, exact)).sum()
    };
    for (name, little, much) in [
        ("pixel_reuse", 4.0, 12.0),
        ("reprojection", 12.0, 2.0),
        ("lower_depth", 3.0, 0.0),
        ("fewer_lights", 4.0, 1.0),
        ("lower_resolution", 1.5, 6.0),
    ] {
        let [little, much] = [little, much].map(|knob| differs(name, knob));
        assert!(little < much && much > 100, "{name}: {little}, then {much} pixels");
    }
}

#[test]
fn where_nothing_moves_what_looks_back_is_exact() {
    let mut scene = scene().still(0.4);
    scene.name = "still".into();
    let times = [0.0, 0.1, 0.2, 0.3];
    let expected = one_by_one(animator(scene.clone(), "refit_only", Levels::One, exact()), &times);
    for (name, knob) in [("pixel_reuse", 12.0), ("reprojection", 2.0)] {
        let method = Approximation::new(name, Some(knob)).unwrap();
        let found = one_by_one(animator(scene.clone(), "refit_only", Levels::One, method), &times);
        assert!(found == expected, "{name}");
    }
}

#[test]
fn less_is_traced_where_something_is_known() {
    let mut animator =
        animator(scene(), "refit_only", Levels::Two, Approximation::new("pixel_reuse", Some(12.0)).unwrap());
    let machine = Threads::new(1).unwrap();
    let mut scheme = tiles::Scheme::new("serial", &machine, 1, BTreeMap::new()).unwrap();
    let mut film = Film::new(&machine, SIZE.0, SIZE.1).unwrap();
    let mut eye_rays = |time: f64| animator.next(time, &machine, &mut scheme, &mut film).unwrap().rays.eye;
    let all = u64::from(SIZE.0 * SIZE.1);
    assert_eq!(eye_rays(0.0), all);
    let then = eye_rays(0.1);
    assert!(then.abs_diff(all / 4) < all / 20, "{then} of {all}");
}

#[test]
fn what_cannot_be_is_refused() {
    for about in APPROXIMATIONS {
        let Knob { default, least, most, .. } = about.knob;
        assert!((least..=most).contains(&default), "{}", about.name);
        for bad in [f64::NAN, least - 1.0, most + 1.0] {
            assert!(Approximation::new(about.name, Some(bad)).is_none(), "{} {bad}", about.name);
        }
    }
    assert!(Approximation::new("guesswork", None).is_none());
    let mut scene = scene();
    scene.animation = Animation::default();
    scene.view = Some(View { eye: Vec3::ONE, look: Vec3::ONE, up: Vec3::Y, fov_y: 0.7 });
    let mut animator = animator(scene, "refit_only", Levels::One, exact());
    let machine = Threads::new(1).unwrap();
    let mut scheme = tiles::Scheme::new("serial", &machine, 1, BTreeMap::new()).unwrap();
    let mut film = Film::new(&machine, SIZE.0, SIZE.1).unwrap();
    let wrong = animator.next(3.5, &machine, &mut scheme, &mut film);
    assert!(matches!(wrong, Err(AnimateError::NoView { time: 3.5 })));
}
