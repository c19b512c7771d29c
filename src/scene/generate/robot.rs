//! A robot arm: a stand-in for the robot of Paper II sec. 5, which was never published.
//!
//! What the paper says, and this keeps: 102 nodes, depth 11, tested for collision against the factory of 3932
//! nodes. What it does not say, and is made up here: everything else. An arm of six joints, the kind that welds
//! cars, reaches 2.6 m from its first axis to its wrist; a chain of links that carries motors, gears, covers,
//! cables and bolts on its way to the pads of a gripper. So its tree of boxes is deep, and each link's box holds
//! nearly all that its parent's does.
//!
//! It stands on the floor (y = 0) about the y axis and reaches along x. All parts are closed meshes.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{Affine3A, Vec3};

use super::super::Scene;
use super::place::{turned_x, turned_y, turned_z};
use super::shapes::{cuboid, cylinder};
use super::{Aisles, Generator};

/// The one robot.
pub(super) const ROBOT: Generator = Generator {
    name: "robot",
    about: "robot arm of six joints with gripper, 102 nodes, depth 11 (stand-in: Paper II sec. 5)",
    generate: assemble,
    aisles: || Aisles::NONE,
};

/// Triangles of each cylinder: 24 sides, three rings high.
const ROUND: u32 = 188;

/// From the first axis out to the second, in metres.
const SHOULDER: f32 = 0.3;
/// From the second axis to the third.
const UPPER_ARM: f32 = 1.1;
/// From the third axis to the wrist.
const FOREARM: f32 = 1.2;

/// Shape of a part. Lengths in metres; a part stands on its origin.
#[derive(Clone, Copy)]
enum Shape {
    /// Sizes along x, y and z.
    Box(f32, f32, f32),
    /// Radius and height.
    Round(f32, f32),
}
use Shape::{Box, Round};

/// A robot in the making.
struct Robot {
    scene: Scene,
}

impl Robot {
    /// Adds a part; parts of one name are of one shape and share a mesh.
    fn part(&mut self, parent: u32, name: &str, shape: Shape, place: Affine3A) -> u32 {
        let mesh = match self.scene.meshes.iter().position(|mesh| mesh.name == name) {
            Some(mesh) => mesh as u32,
            None => self.scene.add_mesh(match shape {
                Box(x, y, z) => cuboid(name, Vec3::new(x, y, z)),
                Round(radius, height) => cylinder(name, radius, height, ROUND),
            }),
        };
        self.scene.add_node(Some(parent), name, place, Some(mesh))
    }

    /// What every link carries at its joint: a motor with a cap across its axis, a gear, and a cover on each
    /// side. 5 nodes, two of them one below the other.
    fn joint(&mut self, link: u32, radius: f32) {
        let across = turned_x(Vec3::new(0.0, 0.0, 0.8 * radius), FRAC_PI_2);
        let motor = self.part(link, "motor", Round(0.07, 0.2), across);
        self.part(motor, "motor cap", Round(0.05, 0.04), at(0.0, 0.2, 0.0));
        let gear = turned_x(Vec3::new(0.0, 0.0, -0.9 * radius - 0.06), FRAC_PI_2);
        self.part(link, "gear", Round(0.08, 0.06), gear);
        for side in [-1.0, 1.0] {
            self.part(link, "cover", Box(0.12, 0.1, 0.02), at(0.0, 0.12, side * (radius + 0.01)));
        }
    }

    /// Cables along a link: a clamp at each end and `strands` of five pieces each. The clamps and a group over
    /// the pieces are below the link.
    fn cables(&mut self, link: u32, strands: u32, side: f32, length: f32) {
        for end in [0.1, 0.9] {
            self.part(link, "clamp", Box(0.1, 0.03, 0.06), at(0.0, end * length, side));
        }
        let cables = self.scene.add_node(Some(link), "cables", at(0.0, 0.1 * length, side), None);
        for (strand, piece) in (0..strands).flat_map(|strand| (0..5).map(move |piece| (strand, piece))) {
            let (x, y) = (0.04 * strand as f32 - 0.02, 0.16 * length * piece as f32);
            // Cables sag: every other piece leans out, and the next one back.
            let lean = if piece % 2 == 0 { 0.12 } else { -0.12 };
            self.part(cables, "cable", Round(0.015, 0.17), turned_x(Vec3::new(x, y, 0.0), lean));
        }
    }

    /// Bolts in a circle about the y axis.
    fn bolts(&mut self, parent: u32, count: u32, radius: f32, height: f32) {
        for bolt in 0..count {
            let angle = f64::from(bolt) / f64::from(count) * TAU;
            let place = Vec3::new(radius * angle.cos() as f32, height, radius * angle.sin() as f32);
            self.part(parent, "bolt", Round(0.012, 0.03), turned_y(place, angle));
        }
    }
}

fn at(x: f32, y: f32, z: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(x, y, z))
}

fn assemble() -> Scene {
    let mut robot = Robot { scene: Scene::new("robot") };
    let plate = robot.scene.add_mesh(cuboid("base plate", Vec3::new(0.9, 0.04, 0.9)));
    let root = robot.scene.add_node(None, "robot", Affine3A::IDENTITY, Some(plate));
    robot.bolts(root, 8, 0.41, 0.04);
    let base = robot.part(root, "base", Round(0.3, 0.36), at(0.0, 0.04, 0.0));
    let panel = robot.part(base, "connector panel", Box(0.04, 0.2, 0.24), at(-0.31, 0.08, 0.0));
    for plug in [-0.07, 0.0, 0.07] {
        robot.part(panel, "plug", Round(0.02, 0.08), turned_z(Vec3::new(-0.02, 0.1, plug), FRAC_PI_2));
    }
    let wrist = arm(&mut robot, base);
    gripper(&mut robot, wrist);
    robot.scene
}

/// The links from the base to the flange, each under the one before, and all that hangs on them.
fn arm(robot: &mut Robot, base: u32) -> u32 {
    // The first axis is upright; the second and third lean the arm forward, towards x; the fourth and sixth turn
    // about the forearm and the flange, the fifth bends between them.
    let turret = robot.part(base, "turret", Round(0.26, 0.25), turned_y(Vec3::Y * 0.36, 0.2));
    robot.joint(turret, 0.26);
    robot.part(turret, "balancer", Round(0.08, 0.5), turned_z(Vec3::new(-0.2, 0.25, 0.2), 0.15));
    robot.part(turret, "balancer rod", Round(0.03, 0.3), turned_z(Vec3::new(-0.27, 0.74, 0.2), -0.4));

    let shoulder = Vec3::new(SHOULDER, 0.25, 0.0);
    let upper = robot.part(turret, "upper arm", Box(0.22, UPPER_ARM, 0.2), turned_z(shoulder, -0.4));
    robot.joint(upper, 0.1);
    robot.cables(upper, 2, 0.16, UPPER_ARM);

    let elbow = robot.part(upper, "elbow", Round(0.15, 0.24), turned_z(Vec3::Y * UPPER_ARM, -0.9));
    robot.joint(elbow, 0.15);
    for side in [-0.16, 0.16] {
        let plate = robot.part(elbow, "side plate", Box(0.24, 0.24, 0.02), at(0.0, 0.0, side));
        robot.bolts(plate, 3, 0.06, 0.24);
    }

    let rest = FOREARM - 0.24;
    let forearm = robot.part(elbow, "forearm", Round(0.11, rest), turned_y(Vec3::Y * 0.24, -0.15));
    robot.joint(forearm, 0.11);
    robot.cables(forearm, 1, 0.14, rest);

    let wrist = robot.part(forearm, "wrist", Round(0.08, 0.12), turned_z(Vec3::Y * rest, -1.1));
    robot.joint(wrist, 0.08);
    let flange = robot.part(wrist, "flange", Round(0.06, 0.1), turned_y(Vec3::Y * 0.12, 0.5));
    robot.joint(flange, 0.06);
    robot.bolts(flange, 8, 0.045, 0.08);
    flange
}

/// The tool: a palm with camera, valve and hoses, and two fingers with their pads.
fn gripper(robot: &mut Robot, flange: u32) {
    let gripper = robot.part(flange, "gripper", Round(0.07, 0.08), at(0.0, 0.1, 0.0));
    robot.part(gripper, "palm", Box(0.24, 0.04, 0.1), at(0.0, 0.08, 0.0));
    let camera = robot.part(gripper, "camera", Box(0.06, 0.06, 0.06), at(0.0, 0.02, 0.1));
    robot.part(camera, "lens", Round(0.02, 0.04), at(0.0, 0.06, 0.0));
    let valve = robot.part(gripper, "valve", Box(0.08, 0.05, 0.04), at(0.0, 0.02, -0.09));
    for hose in [-0.02, 0.02] {
        robot.part(valve, "hose", Round(0.008, 0.12), turned_x(Vec3::new(hose, 0.05, 0.0), -0.3));
    }
    for side in [-0.09, 0.09] {
        let finger = robot.part(gripper, "finger", Box(0.03, 0.16, 0.05), at(side, 0.12, 0.0));
        for pad in [-1.0, 1.0] {
            let place = at(-side.signum() * 0.02, 0.1, 0.014 * pad);
            robot.part(finger, "finger pad", Box(0.01, 0.05, 0.02), place);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::describe;

    #[test]
    fn the_counts_are_the_papers_and_it_stands_on_the_floor() {
        let scene = assemble();
        scene.validate().unwrap();
        let description = describe(&scene);
        assert_eq!((description.nodes, description.depth, description.zero_area), (102, 11, 0));
        assert!(scene.nodes.iter().all(|node| node.mesh.is_some() || !node.children.is_empty()));
        let bounds = scene.bounds();
        assert_eq!(bounds.min.y, 0.0);
        assert!(bounds.min.cmplt(Vec3::ZERO).any() && bounds.max.cmpgt(Vec3::ZERO).all());
        assert!(bounds.size().max_element() > 2.0 && bounds.size().max_element() < 3.0, "{bounds:?}");
    }

    #[test]
    fn stretched_out_it_reaches_two_metres_and_six_tenths() {
        let scene = assemble();
        let named = |name: &str| scene.nodes.iter().position(|node| node.name == name).unwrap();
        let world = scene.world_transforms();
        let place = |name: &str| world[named(name)].translation;
        let lengths =
            [SHOULDER, place("upper arm").distance(place("elbow")), place("elbow").distance(place("wrist"))];
        assert!((lengths.iter().sum::<f32>() - 2.6).abs() < 1e-5, "{lengths:?}");
        let shoulder = place("upper arm");
        assert!((f32::hypot(shoulder.x, shoulder.z) - SHOULDER).abs() < 1e-6);
    }
}
