//! The job on threads: split, build, cull and draw.

use super::super::{MeasureError, Sample, Stage, Subject, failed};
use super::{Culler, Ready};
use crate::job::draw::{Counts, Drawing, Picture};
use crate::machine::{Machine, Threads};
use crate::structure::{PlacedLeaves, midpoint_tree};
use rayon::ThreadPool;
use std::num::NonZeroUsize;
use std::rc::Rc;

pub(super) struct Drawn {
    pub(super) team: Rc<Threads>,
    /// As many threads as the team has, for splitting and building.
    pub(super) pool: Rc<ThreadPool>,
    pub(super) stage: Rc<Stage>,
    pub(super) ready: Rc<Ready>,
    pub(super) most: NonZeroUsize,
    /// None with culling off.
    pub(super) culler: Option<Culler<Rc<Threads>, Threads>>,
    pub(super) picture: Picture,
    /// The fingerprint of each frame drawn without culling.
    pub(super) pictures: Rc<[u64]>,
}

impl Subject for Drawn {
    fn sample(&mut self, _repeat: u32) -> Result<Vec<Sample>, MeasureError> {
        let mut samples = self.make()?;
        let drawing = Drawing::new(&self.stage.scene, &self.ready.leaves);
        let mut sum = Sum::default();
        for (number, camera) in self.stage.cameras.iter().enumerate() {
            let found = match &mut self.culler {
                Some(culler) => Some(culler.cull(number, camera)?),
                None => None,
            };
            let before = self.team.now();
            let (counts, traversal) = match found {
                Some((found, time)) => (drawing.draw(camera, found, &mut self.picture), time),
                None => (drawing.draw_all(camera, &mut self.picture), 0.0),
            };
            let draw = (self.team.now() - before) as f64;
            samples.push(Sample::of_frame("frame_time", number, traversal + draw));
            if self.picture.fingerprint() != self.pictures[number] {
                return Err(MeasureError::Failed(format!(
                    "frame {number}: the picture is not the one drawn without culling"
                )));
            }
            sum.add(traversal, draw, &counts, self.picture.covered());
        }
        let frames = self.stage.cameras.len();
        samples.extend(sum.samples(frames, self.culler.is_some()));
        samples.extend(self.culler.iter_mut().flat_map(|culler| culler.samples(frames)));
        Ok(samples)
    }
}

impl Drawn {
    /// Splits the meshes and builds the tree once more, for the time it takes (Bubenicek, Tables 1 and 2).
    fn make(&self) -> Result<Vec<Sample>, MeasureError> {
        let (team, scene, most) = (&*self.team, &self.stage.scene, self.most);
        let (split, build, leaves) = self.pool.install(|| {
            let start = team.now();
            let leaves = PlacedLeaves::new(scene, most);
            let split = team.now();
            let objects = leaves.as_ref().map_or(&[][..], |leaves| &leaves.objects);
            let tree = midpoint_tree(objects);
            let build = team.now();
            std::hint::black_box(tree);
            ((split - start) as f64, (build - split) as f64, leaves)
        });
        let leaves = leaves.map_err(failed)?;
        let triangles: usize = leaves.splits.iter().map(|split| split.triangles.len()).sum();
        let medians: u32 = leaves.splits.iter().map(|split| split.medians).sum();
        let depth = leaves.splits.iter().map(|split| split.depth).max().unwrap_or(0);
        let count = leaves.leaves.len() as f64;
        // A thousand a nanosecond is a million a microsecond: a time of 0 has no rate.
        let rate = |metric, count: f64, time: f64| {
            (time > 0.0).then(|| Sample::of_path(metric, 1000.0 * count / time))
        };
        let mut samples = vec![
            Sample::of_path("leaves", count),
            Sample::of_path("split_time", split),
            Sample::of_path("split_medians", f64::from(medians)),
            Sample::of_path("split_depth", f64::from(depth)),
            Sample::of_path("build_time", build),
        ];
        samples.extend(rate("split_rate", triangles as f64, split));
        samples.extend(rate("build_rate", count, build));
        Ok(samples)
    }
}

/// What the frames of a path took together.
#[derive(Default)]
struct Sum {
    traversal: f64,
    draw: f64,
    covered: usize,
    counts: Counts,
}

impl Sum {
    fn add(&mut self, traversal: f64, draw: f64, counts: &Counts, covered: usize) {
        self.traversal += traversal;
        self.draw += draw;
        self.covered += covered;
        self.counts += *counts;
    }

    fn samples(&self, frames: usize, is_culled: bool) -> Vec<Sample> {
        let counts = &self.counts;
        let counted = [
            ("draw_calls", counts.draw_calls),
            ("vertices_transformed", counts.vertices),
            ("triangles_drawn", counts.triangles),
            ("triangles_outside", counts.outside),
            ("triangles_set_up", counts.set_up),
            ("pixel_tests", counts.pixel_tests),
            ("pixels_passed", counts.pixels_passed),
            ("pixels_covered", self.covered as u64),
        ];
        let counted = counted.into_iter().map(|(metric, sum)| (metric, sum as f64));
        let times = is_culled.then_some(("traversal_time", self.traversal));
        let all = counted.chain([("draw_time", self.draw)]).chain(times);
        all.map(|(metric, sum)| Sample::of_path(metric, sum / frames as f64)).collect()
    }
}
