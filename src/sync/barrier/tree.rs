//! A combining tree (Yew, Tzeng and Lawrie 1987; Mellor-Crummey and Scott 1991, sec. 3.2): processors come to the
//! leaves, four to a leaf; the last at a node goes on to the one above, and the last at the root turns back. On
//! the way down each turns the flag of the node it came through, on which three others spin at most.
//!
//! Invariant: at a node with m members, in turn t the counter goes from t m to (t + 1) m, and the flag holds t
//! until the node's last member has come back from above.

use super::Turns;
use crate::machine::{Layout, Machine, Processor, Shared, Word};
use std::sync::atomic::Ordering;

/// Members of a node: what Mellor-Crummey and Scott found best for the way up.
const FAN_IN: usize = 4;

pub(super) struct Tree<M: Machine> {
    nodes: Vec<Node>,
    /// How many have come to a node, and the turn it is there, node by node.
    words: Shared<M::Word>,
}

struct Node {
    members: u64,
    above: Option<usize>,
}

/// The nodes of a tree over so many processors, leaves first, the root last.
fn nodes(processors: usize) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::new();
    let mut below = processors;
    loop {
        let level = below.div_ceil(FAN_IN);
        let next = nodes.len() + level;
        nodes.extend((0..level).map(|i| Node {
            members: FAN_IN.min(below - i * FAN_IN) as u64,
            above: (level > 1).then_some(next + i / FAN_IN),
        }));
        if level <= 1 {
            return nodes;
        }
        below = level;
    }
}

impl<M: Machine> Tree<M> {
    fn come_to(&self, at: usize, cpu: &M::Processor, last: impl FnOnce()) {
        let (node, come, turn) = (&self.nodes[at], &self.words[2 * at], &self.words[2 * at + 1]);
        // ORDERING: AcqRel: each one's Release half pairs with the Acquire half of the node's last, who carries
        // it on to the node above in the same way.
        let before = come.fetch_add(1, Ordering::AcqRel);
        let mine = before / node.members;
        if before % node.members == node.members - 1 {
            match node.above {
                Some(above) => self.come_to(above, cpu, last),
                None => last(),
            }
            // ORDERING: Release pairs with the Acquire load below; what came from above goes with it.
            turn.store(mine + 1, Ordering::Release);
        } else {
            // ORDERING: Acquire pairs with the Release store above.
            cpu.wait_until(&[turn], || turn.load(Ordering::Acquire) > mine);
        }
    }
}

impl<M: Machine> Turns<M> for Tree<M> {
    fn new(machine: &M, layout: Layout, processors: usize) -> Option<Self> {
        let nodes = nodes(processors);
        let words = machine.alloc(2 * nodes.len(), layout, |_| Word::new(0));
        Some(Tree { nodes, words })
    }

    fn wait_then(&self, cpu: &M::Processor, last: impl FnOnce()) {
        self.come_to(cpu.id() / FAN_IN, cpu, last);
    }

    fn reset(&self) {
        // ORDERING: Relaxed: between runs.
        self.words.iter().for_each(|word| word.store(0, Ordering::Relaxed));
    }
}

#[cfg(test)]
mod tests {
    use super::{FAN_IN, nodes};

    #[test]
    fn every_processor_has_one_way_up() {
        for processors in (1..200).chain([1024, 4096]) {
            let nodes = nodes(processors);
            let roots = nodes.iter().filter(|node| node.above.is_none()).count();
            assert_eq!((roots, nodes.last().map(|node| node.above)), (1, Some(None)), "{processors}");
            let mut members = vec![0; nodes.len()];
            (0..processors).for_each(|p| members[p / FAN_IN] += 1);
            nodes.iter().filter_map(|node| node.above).for_each(|above| members[above] += 1);
            assert!(nodes.iter().map(|node| node.members).eq(members.iter().copied()), "{processors}");
            assert!(members.iter().all(|&m| (1..=FAN_IN as u64).contains(&m)), "{processors}: {members:?}");
        }
    }
}
