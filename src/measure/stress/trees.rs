//! Random trees, settings and pauses for a tree scheme; now and then a visit panics.

use super::pause;
use crate::machine::{Processor, RunError, Threads};
use crate::scene::SplitMix64;
use crate::scheme::tree::{Scheme, TreeWork};
use std::collections::BTreeMap;

/// Settings to choose from; a scheme takes those that it knows.
const CHOICES: &[(&str, &[&str])] = &[
    ("capacity", &["1", "2", "3", "8", "32"]),
    ("mailbox", &["1", "2", "16"]),
    ("grain", &["1", "2", "5"]),
    ("receivers", &["1", "2", "4"]),
    ("balance", &["off", "half_difference"]),
    ("ring", &["remember", "1999"]),
    ("layout", &["1999", "padded"]),
    ("lock", &["test_and_set", "test_and_test_and_set", "ticket", "mcs"]),
    ("counter", &["locked", "fetch_add"]),
    ("insert", &["each", "batch"]),
    ("threshold", &["0", "1", "6"]),
    ("order", &["descend", "stack"]),
];

/// A tree by its nodes' first child and number of children, node 0 being the root.
struct Tree {
    below: Vec<(u32, u32)>,
    seed: u64,
    /// The node whose visit panics.
    rotten: Option<u32>,
}

const PANIC: &str = "a rotten node";

impl Tree {
    /// Each node in turn gets up to `width` of the nodes that are left.
    fn new(random: &mut SplitMix64) -> Self {
        let (nodes, width) = (random.below(400) as u32, 1 + random.below(9));
        let mut below = Vec::new();
        let mut next = 1;
        for node in 0..nodes {
            // The last one that can still have a child must have one.
            let least = usize::from(next == node + 1);
            let children = (least + random.below(width)).min((nodes - next) as usize) as u32;
            below.push((next, children));
            next += children;
        }
        Tree { below, seed: random.next_u64(), rotten: None }
    }
}

impl TreeWork for Tree {
    type Task = u32;
    type Found = Vec<u32>;

    fn root(&self) -> Option<u32> {
        (!self.below.is_empty()).then_some(0)
    }

    fn found(&self) -> Vec<u32> {
        Vec::new()
    }

    fn visit<P: Processor>(&self, node: u32, found: &mut Vec<u32>, _cpu: &P, emit: impl FnMut(u32)) {
        pause(SplitMix64::new(self.seed ^ u64::from(node)).next_u64());
        if self.rotten == Some(node) {
            // As a panic, but the hook prints nothing.
            std::panic::resume_unwind(Box::new(PANIC));
        }
        found.push(node);
        let (first, children) = self.below[node as usize];
        (first..first + children).for_each(emit);
    }

    fn size(&self, node: u32) -> usize {
        if self.below[node as usize].1 == 0 { 1 } else { usize::MAX }
    }
}

/// Sets the scheme up with random settings and runs it on a few trees; returns the nodes visited.
pub(super) fn check(
    name: &str,
    team: &Threads,
    processors: usize,
    random: &mut SplitMix64,
) -> Result<u64, String> {
    let processors = 1 + random.below(processors);
    let mut given = BTreeMap::new();
    for (key, values) in CHOICES {
        let one = BTreeMap::from([((*key).to_owned(), values[random.below(values.len())].to_owned())]);
        if Scheme::new(name, team, 1, one.clone()).is_ok() {
            given.extend(one);
        }
    }
    let about = |e: String| format!("{e} (on {processors} processors, {given:?})");
    let mut scheme = Scheme::new(name, team, processors, given.clone()).map_err(|e| about(e.to_string()))?;
    let mut visited = 0;
    for _ in 0..3 {
        let mut tree = Tree::new(random);
        if !tree.below.is_empty() && random.below(8) == 0 {
            tree.rotten = Some(random.below(tree.below.len()) as u32);
        }
        visited += run(&mut scheme, team, &tree).map_err(about)?;
    }
    Ok(visited)
}

fn run(scheme: &mut Scheme<Threads>, team: &Threads, tree: &Tree) -> Result<u64, String> {
    let nodes = tree.below.len();
    let shares = match (scheme.run(team, tree), tree.rotten) {
        (Ok(shares), None) => shares,
        (Err(RunError::Panicked { message, .. }), Some(_)) if message == PANIC => return Ok(0),
        (Err(e), _) => return Err(format!("{nodes} nodes, {:?} rotten: {e}", tree.rotten)),
        (Ok(_), Some(node)) => return Err(format!("{nodes} nodes: the panic at {node} went unnoticed")),
    };
    let mut visits = vec![0_u32; nodes];
    for share in &shares {
        if share.visited != share.found.len() as u64 {
            return Err(format!("a processor counted {} visits of {}", share.visited, share.found.len()));
        }
        share.found.iter().for_each(|&node| visits[node as usize] += 1);
    }
    match visits.iter().position(|&visits| visits != 1) {
        Some(node) => Err(format!("node {node} of {nodes} was visited {} times", visits[node])),
        None => Ok(nodes as u64),
    }
}
