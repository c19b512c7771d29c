//! Hierarchical view frustum culling (Paper I section 3, Paper II section 2): which nodes of a tree of
//! boxes may be seen from a camera.
//!
//! A [`CullTree`] is the tree as it lies in a machine's shared memory; a [`Frame`] is the job of one
//! camera, which any tree scheme can share out. Each processor gathers the part of the visible set that it
//! found; [`CullTree::visible`] puts the parts together.
//!
//! The plane that rejected a box is kept with the box and tested first next time (P1-08). Processors of
//! successive frames write it, even while another reads it (P2-F17): it is a machine word, read and
//! written whole, and any plane to start with gives the same answer, so a stale one costs time only.

mod costs;
mod work;

use crate::geometry::culling::{self, OctantTest, Side, Verdict};
use crate::geometry::{Frustum, PLANE_COUNT};
use crate::machine::{Layout, Machine, Shared, Word};
use crate::structure::SkipTree;
pub use costs::Costs;
use std::sync::atomic::Ordering;
pub use work::{NodeWork, RangeWork, Visible};

/// What the test of a box is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tests {
    /// Plane-coherency: the plane that rejected the box last time first.
    pub plane_coherency: bool,
    /// The octant test; not for asymmetric frusta.
    pub octant: bool,
}

impl Default for Tests {
    fn default() -> Self {
        Tests { plane_coherency: true, octant: true }
    }
}

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
    /// Also the frame in which it was last tested and its signed distances from the six planes, written
    /// at every visit: what translation and rotation coherency needs (P1-12), and so what the code that
    /// Paper II shared out kept. Only the traffic of keeping them is here; the test that uses them is not.
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
}

/// A node as it lies in shared memory.
struct Record<W> {
    bounds: crate::geometry::Aabb,
    /// Index after the subtree.
    end: u32,
    triangles: u32,
    /// The plane that rejected the box when it was last rejected, in the lowest byte; with
    /// [`History::Distances`] the frame of its last test above it.
    tested: W,
}

/// For each plane the distances of n- and p-vertex, as two `f32` in a word.
type Distances<W> = [W; PLANE_COUNT];

/// A tree of boxes in the shared memory of a machine.
pub struct CullTree<M: Machine> {
    records: Shared<Record<M::Word>>,
    /// With [`History::Distances`]: one a node; empty otherwise.
    distances: Shared<Distances<M::Word>>,
}

impl<M: Machine> CullTree<M> {
    /// Copies a skip tree into shared memory, record beside record, depth first.
    pub fn new(machine: &M, tree: &SkipTree, history: History) -> Self {
        let records = machine.alloc(tree.nodes.len(), Layout::Packed, |i| {
            let node = &tree.nodes[i];
            Record { bounds: node.bounds, end: node.end, triangles: node.triangles, tested: Word::new(0) }
        });
        let kept = if history == History::Distances { tree.nodes.len() } else { 0 };
        let distances = machine.alloc(kept, Layout::Packed, |_| std::array::from_fn(|_| Word::new(0)));
        CullTree { records, distances }
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
    number: usize,
    frustum: &'a Frustum,
    tests: Tests,
    octant: Option<OctantTest<'a>>,
    descent: Descent,
    costs: Costs,
    /// With [`Descent::NoWork`]: where each box is, found beforehand.
    answers: Vec<Side>,
}

impl<'a, M: Machine> Frame<'a, M> {
    /// The job of frame number `frame` of a camera path.
    ///
    /// # Errors
    /// [`CullError::Asymmetric`].
    pub fn new(
        tree: &'a CullTree<M>,
        frame: usize,
        frustum: &'a Frustum,
        tests: Tests,
    ) -> Result<Self, CullError> {
        let octant = if tests.octant {
            Some(OctantTest::new(frustum).ok_or(CullError::Asymmetric { frame })?)
        } else {
            None
        };
        let (descent, costs) = (Descent::default(), Costs::default());
        Ok(Frame { tree, number: frame, frustum, tests, octant, descent, costs, answers: Vec::new() })
    }

    /// Sets which nodes are gone through.
    #[must_use]
    pub fn descent(mut self, descent: Descent) -> Self {
        self.descent = descent;
        if descent == Descent::NoWork {
            let test = |record: &Record<M::Word>| culling::basic(&record.bounds, self.frustum).side;
            self.answers = self.tree.records.iter().map(test).collect();
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

    /// Where a node's box is, and how many planes it took to tell.
    #[inline]
    fn test(&self, node: u32, record: &Record<M::Word>) -> Verdict {
        if self.descent == Descent::NoWork {
            return Verdict { side: self.answers[node as usize], tests: 0 };
        }
        // ORDERING: Relaxed here and below: each word stands for itself, see the head of this file.
        let first = self.tests.plane_coherency.then(|| record.tested.load(Ordering::Relaxed) as u8);
        let verdict = match (&self.octant, first) {
            (Some(octant), first) => octant.classify(&record.bounds, first),
            (None, Some(first)) => culling::from_plane(&record.bounds, self.frustum, first),
            (None, None) => culling::basic(&record.bounds, self.frustum),
        };
        let by = if let Side::Outside(by) = verdict.side { by } else { first.unwrap_or(0) };
        if self.tree.distances.is_empty() {
            if first.is_some_and(|first| by != first) {
                record.tested.store(u64::from(by), Ordering::Relaxed);
            }
        } else {
            record.tested.store((self.number as u64) << 8 | u64::from(by), Ordering::Relaxed);
            for (word, plane) in self.tree.distances[node as usize].iter().zip(&self.frustum.planes) {
                let (nearest, farthest) = plane.extremes(&record.bounds);
                let pair = u64::from(nearest.to_bits()) << 32 | u64::from(farthest.to_bits());
                word.store(pair, Ordering::Relaxed);
            }
        }
        verdict
    }
}

#[cfg(test)]
mod tests;
