//! Hierarchical view frustum culling (Paper I section 3, Paper II section 2): which nodes of a tree of
//! boxes may be seen from a camera.
//!
//! A [`CullTree`] is the tree as it lies in a machine's shared memory; a [`Frame`] is the job of one
//! camera, which any tree scheme can share out. Each processor gathers the part of the visible set that it
//! found; [`CullTree::visible`] puts the parts together.
//!
//! What a test keeps with a volume from frame to frame (P1-08, P1-12) is written by processors of successive
//! frames (P2-F17): it is in machine words, read and written whole. In one frame a node is visited by one
//! processor only, and the next frame begins when all are done with this one.
//!
//! Between frames objects may move: [`CullTree::refit`] takes over their new volumes.

mod costs;
mod kept;
mod test;
mod work;

use crate::geometry::culling::{self, Memory, Motion, Side, Steps, Verdict};
use crate::geometry::{Frustum, PLANE_COUNT};
use crate::machine::{Layout, Machine, Shared, Word};
use crate::structure::{MovingTree, SkipTree, Volumes};
pub use costs::Costs;
use kept::Kept;
use std::sync::{Mutex, PoisonError};
use test::{NodeVolumes, Test};
pub use work::{NodeTask, NodeWork, RangeTask, RangeWork, Visible};

/// Which nodes a descent goes through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Descent {
    /// Below a node only where it crosses the frustum.
    #[default]
    Pruned,
    /// Below every node whatever its test said: Paper II's control run for the parallelism there is in
    /// the tree (section 4.2, P2-23).
    WholeTree,
    /// The nodes of a pruned descent, but their tests take no time: Paper II's control run for the cost
    /// of sharing alone (section 3.3, P2-23).
    NoWork,
}

/// What is kept with a node from frame to frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum History {
    /// The plane that rejected it, written when it is another than last time.
    #[default]
    Plane,
    /// Also its signed distances from the six planes: what translation coherency needs (P1-12), and so what
    /// the code that Paper II shared out kept. Steps without translation coherency write them all the same, at
    /// every visit: that is the traffic of keeping them, without what they save.
    Distances,
}

/// Why a frame cannot be culled as asked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CullError {
    /// The octant test needs a symmetric frustum (Paper I sections 3.3 and 4, P1-F02).
    #[error("the octant test cannot be used with an asymmetric frustum (frame {frame}): turn it off")]
    Asymmetric {
        /// The frame of the camera path, from 0.
        frame: usize,
    },
    /// Translation coherency needs a tree with [`History::Distances`].
    #[error("translation coherency needs a tree that keeps distances")]
    NoDistances,
}

/// A node as it lies in shared memory.
struct Record<W> {
    bounds: crate::geometry::Aabb,
    /// Index after the subtree.
    end: u32,
    triangles: u32,
    /// A packed [`Head`](culling::Head).
    tested: W,
}

/// For each plane the distances of n- and p-vertex, as two `f32` in a word.
type Distances<W> = [W; PLANE_COUNT];

/// How many nodes a tree may have: their numbers leave room for a mask in a task.
pub const MOST_NODES: usize = (1 << 29) - 1;

/// A tree of volumes in the shared memory of a machine.
pub struct CullTree<M: Machine> {
    records: Shared<Record<M::Word>>,
    volumes: NodeVolumes,
    /// With [`History::Distances`]: one a node; empty otherwise.
    distances: Shared<Distances<M::Word>>,
    /// What the camera did up to the last frame that asked for it. It goes with what the nodes keep, so it is
    /// kept with them.
    motion: Mutex<Option<Motion>>,
}

impl<M: Machine> CullTree<M> {
    /// Copies a skip tree into shared memory, record beside record, depth first.
    ///
    /// # Panics
    /// If the tree has more than [`MOST_NODES`].
    pub fn new(machine: &M, tree: &SkipTree, history: History) -> Self {
        Self::with_volumes(machine, tree, &Volumes::Aabb, history)
    }

    /// The same with other volumes than the nodes' boxes. These lie in an array of their own.
    ///
    /// # Panics
    /// If there is not one volume a node, or more than [`MOST_NODES`].
    pub fn with_volumes(machine: &M, tree: &SkipTree, volumes: &Volumes, history: History) -> Self {
        assert!(tree.nodes.len() <= MOST_NODES, "{} nodes, expected at most {MOST_NODES}", tree.nodes.len());
        let records = machine.alloc(tree.nodes.len(), Layout::Packed, |i| {
            let node = &tree.nodes[i];
            Record { bounds: node.bounds, end: node.end, triangles: node.triangles, tested: Word::new(0) }
        });
        let kept = if history == History::Distances { tree.nodes.len() } else { 0 };
        let distances = machine.alloc(kept, Layout::Packed, |_| std::array::from_fn(|_| Word::new(0)));
        let volumes = NodeVolumes::new(machine, volumes, tree.nodes.len());
        CullTree { records, volumes, distances, motion: Mutex::new(None) }
    }

    /// Takes over what the last [`MovingTree::refit`] changed, and forgets what was kept about those nodes: they
    /// are tested anew, as Paper I asks for objects that moved (section 3.5, P1-F06). It takes time for the changed
    /// nodes only. To be called after each refit, between frames; on a simulated machine it is not billed.
    ///
    /// # Panics
    /// If this tree was not made of the moving one's tree, or of volumes of another kind. A tree of boxes takes the
    /// boxes, whatever volumes there are beside them.
    pub fn refit(&mut self, moving: &MovingTree) {
        let (changed, nodes) = (moving.changed(), &moving.tree().nodes);
        assert_eq!(nodes.len(), self.records.len(), "expected the tree that this one was made of");
        self.volumes.renew(moving.volumes(), changed);
        for &node in changed {
            let record = &mut self.records[node as usize];
            record.bounds = nodes[node as usize].bounds;
            Kept::new(&record.tested, None, false).forget();
        }
    }

    /// The camera's way up to this frame.
    fn follow(&self, frustum: &Frustum) -> Motion {
        let mut last = self.motion.lock().unwrap_or_else(PoisonError::into_inner);
        let now = last.map_or_else(|| Motion::start(frustum), |last| last.next(frustum));
        *last = Some(now);
        now
    }

    /// How many nodes there are.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// The visible set: the nodes with triangles of their own among what the processors found, in order.
    pub fn visible<'a>(&self, found: impl IntoIterator<Item = &'a Visible>) -> Vec<u32> {
        let ranges = found.into_iter().flat_map(|visible| visible.ranges.iter());
        let nodes = ranges.flat_map(|&(start, stop)| start..stop);
        let mut nodes: Vec<u32> = nodes.filter(|&i| self.records[i as usize].triangles > 0).collect();
        nodes.sort_unstable();
        nodes
    }
}

/// The culling of one tree for one camera.
pub struct Frame<'a, M: Machine> {
    tree: &'a CullTree<M>,
    frustum: &'a Frustum,
    steps: Steps,
    test: Test<'a>,
    descent: Descent,
    costs: Costs,
    /// With [`Descent::NoWork`]: where each volume is, found beforehand.
    answers: Vec<Side>,
}

impl<'a, M: Machine> Frame<'a, M> {
    /// The job of frame number `frame` of a camera path. With rotation or translation coherency among the
    /// steps, it follows the frame that was made before it of the same tree.
    ///
    /// # Errors
    /// [`CullError`].
    pub fn new(
        tree: &'a CullTree<M>,
        frame: usize,
        frustum: &'a Frustum,
        steps: Steps,
    ) -> Result<Self, CullError> {
        if steps.translation && tree.distances.is_empty() && !tree.is_empty() {
            return Err(CullError::NoDistances);
        }
        let motion = (steps.rotation || steps.translation).then(|| tree.follow(frustum));
        let test = Test::new(&tree.volumes, frustum, steps, motion)
            .map_err(|culling::Asymmetric| CullError::Asymmetric { frame })?;
        let (descent, costs) = (Descent::default(), Costs::default());
        Ok(Frame { tree, frustum, steps, test, descent, costs, answers: Vec::new() })
    }

    /// Sets which nodes are gone through.
    ///
    /// # Panics
    /// Never: the basic test, which finds the answers of [`Descent::NoWork`], needs no symmetry.
    #[must_use]
    pub fn descent(mut self, descent: Descent) -> Self {
        self.descent = descent;
        if descent == Descent::NoWork {
            let basic = Test::new(&self.tree.volumes, self.frustum, Steps::BASIC, None);
            let basic = basic.unwrap_or_else(|_| unreachable!("the basic test takes any frustum"));
            let side = |(i, record): (usize, &Record<M::Word>)| {
                basic.classify(i, &record.bounds, &culling::Forgetful, 0).side
            };
            self.answers = self.tree.records.iter().enumerate().map(side).collect();
        }
        self
    }

    /// Sets what a node costs on a simulated machine.
    #[must_use]
    pub fn costs(mut self, costs: Costs) -> Self {
        self.costs = costs;
        self
    }

    /// This frame as work whose tasks are (start, stop) ranges of the depth-first array.
    pub fn ranges(&self) -> RangeWork<'_, 'a, M> {
        RangeWork(self)
    }

    /// This frame as work whose tasks are nodes.
    pub fn nodes(&self) -> NodeWork<'_, 'a, M> {
        NodeWork(self)
    }

    /// Where a node's volume is, and how many planes it took to tell. `mask` has the planes that the nodes
    /// above are inside of.
    #[inline]
    fn test(&self, node: u32, record: &Record<M::Word>, mask: u8) -> Verdict {
        if self.descent == Descent::NoWork {
            return Verdict { side: self.answers[node as usize], tests: 0, inside: 0 };
        }
        let kept = !self.tree.distances.is_empty();
        let distances = kept.then(|| &self.tree.distances[node as usize]);
        let each_visit = kept && !self.steps.translation;
        let kept = Kept::new(&record.tested, distances, each_visit);
        let verdict = self.test.classify(node as usize, &record.bounds, &kept, mask);
        if each_visit {
            kept.keep_all(&record.bounds, &self.frustum.planes, verdict.side);
        }
        verdict
    }
}

#[cfg(test)]
mod moving_tests;
#[cfg(test)]
mod tests;
