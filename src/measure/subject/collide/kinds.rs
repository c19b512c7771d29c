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

/// Declares the kinds with their measured times in nanoseconds: a pair tested by itself, with its visit; a visit that
/// tests by eight, but for the tests; one of those.
///
/// Least-squares fits of serial queries' times to their tests and visits over the robot in `factory-large` and the
/// shells, warm caches, on one core of an AMD EPYC (Zen 3, 2.45 GHz nominal).
macro_rules! kinds {
    ($($name:literal => $Volume:ty: $pair:literal, $visit:literal, $batched:literal;)*) => {
        pub(super) const KINDS: &[Kind] = &[$(Kind {
            name: $name,
            times: Times { pair: $pair, visit: $visit, batched: $batched, triangles: TRIANGLES_NS },
            open: open_as::<$Volume>,
        }),*];
    };
}

/// A pair of triangles tested, nanoseconds.
const TRIANGLES_NS: f64 = 40.0;

kinds! {
    "obb" => Obb: 60.0, 15.0, 6.0;
    "aabb" => Aabb: 15.0, 10.0, 1.0;
    "aabb_as_obb" => AlignedObb: 60.0, 15.0, 6.0;
    "sphere" => Sphere: 12.0, 10.0, 1.0;
    "dop14" => KDop<7>: 40.0, 40.0, 2.0;
    "dop18" => KDop<9>: 45.0, 45.0, 2.5;
    "dop26" => KDop<13>: 55.0, 55.0, 3.5;
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
