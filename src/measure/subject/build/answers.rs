//! What each frame of the job `build` must come to, and what it is worth: one processor's hierarchies.

use super::super::{Cell, MeasureError, failed};
use super::{Asked, How, boxes_of, corners_of};
use crate::geometry::Aabb;
use crate::job::rays::{RayKind, ray_set};
use crate::job::trace::{Hierarchy, TriangleKind, World};
use crate::machine::{Machine, Threads};
use crate::record::statistics::median;
use crate::scene::{Mesh, Scene};
use crate::structure::bvh::build::phased::{Alone, Phased, Way};
use crate::structure::bvh::build::{Builder, Input, Settings};
use crate::structure::bvh::{BinaryBvh, Intersector, RayCounts, refit};
use glam::{Affine3A, Vec3};
use std::rc::Rc;

/// Passes of the rays of which the median is told.
const PASSES: usize = 3;

/// What rays go through a frame's hierarchy.
pub(super) struct Looked {
    pub(super) kind: RayKind,
    /// About how many; 0 for none.
    pub(super) count: usize,
    pub(super) seed: u64,
}

/// A frame's hierarchy and what there is to say of it, by metric.
pub(super) struct Answer {
    pub(super) bvh: BinaryBvh,
    pub(super) told: Vec<(&'static str, f64)>,
}

/// The answers of a cell's frames, each made when it is first asked for.
pub(super) struct Answers {
    how: How,
    serial: bool,
    settings: Settings,
    looked: Looked,
    /// On whose clock rays are timed; none on simulated machines.
    clock: Option<Rc<Threads>>,
    /// By how far the body is rolled up.
    known: Vec<(f64, Answer)>,
}

impl Answers {
    pub(super) fn new(asked: &Asked, cell: &Cell, clock: Option<Rc<Threads>>) -> Result<Self, MeasureError> {
        let Asked { how, looked: Looked { kind, count, seed }, .. } = *asked;
        let looked = Looked { kind, count, seed };
        let (serial, settings) = (cell.scheme == "serial", asked.settings.clone());
        settings.check().map_err(failed)?;
        Ok(Self { how, serial, settings, looked, clock, known: Vec::new() })
    }

    /// The hierarchy that one processor builds. Cut by bins all the way it is that of another builder, which does not
    /// work in phases; cut from a grid there is no other, and it is the one of a team of one.
    pub(super) fn built(&mut self, boxes: &[Aabb], corners: &[[Vec3; 3]]) -> Result<BinaryBvh, MeasureError> {
        let input = Input { boxes, triangles: Some(corners) };
        let mut bvh = BinaryBvh::default();
        let name = match self.how {
            How::Phases(Way::SahSah) => "binned_sah",
            How::Phases(Way::GridSah) if self.serial => "binned_sah",
            How::Phases(Way::GridBih) if self.serial => "spatial_median",
            How::Phases(way) => {
                let mut phased = Phased::new(way, &self.settings).map_err(failed)?;
                phased.build(&input, &mut bvh, &mut Alone).map_err(failed)?;
                return Ok(bvh);
            }
            How::Alone(name) => name,
        };
        let mut builder = Builder::new(name, &self.settings).map_err(failed)?;
        builder.build(&input, &mut bvh).map_err(failed)?;
        Ok(bvh)
    }

    /// The answer for corners that were brought to these places by so many turns: a hierarchy that is refitted `from`
    /// another, or built.
    pub(super) fn of(
        &mut self,
        turns: f64,
        from: Option<&BinaryBvh>,
        places: &[Vec3],
        triangles: &[[u32; 3]],
    ) -> Result<&Answer, MeasureError> {
        let at = match self.known.iter().position(|(known, _)| *known == turns) {
            Some(at) => at,
            None => {
                let boxes = boxes_of(places, triangles);
                let bvh = match from {
                    Some(from) => {
                        let mut bvh = from.clone();
                        refit::refit(&mut bvh, &boxes);
                        bvh
                    }
                    None => self.built(&boxes, &corners_of(places, triangles))?,
                };
                bvh.validate(&boxes).map_err(failed)?;
                let told = self.told(&bvh, places, triangles)?;
                self.known.push((turns, Answer { bvh, told }));
                self.known.len() - 1
            }
        };
        Ok(&self.known[at].1)
    }

    /// What a hierarchy costs rays: by the heuristic, and by what those that go through it take.
    fn told(
        &self,
        bvh: &BinaryBvh,
        places: &[Vec3],
        triangles: &[[u32; 3]],
    ) -> Result<Vec<(&'static str, f64)>, MeasureError> {
        let mut told = vec![("sah_cost", bvh.cost(1.0, 1.0))];
        let Looked { kind, count, seed } = self.looked;
        if count == 0 {
            return Ok(told);
        }
        let mut scene = Scene::new("body");
        let mesh = scene.add_mesh(Mesh::new("body", places.to_vec(), triangles.to_vec()));
        scene.add_node(None, "body", Affine3A::IDENTITY, Some(mesh));
        let world = World::new(scene);
        let mut builder = Builder::new("binned_sah", &self.settings).map_err(failed)?;
        let hierarchy =
            Hierarchy::over(world.items(), bvh, &mut builder, TriangleKind::default()).map_err(failed)?;
        let rays = ray_set(kind, world.scene(), &hierarchy, count, seed).filter(|rays| !rays.is_empty());
        let rays = rays.ok_or_else(|| MeasureError::Failed("there is nothing to aim rays at".to_owned()))?;
        let mut counts = RayCounts::default();
        for ray in &rays {
            hierarchy.triangle_counted(ray, &mut counts);
        }
        let a_ray = |count: u64| count as f64 / rays.len() as f64;
        told.push(("nodes_per_ray", a_ray(counts.nodes)));
        told.push(("blocks_per_ray", a_ray(counts.blocks)));
        if let Some(clock) = &self.clock {
            let mut hits = 0;
            let times: Vec<f64> = (0..PASSES)
                .map(|_| {
                    let before = clock.now();
                    hits += rays.iter().filter(|ray| hierarchy.closest(ray).is_some()).count();
                    (clock.now() - before) as f64
                })
                .collect();
            let time = median(&times).unwrap_or_default();
            told.push(("ray_rate", rays.len() as f64 * 1e3 / time.max(1.0)));
            told.push(("rays_hit", 100.0 * hits as f64 / (PASSES * rays.len()) as f64));
        }
        Ok(told)
    }
}
