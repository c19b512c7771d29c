//! The box tests of a query and nothing else: those it makes are written down, then made again.

use super::Question;
use crate::clock::{self, Run, least, median};
use apportion::geometry::overlap::{Eight, Way};
use apportion::geometry::{Overlap, Unit};
use apportion::job::collide::{Query, contacts};
use apportion::structure::VolumeTree;
use std::hint::black_box;

/// A box and the block of eight it is tested against.
struct Test {
    /// Whether the box is the second body's, and the block the first's.
    first: bool,
    one: u32,
    block: u32,
    used: u8,
}

/// Prints what a test takes, in nanoseconds, beside its target.
pub(super) fn time<V: Overlap>(name: &str, question: &Question, target: Option<f64>) {
    let ([a, b], motion) = (question.trees::<V>(), question.motion());
    let ways = (a.way_to(&b, &motion.inverse(), 0.0), b.way_to(&a, &motion, 0.0));
    let tests = tests(&a, &b, ways);
    let count: u64 = tests.iter().map(|test| u64::from(test.used.count_ones())).sum();
    assert_eq!(count, contacts(&a, &b, &motion, Query::default()).box_tests, "not the tests of the query");
    let unit = Unit::best();
    let run = || {
        for test in &tests {
            black_box(near(&a, &b, ways, unit, test));
        }
    };
    let times = &clock::rounds(&mut [Box::new(run) as Run<'_>])[0];
    let [middle, least] =
        [median(times.iter().copied()), least(times)].map(|time| time / count.max(1) as f64);
    let target = target.map_or(String::new(), |target| format!(", target {target}"));
    println!("{name}: box tests alone, median {middle:.1} ns, least {least:.1} ns{target}");
}

/// The boxes of the block that are near the one.
fn near<V: Overlap>(a: &VolumeTree<V>, b: &VolumeTree<V>, ways: (Way, Way), unit: Unit, test: &Test) -> u8 {
    let (moved, blocks) = match test.first {
        true => (b.volumes()[test.one as usize].moved(&ways.1), a.blocks()),
        false => (a.volumes()[test.one as usize].moved(&ways.0), b.blocks()),
    };
    !blocks[test.block as usize].apart(unit, &moved) & test.used
}

/// The descent of [`apportion::job::collide`], for what it tests.
fn tests<V: Overlap>(a: &VolumeTree<V>, b: &VolumeTree<V>, ways: (Way, Way)) -> Vec<Test> {
    let (mut tests, mut stack, unit) = (Vec::new(), vec![(0, 0)], Unit::best());
    while let Some((i, j)) = stack.pop() {
        let (link, other) = (a.links()[i as usize], b.links()[j as usize]);
        let first = match (link.is_leaf(), other.is_leaf()) {
            (true, true) => continue,
            (own, leaf) => !own && (leaf || link.surface >= other.surface),
        };
        let (below, one) = if first { (link, j) } else { (other, i) };
        for (block, used) in below.blocks() {
            let test = Test { first, one, block, used };
            let bits = near(a, b, ways, unit, &test);
            let lanes = (0..8).filter(|lane| bits >> lane & 1 == 1).map(|lane| block * 8 + lane);
            stack.extend(lanes.map(|lane| if first { (lane, j) } else { (i, lane) }));
            tests.push(test);
        }
    }
    tests
}
