//! The job `draw`: a camera path through a scene whose meshes are split into leaves, culled and drawn.
//!
//! Settings: `job.culling` (`on`: six planes for each box; `coherent`: the plane that rejected a box last
//! time first, and none that the box around it is inside of; `off`), `job.leaf` (the most triangles a leaf may have: a number, a share of the scene's
//! largest mesh such as `1/288`, or `unsplit`), `job.width` and `job.height` of the picture in pixels.
//!
//! On threads the meshes are split and the tree is built anew in every repeat, on as many threads as the
//! cell has processors; the scheme shares out the culling, and one thread draws. Each picture is held
//! against the one drawn without culling. A simulated machine culls only: it has nothing to do with culling
//! off, and what it finds is held against the exact test of each box.

mod culler;
mod drawn;

use super::settings::{JobSettings, of_scheme};
use super::{Cell, MeasureError, Options, Stage, Subject, SubjectCache, failed, simulated, stage_key};
use crate::geometry::culling::{Cached, Steps};
use crate::job::cull::Costs;
use crate::job::draw::{Drawing, MOST_PIXELS, Picture};
use crate::machine::threads::pin;
use crate::record::THREADS;
use crate::scene::Scene;
use crate::structure::{PlacedLeaves, SkipTree, midpoint_tree};
use culler::Culler;
use drawn::Drawn;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::HashMap;
use std::num::NonZeroUsize;
use std::rc::Rc;

/// The most triangles a leaf may have.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LeafSize {
    Triangles(NonZeroUsize),
    /// The largest mesh's triangles divided by this: what makes meshes of different sizes comparable.
    OneIn(NonZeroUsize),
    Unsplit,
}

impl LeafSize {
    fn read(value: &str) -> Option<Self> {
        if value == "unsplit" {
            return Some(Self::Unsplit);
        }
        match value.strip_prefix("1/") {
            Some(share) => share.parse().ok().map(Self::OneIn),
            None => value.parse().ok().map(Self::Triangles),
        }
    }

    fn most(self, scene: &Scene) -> NonZeroUsize {
        match self {
            Self::Triangles(most) => most,
            Self::OneIn(share) => {
                let largest = scene.meshes.iter().map(|mesh| mesh.triangles.len()).max().unwrap_or(0);
                NonZeroUsize::new(largest.div_ceil(share.get())).unwrap_or(NonZeroUsize::MIN)
            }
            Self::Unsplit => NonZeroUsize::MAX,
        }
    }
}

/// What cells of this job share.
#[derive(Default)]
pub(super) struct Drawings {
    /// By stage and leaf size.
    ready: HashMap<String, Rc<Ready>>,
    /// By stage and size of the picture: the fingerprint of each frame drawn without culling.
    pictures: HashMap<String, Rc<[u64]>>,
    pools: HashMap<u32, Rc<ThreadPool>>,
}

impl Drawings {
    fn pool(&mut self, threads: u32) -> Result<Rc<ThreadPool>, MeasureError> {
        if let Some(pool) = self.pools.get(&threads) {
            return Ok(pool.clone());
        }
        let builder = ThreadPoolBuilder::new().num_threads(threads as usize).start_handler(pin);
        let pool = Rc::new(builder.build().map_err(failed)?);
        self.pools.insert(threads, pool.clone());
        Ok(pool)
    }

    fn ready(&mut self, key: &str, scene: &Scene, most: NonZeroUsize) -> Result<Rc<Ready>, MeasureError> {
        let key = format!("{key} {most}");
        if let Some(ready) = self.ready.get(&key) {
            return Ok(ready.clone());
        }
        let ready = Rc::new(Ready::new(scene, most)?);
        self.ready.insert(key, ready.clone());
        Ok(ready)
    }

    fn pictures(
        &mut self,
        key: &str,
        stage: &Stage,
        leaves: &PlacedLeaves,
        picture: &mut Picture,
    ) -> Rc<[u64]> {
        let key = format!("{key} {:?}", picture.size());
        let pictures = self.pictures.entry(key).or_insert_with(|| {
            let drawing = Drawing::new(&stage.scene, leaves);
            let fingerprint = |camera| {
                drawing.draw_all(camera, picture);
                picture.fingerprint()
            };
            stage.cameras.iter().map(fingerprint).collect()
        });
        pictures.clone()
    }
}

/// A scene's leaves and the tree over them.
struct Ready {
    leaves: PlacedLeaves,
    tree: SkipTree,
}

impl Ready {
    fn new(scene: &Scene, most: NonZeroUsize) -> Result<Self, MeasureError> {
        let leaves = PlacedLeaves::new(scene, most).map_err(failed)?;
        let (tree, _) = midpoint_tree(&leaves.objects);
        tree.validate().map_err(failed)?;
        Ok(Self { leaves, tree })
    }
}

pub(super) fn open(
    cell: &Cell,
    options: &Options,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    let settings = JobSettings::of(cell);
    // Bubenicek sec. 2.3 and 2.4: both together are his "optimised".
    let coherent = Steps { cached: Cached::Rejecting, masking: true, ..Steps::BASIC };
    let cullings = [("on", Some(Steps::BASIC)), ("coherent", Some(coherent)), ("off", None)];
    let steps = settings.choice("culling", &cullings)?;
    let leaf = settings.read(
        "leaf",
        LeafSize::Unsplit,
        "a number of triangles, a share of the largest mesh such as 1/288, or unsplit",
        LeafSize::read,
    )?;
    let most = f64::from(MOST_PIXELS).sqrt();
    let width = settings.number("width", 640.0, 1.0..=most)? as u32;
    let height = settings.number("height", 480.0, 1.0..=most)? as u32;
    settings.finish(cell)?;
    if steps.is_none() && cell.machine != THREADS {
        let message = "with `job.culling` `off` a simulated machine has nothing to do: it does not draw";
        return Err(MeasureError::Setting(message.to_owned()));
    }
    let stage = cache.stage(cell, options)?;
    let key = stage_key(cell, options);
    let most = leaf.most(&stage.scene);
    let ready = cache.drawings.ready(&key, &stage.scene, most)?;
    if cell.machine == THREADS {
        let mut picture = Picture::new(width, height).expect("the settings' ranges keep within its bounds");
        let pictures = cache.drawings.pictures(&key, &stage, &ready.leaves, &mut picture);
        let (team, pool) = (cache.team(cell.processors)?, cache.drawings.pool(cell.processors)?);
        let culler = match steps {
            Some(steps) => Some(Culler::new(cell, team.clone(), &ready.tree, steps, Costs::default())?),
            None => None,
        };
        Ok(Box::new(Drawn { team, pool, stage, ready, most, culler, picture, pictures }))
    } else {
        let machine = simulated(cell, cache)?;
        let costs = Costs::measured_on(machine.model());
        let culler = Culler::new(cell, machine, &ready.tree, steps.unwrap_or(Steps::BASIC), costs)?;
        Ok(Box::new(culler::Alone { culler, stage, ready }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaf_sizes_are_numbers_shares_or_nothing() {
        let number = |most| NonZeroUsize::new(most).expect("not 0");
        assert_eq!(LeafSize::read("25000"), Some(LeafSize::Triangles(number(25_000))));
        assert_eq!(LeafSize::read("1/288"), Some(LeafSize::OneIn(number(288))));
        assert_eq!(LeafSize::read("unsplit"), Some(LeafSize::Unsplit));
        for wrong in ["0", "1/0", "2/3", "-4", "", "1/", "half", "1e9"] {
            assert_eq!(LeafSize::read(wrong), None, "{wrong}");
        }
        let scene = crate::scene::by_name("dragon").expect("there is one");
        assert_eq!(LeafSize::OneIn(number(288)).most(&scene).get(), 349);
        assert_eq!(LeafSize::OneIn(number(288)).most(&Scene::new("nothing")).get(), 1);
    }
}
