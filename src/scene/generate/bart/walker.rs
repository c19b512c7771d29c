//! A robot of eighteen moving parts, and how it walks.

use std::f64::consts::TAU;

use glam::{Affine3A, Quat, Vec3};

use super::super::{cuboid, cylinder, geodesic};
use super::{Stage, about, pennant, smooth, spline, turning};
use crate::scene::{Material, Mesh, Motion};

/// Triangles of a robot (P3-03).
pub(super) const TRIANGLES: usize = 6_249;
/// From the ground to the hip, in metres, legs straight.
const HIP: f32 = 1.8;
/// How long two steps take, in seconds.
const STRIDE: f64 = 1.6;
/// Key frames of a stride.
const PHASES: u32 = 8;

/// The meshes of a robot, which all of them share.
pub(super) struct Parts {
    pelvis: u32,
    torso: u32,
    head: u32,
    gun: u32,
    upper_arm: u32,
    lower_arm: u32,
    hand: u32,
    thigh: u32,
    shin: u32,
    foot: u32,
    toes: u32,
    aerial: u32,
}

impl Parts {
    pub(super) fn new(stage: &mut Stage) -> Self {
        let steel = Material {
            diffuse: Vec3::new(0.2, 0.22, 0.25),
            ..Material::metal("steel", Vec3::splat(0.35), 60)
        };
        let steel = stage.material(steel);
        let paint = stage.material(Material::polished("paint", Vec3::new(0.5, 0.16, 0.08), 1.5));
        let glow = stage.material(Material::matt("eyes", Vec3::new(0.9, 0.8, 0.2)));
        // Limbs hang down from their joints: a cylinder stands on the origin, so it is turned over.
        let hanging = |name: &str, radius: f32, length: f32, count: u32| {
            let mesh = smooth(cylinder(name, radius, length, count));
            moved(mesh, Vec3::Y * -length)
        };
        let mut parts = Self {
            pelvis: stage.mesh(smooth(cylinder("pelvis", 0.4, 0.35, 300)), steel),
            torso: 0,
            head: stage.mesh(smooth(geodesic("head", 0.3, 4)), glow),
            gun: stage.mesh(smooth(cylinder("gun", 0.07, 0.9, 200)), steel),
            upper_arm: stage.mesh(hanging("upper arm", 0.14, 0.6, 300), paint),
            lower_arm: stage.mesh(hanging("lower arm", 0.11, 0.6, 300), steel),
            hand: stage.mesh(moved(cuboid("hand", Vec3::new(0.2, 0.25, 0.12)), Vec3::Y * -0.25), steel),
            thigh: stage.mesh(hanging("thigh", 0.18, 0.85, 400), paint),
            shin: stage.mesh(hanging("shin", 0.14, 0.8, 400), steel),
            foot: stage
                .mesh(moved(cuboid("foot", Vec3::new(0.3, 0.15, 0.4)), Vec3::new(0.0, -0.15, 0.06)), steel),
            toes: stage
                .mesh(moved(cuboid("toes", Vec3::new(0.3, 0.12, 0.2)), Vec3::new(0.0, -0.12, 0.1)), paint),
            aerial: 0,
        };
        let corners = [Vec3::new(0.0, 0.25, 0.0), Vec3::new(0.0, 0.8, -0.1), Vec3::new(0.0, 0.65, 0.12)];
        parts.aerial = stage.mesh(pennant("aerial", corners), paint);
        // The torso is made of what the others leave over.
        let count = |part: u32| stage.scene.meshes[part as usize].triangles.len();
        let single = [parts.pelvis, parts.head, parts.gun, parts.aerial].map(count);
        let pairs =
            [parts.upper_arm, parts.lower_arm, parts.hand, parts.thigh, parts.shin, parts.foot, parts.toes];
        let rest = TRIANGLES - single.iter().sum::<usize>() - 2 * pairs.map(count).iter().sum::<usize>();
        let torso = smooth(cylinder("torso", 0.5, 1.0, rest as u32));
        parts.torso = stage.mesh(torso, paint);
        parts
    }
}

fn moved(mesh: Mesh, by: Vec3) -> Mesh {
    let normals = mesh.shading.normals;
    let positions = mesh.positions.into_iter().map(|position| position + by).collect();
    let mut mesh = Mesh::new(mesh.name, positions, mesh.triangles);
    mesh.shading.normals = normals;
    mesh
}

/// A robot's way: from when it walks to when it has come, in seconds, by which corners.
pub(super) struct Way<'a> {
    pub(super) number: usize,
    pub(super) corners: &'a [Vec3],
    pub(super) starts: f64,
    pub(super) comes: f64,
    /// Whether it still looks about after it has come.
    pub(super) restless: bool,
    /// End of the animation, in seconds.
    pub(super) end: f64,
}

impl Way<'_> {
    /// Puts the robot on its way: eighteen nodes that move, three below the other from the body to the hands, five to
    /// the toes.
    pub(super) fn send(&self, stage: &mut Stage, parts: &Parts) {
        let body = stage.moving(None, self.body(), Some(parts.pelvis));
        let swing = |what: &str, place: Vec3, degrees: f64, phase: f64, rest: f64| {
            self.swing(what, place, degrees, phase, rest)
        };
        let torso =
            stage.moving(Some(body), swing("torso", Vec3::Y * 0.35, 4.0, 0.25, 0.0), Some(parts.torso));
        let head = stage.moving(Some(torso), self.head(), Some(parts.head));
        stage.scene.add_node(Some(head), "aerial", Affine3A::IDENTITY, Some(parts.aerial));
        stage.moving(Some(torso), self.gun(), Some(parts.gun));
        for (side, phase) in [(-1.0, 0.0), (1.0, 0.5)] {
            let shoulder = Vec3::new(side * 0.66, 0.85, 0.0);
            let arm = swing("upper arm", shoulder, 25.0, phase + 0.5, 0.0);
            let arm = stage.moving(Some(torso), arm, Some(parts.upper_arm));
            let lower = swing("lower arm", Vec3::Y * -0.6, 12.0, phase + 0.6, -35.0);
            let lower = stage.moving(Some(arm), lower, Some(parts.lower_arm));
            let hand = swing("hand", Vec3::Y * -0.6, 15.0, phase + 0.7, 0.0);
            stage.moving(Some(lower), hand, Some(parts.hand));
            let hip = Vec3::new(side * 0.24, 0.05, 0.0);
            let thigh = stage.moving(Some(body), swing("thigh", hip, 28.0, phase, 0.0), Some(parts.thigh));
            let shin = swing("shin", Vec3::Y * -0.85, 22.0, phase - 0.25, 18.0);
            let shin = stage.moving(Some(thigh), shin, Some(parts.shin));
            let foot = swing("foot", Vec3::Y * -0.8, 14.0, phase + 0.4, -8.0);
            let foot = stage.moving(Some(shin), foot, Some(parts.foot));
            let toes = swing("toes", Vec3::new(0.0, -0.02, 0.22), 12.0, phase + 0.3, 0.0);
            stage.moving(Some(foot), toes, Some(parts.toes));
        }
    }

    fn name(&self, what: &str) -> String {
        format!("{what} {}", self.number)
    }

    /// Times of key frames while it walks, and two before and behind that hold it still.
    fn times(&self) -> impl Iterator<Item = f64> + use<> {
        let (starts, comes) = (self.starts, self.comes);
        let step = STRIDE / f64::from(PHASES);
        let count = ((comes - starts) / step).ceil() as u32;
        let walking = (0..count).map(move |at| starts + step * f64::from(at));
        [starts - 2.0, starts - 1.0].into_iter().chain(walking).chain([
            comes,
            comes + 1.0,
            self.end.max(comes) + 2.0,
            self.end.max(comes) + 3.0,
        ])
    }

    /// How far it swings at a time: all the way, but for its first and last half second.
    fn share(&self, time: f64) -> f64 {
        ((time - self.starts) * 2.0).min((self.comes - time) * 2.0).clamp(0.0, 1.0)
    }

    /// A joint that swings about x as it walks, by so many degrees to either side of another angle.
    fn swing(&self, what: &str, place: Vec3, degrees: f64, phase: f64, rest: f64) -> Motion {
        let angle = |time: f64| {
            let share = self.share(time);
            let along = (time / STRIDE + phase) * TAU;
            ((along.sin() * degrees + rest) * share).to_radians()
        };
        let still = [-10.0, 0.0, self.end, self.end + 10.0];
        Motion {
            name: self.name(what),
            translation: spline(still.map(|time| (time, place))),
            rotation: turning(self.times().map(|time| (time, about(Vec3::X, angle(time))))),
            ..Motion::default()
        }
    }

    /// Where it is and where it is headed; it bobs with its steps.
    fn body(&self) -> Motion {
        let lengths: Vec<f32> = self.corners.windows(2).map(|pair| pair[0].distance(pair[1])).collect();
        let total: f32 = lengths.iter().sum();
        let place = |time: f64| {
            let gone = ((time - self.starts) / (self.comes - self.starts)).clamp(0.0, 1.0) as f32 * total;
            let mut left = gone;
            for (pair, length) in self.corners.windows(2).zip(&lengths) {
                if left <= *length {
                    return pair[0].lerp(pair[1], left / length);
                }
                left -= length;
            }
            self.corners[self.corners.len() - 1]
        };
        let bob = |time: f64| ((time / STRIDE * 2.0 * TAU).sin() * 0.05 * self.share(time)) as f32;
        let heading = |time: f64| {
            // As it will be a moment later, or, when it has come, was before.
            let (from, to) = (place(time.min(self.comes - 0.8) - 0.4), place(time.max(self.starts) + 0.4));
            let way = if from == to { place(self.starts + 0.4) - place(self.starts) } else { to - from };
            about(Vec3::Y, f64::from(way.x).atan2(f64::from(way.z)))
        };
        Motion {
            name: self.name("body"),
            translation: spline(self.times().map(|time| (time, place(time) + Vec3::Y * (HIP + bob(time))))),
            rotation: turning(self.times().map(|time| (time, heading(time)))),
            ..Motion::default()
        }
    }

    /// It looks about: as long as it walks, and some of them to the end.
    fn head(&self) -> Motion {
        let until = if self.restless { self.end } else { self.comes };
        let turn = |time: f64| {
            let angle = if time < until { (time * 0.7 + self.number as f64).sin() * 0.8 } else { 0.0 };
            about(Vec3::Y, angle)
        };
        let last = self.end as u32 + 3;
        Motion {
            name: self.name("head"),
            translation: spline([-10.0, 0.0, self.end, self.end + 10.0].map(|time| (time, Vec3::Y * 1.3))),
            rotation: turning((0..=last + 2).map(|at| f64::from(at) - 2.0).map(|time| (time, turn(time)))),
            ..Motion::default()
        }
    }

    /// On its back, forward over the shoulder; it is drawn in and out, which is a scaling.
    fn gun(&self) -> Motion {
        let until = if self.restless { self.end } else { self.comes };
        let length = |time: f64| {
            let drawn = if time < until { (time * 0.9 + self.number as f64).sin() * 0.3 } else { 0.0 };
            Vec3::new(1.0, 1.0 + drawn as f32, 1.0)
        };
        let last = self.end as u32 + 3;
        let still = [-10.0, 0.0, self.end, self.end + 10.0];
        let forward: Quat = about(Vec3::X, TAU / 4.4);
        Motion {
            name: self.name("gun"),
            translation: spline(still.map(|time| (time, Vec3::new(0.36, 1.1, -0.1)))),
            rotation: turning(still.map(|time| (time, forward))),
            scale: spline((0..=last + 2).map(|at| f64::from(at) - 2.0).map(|time| (time, length(time)))),
            ..Motion::default()
        }
    }
}
