//! A query on two threads, against the serial scheme in the same round.

use super::Question;
use crate::clock::{self, Run, median, ratios};
use apportion::geometry::{Obb, Unit};
use apportion::job::collide::{BatchWork, Contacts, Pair, SharedTree};
use apportion::machine::{Machine, Threads};
use apportion::scheme::tree::Scheme;
use std::collections::BTreeMap;
use std::hint::black_box;

/// The first is what the others are held against.
const SCHEMES: [(&str, usize); 3] = [("serial", 1), ("work_stealing", 2), ("lock_free", 2)];

/// Prints how many times as fast as the serial scheme the others answer; the target is 1.8.
pub(super) fn time(question: &Question) {
    let team = Threads::new(2).expect("two threads");
    let [a, b] = question.trees::<Obb>().map(|tree| SharedTree::new(&team, tree.into()));
    let pair = a.against(&b, &question.motion(), 0.0, Unit::best());
    let mut runs: Vec<Run<'_>> = SCHEMES.iter().map(|scheme| run(*scheme, &team, &pair)).collect();
    let times = clock::rounds(&mut runs);
    println!("\n{} by Obb on two threads, target 1.8", question.name);
    for ((name, processors), own) in SCHEMES.iter().zip(&times) {
        let speedup = median(ratios(&times[0], own));
        let middle = median(own.iter().copied()) / 1e3;
        println!("{:46} {middle:9.1} us {speedup:8.2}x", format!("{name}, threads: {processors}"));
    }
}

fn run<'a>((name, processors): (&str, usize), team: &'a Threads, pair: &'a Pair<'a, Obb>) -> Run<'a> {
    let mut scheme = Scheme::new(name, team, processors, BTreeMap::new()).expect("its settings are its own");
    Box::new(move || {
        let work = BatchWork::<<Threads as Machine>::Word, _>::new(pair, None);
        let shares = scheme.run(team, &work).expect("no worker panics");
        black_box(Contacts::gather(shares.iter().map(|share| &share.found)));
    })
}
