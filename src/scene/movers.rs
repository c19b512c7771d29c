//! Objects that move from frame to frame: a share of a scene's, each on a round of its own.

use glam::{Affine3A, Quat, Vec3};

use super::{Scene, SplitMix64};

/// Radius of a round, in half-diagonals of what goes round.
const RADIUS: (f64, f64) = (0.5, 2.0);
/// Frames that a round takes: 4 to 16 seconds at 30 a second.
const ROUND: (f64, f64) = (120.0, 480.0);

/// Objects on rounds.
///
/// Each goes round a circle in its parent's horizontal plane and turns as it goes, as a vehicle does: rigidly, from
/// where the scene has it in frame 0. The same ones move in every frame, the others never: doors, robots and vehicles
/// among walls. Those of a smaller share are among those of a larger one with the same seed.
#[derive(Clone, Debug)]
pub struct Movers {
    rounds: Vec<Round>,
}

#[derive(Clone, Debug)]
struct Round {
    node: u32,
    /// The node's transform at rest.
    rest: Affine3A,
    /// The circle's middle in the parent's space, metres.
    centre: Vec3,
    /// Radians a frame, clockwise if negative.
    speed: f64,
}

impl Movers {
    /// A share, 0 to 1, of the nodes offered, rounded, but one at least where the share is not 0. Equal seeds choose
    /// the same. Nodes without a mesh can be offered too; they turn about where they are.
    ///
    /// # Panics
    /// If a node is not in the scene.
    pub fn new(scene: &Scene, mut offered: Vec<u32>, share: f64, seed: u64) -> Self {
        let count = (offered.len() as f64 * share).round() as usize;
        let least = usize::from(share > 0.0).min(offered.len());
        let mut random = SplitMix64::new(seed);
        let rounds = (0..count.clamp(least, offered.len())).map(|chosen| {
            let pick = chosen + random.below(offered.len() - chosen);
            offered.swap(chosen, pick);
            Round::new(scene, offered[chosen], &mut random)
        });
        Self { rounds: rounds.collect() }
    }

    /// The nodes that move, each with its transform to its parent's space in a frame.
    pub fn transforms(&self, frame: usize) -> impl Iterator<Item = (u32, Affine3A)> {
        self.rounds.iter().map(move |round| (round.node, round.transform(frame)))
    }
}

impl Round {
    fn new(scene: &Scene, node: u32, random: &mut SplitMix64) -> Self {
        let placed = &scene.nodes[node as usize];
        let rest = placed.transform;
        let bounds = placed.mesh.map(|mesh| scene.meshes[mesh as usize].bounds.transformed(&rest));
        let bounds = bounds.filter(|bounds| !bounds.is_empty());
        let (middle, size) =
            bounds.map_or((rest.translation.into(), 0.0), |bounds| (bounds.centre(), bounds.half_diagonal()));
        let towards = Quat::from_rotation_y(random.between(0.0, std::f64::consts::TAU) as f32) * Vec3::X;
        let centre = middle + towards * (size * random.between(RADIUS.0, RADIUS.1) as f32);
        let sense = if random.below(2) == 0 { 1.0 } else { -1.0 };
        let speed = sense * std::f64::consts::TAU / random.between(ROUND.0, ROUND.1);
        Self { node, rest, centre, speed }
    }

    /// About the circle's middle: what goes round it and turns as it goes is simply turned there.
    fn transform(&self, frame: usize) -> Affine3A {
        if frame == 0 {
            return self.rest;
        }
        let angle = (self.speed * frame as f64) % std::f64::consts::TAU;
        let turn = Quat::from_rotation_y(angle as f32);
        let offset = self.centre - turn * self.centre;
        Affine3A::from_rotation_translation(turn, offset) * self.rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::by_name;

    fn some(share: f64, seed: u64) -> (Scene, Movers) {
        let scene = by_name("factory-small").unwrap();
        let offered = (0..scene.nodes.len() as u32).filter(|node| scene.nodes[*node as usize].mesh.is_some());
        let movers = Movers::new(&scene, offered.collect(), share, seed);
        (scene, movers)
    }

    fn nodes(movers: &Movers) -> Vec<u32> {
        movers.transforms(0).map(|(node, _)| node).collect()
    }

    #[test]
    fn as_many_move_as_were_asked_for_and_each_once() {
        let all = some(1.0, 1).1.rounds.len();
        for (share, count) in [(0.0, 0), (1e-9, 1), (0.1, (all as f64 * 0.1).round() as usize), (1.0, all)] {
            let mut found = nodes(&some(share, 1).1);
            assert_eq!(found.len(), count, "{share}");
            found.sort_unstable();
            found.dedup();
            assert_eq!(found.len(), count, "{share}: twice the same");
        }
        let (few, half) = (nodes(&some(0.1, 4).1), nodes(&some(0.5, 4).1));
        assert_eq!(few, half[..few.len()], "a smaller share's are among a larger's");
        assert_ne!(nodes(&some(0.1, 4).1), nodes(&some(0.1, 5).1));
        let empty = Scene::new("empty");
        assert_eq!(Movers::new(&empty, Vec::new(), 1.0, 1).transforms(3).count(), 0);
    }

    #[test]
    fn rounds_are_rigid_small_and_start_at_rest() {
        let (scene, movers) = some(1.0, 9);
        for (node, transform) in movers.transforms(0) {
            assert_eq!(transform, scene.nodes[node as usize].transform);
        }
        for frame in [1, 2, 60, 100_000, usize::MAX] {
            for ((_, transform), round) in movers.transforms(frame).zip(&movers.rounds) {
                let moved = transform * round.rest.inverse();
                let squared = moved.matrix3.transpose() * moved.matrix3;
                assert!(squared.abs_diff_eq(glam::Mat3A::IDENTITY, 1e-3), "frame {frame}: {squared}");
                let middle = moved.transform_point3(round.centre);
                assert!(middle.distance(round.centre) < 1e-3, "frame {frame}: the circle moved to {middle}");
            }
        }
        let steps = movers.transforms(1).zip(&movers.rounds);
        let moved = steps.filter(|((_, transform), round)| *transform != round.rest).count();
        assert_eq!(moved, movers.rounds.len(), "all that is to move does");
    }
}
