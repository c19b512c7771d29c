//! The volumes that bodies can be wrapped in. The list is the table of contents.

use super::stage::{PairStage, Trees};
use super::{Asked, CollideSubject, Over, bend};
use crate::geometry::overlap::AlignedObb;
use crate::geometry::{Aabb, KDop, Obb, Overlap, Sphere};
use crate::job::collide::{Costs, Times};
use crate::machine::{Simulated, Threads};
use crate::measure::subject::{Cell, MeasureError, Options, Subject, SubjectCache, simulated};
use crate::record::THREADS;
use std::rc::Rc;

/// A kind of volume.
pub(super) struct Kind {
    /// The value of `job.volume`.
    pub(super) name: &'static str,
    /// Measured times of its tests.
    times: Times,
    open: OpenKind,
    /// The same of one body that bends.
    pub(super) bend: OpenBend,
}

type OpenKind =
    fn(&Kind, &Cell, &Asked, Rc<PairStage>, &mut SubjectCache) -> Result<Box<dyn Subject>, MeasureError>;

type OpenBend = fn(&Cell, bend::Asked, &Options, Rc<Threads>) -> Result<Box<dyn Subject>, MeasureError>;

/// Declares the kinds with the measured times of their tests in nanoseconds: a pair tested by itself, and a block of
/// eight, each with its visit. Least medians of five serial runs of 2,000 queries each, the robot in `factory-large`
/// by scene nodes, warm caches, on one core of an AMD EPYC (Zen 3, 2.45 GHz nominal); what is kept in queues and read
/// from memory is billed apart.
///
/// Every kind is compiled with every scheme, which takes its time: simulated machines run those of Paper II and the
/// tight ones, and of the k-DOPs there is the one in the middle.
macro_rules! kinds {
    ($($name:literal => $Volume:ty: $pair:literal, $batch:literal, $open:ident;)*) => {
        pub(super) const KINDS: &[Kind] = &[$(Kind {
            name: $name,
            times: Times { pair: $pair, batch: $batch, triangles: TRIANGLES_NS },
            open: $open::<$Volume>,
            bend: bend::with_volume::<$Volume>,
        }),*];
    };
}

/// A pair of triangles tested, nanoseconds: two bunnies a thousandth of their size apart, aligned boxes.
const TRIANGLES_NS: f64 = 28.0;

kinds! {
    "obb" => Obb: 34.2, 64.0, on_any;
    "aabb" => Aabb: 12.7, 33.6, on_any;
    "aabb_as_obb" => AlignedObb: 34.2, 64.0, on_any;
    "sphere" => Sphere: 19.3, 22.9, on_threads;
    "18dop" => KDop<9>: 41.3, 58.7, on_threads;
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

/// On threads or a simulated machine.
fn on_any<V: Overlap>(
    kind: &Kind,
    cell: &Cell,
    asked: &Asked,
    stage: Rc<PairStage>,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    if cell.machine == THREADS {
        return on_threads::<V>(kind, cell, asked, stage, cache);
    }
    let trees = trees::<V>(kind, asked, &stage)?;
    let machine = simulated(cell, cache)?;
    let costs = Costs::measured_on(machine.model(), kind.times);
    Ok(Box::new(CollideSubject::<_, Simulated, V>::new(cell, machine, stage, trees, *asked, costs)?))
}

fn on_threads<V: Overlap>(
    kind: &Kind,
    cell: &Cell,
    asked: &Asked,
    stage: Rc<PairStage>,
    cache: &mut SubjectCache,
) -> Result<Box<dyn Subject>, MeasureError> {
    if cell.machine != THREADS {
        let message =
            format!("setting `job.volume`: `{}` runs on {THREADS} only, not on {}", kind.name, cell.machine);
        return Err(MeasureError::Setting(message));
    }
    let trees = trees::<V>(kind, asked, &stage)?;
    let team = cache.team(cell.processors)?;
    Ok(Box::new(CollideSubject::<_, Threads, V>::new(cell, team, stage, trees, *asked, Costs::default())?))
}

fn trees<V: Overlap>(kind: &Kind, asked: &Asked, stage: &PairStage) -> Result<Rc<Trees<V>>, MeasureError> {
    let leaf = if asked.over == Over::Nodes { 0 } else { asked.leaf };
    stage.trees::<V>(kind.name, asked.over, leaf)
}
