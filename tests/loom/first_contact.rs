//! A query that ends at the first contact. The word that says so is relaxed, so a processor may see it late; whatever
//! it sees, the run ends, each processor finds one contact at most, and all of them together find one exactly if there
//! is one.

use crate::machine::{Loom, LoomWord};
use crate::mutant::{self, Mutant, assert_caught};
use crate::schemes::set_up;
use crate::{Bounds, check};
use apportion::geometry::{Aabb, Rigid, Unit};
use apportion::job::collide::{BatchWork, Found, Pair, PairWork, contacts};
use apportion::machine::{Processor, Word};
use apportion::scheme::tree::TreeWork;
use apportion::structure::VolumeTree;
use glam::{DVec3, Vec3};
use std::sync::atomic::Ordering;

/// A query; on the broken machine, one that says it is over before its contact is found.
struct Asked<'a, W>(W, &'a LoomWord);

impl<W: TreeWork<Task = (u32, u32), Found = Found>> TreeWork for Asked<'_, W> {
    type Task = (u32, u32);
    type Found = Found;

    fn root(&self) -> Option<(u32, u32)> {
        self.0.root()
    }

    fn found(&self) -> Found {
        self.0.found()
    }

    fn visit<P: Processor>(
        &self,
        task: (u32, u32),
        found: &mut Found,
        cpu: &P,
        emit: impl FnMut((u32, u32)),
    ) {
        if mutant::is(Mutant::HastyStop) && task != (0, 0) {
            // ORDERING: as the store it comes too early for: the load of a later visit is the partner.
            self.1.store(1, Ordering::Relaxed);
        }
        self.0.visit(task, found, cpu, emit);
    }
}

/// Two triangles side by side, each a leaf under one root.
fn body() -> VolumeTree<Aabb> {
    let side = |x: f32| [Vec3::new(x, 0.0, 0.0), Vec3::new(x + 1.0, 0.0, 0.0), Vec3::new(x, 1.0, 0.0)];
    let corners = [side(0.0), side(2.0)].concat();
    VolumeTree::over_triangles(&corners, &[[0, 1, 2], [3, 4, 5]], 1).expect("two triangles")
}

/// How the other body is moved: both triangles are met, one is, none is though boxes overlap.
const MOTIONS: [DVec3; 3] = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.8, 0.8, 0.0)];

/// Asks once, of two processors.
fn asks(name: &str, motion: DVec3, in_batches: bool) {
    let machine = Loom::new();
    let mut scheme = set_up(name, &machine, None).expect("a scheme without settings");
    let (a, b, motion) = (body(), body(), Rigid::shift(motion));
    let expected = contacts(&a, &b, &motion, Default::default()).pairs;
    let pair = Pair::new(&a, &b, &motion, 0.0, Unit::best());
    let stop = LoomWord::new(0);
    let shares = if in_batches {
        scheme.run(&machine, &Asked(BatchWork::new(&pair, Some(&stop)), &stop))
    } else {
        scheme.run(&machine, &Asked(PairWork::new(&pair, Some(&stop)), &stop))
    };
    let shares = shares.expect("no panic");
    let found: Vec<_> = shares.iter().flat_map(|share| &share.found.pairs).collect();
    assert_eq!(found.is_empty(), expected.is_empty(), "{name}: found {found:?} of {expected:?}");
    assert!(found.iter().all(|pair| expected.contains(pair)), "{name}: found {found:?} of {expected:?}");
    assert!(shares.iter().all(|share| share.found.pairs.len() <= 1), "{name}: went on after a contact");
}

const SCHEMES: [&str; 2] = ["lock_free", "work_stealing"];

fn bounds() -> Bounds {
    Bounds { preemptions: 2, steps: 5_000 }
}

#[test]
fn a_contact_is_found_exactly_if_there_is_one() {
    for name in SCHEMES {
        for motion in MOTIONS {
            for in_batches in [false, true] {
                let executions = check(bounds(), move || asks(name, motion, in_batches));
                eprintln!("{name} {motion} {in_batches}: {executions} executions");
            }
        }
    }
}

#[test]
fn a_query_that_is_over_too_early_is_caught() {
    for name in SCHEMES {
        for in_batches in [false, true] {
            assert_caught(name, &[Mutant::HastyStop], bounds(), move || asks(name, MOTIONS[1], in_batches));
        }
    }
}
