//! The culling of a tree over leaves, on any machine.

use super::super::{MeasureError, Sample, Subject, TraversalShare, failed, load_imbalance};
use super::{Cell, Ready, Stage, of_scheme};
use crate::geometry::culling::Steps;
use crate::geometry::oracle::Hexahedron;
use crate::geometry::{Camera, Frustum};
use crate::job::cull::{Costs, CullTree, Frame, History};
use crate::machine::{Machine, Simulated};
use crate::scheme::tree::Scheme;
use crate::structure::SkipTree;
use std::borrow::Borrow;
use std::rc::Rc;

/// A tree, and the scheme that shares out its culling.
pub(super) struct Culler<H, M: Machine> {
    machine: H,
    tree: CullTree<M>,
    /// The object each node of the tree stands for.
    objects: Vec<u32>,
    scheme: Scheme<M>,
    steps: Steps,
    costs: Costs,
    tally: Tally,
}

/// What the frames of a path took together.
#[derive(Default)]
struct Tally {
    visited: u64,
    used: usize,
    imbalance: f64,
    traversal: TraversalShare,
}

impl<H: Borrow<M>, M: Machine> Culler<H, M> {
    pub(super) fn new(
        cell: &Cell,
        machine: H,
        tree: &SkipTree,
        steps: Steps,
        costs: Costs,
    ) -> Result<Self, MeasureError> {
        let on = machine.borrow();
        let scheme = Scheme::new(&cell.scheme, on, cell.processors as usize, of_scheme(cell))
            .map_err(|error| MeasureError::Setting(error.to_string()))?;
        let objects = tree.nodes.iter().map(|node| node.source).collect();
        let tree = CullTree::new(on, tree, History::Plane);
        Ok(Self { machine, tree, objects, scheme, steps, costs, tally: Tally::default() })
    }

    /// The objects that may be visible, and how long it took to find them, ns.
    pub(super) fn cull(&mut self, number: usize, camera: &Camera) -> Result<(Vec<u32>, f64), MeasureError> {
        let machine = self.machine.borrow();
        let frustum = Frustum::new(camera);
        let frame = Frame::new(&self.tree, number, &frustum, self.steps).map_err(failed)?.costs(self.costs);
        let before = machine.now();
        let shares = self.scheme.run(machine, &frame.ranges());
        let ticks = machine.now() - before;
        let shares = shares.map_err(failed)?;
        self.tally.traversal.add(machine, shares.len(), ticks);
        self.tally.visited += shares.iter().map(|share| share.visited).sum::<u64>();
        self.tally.used += shares.len();
        self.tally.imbalance += load_imbalance(shares.iter().map(|share| share.visited));
        let nodes = self.tree.visible(shares.iter().map(|share| &share.found));
        let objects = nodes.into_iter().map(|node| self.objects[node as usize]).collect();
        Ok((objects, ticks as f64 / machine.ticks_per_nanosecond()))
    }

    /// What there is to say of the frames since it was last asked.
    pub(super) fn samples(&mut self, frames: usize) -> Vec<Sample> {
        let tally = std::mem::take(&mut self.tally);
        let mean = |metric, sum: f64| Sample::of_path(metric, sum / frames as f64);
        let mut samples = vec![
            mean("nodes_visited", tally.visited as f64),
            mean("processors_used", tally.used as f64),
            mean("load_imbalance", tally.imbalance),
        ];
        samples.extend(tally.traversal.sample());
        samples
    }
}

/// A simulated machine, which culls and does not draw.
pub(super) struct Alone {
    pub(super) culler: Culler<Simulated, Simulated>,
    pub(super) stage: Rc<Stage>,
    pub(super) ready: Rc<Ready>,
}

impl Subject for Alone {
    fn sample(&mut self, _repeat: u32) -> Result<Vec<Sample>, MeasureError> {
        let (mut samples, mut calls) = (Vec::new(), 0);
        for (number, camera) in self.stage.cameras.iter().enumerate() {
            let (found, time) = self.culler.cull(number, camera)?;
            self.check(number, camera, &found)?;
            samples.push(Sample::of_frame("frame_time", number, time));
            calls += found.len();
        }
        let frames = self.stage.cameras.len();
        samples.push(Sample::of_path("draw_calls", calls as f64 / frames as f64));
        samples.push(Sample::of_path("leaves", self.ready.leaves.leaves.len() as f64));
        samples.extend(self.culler.samples(frames));
        Ok(samples)
    }
}

impl Alone {
    /// Nothing that meets the frustum may be missing, by the exact test of each box.
    fn check(&self, number: usize, camera: &Camera, found: &[u32]) -> Result<(), MeasureError> {
        let exact = Hexahedron::new(camera);
        let objects = &self.ready.leaves.objects;
        let mut is_found = vec![false; objects.len()];
        found.iter().for_each(|object| is_found[*object as usize] = true);
        let missed = |(object, is_found): (&crate::structure::Object, &bool)| {
            !is_found && object.triangles > 0 && exact.intersects(&object.bounds)
        };
        match objects.iter().zip(&is_found).position(missed) {
            None => Ok(()),
            Some(lost) => {
                Err(MeasureError::Failed(format!("frame {number}: leaf {lost} can be seen and was culled")))
            }
        }
    }
}
