//! What must be found, and what a test gives up: by a descent of its own, without any of the job's code.

use super::super::{Sample, Stage};
use super::{Asked, MeasureError, Volumes};
use crate::geometry::culling::{Culler, Forgetful, Motion, Remembering, Side, Steps, Verdict};
use crate::geometry::oracle::{Exact, Hexahedron};
use crate::geometry::{Aabb, Frustum, Volume};
use crate::job::cull::Descent;
use crate::structure::SkipNode;
use glam::Affine3A;
use std::collections::BTreeMap;

/// The exact tests are slow: at most so many frames of a path go through them, evenly chosen.
const FRAMES: usize = 64;

/// What a run is held against.
pub(super) struct Truth {
    found: Found,
    given_up: Vec<Sample>,
}

/// What must be found in a frame.
enum Found {
    /// These nodes, frame by frame: what the serial basic test finds.
    These(Vec<Vec<u32>>),
    /// These nodes at least, in the frames looked at: those that the exact test finds.
    AtLeast(BTreeMap<usize, Vec<u32>>),
}

impl Truth {
    pub(super) fn of(stage: &Stage, volumes: &Volumes, asked: &Asked) -> Result<Self, MeasureError> {
        match volumes {
            Volumes::Aabb => {
                let boxes: Vec<Aabb> = stage.tree.nodes.iter().map(|node| node.bounds).collect();
                Self::with(stage, &boxes, asked)
            }
            Volumes::Obb(volumes) => Self::with(stage, volumes, asked),
            Volumes::Sphere(volumes) => Self::with(stage, volumes, asked),
            Volumes::Dop14(volumes) => Self::with(stage, volumes, asked),
            Volumes::Dop18(volumes) => Self::with(stage, volumes, asked),
            Volumes::Dop26(volumes) => Self::with(stage, volumes, asked),
        }
    }

    fn with<V: Exact>(stage: &Stage, volumes: &[V], asked: &Asked) -> Result<Self, MeasureError> {
        let nodes = &stage.tree.nodes;
        let whole = asked.descent == Descent::WholeTree;
        let found = if asked.is_basic_at_heart() {
            let these = |camera| {
                let frustum = Frustum::new(camera);
                let basic = Culler::basic(&frustum);
                let test = |node: u32, _| basic.classify(&volumes[node as usize], &Forgetful, 0);
                drawn(nodes, whole, test)
            };
            Found::These(stage.cameras.iter().map(these).collect())
        } else {
            let least = looked_at(stage).map(|frame| {
                let exact = Hexahedron::new(&stage.cameras[frame]);
                let test = |node: u32, _| Verdict {
                    side: if meets(&exact, &volumes[node as usize]) {
                        Side::Intersecting
                    } else {
                        Side::Outside(0)
                    },
                    tests: 0,
                    inside: 0,
                };
                (frame, drawn(nodes, whole, test))
            });
            Found::AtLeast(least.collect())
        };
        let given_up = match asked.accuracy {
            true => given_up(stage, volumes, asked.steps)?,
            false => Vec::new(),
        };
        Ok(Truth { found, given_up })
    }

    /// Checks what a run found in a frame.
    pub(super) fn check(&self, frame: usize, found: &[u32]) -> Result<(), String> {
        match &self.found {
            Found::These(frames) if found == frames[frame] => Ok(()),
            Found::These(frames) => {
                let (found, expected) = (found.len(), frames[frame].len());
                Err(format!("frame {frame}: {found} visible nodes where the serial oracle finds {expected}"))
            }
            Found::AtLeast(frames) => {
                let mut least = frames.get(&frame).into_iter().flatten();
                match least.find(|node| found.binary_search(node).is_err()) {
                    None => Ok(()),
                    Some(lost) => {
                        Err(format!("frame {frame}: node {lost} is visible by the exact test, but culled"))
                    }
                }
            }
        }
    }

    /// What the test gives up.
    pub(super) fn given_up(&self) -> impl Iterator<Item = Sample> {
        self.given_up.iter().cloned()
    }
}

/// The frames that the exact tests look at.
fn looked_at(stage: &Stage) -> impl Iterator<Item = usize> {
    let frames = stage.cameras.len();
    (0..frames).step_by(frames.div_ceil(FRAMES).max(1))
}

/// Whether a volume meets the frustum; by the box around it first, for most are nowhere near.
fn meets<V: Exact>(exact: &Hexahedron, volume: &V) -> bool {
    // Its corners are rounded.
    let (around, room) = (Aabb::of_points(volume.corners()), volume.radius() * 1e-3);
    let around = Aabb { min: around.min - room, max: around.max + room };
    (volume.is_nan() || exact.intersects(&around)) && exact.intersects(volume)
}

/// The nodes with triangles that a descent finds, in order. `test` is given a node and the planes that the nodes
/// above it are inside of.
fn drawn(nodes: &[SkipNode], whole: bool, mut test: impl FnMut(u32, u8) -> Verdict) -> Vec<u32> {
    let mut found = Vec::new();
    let mut masks = vec![(nodes.len() as u32, 0)];
    // Up to `inside` every node lies inside.
    let (mut node, mut inside) = (0, 0);
    while let Some(here) = nodes.get(node as usize) {
        while masks.last().is_some_and(|(until, _)| *until <= node) {
            masks.pop();
        }
        let mask = masks.last().map_or(0, |(_, mask)| *mask);
        let verdict = match node < inside {
            true => Verdict { side: Side::Inside, tests: 0, inside: 0 },
            false => test(node, mask),
        };
        if here.triangles > 0 && !matches!(verdict.side, Side::Outside(_)) {
            found.push(node);
        }
        node = match verdict.side {
            Side::Outside(_) if !whole => here.end,
            Side::Inside if !whole => {
                inside = inside.max(here.end);
                node + 1
            }
            _ => {
                masks.push((here.end, verdict.inside));
                node + 1
            }
        };
    }
    found
}

/// Goes down the path serially by the steps, and holds every verdict of the frames looked at against the exact one,
/// and every node drawn or culled against its triangles.
fn given_up<V: Exact>(stage: &Stage, volumes: &[V], steps: Steps) -> Result<Vec<Sample>, MeasureError> {
    let nodes = &stage.tree.nodes;
    let memory = vec![Remembering::default(); nodes.len()];
    let world = stage.scene.world_transforms();
    let mut motion: Option<Motion> = None;
    let look: Vec<usize> = looked_at(stage).collect();
    let (mut falsely_met, mut falsely_inside) = (0_u32, 0_u32);
    let (mut drawn_for_nothing, mut overdraw, mut angle) = (0_u32, 0_u64, 0.0);
    for (number, camera) in stage.cameras.iter().enumerate() {
        let frustum = Frustum::new(camera);
        let now = motion.map_or_else(|| Motion::start(&frustum), |motion| motion.next(&frustum));
        motion = Some(now);
        let culler = Culler::new(&frustum, steps, Some(now))
            .map_err(|error| MeasureError::Failed(format!("frame {number}: {error}")))?;
        let exact = look.binary_search(&number).is_ok().then(|| Hexahedron::new(camera));
        let mut culled = None;
        let found = drawn(nodes, false, |node, mask| {
            let volume = &volumes[node as usize];
            let verdict = culler.classify(volume, &memory[node as usize], mask);
            if let Some(exact) = &exact {
                match verdict.side {
                    Side::Outside(_) if meets(exact, volume) => culled = Some(node),
                    Side::Outside(_) => {}
                    Side::Intersecting => falsely_met += u32::from(!meets(exact, volume)),
                    Side::Inside => falsely_inside += u32::from(!exact.contains(volume)),
                }
            }
            verdict
        });
        let Some(exact) = exact else { continue };
        for (node, here) in (0..).zip(nodes).filter(|(_, here)| here.triangles > 0) {
            if found.binary_search(&node).is_ok() {
                if !is_seen(stage, &world, here, &exact) {
                    drawn_for_nothing += 1;
                    overdraw += u64::from(here.triangles);
                    angle += exact.solid_angle_of(&here.bounds.corners()) / exact.solid_angle();
                }
            } else if exact.intersects(&here.bounds) && is_seen(stage, &world, here, &exact) {
                culled = Some(node);
            }
        }
        if let Some(node) = culled {
            return Err(MeasureError::Failed(format!("frame {number}: node {node} is visible, but culled")));
        }
    }
    let frames = look.len().max(1) as f64;
    Ok(vec![
        Sample::of_path("falsely_intersecting", f64::from(falsely_met) / frames),
        Sample::of_path("falsely_inside", f64::from(falsely_inside) / frames),
        Sample::of_path("overdrawn_nodes", f64::from(drawn_for_nothing) / frames),
        Sample::of_path("overdrawn_triangles", overdraw as f64 / frames),
        Sample::of_path("overdrawn_angle", 100.0 * angle / frames),
    ])
}

/// Whether any triangle placed at a node meets the frustum.
fn is_seen(stage: &Stage, world: &[Affine3A], node: &SkipNode, exact: &Hexahedron) -> bool {
    let Some(source) = stage.scene.nodes.get(node.source as usize) else { return false };
    let Some(mesh) = source.mesh.map(|mesh| &stage.scene.meshes[mesh as usize]) else { return false };
    let placed = world[node.source as usize];
    mesh.triangles.iter().any(|triangle| {
        exact.meets_triangle(triangle.map(|vertex| placed.transform_point3(mesh.positions[vertex as usize])))
    })
}
