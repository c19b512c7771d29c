//! The robots (P3-03): ten of them walk through a city and gather in its middle.

use glam::Vec3;

use super::city::{BLOCKS, PITCH, city};
use super::walker::{Parts, Way};
use super::{Aisles, Generator, Stage, flight};
use crate::scene::{PointLight, Scene};

pub(in crate::scene::generate) const ROBOTS: Generator = Generator {
    name: "bart-robots",
    about: "BART's robots: 10 of 6,249 triangles in 18 moving parts, a city of 9,218; 50 s (stand-in: Paper III, Robots)",
    generate: robots,
    aisles: || Aisles::NONE,
};

/// How many there are.
const ROBOTS_THERE: usize = 10;
/// End of the animation, in seconds.
const END: f64 = 50.0;
/// From when on the camera stands still.
const STILL: f64 = 45.0;

fn robots() -> Scene {
    let mut stage = Stage::new("bart-robots");
    let animation = &mut stage.scene.animation;
    (animation.start, animation.end, animation.frames) = (0.0, END, 800);
    let parts = Parts::new(&mut stage);
    for number in 0..ROBOTS_THERE {
        let corners = way(number);
        let starts = 0.5 + 0.3 * number as f64;
        let comes = 38.0 + 0.6 * number as f64;
        let restless = number % 4 == 1;
        Way { number, corners: &corners, starts, comes, restless, end: END }.send(&mut stage, &parts);
    }
    city(&mut stage);
    let sun = PointLight { position: Vec3::new(350.0, 700.0, 250.0), colour: Vec3::splat(0.95) };
    stage.scene.lights = vec![sun];
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let high = at(2.0, 24.0, 15.0);
    let middle = at(0.0, 1.0, 0.0);
    // Past a robot as it sets out, down its street, over a corner, up to where all of them are seen.
    stage.fly(
        flight(&[
            (-2.0, at(23.5, 2.2, 104.0), at(20.0, 2.2, 94.0)),
            (0.0, at(23.5, 2.2, 101.0), at(20.0, 2.2, 92.0)),
            (6.0, at(22.5, 3.0, 92.0), at(20.0, 1.8, 82.0)),
            (12.0, at(18.0, 6.0, 84.0), at(20.0, 1.5, 66.0)),
            (18.0, at(21.0, 12.0, 70.0), at(20.0, 1.5, 48.0)),
            (24.0, at(19.0, 10.0, 52.0), at(18.0, 1.5, 30.0)),
            (30.0, at(20.0, 14.0, 36.0), at(8.0, 2.0, 14.0)),
            (36.0, at(14.0, 18.0, 26.0), at(2.0, 2.0, 6.0)),
            (STILL - 4.0, at(4.0, 22.0, 18.0), middle),
            // Twice there, so that it has come to rest the second time.
            (STILL - 1.0, high, middle),
            (STILL, high, middle),
            (STILL + 2.0, high, middle),
            (END, high, middle),
            (END + 2.0, high, middle),
        ]),
        0.8,
    );
    stage.scene
}

/// Where a robot walks: along a street to the square, then to its place in a ring there.
fn way(number: usize) -> Vec<Vec3> {
    // Streets lie halfway between the blocks, on either side of the square; the ends of five and the middles of five
    // are their beginnings, so that they are spread evenly.
    let street = 0.5 * PITCH;
    let far = PITCH * BLOCKS as f32 * 0.5;
    let (sign, other) =
        (if number.is_multiple_of(2) { 1.0 } else { -1.0 }, if number % 4 < 2 { 1.0 } else { -1.0 });
    let distance = far * (1.0 - 0.12 * (number / 4) as f32);
    let begin = match number / 2 % 2 {
        0 => Vec3::new(street * sign, 0.0, distance * other),
        _ => Vec3::new(distance * sign, 0.0, street * other),
    };
    let turn = match number / 2 % 2 {
        0 => Vec3::new(begin.x, 0.0, street * 0.55 * other),
        _ => Vec3::new(street * 0.55 * sign, 0.0, begin.z),
    };
    let angle = number as f64 / ROBOTS_THERE as f64 * std::f64::consts::TAU + 0.3;
    let ring = Vec3::new((angle.sin() * 4.5) as f32, 0.0, (angle.cos() * 4.5) as f32);
    vec![begin, turn, ring]
}

#[cfg(test)]
mod tests {
    use super::super::walker::TRIANGLES;
    use super::*;
    use crate::scene::describe;

    #[test]
    fn the_counts_are_the_papers() {
        let scene = robots();
        scene.validate().unwrap();
        let holds = describe(&scene);
        assert_eq!(holds.instanced_triangles, 71_708);
        assert_eq!(holds.instanced_triangles - ROBOTS_THERE * TRIANGLES, 9_218, "the city");
        assert_eq!((holds.moving, holds.lights, holds.frames, holds.seconds), (180, 1, 800, 50.0));
        assert_eq!(holds.zero_area, 0);
        // Each robot is a tree of its own with 18 nodes that move.
        let moves = |node: u32| scene.animation.followers.iter().any(|(follower, _)| *follower == node);
        let bodies: Vec<u32> = scene.roots.iter().copied().filter(|root| moves(*root)).collect();
        assert_eq!(bodies.len(), ROBOTS_THERE);
        for body in bodies {
            let (mut stack, mut moving, mut triangles) = (vec![body], 0, 0);
            while let Some(node) = stack.pop() {
                let node_there = &scene.nodes[node as usize];
                stack.extend(&node_there.children);
                moving += usize::from(moves(node));
                triangles += node_there.mesh.map_or(0, |mesh| scene.meshes[mesh as usize].triangles.len());
            }
            assert_eq!((moving, triangles), (18, TRIANGLES));
        }
        let with =
            |is: fn(&crate::scene::Motion) -> bool| scene.animation.motions.iter().filter(|m| is(m)).count();
        assert_eq!(with(|motion| motion.scale.is_some()), ROBOTS_THERE, "translation, rotation and scale");
    }

    /// The mean distance of the robots from the middle of them all, in metres.
    fn spread(scene: &Scene, time: f64) -> f32 {
        let pose = scene.pose(time);
        let bodies = (0..scene.nodes.len()).filter(|node| scene.nodes[*node].name.starts_with("body"));
        let places: Vec<Vec3> = bodies.map(|node| pose.world[node].translation.into()).collect();
        let middle = places.iter().sum::<Vec3>() / places.len() as f32;
        places.iter().map(|place| place.distance(middle)).sum::<f32>() / places.len() as f32
    }

    #[test]
    fn they_are_spread_at_first_and_gather_and_the_camera_comes_to_rest() {
        let scene = robots();
        assert!(spread(&scene, 0.0) > 60.0 && spread(&scene, END) < 6.0);
        let (before, after) = (scene.pose(STILL + 0.1), scene.pose(END));
        assert_eq!(before.view, after.view, "the camera stands still");
        let moved = before.world.iter().zip(&after.world).filter(|(a, b)| a != b).count();
        assert!(moved > 0 && moved < 20, "a few parts move on: {moved}");
        assert_ne!(scene.pose(10.0).view, scene.pose(10.1).view);
    }

    #[test]
    fn nobody_sinks_into_the_ground_or_walks_through_a_tower() {
        let scene = robots();
        let towers: Vec<_> = scene
            .world_bounds()
            .into_iter()
            .zip(&scene.nodes)
            .filter(|(_, node)| node.name == "tower")
            .collect();
        assert_eq!(towers.len(), 96);
        for step in 0..=100 {
            let pose = scene.pose(f64::from(step) * 0.5);
            for (index, node) in scene.nodes.iter().enumerate() {
                let Some(mesh) = node.mesh.filter(|_| node.name != "tower" && node.name != "ground") else {
                    continue;
                };
                let bounds = scene.meshes[mesh as usize].bounds.transformed(&pose.world[index]);
                assert!(bounds.min.y > -0.15, "{} at {step}: {bounds:?}", node.name);
                let hit = towers.iter().find(|(tower, _)| {
                    tower.min.cmple(bounds.max).all() && bounds.min.cmple(tower.max).all()
                });
                assert!(hit.is_none(), "{} at {step} in a tower", node.name);
            }
        }
    }
}
