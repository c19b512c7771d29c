//! The volumes that bodies can be wrapped in. The list is the table of contents.

use super::stage::PairStage;
use super::{Asked, CollideSubject, Over};
use crate::geometry::overlap::AlignedObb;
use crate::geometry::{Aabb, KDop, Obb, Overlap, Sphere};
use crate::job::collide::{Costs, Times};
use crate::machine::{Simulated, Threads};
use crate::measure::subject::{Cell, MeasureError, Subject, SubjectCache, simulated};
use crate::record::THREADS;
use std::rc::Rc;

/// A kind of volume.
pub(super) struct Kind {
    /// The value of `job.volume`.
    pub(super) name: &'static str,
    /// Measured times of its tests.
    times: Times,
    open: OpenKind,
}

type OpenKind =
    fn(&Kind, &Cell, &Asked, Rc<PairStage>, &mut SubjectCache) -> Result<Box<dyn Subject>, MeasureError>;

/// Declares the kinds with the measured times of their tests in nanoseconds: a pair tested by itself, and a block of
/// eight, each with its visit. Least medians of five serial runs of 2,000 queries each, the robot in `factory-large`
/// by scene nodes, warm caches, on one core of an AMD EPYC (Zen 3, 2.45 GHz nominal); what is kept in queues and read
/// from memory is billed apart.
macro_rules! kinds {
    ($($name:literal => $Volume:ty: $pair:literal, $batch:literal;)*) => {
        pub(super) const KINDS: &[Kind] = &[$(Kind {
            name: $name,
            times: Times { pair: $pair, batch: $batch, triangles: TRIANGLES_NS },
            open: open_as::<$Volume>,
        }),*];
    };
}

/// A pair of triangles tested, nanoseconds: two bunnies a thousandth of their size apart, aligned boxes.
const TRIANGLES_NS: f64 = 28.0;

kinds! {
    "obb" => Obb: 34.2, 64.0;
    "aabb" => Aabb: 12.7, 33.6;
    "aabb_as_obb" => AlignedObb: 34.2, 64.0;
    "sphere" => Sphere: 19.3, 22.9;
    "14dop" => KDop<7>: 40.4, 52.0;
    "18dop" => KDop<9>: 41.3, 58.7;
    "26dop" => KDop<13>: 52.8, 51.9;
}

impl Kind {
    /// Makes a cell ready with this kind of volume.
    pub(super) fn open(
        &self,
        cell: &Cell,
        asked: &Asked,
        stage: Rc<PairStage>,
        cache: &mut SubjectCache,
    ) -> Result<Box<dyn Subject>, MeasureError> {
        (self.open)(self, cell, asked, stage, cache)
    }
}

fn open_as<V: Overlap>(
    kind: &Kind,
    cell: &Cell,
    asked: &Asked,
    stage: Rc<PairStage>,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    let leaf = if asked.over == Over::Nodes { 0 } else { asked.leaf };
    let trees = stage.trees::<V>(kind.name, asked.over, leaf)?;
    if cell.machine == THREADS {
        let team = cache.team(cell.processors)?;
        Ok(Box::new(CollideSubject::<_, Threads, V>::new(
            cell,
            team,
            stage,
            trees,
            *asked,
            Costs::default(),
        )?))
    } else {
        let machine = simulated(cell, cache)?;
        let costs = Costs::measured_on(machine.model(), kind.times);
        Ok(Box::new(CollideSubject::<_, Simulated, V>::new(cell, machine, stage, trees, *asked, costs)?))
    }
}
