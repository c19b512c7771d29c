//! Work of a set size a node on a generated unbalanced tree: no geometry, no pruning, every node
//! visited. It shows what sharing costs, apart from what any job does.
//!
//! The tree is made as a factory floor is: chains (robots), wide fans (shelves) and uneven branches. It
//! lies in a depth-first array with skip indices; a task is a range of it. Everything follows from the
//! seed.
//!
//! A visit natively turns a loop of dependent arithmetic for the node's nanoseconds; how many turns a
//! nanosecond takes is measured once a process, so that a visit never looks at a clock. On a simulated
//! machine it charges the same nanoseconds in cycles.

use crate::machine::{Layout, Machine, Processor, Shared};
use crate::scheme::tree::TreeWork;
use std::hint::black_box;
use std::ops::RangeInclusive;
use std::sync::OnceLock;

/// A generated tree with a set work a node.
///
/// ```
/// use apportion::{job::synthetic::Synthetic, machine::Threads, scheme::tree::share};
/// let team = Threads::new(2)?;
/// let work = Synthetic::new(&team, 401, 20..=60, 1);
/// let shares = share("lock_free", &team, 2, &work)?;
/// assert_eq!(shares.iter().map(|s| s.visited).sum::<u64>(), 401);
/// assert_eq!(shares.iter().fold(0, |sum, s| sum ^ s.found), work.expected());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Synthetic {
    nodes: Shared<Node>,
    /// A 1 that the compiler does not know of.
    one: u64,
}

#[derive(Debug)]
struct Node {
    /// Index after the last node of this one's subtree.
    end: u32,
    /// Turns of the loop, natively; 0 on a simulated machine.
    turns: u32,
    /// Cycles charged on a simulated machine; nobody looks at it natively.
    cycles: u32,
    /// What finding this node contributes.
    mark: u32,
}

impl Synthetic {
    /// A tree of `nodes` nodes in the shared memory of `machine`, each of which takes a time drawn
    /// evenly from `work_ns` nanoseconds. Equal arguments give equal trees.
    pub fn new<M: Machine>(machine: &M, nodes: u32, work_ns: RangeInclusive<u32>, seed: u64) -> Self {
        let turns_per_ns = if machine.is_native() { turns_per_ns(machine) } else { 0.0 };
        let cycles_per_ns = machine.ticks_per_nanosecond();
        let ends = shape(nodes, seed);
        let make = |i: usize| {
            let hash = mix(seed ^ mix(i as u64));
            let ns = f64::from(draw(hash, &work_ns));
            Node {
                end: ends[i],
                turns: (ns * turns_per_ns).round() as u32,
                cycles: (ns * cycles_per_ns).round() as u32,
                mark: (hash >> 32) as u32,
            }
        };
        Synthetic { nodes: machine.alloc(ends.len(), Layout::Packed, make), one: black_box(1) }
    }

    /// How many nodes the tree has.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether the tree has no nodes.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// What the found values of a run's shares must give, combined by exclusive or, if each node was
    /// visited once.
    pub fn expected(&self) -> u64 {
        (0..self.nodes.len()).fold(0, |sum, i| sum ^ self.found_at(i))
    }

    /// Work of the whole tree on a simulated machine, cycles, without what reading the nodes costs.
    pub fn cycles(&self) -> u64 {
        self.nodes.iter().map(|node| u64::from(node.cycles)).sum()
    }

    #[inline]
    fn found_at(&self, i: usize) -> u64 {
        u64::from(self.nodes[i].mark) << 32 | i as u64
    }

    /// The node's own work.
    #[inline]
    fn work<P: Processor>(&self, i: u32, found: &mut u64, cpu: &P) {
        let node = &self.nodes[i as usize];
        cpu.touch(node);
        cpu.charge(u64::from(node.cycles));
        *found ^= self.found_at(i as usize);
        turn(node.turns, self.one);
    }
}

impl TreeWork for Synthetic {
    type Task = (u32, u32);
    type Found = u64;

    fn root(&self) -> Option<(u32, u32)> {
        (!self.nodes.is_empty()).then_some((0, self.nodes.len() as u32))
    }

    fn found(&self) -> u64 {
        0
    }

    #[inline]
    fn visit<P: Processor>(
        &self,
        (start, stop): (u32, u32),
        found: &mut u64,
        cpu: &P,
        mut emit: impl FnMut((u32, u32)),
    ) {
        self.work(start, found, cpu);
        let mut child = start + 1;
        while child < stop {
            let node = &self.nodes[child as usize];
            cpu.touch(node);
            emit((child, node.end));
            child = node.end;
        }
    }

    #[inline]
    fn descend<P: Processor>(
        &self,
        (start, stop): (u32, u32),
        found: &mut u64,
        cpu: &P,
        _stack: &mut Vec<u64>,
    ) -> u64 {
        // Nothing is skipped, so the range is read from end to end.
        (start..stop).for_each(|i| self.work(i, found, cpu));
        u64::from(stop - start)
    }

    fn size(&self, (start, stop): (u32, u32)) -> usize {
        (stop - start) as usize
    }
}

/// The ends of all subtrees of a tree of `nodes` nodes, in depth-first order.
fn shape(nodes: u32, seed: u64) -> Vec<u32> {
    let mut ends = vec![0; nodes as usize];
    // Subtrees to lay out, as (first, end), and how many more links of a chain start there.
    let mut open = vec![(0, nodes, 0)];
    let mut state = mix(seed);
    while let Some((first, end, links)) = open.pop() {
        if first == end {
            continue;
        }
        ends[first as usize] = end;
        let below = end - first - 1;
        state = mix(state);
        let links = if links == 0 && state.is_multiple_of(4) { draw(state >> 8, &(2..=7)) } else { links };
        if links > 0 {
            open.push((first + 1, end, links - 1));
            continue;
        }
        let wide = state % 4 == 1;
        let children = draw(state >> 8, if wide { &(8..=24) } else { &(2..=4) }).min(below);
        let mut child = first + 1;
        for left in (1..=children).rev() {
            state = mix(state);
            let even = (end - child) / left;
            // Shelves are alike; other branches are anything from nothing much to twice their share.
            let most = (2 * even).saturating_sub(1).max(1);
            let size = if left == 1 {
                end - child
            } else if wide {
                even
            } else {
                draw(state, &(1..=most)).min(end - child - (left - 1))
            };
            open.push((child, child + size, 0));
            child += size;
        }
    }
    ends
}

/// SplitMix64's finisher on the next state: a good hash of a small number.
pub(super) fn mix(number: u64) -> u64 {
    let mut z = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

/// A number of `range` that depends on `hash` alone.
pub(super) fn draw(hash: u64, range: &RangeInclusive<u32>) -> u32 {
    let span = u64::from(range.end().saturating_sub(*range.start())) + 1;
    range.start() + (((hash >> 32) * span) >> 32) as u32
}

/// Turns a loop of dependent arithmetic, a few cycles a turn.
///
/// The count itself is the chain: a processor that executes out of order knows only at its end that
/// the loop is over, so it can overlap neither the next node nor a scheme's bookkeeping with it.
#[inline(always)]
pub(super) fn turn(turns: u32, one: u64) {
    let mut left = u64::from(turns);
    while left != 0 {
        left = left.wrapping_mul(one).wrapping_sub(1);
    }
    black_box(left);
}

/// Turns a nanosecond takes on this host, measured once a process: the fastest of many samples, since
/// whatever disturbs a sample makes it slower.
pub(super) fn turns_per_ns<M: Machine>(machine: &M) -> f64 {
    static MEASURED: OnceLock<f64> = OnceLock::new();
    const TURNS: u32 = 20_000;
    *MEASURED.get_or_init(|| {
        let sample = |_| {
            let before = machine.now();
            turn(black_box(TURNS), black_box(1));
            machine.now() - before
        };
        let ticks = (0..200).map(sample).min().unwrap_or(0).max(1);
        f64::from(TURNS) / (ticks as f64 / machine.ticks_per_nanosecond())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::simulated::{Model, Simulated};
    use crate::scheme::tree::Scheme;
    use std::collections::BTreeMap;

    #[test]
    fn ends_nest_and_the_tree_is_unbalanced() {
        for nodes in [0, 1, 2, 3, 10, 401, 4_001, 50_000] {
            let ends = shape(nodes, 7);
            assert_eq!(ends.len(), nodes as usize);
            let mut open: Vec<u32> = Vec::new();
            let mut deepest = 0;
            for (i, &end) in ends.iter().enumerate() {
                while open.last().is_some_and(|&above| above as usize <= i) {
                    open.pop();
                }
                assert!(end as usize > i && end <= open.last().copied().unwrap_or(nodes), "node {i}");
                open.push(end);
                deepest = deepest.max(open.len());
            }
            assert!(nodes < 400 || (10..200).contains(&deepest), "{nodes} nodes, depth {deepest}");
        }
    }

    #[test]
    fn equal_arguments_give_equal_trees() {
        let machine = Simulated::new(Model::named("e4000").unwrap());
        let of = |seed| {
            let tree = Synthetic::new(&machine, 401, 100..=300, seed);
            tree.nodes.iter().map(|n| (n.end, n.cycles, n.mark)).collect::<Vec<_>>()
        };
        assert_eq!(of(1), of(1));
        assert_ne!(of(1), of(2));
    }

    #[test]
    fn charges_are_exact_on_a_simulated_machine() {
        let machine = Simulated::new(Model::named("e4000").unwrap());
        let tree = Synthetic::new(&machine, 401, 100..=300, 5);
        let mean = tree.cycles() as f64 / 401.0 / machine.ticks_per_nanosecond();
        assert!((185.0..215.0).contains(&mean), "{mean} ns");
        for (scheme, processors) in [("serial", 1), ("lock_free", 2), ("hybrid", 5)] {
            let mut scheme = Scheme::new(scheme, &machine, processors, BTreeMap::new()).unwrap();
            let shares = scheme.run(&machine, &tree).unwrap();
            assert_eq!(machine.statistics().charged.iter().sum::<u64>(), tree.cycles());
            assert_eq!(shares.iter().fold(0, |sum, s| sum ^ s.found), tree.expected());
            assert_eq!(shares.iter().map(|s| s.visited).sum::<u64>(), 401);
        }
    }
}
