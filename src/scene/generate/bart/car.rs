//! The toy car of the kitchen: a body, two front wheels that steer, four that roll, three levels deep.

use std::f64::consts::TAU;

use glam::{Affine3A, DVec3, Quat, Vec3};

use super::super::{cuboid, cylinder, geodesic, place::turned_x};
use super::{Stage, about, smooth, spline, turning};
use crate::scene::{Curve, Material, Motion};

/// Triangles of the car, as many as the original's.
pub(super) const TRIANGLES: usize = 7_218;
/// Radius of a wheel, in metres.
const WHEEL: f32 = 0.032;
/// From the car's middle to an axle, and to a wheel's middle along it.
const AXLE: f32 = 0.085;
const TRACK: f32 = 0.062;

/// Where it drives, in metres: from a corner past the camera, about the table and under it, into a cupboard.
const WAY: [(f64, f32, f32); 15] = [
    (-1.0, 4.1, 3.3),
    (3.0, 4.1, 3.3),
    (5.0, 3.65, 3.2),
    (7.0, 3.35, 2.9),
    (7.3, 3.3, 1.6),
    (9.0, 3.2, 1.2),
    (11.0, 2.3, 1.9),
    (13.0, 1.4, 2.4),
    (15.0, 0.7, 1.7),
    (17.0, 1.1, 0.95),
    (18.5, 2.3, 0.8),
    (19.4, 3.4, 1.0),
    (19.75, 3.72, 0.77),
    (20.0, 3.74, 0.7),
    (21.0, 3.74, 0.7),
];
/// When it meets the cupboard, and when the scene ends, in seconds.
const CRASH: f64 = 19.75;
const END: f64 = 20.0;

/// How it was driven.
struct Drive {
    way: Curve<Vec3>,
}

impl Drive {
    fn place(&self, time: f64) -> DVec3 {
        self.way.at(time).unwrap_or_default()
    }

    /// The angle about y that turns its nose, which is at +x, to where it goes; where it stands, to where it went or
    /// will go.
    fn heading(&self, time: f64) -> f64 {
        let time = time.clamp(3.2, CRASH - 0.05);
        let way = self.place(time + 0.05) - self.place(time - 0.05);
        (-way.z).atan2(way.x)
    }
}

/// Adds the car, which drives from 3 s on.
pub(super) fn car(stage: &mut Stage) {
    let keys = WAY.map(|(time, x, z)| (time, Vec3::new(x, 0.0, z)));
    let drive = Drive { way: spline(keys).expect("it has keys") };
    let red = stage.material(Material {
        highlight: Vec3::splat(0.6),
        exponent: 120,
        ..Material::polished("car", Vec3::new(0.65, 0.06, 0.05), 1.6)
    });
    let glass = stage.material(Material {
        mirror: Vec3::splat(0.3),
        ..Material::matt("windows", Vec3::new(0.05, 0.07, 0.1))
    });
    let rubber = stage.material(Material::matt("rubber", Vec3::splat(0.06)));
    let chrome = stage.material(Material::metal("chrome", Vec3::splat(0.7), 200));
    let root = stage.moving(None, whole(&drive), None);
    let fixed = |stage: &mut Stage, mesh: u32, name: &str, place: Affine3A| {
        stage.scene.add_node(Some(root), name, place, Some(mesh));
    };
    let at = |x: f32, y: f32, z: f32| Affine3A::from_translation(Vec3::new(x, y, z));
    let hood = stage.mesh(cuboid("hood", Vec3::new(0.27, 0.045, 0.115)), red);
    fixed(stage, hood, "hood", at(0.0, 0.028, 0.0));
    let bumper = stage.mesh(smooth(cylinder("bumper", 0.009, 0.12, 120)), chrome);
    for x in [-0.137, 0.137] {
        fixed(stage, bumper, "bumper", turned_x(Vec3::new(x, 0.035, -0.06), TAU / 4.0));
    }
    let lamp = stage.mesh(smooth(geodesic("lamp", 0.014, 5)), chrome);
    for z in [-0.04, 0.04] {
        fixed(stage, lamp, "lamp", at(0.132, 0.06, z));
    }
    let tyre = smooth(cylinder("tyre", WHEEL, 0.026, 640));
    let hub = smooth(cylinder("hub", WHEEL * 0.55, 0.028, 200));
    let (tyre, hub) = (stage.mesh(tyre, rubber), stage.mesh(hub, chrome));
    let roll = stage.scene.animation.motions.len() as u32;
    stage.scene.animation.motions.push(rolling(&drive));
    for (front, side) in [(false, -1.0), (false, 1.0), (true, -1.0), (true, 1.0)] {
        let place = Vec3::new(if front { AXLE } else { -AXLE }, WHEEL, side * TRACK);
        let axle = if front {
            stage.moving(Some(root), steering(&drive, place), None)
        } else {
            stage.scene.add_node(Some(root), "axle", Affine3A::from_translation(place), None)
        };
        let wheel = stage.scene.add_node(Some(axle), "wheel", Affine3A::IDENTITY, None);
        stage.scene.animation.followers.push((wheel, roll));
        // A cylinder stands along y; a wheel's axle lies along z. The spoke shows that it rolls.
        let lying = turned_x(Vec3::new(0.0, 0.0, -0.013), TAU / 4.0);
        stage.scene.add_node(Some(wheel), "tyre", lying, Some(tyre));
        stage.scene.add_node(Some(wheel), "hub", turned_x(Vec3::new(0.0, 0.0, -0.014), TAU / 4.0), Some(hub));
    }
    // The roof is made of what the others leave over.
    let placed = |node: &crate::scene::Node| node.mesh.map(|mesh| &stage.scene.meshes[mesh as usize]);
    let of_car = ["hood", "bumper", "lamp", "tyre", "hub"];
    let nodes = stage.scene.nodes.iter().filter(|node| of_car.contains(&node.name.as_str()));
    let used: usize = nodes.filter_map(placed).map(|mesh| mesh.triangles.len()).sum();
    let roof = stage.mesh(smooth(geodesic("roof", 0.06, 8)), glass);
    let cap = TRIANGLES - used - 20 * 64;
    let cap = stage.mesh(smooth(cylinder("cap", 0.042, 0.008, cap as u32)), red);
    let flat = Affine3A::from_scale_rotation_translation(
        Vec3::new(1.15, 0.8, 0.85),
        Quat::IDENTITY,
        Vec3::new(-0.02, 0.065, 0.0),
    );
    fixed(stage, roof, "roof", flat);
    fixed(stage, cap, "cap", at(-0.02, 0.105, 0.0));
}

/// The whole car: it drives, turns where it goes, and is pressed together along its way as it meets the cupboard.
fn whole(drive: &Drive) -> Motion {
    let length = |part: f32| Vec3::new(part, 1.0, 1.0);
    let keys = (-4..=84).map(|quarter| f64::from(quarter) * 0.25);
    Motion {
        name: "toycar".into(),
        translation: Some(drive.way.clone()),
        rotation: turning(keys.map(|time| (time, about(Vec3::Y, drive.heading(time))))),
        scale: spline([(-1.0, length(1.0)), (CRASH, length(1.0)), (END, length(0.5)), (21.0, length(0.5))]),
        ..Motion::default()
    }
}

/// A front wheel turns a little further than the car does.
fn steering(drive: &Drive, place: Vec3) -> Motion {
    let angle = |time: f64| {
        let (before, after) = (drive.heading(time - 0.1), drive.heading(time + 0.1));
        let turn = (after - before + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0;
        (turn * 1.5).clamp(-0.6, 0.6)
    };
    let keys = (-4..=84).map(|quarter| f64::from(quarter) * 0.25);
    Motion {
        name: "front wheel".into(),
        translation: spline([-1.0, 0.0, END, 21.0].map(|time| (time, place))),
        rotation: turning(keys.map(|time| (time, about(Vec3::Y, angle(time))))),
        ..Motion::default()
    }
}

/// Wheels roll as far as the car goes: a key for each quarter of a turn, so that none is taken the wrong way round.
fn rolling(drive: &Drive) -> Motion {
    const STEPS: u32 = 8_000;
    let mut keys = vec![(-1.0, 0.0), (0.0, 0.0)];
    let (mut gone, mut last, mut quarters) = (0.0, drive.place(0.0), 0.0);
    for step in 1..=STEPS {
        let time = END * f64::from(step) / f64::from(STEPS);
        let place = drive.place(time);
        gone += place.distance(last) / f64::from(WHEEL);
        last = place;
        if gone >= (quarters + 1.0) * TAU / 4.0 || step == STEPS {
            quarters = (gone / (TAU / 4.0)).floor();
            keys.push((time, gone));
        }
    }
    keys.push((END + 1.0, gone));
    // About -z: a wheel that rolls towards +x turns clockwise seen from +z.
    Motion {
        name: "rotating wheel".into(),
        rotation: turning(keys.into_iter().map(|(time, angle)| (time, about(Vec3::NEG_Z, angle)))),
        ..Motion::default()
    }
}
