//! The job `cull_boxes`: random boxes, frame by frame from another side, against the bare reading of their memory.
//!
//! Settings: `job.boxes`, `job.visible` (per cent of them), `job.structure` (`flat`, `box_tree`, or `plain`: one box
//! after the other from an array of structures), `job.kernel` (`best`, or one by name; `plain` uses none). On a
//! simulated machine the kernel decides what is charged, and `best` is `scalar` there: rows must not hang on the
//! computer at hand, and the papers' machines have no vector unit to speak of. The scene is called `random`.

use super::settings::{JobSettings, of_scheme};
use super::{
    Cell, MeasureError, Nearest, Options, Sample, Subject, SubjectCache, TraversalShare, Walk, failed,
    load_imbalance, simulated,
};
use crate::geometry::{BoxTest, Camera, Frustum, Kernel};
use crate::job::cull_boxes::{BoxField, Costs, Frame, Way, camera, plain, random_boxes};
use crate::machine::{Machine, Simulated, Threads};
use crate::record::THREADS;
use crate::record::statistics::median;
use crate::scheme::tiles::Scheme;
use crate::structure::{BitMask, BoxTree, cull};
use std::borrow::Borrow;
use std::rc::Rc;

/// What its rows call the boxes.
const SCENE: &str = "random";
/// The kernel whose cost stands for `best` on a simulated machine.
const SIMULATED_BEST: &str = "scalar";

/// The boxes of a cell, and what is to be found from each of its cameras.
pub(super) struct BoxStage {
    tree: BoxTree,
    cameras: Vec<Camera>,
}

struct Asked {
    boxes: usize,
    visible: f64,
    way: Way,
    kernel: &'static str,
}

impl Asked {
    fn of(cell: &Cell) -> Result<Self, MeasureError> {
        let settings = JobSettings::of(cell);
        let kernels = ["best", "avx512", "avx2", "sse2", "neon", "scalar"].map(|name| (name, name));
        let ways = [("flat", Way::Flat), ("box_tree", Way::Hierarchy), ("plain", Way::Plain)];
        let asked = Asked {
            boxes: settings.number("boxes", 4096.0, 1.0..=16_777_216.0)? as usize,
            visible: settings.number("visible", 20.0, 0.0..=100.0)?,
            way: settings.choice("structure", &ways)?,
            kernel: settings.choice("kernel", &kernels)?,
        };
        settings.finish(cell)?;
        Ok(asked)
    }

    /// The kernel that does the work.
    fn kernel(&self) -> Result<Kernel, MeasureError> {
        let kernel = match self.kernel {
            "best" => Some(Kernel::best()),
            name => Kernel::named(name),
        };
        kernel.ok_or_else(|| {
            let known: Vec<_> = Kernel::all().map(Kernel::name).collect();
            let (asked, known) = (self.kernel, known.join(", "));
            MeasureError::Setting(format!("setting `job.kernel` is `{asked}`; this processor has: {known}"))
        })
    }

    fn costs(&self, machine: &Simulated) -> Result<Costs, MeasureError> {
        let name = match (self.way, self.kernel) {
            (Way::Plain, _) => "plain",
            (_, "best") => SIMULATED_BEST,
            (_, name) => name,
        };
        Costs::measured_on(machine.model(), name).ok_or_else(|| {
            let known = Costs::kernels().collect::<Vec<_>>().join(", ");
            MeasureError::Setting(format!(
                "setting `job.kernel` is `{name}`, of which no cost is known on simulated machines; expected one of: {known}"
            ))
        })
    }
}

pub(super) fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    if cell.scene != SCENE || options.path.is_some() {
        let message =
            "the job `cull_boxes` makes its own boxes: it takes no --scene and no --path".to_owned();
        return Err(MeasureError::Words(message));
    }
    let asked = Asked::of(cell)?;
    let key = format!("{} {} {} {}", asked.boxes, asked.visible, options.frames, options.seed);
    let stage = cache.boxes.entry(key).or_insert_with(|| Rc::new(BoxStage::new(&asked, options))).clone();
    if cell.machine == THREADS {
        let (team, kernel) = (cache.team(cell.processors)?, asked.kernel()?);
        Ok(Box::new(BoxSubject::<_, Threads>::new(cell, team, stage, asked.way, kernel, Costs::default())?))
    } else {
        let machine = simulated(cell, cache)?;
        // All kernels find the same; only what they are charged differs.
        let (costs, kernel) = (asked.costs(&machine)?, Kernel::best());
        Ok(Box::new(BoxSubject::<_, Simulated>::new(cell, machine, stage, asked.way, kernel, costs)?))
    }
}

impl BoxStage {
    fn new(asked: &Asked, options: &Options) -> Self {
        let tree = BoxTree::build(&random_boxes(asked.boxes, options.seed));
        let frames = 0..options.frames as usize;
        let cameras = frames.map(|frame| camera(tree.boxes(), frame, asked.visible)).collect();
        BoxStage { tree, cameras }
    }
}

struct BoxSubject<H, M: Machine> {
    machine: H,
    field: BoxField<M>,
    scheme: Scheme<M>,
    stage: Rc<BoxStage>,
    way: Way,
    kernel: Kernel,
    costs: Costs,
    /// The mask that must be found in each frame.
    expected: Vec<BitMask>,
}

impl<H: Borrow<M>, M: Machine> BoxSubject<H, M> {
    fn new(
        cell: &Cell,
        machine: H,
        stage: Rc<BoxStage>,
        way: Way,
        kernel: Kernel,
        costs: Costs,
    ) -> Result<Self, MeasureError> {
        let on = machine.borrow();
        let scheme = Scheme::new(&cell.scheme, on, cell.processors as usize, of_scheme(cell))
            .map_err(|error| MeasureError::Setting(error.to_string()))?;
        let field = BoxField::new(on, &stage.tree, way == Way::Plain);
        let expected = stage.cameras.iter().map(|camera| {
            let (boxes, frustum) = (stage.tree.boxes(), Frustum::new(camera));
            if way == Way::Plain { plain(boxes, &frustum) } else { cull(boxes, &frustum) }
        });
        let expected = expected.collect();
        Ok(BoxSubject { machine, field, scheme, stage, way, kernel, costs, expected })
    }

    /// Runs a frame; returns its time in nanoseconds and the pieces of each processor.
    fn run(&mut self, frustum: &Frustum, way: Way) -> Result<(f64, Vec<u64>), MeasureError> {
        let machine = self.machine.borrow();
        let costs = if way == Way::Stream { Costs::default() } else { self.costs };
        let before = machine.now();
        let test = BoxTest::with_kernel(frustum, self.kernel);
        let shares = self.scheme.run(machine, &Frame::new(&self.field, way, frustum, test, costs));
        let ticks = machine.now() - before;
        let pieces = shares.map_err(failed)?.iter().map(|share| share.visited).collect();
        Ok((ticks as f64 / machine.ticks_per_nanosecond(), pieces))
    }
}

impl<H: Borrow<M>, M: Machine> Walk for BoxSubject<H, M> {
    fn go(&mut self, mut trace: Option<&mut Nearest>) -> Result<Vec<Sample>, MeasureError> {
        let mut samples = Vec::new();
        let mut traversal = TraversalShare::default();
        let (mut times, mut streams) = (Vec::new(), Vec::new());
        let (mut visible, mut imbalance, mut used) = (0, 0.0, 0);
        for number in 0..self.stage.cameras.len() {
            let frustum = Frustum::new(&self.stage.cameras[number]);
            // Read before as it is read after, so that either finds the caches as the other left them.
            streams.push(self.run(&frustum, Way::Stream)?.0);
            if trace.is_some() {
                self.machine.borrow().start_trace();
            }
            let outcome = self.run(&frustum, self.way);
            let machine = self.machine.borrow();
            let traced = machine.take_trace();
            let (time, pieces) = outcome?;
            let tick = 1.0 / machine.ticks_per_nanosecond();
            traversal.add(machine, pieces.len(), (time / tick).round() as u64);
            let found = self.field.mask();
            if found != self.expected[number] {
                let (found, expected) = (found.count(), self.expected[number].count());
                return Err(MeasureError::Failed(format!(
                    "frame {number}: {found} visible boxes, or others, where the serial oracle finds {expected}"
                )));
            }
            samples.push(Sample::of_frame("frame_time", number, time));
            times.push(time);
            visible += found.count();
            used += pieces.len();
            imbalance += load_imbalance(pieces.into_iter());
            if trace.as_mut().is_some_and(|nearest| nearest.look(time, number, traced, tick)) {
                break;
            }
        }
        let frames = times.len() as f64;
        let (time, stream) = (median(&times).unwrap_or_default(), median(&streams).unwrap_or_default());
        samples.push(Sample::of_path("time_per_box", time / self.field.len() as f64));
        samples.push(Sample::of_path("bytes_per_second", self.field.bytes() as f64 / (time * 1e-9)));
        samples.push(Sample::of_path("stream_time", stream));
        samples.push(Sample::of_path("stream_ratio", time / stream));
        samples.push(Sample::of_path("boxes_visible", visible as f64 / frames));
        samples.push(Sample::of_path("load_imbalance", imbalance / frames));
        samples.push(Sample::of_path("processors_used", used as f64 / frames));
        samples.extend(traversal.sample());
        Ok(samples)
    }
}
