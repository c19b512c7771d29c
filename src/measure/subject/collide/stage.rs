//! Two bodies ready to be moved against each other, and the trees over them.

use super::place::{self, Place};
use super::{Over, Sample, failed};
use crate::geometry::{Overlap, Rigid, Sphere};
use crate::job::collide::{Query, contacts};
use crate::measure::MeasureError;
use crate::scene::Scene;
use crate::structure::VolumeTree;
use crate::structure::volume_tree::in_world;
use glam::{Affine3A, DQuat, Vec3};
use std::any::Any;
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;
use std::time::Instant;

/// Leaves of the trees that places are found and answers are held against with.
const LEAF: usize = 4;
/// Trees are built so often to be timed; the median counts.
const BUILDS: usize = 3;
/// Bodies of more triangles than this, together, are built once.
const LARGE: usize = 1_000_000;

/// What tells a place: where the origin is in metres, and a turn in radians.
const PLACE: [[&str; 3]; 2] =
    [["mover_x", "mover_y", "mover_z"], ["mover_turn_x", "mover_turn_y", "mover_turn_z"]];

/// A body: a scene, and its triangles in the world.
pub(super) struct Body {
    pub(super) scene: Scene,
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Body {
    /// A scene, made larger or smaller and put elsewhere: all of its roots are.
    ///
    /// # Errors
    /// It has more corners than can be numbered.
    pub(super) fn new(mut scene: Scene, scale: f32, offset: f32) -> Result<Self, MeasureError> {
        let put = Affine3A::from_translation(Vec3::splat(offset)) * Affine3A::from_scale(Vec3::splat(scale));
        for &root in &scene.roots {
            let transform = &mut scene.nodes[root as usize].transform;
            *transform = put * *transform;
        }
        let (positions, triangles) = in_world(&scene).map_err(failed)?;
        Ok(Self { scene, positions, triangles })
    }

    pub(super) fn tree<V: Overlap>(&self, over: Over, leaf: usize) -> Result<VolumeTree<V>, MeasureError> {
        match over {
            Over::Triangles => VolumeTree::over_triangles(&self.positions, &self.triangles, leaf)
                .map_err(|error| MeasureError::Failed(format!("scene `{}`: {error}", self.scene.name))),
            Over::Nodes => Ok(VolumeTree::over_nodes(&self.scene)),
        }
    }
}

/// Trees over both bodies, and how they were built.
pub(super) struct Trees<V: Overlap> {
    pub(super) mover: Rc<VolumeTree<V>>,
    pub(super) other: Rc<VolumeTree<V>>,
    /// Millions of triangles built into trees a second.
    pub(super) rate: f64,
    pub(super) tightness: f64,
}

/// The contacts of a frame.
type Answer = Rc<Vec<(u32, u32)>>;

/// A body that moves, another that stands, and where the first is in each frame.
pub(in crate::measure::subject) struct PairStage {
    mover: Body,
    other: Body,
    pub(super) poses: Vec<Rigid>,
    trees: RefCell<HashMap<String, Rc<dyn Any>>>,
    /// By frame, and reach as bits.
    answers: RefCell<HashMap<(usize, u64), Answer>>,
}

impl PairStage {
    pub(super) fn new(
        mover: Body,
        other: Body,
        over: Over,
        place: Place,
        frames: usize,
        seed: u64,
    ) -> Result<Self, MeasureError> {
        for body in [&mover, &other] {
            if body.triangles.is_empty() {
                return Err(MeasureError::Failed(format!("scene `{}` has no triangles", body.scene.name)));
            }
        }
        let poses = place::poses(&mover, &other, over, place, frames, seed)?;
        Ok(Self { mover, other, poses, trees: RefCell::default(), answers: RefCell::default() })
    }

    /// Where the moving body is, and how it is turned: of the first frame, and of each in which that changed.
    pub(super) fn places(&self) -> Vec<Sample> {
        let mut samples = Vec::new();
        let mut last = None;
        for (frame, pose) in
            self.poses.iter().enumerate().filter(|(_, pose)| last.replace(**pose) != Some(**pose))
        {
            let turn = DQuat::from_mat3(&pose.rotation()).to_scaled_axis();
            let numbers = [pose.translation().to_array(), turn.to_array()];
            let named = PLACE.as_flattened().iter().zip(numbers.as_flattened());
            samples.extend(named.map(|(metric, value)| Sample::of_frame(metric, frame, *value)));
        }
        samples
    }

    /// The trees of a kind, built when they are first asked for.
    #[expect(clippy::disallowed_methods, reason = "how fast trees are built is told by the real clock")]
    pub(super) fn trees<V: Overlap>(
        &self,
        kind: &str,
        over: Over,
        leaf: usize,
    ) -> Result<Rc<Trees<V>>, MeasureError> {
        let key = format!("{kind} {over:?} {leaf}");
        if let Some(Ok(known)) = self.trees.borrow().get(&key).map(|trees| trees.clone().downcast()) {
            return Ok(known);
        }
        let triangles = self.mover.triangles.len() + self.other.triangles.len();
        let builds = if triangles > LARGE { 1 } else { BUILDS };
        let (mut times, mut built) = (Vec::new(), None);
        for _ in 0..builds {
            let before = Instant::now();
            let trees = (self.mover.tree(over, leaf)?, self.other.tree(over, leaf)?);
            times.push(before.elapsed().as_secs_f64());
            built = Some(trees);
        }
        times.sort_by(f64::total_cmp);
        let (mover, other): (VolumeTree<V>, VolumeTree<V>) = built.expect("built at least once");
        for tree in [&mover, &other] {
            tree.validate().map_err(failed)?;
        }
        // Surfaces over aligned boxes' surfaces, of both bodies.
        let (a, b) = (mover.statistics(), other.statistics());
        let boxes = (a.boxes + b.boxes) as f64;
        let tightness = (a.tightness * a.boxes as f64 + b.tightness * b.boxes as f64) / boxes;
        let trees = Rc::new(Trees {
            mover: Rc::new(mover),
            other: Rc::new(other),
            rate: triangles as f64 / times[times.len() / 2] / 1e6,
            tightness,
        });
        self.trees.borrow_mut().insert(key, trees.clone());
        Ok(trees)
    }

    /// The contacts of the triangles in a frame, found by trees of spheres.
    pub(super) fn answer(&self, frame: usize, reach: f64) -> Result<Answer, MeasureError> {
        // Frames in which nothing has moved have one answer.
        let same = self.poses.iter().position(|pose| *pose == self.poses[frame]).unwrap_or(frame);
        let key = (same, reach.to_bits());
        if let Some(known) = self.answers.borrow().get(&key) {
            return Ok(known.clone());
        }
        let trees = self.trees::<Sphere>("answer", Over::Triangles, LEAF)?;
        let query = Query { first: false, reach };
        let found = Rc::new(contacts(&trees.other, &trees.mover, &self.poses[frame], query).pairs);
        self.answers.borrow_mut().insert(key, found.clone());
        Ok(found)
    }
}
