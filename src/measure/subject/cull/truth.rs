//! What must be found, and what a test gives up: by a descent of its own, without any of the job's code.

use super::super::{Sample, Stage};
use super::moving::MovingScene;
use super::{Asked, MeasureError, Volumes};
use crate::geometry::culling::{Culler, Forgetful, Memory, Motion, Remembering, Side, Steps, Verdict};
use crate::geometry::oracle::{Exact, Hexahedron};
use crate::geometry::{Aabb, Camera, Frustum, Volume};
use crate::job::cull::Descent;
use crate::scene::Scene;
use crate::structure::{SkipNode, SkipTree};
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
        let mut moving = MovingScene::of(stage, asked.volume);
        // Where things move, each frame may be the one that forgot too little.
        let look: Vec<usize> = match moving {
            Some(_) => (0..stage.cameras.len()).collect(),
            None => looked_at(stage).collect(),
        };
        // There volumes also depend a little on where things were before, and so may what the basic test finds.
        let basic = asked.is_basic_at_heart() && moving.is_none();
        let mut loss = asked.accuracy.then(|| Loss::new(stage, asked.steps));
        let (mut these, mut least) = (Vec::new(), BTreeMap::new());
        for (number, camera) in stage.cameras.iter().enumerate() {
            let now = match &mut moving {
                None => Now { number, camera, scene: &stage.scene, tree: &stage.tree, volumes, changed: &[] },
                Some(moving) => {
                    moving.go_to(number).map_err(MeasureError::Failed)?;
                    let (scene, moving) = (moving.scene(), moving.moving());
                    let (tree, volumes, changed) = (moving.tree(), moving.volumes(), moving.changed());
                    Now { number, camera, scene, tree, volumes, changed }
                }
            };
            let look = look.binary_search(&number).is_ok();
            if basic {
                these.push(now.by_basic(asked));
            } else if look {
                least.insert(number, now.by_exact(asked));
            }
            if let Some(loss) = &mut loss {
                loss.frame(&now, look)?;
            }
        }
        let found = if basic { Found::These(these) } else { Found::AtLeast(least) };
        let given_up = loss.map_or_else(Vec::new, |loss| loss.given_up(look.len()));
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

/// A frame of a path: the camera, and where everything is.
struct Now<'a> {
    number: usize,
    camera: &'a Camera,
    scene: &'a Scene,
    tree: &'a SkipTree,
    volumes: &'a Volumes,
    /// The nodes whose volumes are not those of the frame before.
    changed: &'a [u32],
}

/// Runs a generic expression on the volumes of a frame, whatever their kind.
macro_rules! with_volumes {
    ($now:expr, |$volumes:ident| $do:expr) => {
        match $now.volumes {
            Volumes::Aabb => {
                let $volumes: &[Aabb] = &$now.tree.nodes.iter().map(|node| node.bounds).collect::<Vec<_>>();
                $do
            }
            Volumes::Obb($volumes) => $do,
            Volumes::Sphere($volumes) => $do,
            Volumes::Dop14($volumes) => $do,
            Volumes::Dop18($volumes) => $do,
            Volumes::Dop26($volumes) => $do,
        }
    };
}

impl Now<'_> {
    /// What the basic test finds.
    fn by_basic(&self, asked: &Asked) -> Vec<u32> {
        let frustum = Frustum::new(self.camera);
        let whole = asked.descent == Descent::WholeTree;
        with_volumes!(self, |volumes| {
            let basic = Culler::basic(&frustum);
            let test = |node: u32, _| basic.classify(&volumes[node as usize], &Forgetful, 0);
            drawn(&self.tree.nodes, whole, test)
        })
    }

    /// What the exact test finds.
    fn by_exact(&self, asked: &Asked) -> Vec<u32> {
        let exact = Hexahedron::new(self.camera);
        let whole = asked.descent == Descent::WholeTree;
        with_volumes!(self, |volumes| {
            let test = |node: u32, _| {
                let meets = meets(&exact, &volumes[node as usize]);
                let side = if meets { Side::Intersecting } else { Side::Outside(0) };
                Verdict { side, tests: 0, inside: 0 }
            };
            drawn(&self.tree.nodes, whole, test)
        })
    }
}

/// What a serial descent by the steps gives up: it holds every verdict of the frames looked at against the exact one,
/// and every node drawn or culled against its triangles.
struct Loss {
    steps: Steps,
    memory: Vec<Remembering>,
    motion: Option<Motion>,
    falsely_met: u32,
    falsely_inside: u32,
    drawn_for_nothing: u32,
    overdraw: u64,
    angle: f64,
}

impl Loss {
    fn new(stage: &Stage, steps: Steps) -> Self {
        let memory = vec![Remembering::default(); stage.tree.nodes.len()];
        let (falsely_met, falsely_inside, drawn_for_nothing) = (0, 0, 0);
        Loss {
            steps,
            memory,
            motion: None,
            falsely_met,
            falsely_inside,
            drawn_for_nothing,
            overdraw: 0,
            angle: 0.0,
        }
    }

    /// The next frame, to be looked at or only to be remembered.
    fn frame(&mut self, now: &Now, look: bool) -> Result<(), MeasureError> {
        for node in now.changed {
            self.memory[*node as usize].forget();
        }
        with_volumes!(now, |volumes| self.descend(now, volumes, look))
    }

    fn descend<V: Exact>(&mut self, now: &Now, volumes: &[V], look: bool) -> Result<(), MeasureError> {
        let (number, nodes) = (now.number, &now.tree.nodes);
        let frustum = Frustum::new(now.camera);
        let motion = self.motion.map_or_else(|| Motion::start(&frustum), |motion| motion.next(&frustum));
        self.motion = Some(motion);
        let culler = Culler::new(&frustum, self.steps, Some(motion))
            .map_err(|error| MeasureError::Failed(format!("frame {number}: {error}")))?;
        let exact = look.then(|| Hexahedron::new(now.camera));
        let mut culled = None;
        let found = drawn(nodes, false, |node, mask| {
            let volume = &volumes[node as usize];
            let verdict = culler.classify(volume, &self.memory[node as usize], mask);
            if let Some(exact) = &exact {
                match verdict.side {
                    Side::Outside(_) if meets(exact, volume) => culled = Some(node),
                    Side::Outside(_) => {}
                    Side::Intersecting => self.falsely_met += u32::from(!meets(exact, volume)),
                    Side::Inside => self.falsely_inside += u32::from(!exact.contains(volume)),
                }
            }
            verdict
        });
        let Some(exact) = exact else { return Ok(()) };
        let world = now.scene.world_transforms();
        for (node, here) in (0..).zip(nodes).filter(|(_, here)| here.triangles > 0) {
            if found.binary_search(&node).is_ok() {
                if !is_seen(now.scene, &world, here, &exact) {
                    self.drawn_for_nothing += 1;
                    self.overdraw += u64::from(here.triangles);
                    self.angle += exact.solid_angle_of(&here.bounds.corners()) / exact.solid_angle();
                }
            } else if exact.intersects(&here.bounds) && is_seen(now.scene, &world, here, &exact) {
                culled = Some(node);
            }
        }
        match culled {
            Some(node) => {
                Err(MeasureError::Failed(format!("frame {number}: node {node} is visible, but culled")))
            }
            None => Ok(()),
        }
    }

    fn given_up(self, frames: usize) -> Vec<Sample> {
        let frames = frames.max(1) as f64;
        vec![
            Sample::of_path("falsely_intersecting", f64::from(self.falsely_met) / frames),
            Sample::of_path("falsely_inside", f64::from(self.falsely_inside) / frames),
            Sample::of_path("overdrawn_nodes", f64::from(self.drawn_for_nothing) / frames),
            Sample::of_path("overdrawn_triangles", self.overdraw as f64 / frames),
            Sample::of_path("overdrawn_angle", 100.0 * self.angle / frames),
        ]
    }
}

/// Whether any triangle placed at a node meets the frustum.
fn is_seen(scene: &Scene, world: &[Affine3A], node: &SkipNode, exact: &Hexahedron) -> bool {
    let Some(source) = scene.nodes.get(node.source as usize) else { return false };
    let Some(mesh) = source.mesh.map(|mesh| &scene.meshes[mesh as usize]) else { return false };
    let placed = world[node.source as usize];
    mesh.triangles.iter().any(|triangle| {
        exact.meets_triangle(triangle.map(|vertex| placed.transform_point3(mesh.positions[vertex as usize])))
    })
}
