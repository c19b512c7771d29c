//! Where memory lies and how far away: one bus for all, or nodes in a network, each with memory of its own and a
//! directory of who has copies of it.
//!
//! A way is counted in routers: none within a node; between nodes the first router and one more for each link between
//! two routers. Links are never busy here: what makes others wait is the memory and directory of a line's
//! home node.

use serde::{Deserialize, Serialize};

/// How the routers are connected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Topology {
    /// There are none: one bus, one memory.
    #[default]
    Bus,
    /// Router a and router b are as many links apart as their numbers have different bits.
    Hypercube,
    /// Rows of [`Network::columns`] routers, each connected to its neighbours in four directions.
    Mesh,
    /// Each router is connected to each other.
    AllToAll,
}

/// In which node's memory a page lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Home {
    /// In that of the processor that first uses it in a run.
    #[default]
    FirstTouch,
    /// Page after page in node after node.
    Interleaved,
}

/// The network of a simulated machine. Times are cycles of the processors' clock, there and back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Network {
    /// How the routers are connected.
    pub topology: Topology,
    /// Processors of a node.
    pub node: usize,
    /// Nodes at a router.
    pub router: usize,
    /// Routers in a row of a mesh; of no concern elsewhere.
    pub columns: usize,
    /// Where a page lies.
    pub home: Home,
    /// Bytes of a page.
    pub page: usize,
    /// Cycles that leaving the node adds to a miss: out of it, through one router, and back.
    pub away: u64,
    /// Cycles that each further link between two routers adds, there and back.
    pub hop: u64,
    /// Cycles for which a home node is busy with telling one processor that its copy is void.
    pub message: u64,
    /// Cycles for which a home node is busy with an atomic operation on a word in its memory; 0 where memories cannot
    /// do that, so that the line comes to the processor instead.
    pub at_memory: u64,
}

impl Default for Network {
    fn default() -> Self {
        Network {
            topology: Topology::Bus,
            node: 1,
            router: 1,
            columns: 1,
            home: Home::FirstTouch,
            page: 4096,
            away: 0,
            hop: 0,
            message: 0,
            at_memory: 0,
        }
    }
}

impl Network {
    /// The node of a processor.
    #[inline]
    pub(super) fn node_of(&self, p: u16) -> usize {
        if self.topology == Topology::Bus { 0 } else { usize::from(p) / self.node }
    }

    /// How many nodes so many processors make.
    pub(super) fn nodes(&self, processors: usize) -> usize {
        if self.topology == Topology::Bus { 1 } else { processors.div_ceil(self.node) }
    }

    /// Cycles that the way from one node to another adds, there and back.
    #[inline]
    pub(super) fn travel(&self, from: usize, to: usize) -> u64 {
        if from == to {
            return 0;
        }
        let (a, b) = (from / self.router, to / self.router);
        let links = match self.topology {
            Topology::Bus => return 0,
            Topology::Hypercube => u64::from((a ^ b).count_ones()),
            Topology::Mesh => {
                let apart = |a: usize, b: usize| a.abs_diff(b) as u64;
                apart(a % self.columns, b % self.columns) + apart(a / self.columns, b / self.columns)
            }
            Topology::AllToAll => u64::from(a != b),
        };
        self.away + links * self.hop
    }

    /// What is wrong with the constants: which, its value, and what was expected.
    pub(super) fn wrong(&self) -> Option<(&'static str, String, &'static str)> {
        let counts =
            [("network.node", self.node), ("network.router", self.router), ("network.columns", self.columns)];
        if let Some((key, count)) = counts.into_iter().find(|&(_, count)| count == 0 || count > super::MOST) {
            return Some((key, count.to_string(), "1 to 4096"));
        }
        if !self.page.is_power_of_two() || !(128..=1 << 30).contains(&self.page) {
            return Some(("network.page", self.page.to_string(), "a power of two from 128 to 2^30"));
        }
        let times = [
            ("network.away", self.away),
            ("network.hop", self.hop),
            ("network.message", self.message),
            ("network.at_memory", self.at_memory),
        ];
        let long = times.into_iter().find(|&(_, time)| time > 1_000_000);
        long.map(|(key, time)| (key, time.to_string(), "at most 1,000,000 cycles"))
    }
}

#[cfg(test)]
mod tests {
    use super::super::Model;
    use super::*;

    fn network(topology: Topology) -> Network {
        Network { topology, node: 2, router: 2, columns: 4, away: 100, hop: 10, ..Network::default() }
    }

    #[test]
    fn ways_are_as_long_as_the_topology_says() {
        let travel = |topology, from, to| network(topology).travel(from, to);
        for topology in [Topology::Hypercube, Topology::Mesh, Topology::AllToAll] {
            assert_eq!(travel(topology, 5, 5), 0, "{topology:?}: at home");
            assert_eq!(travel(topology, 4, 5), 100, "{topology:?}: the other node of the router");
            for (a, b) in (0..40).flat_map(|a| (0..40).map(move |b| (a, b))) {
                assert_eq!(travel(topology, a, b), travel(topology, b, a), "{topology:?}: {a}, {b}");
            }
        }
        // Routers 0 and 7, which is 111 in binary; and, in rows of four, 3 to the right and 1 down.
        assert_eq!(travel(Topology::Hypercube, 0, 14), 130);
        assert_eq!(travel(Topology::Mesh, 0, 14), 140);
        assert_eq!(travel(Topology::AllToAll, 0, 14), 110);
        assert_eq!(travel(Topology::Bus, 0, 14), 0);
    }

    /// Laudon and Lenoski 1997 print the latency of a miss to memory, in ns, local and on average over the
    /// other nodes of machines of several sizes.
    #[test]
    fn the_origin_misses_as_slowly_as_was_printed() {
        let model = Model::named("origin2000").unwrap();
        let ns = |cycles: f64| cycles * 1000.0 / model.clock_mhz;
        assert!((ns(model.memory as f64) / 310.0 - 1.0).abs() < 0.02);
        for (processors, printed) in [(4, 540.0), (16, 726.0), (32, 773.0), (64, 867.0), (128, 945.0)] {
            let nodes = model.network.nodes(processors);
            let sum: u64 = (1..nodes).map(|node| model.memory + model.network.travel(0, node)).sum();
            let mean = ns(sum as f64 / (nodes - 1) as f64);
            assert!(
                (mean / printed - 1.0).abs() < 0.03,
                "{processors} processors: {mean} ns, printed {printed}"
            );
        }
    }
}
