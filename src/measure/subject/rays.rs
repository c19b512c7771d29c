//! The job `rays`: sets of rays against a hierarchy, pass after pass (Ize Table 7.1).
//!
//! Settings: `job.rays`, one of [`KINDS`]; `job.ask` (`closest`, `coherent`: a piece's rays together, `any`);
//! `job.count`, about how many; `job.builder`, one of [`BUILDERS`], with `job.bins`; `job.triangle` (`watertight`,
//! `fast`). The cell's frames are passes. On threads only: what a ray costs is not charged.
//!
//! A hundred rays, but for those aimed at edges, are held against the list of all triangles in f64: what they meet must be
//! as far off, to the rounding of both. That not a bit depends on the structure is a test's business; here the two triangle tests differ.

use super::settings::{JobSettings, of_scheme};
use super::{
    Cell, MeasureError, Nearest, Options, Sample, Subject, SubjectCache, Walk, failed, load_imbalance,
    stage_key, staging,
};
use crate::geometry::Ray;
use crate::job::rays::{Asked as Ask, KINDS, Met, RayKind, RayWork, ray_set};
use crate::job::trace::{Hierarchy, List, TriangleKind, World};
use crate::machine::{Machine, Threads};
use crate::record::THREADS;
use crate::record::statistics::median;
use crate::scene::Scene;
use crate::scheme::tiles::{Scheme, share};
use crate::structure::bvh::build::{BUILDERS, Builder, Input, MOST_BINS, Settings};
use crate::structure::bvh::{BinaryBvh, Intersector, RayCounts};
use std::rc::Rc;

/// Rays held against the list.
const CHECKED: usize = 100;

/// Builds of which the median is told.
const BUILDS: usize = 3;

struct Asked {
    kind: RayKind,
    ask: Ask,
    count: usize,
    builder: &'static str,
    settings: Settings,
    triangle: TriangleKind,
}

impl Asked {
    fn of(cell: &Cell) -> Result<Self, MeasureError> {
        let settings = JobSettings::of(cell);
        let kinds: Vec<_> = KINDS.iter().map(|kind| (kind.name, kind.kind)).collect();
        let builders: Vec<_> = BUILDERS.iter().map(|builder| (builder.name, builder.name)).collect();
        let asks = [("closest", Ask::Closest), ("coherent", Ask::Coherent), ("any", Ask::Any)];
        let default = Settings::default();
        let asked = Asked {
            kind: settings.choice("rays", &kinds)?,
            ask: settings.choice("ask", &asks)?,
            count: settings.number("count", 1_000_000.0, 1.0..=1e8)? as usize,
            builder: settings.choice("builder", &builders)?,
            settings: Settings {
                bins: settings.number("bins", default.bins as f64, 2.0..=MOST_BINS as f64)? as usize,
                ..default
            },
            triangle: settings.choice("triangle", TriangleKind::ALL)?,
        };
        settings.finish(cell)?;
        Ok(asked)
    }
}

/// A hierarchy over a scene.
pub(super) struct Built {
    world: World,
    hierarchy: Hierarchy,
    /// What there is to say of it.
    told: Vec<Sample>,
}

/// A hierarchy and the rays that go through it.
pub(super) struct RayStage {
    built: Rc<Built>,
    rays: Vec<Ray>,
    /// What they come to on one processor.
    met: Met,
    /// What is known of the hierarchy, and what the rays took.
    told: Vec<Sample>,
}

pub(super) fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    if cell.machine != THREADS {
        let message = format!("the job `rays` runs on {THREADS} only, not on {}", cell.machine);
        return Err(MeasureError::Words(message));
    }
    if options.path.is_some() {
        let message = "the job `rays` aims its rays itself: it takes no --path".to_owned();
        return Err(MeasureError::Words(message));
    }
    let asked = Asked::of(cell)?;
    let of_job: Vec<_> = cell.settings.iter().filter(|(key, _)| key.starts_with("job.")).collect();
    let key = format!("{} {of_job:?}", stage_key(cell, options));
    let team = cache.team(cell.processors)?;
    let stage = match cache.rays.get(&key) {
        Some(stage) => stage.clone(),
        None => {
            let one = cache.team(1)?;
            let of_built = format!("{} {:?} {:?}", asked.builder, asked.settings, asked.triangle);
            let of_built = format!("{} {of_built}", stage_key(cell, options));
            let built = match cache.hierarchies.get(&of_built) {
                Some(built) => built.clone(),
                None => {
                    let built = Rc::new(Built::new(&asked, staging::scene(cell)?, &one)?);
                    cache.hierarchies.insert(of_built, built.clone());
                    built
                }
            };
            let stage = Rc::new(RayStage::new(built, &asked, options.seed, &one)?);
            cache.rays.insert(key, stage.clone());
            stage
        }
    };
    let scheme = Scheme::new(&cell.scheme, &*team, cell.processors as usize, of_scheme(cell))
        .map_err(|error| MeasureError::Setting(error.to_string()))?;
    Ok(Box::new(RaySubject { team, scheme, stage, ask: asked.ask, passes: options.frames as usize }))
}

impl Built {
    fn new(asked: &Asked, scene: Scene, one: &Threads) -> Result<Self, MeasureError> {
        let world = World::new(scene);
        let items = world.items();
        let triangles = items.triangles.len();
        let mut builder = Builder::new(asked.builder, &asked.settings).map_err(failed)?;
        let mut binary = BinaryBvh::default();
        let (mut builds, mut collapses) = (Vec::new(), Vec::new());
        let timed = |times: &mut Vec<f64>, before: u64| times.push((one.now() - before) as f64);
        let boxes = items.triangle_boxes();
        let mut hierarchy = None;
        for _ in 0..BUILDS {
            let before = one.now();
            let input = Input { boxes: &boxes, triangles: Some(&items.triangles) };
            builder.build(&input, &mut binary).map_err(failed)?;
            timed(&mut builds, before);
            let before = one.now();
            hierarchy = Some(Hierarchy::over(items, &binary, &mut builder, asked.triangle).map_err(failed)?);
            timed(&mut collapses, before);
        }
        let hierarchy = hierarchy.expect("it was built at least once");
        let (build, collapse) = (median(&builds).unwrap_or_default(), median(&collapses).unwrap_or_default());
        let told = vec![
            Sample::of_path("structure_time", build),
            Sample::of_path("structure_rate", triangles as f64 * 1e3 / build.max(1.0)),
            Sample::of_path("collapse_time", collapse),
            Sample::of_path("structure_bytes", hierarchy.bytes() as f64),
            Sample::of_path("sah_cost", binary.cost(1.0, 1.0)),
        ];
        Ok(Self { world, hierarchy, told })
    }
}

impl RayStage {
    fn new(built: Rc<Built>, asked: &Asked, seed: u64, one: &Threads) -> Result<Self, MeasureError> {
        let (scene, hierarchy) = (built.world.scene(), &built.hierarchy);
        let rays = ray_set(asked.kind, scene, hierarchy, asked.count, seed)
            .filter(|rays| !rays.is_empty())
            .ok_or_else(|| {
            MeasureError::Failed(format!("scene `{}`: there is nothing to aim at", scene.name))
        })?;
        if asked.kind != RayKind::Edge {
            check(hierarchy, &List(built.world.items()), &rays)?;
        }
        let mut counts = RayCounts::default();
        for ray in &rays {
            hierarchy.triangle_counted(ray, &mut counts);
        }
        let work = RayWork { intersector: hierarchy, rays: &rays, asked: asked.ask };
        let mut met = Met::default();
        share("serial", one, 1, &work).map_err(failed)?.iter().for_each(|share| met += share.found);
        let a_ray = |count: u64| count as f64 / rays.len() as f64;
        let mut told = built.told.clone();
        told.push(Sample::of_path("nodes_per_ray", a_ray(counts.nodes)));
        told.push(Sample::of_path("blocks_per_ray", a_ray(counts.blocks)));
        told.push(Sample::of_path("rays_hit", 100.0 * a_ray(met.hits)));
        if asked.kind == RayKind::Edge {
            told.push(Sample::of_path("rays_through", rays.len() as f64 - met.hits as f64));
        }
        Ok(Self { built, rays, met, told })
    }
}

/// Of the rays held against the list, so many may pass an edge so closely that the two tests tell another thing.
const AT_EDGES: usize = 3;

/// Holds some rays against the list of all items.
fn check(hierarchy: &Hierarchy, list: &List<'_>, rays: &[Ray]) -> Result<(), MeasureError> {
    let differs = |ray: &&Ray| match (hierarchy.closest(ray), list.closest(ray)) {
        (Some(found), Some(expected)) => (found.t - expected.t).abs() > 1e-3 * expected.t.abs(),
        (found, expected) => found.is_some() != expected.is_some(),
    };
    let checked = rays.iter().step_by(rays.len().div_ceil(CHECKED));
    let (all, other) = (checked.clone().count(), checked.filter(differs).count());
    if other > AT_EDGES {
        return Err(MeasureError::Failed(format!(
            "{other} of {all} rays end elsewhere than among the triangles gone through one by one"
        )));
    }
    Ok(())
}

struct RaySubject {
    team: Rc<Threads>,
    scheme: Scheme<Threads>,
    stage: Rc<RayStage>,
    ask: Ask,
    passes: usize,
}

impl Walk for RaySubject {
    fn go(&mut self, mut trace: Option<&mut Nearest>) -> Result<Vec<Sample>, MeasureError> {
        let RayStage { built, rays, met: expected, told } = &*self.stage;
        let work = RayWork { intersector: &built.hierarchy, rays, asked: self.ask };
        let mut samples = Vec::new();
        let (mut all, mut imbalance, mut used) = (0.0, 0.0, 0);
        for pass in 0..self.passes {
            if trace.is_some() {
                self.team.start_trace();
            }
            let before = self.team.now();
            let shares = self.scheme.run(&*self.team, &work);
            let time = (self.team.now() - before) as f64;
            let traced = self.team.take_trace();
            let shares = shares.map_err(failed)?;
            let mut met = Met::default();
            shares.iter().for_each(|share| met += share.found);
            if met != *expected {
                return Err(MeasureError::Failed(format!(
                    "pass {pass}: {} rays ended, or elsewhere, where one processor finds {}",
                    met.hits, expected.hits
                )));
            }
            samples.push(Sample::of_frame("frame_time", pass, time));
            all += time;
            used += shares.len();
            imbalance += load_imbalance(shares.iter().map(|share| share.visited));
            if trace.as_mut().is_some_and(|nearest| nearest.look(time, pass, traced, 1.0)) {
                break;
            }
        }
        let passes = self.passes.max(1) as f64;
        samples.push(Sample::of_path("rays", rays.len() as f64));
        samples.push(Sample::of_path("ray_rate", rays.len() as f64 * passes * 1e3 / all.max(1.0)));
        samples.extend(told.iter().cloned());
        samples.push(Sample::of_path("load_imbalance", imbalance / passes));
        samples.push(Sample::of_path("processors_used", used as f64 / passes));
        Ok(samples)
    }
}
