use super::*;
use crate::geometry::oracle::Hexahedron;
use crate::machine::simulated::Model;
use crate::machine::{Simulated, Threads};
use crate::scheme::tiles::{SCHEMES, Scheme};
use crate::structure::cull;
use std::collections::BTreeMap;

fn tree(count: usize) -> BoxTree {
    BoxTree::build(&random_boxes(count, 7))
}

/// Runs every scheme the machine takes, in every way, and compares the masks.
fn hold<M: Machine>(machine: &M, processors: usize, tree: &BoxTree) {
    let mut field = BoxField::<M>::new(machine, tree, true);
    assert!(field.bytes() >= 24 * field.len() && field.is_empty() == tree.boxes().is_empty());
    for (number, share) in [20.0, 55.0].into_iter().enumerate() {
        let camera = camera(tree.boxes(), number, share);
        let frustum = Frustum::new(&camera);
        let flat = cull(tree.boxes(), &frustum);
        let one_by_one = plain(tree.boxes(), &frustum);
        for about in SCHEMES.iter().filter(|about| machine.is_native() || !about.native_only) {
            for (way, expected) in [(Way::Flat, &flat), (Way::Hierarchy, &flat), (Way::Plain, &one_by_one)] {
                let test = BoxTest::new(&frustum);
                let mut scheme = Scheme::new(about.name, machine, processors, BTreeMap::new()).unwrap();
                let frame = Frame::new(&field, way, &frustum, test, Costs::default());
                scheme.run(machine, &frame).unwrap();
                assert_eq!(field.mask(), *expected, "{} {way:?} {}", about.name, tree.boxes().len());
                // Reading leaves the mask as it is.
                let frame = Frame::new(&field, Way::Stream, &frustum, test, Costs::default());
                scheme.run(machine, &frame).unwrap();
                assert_eq!(field.mask(), *expected);
            }
        }
    }
}

#[test]
fn every_scheme_machine_and_way_finds_the_flat_mask() {
    for count in [0, 1, 64, 500, 512, 4096, 9000] {
        let tree = tree(count);
        hold(&Threads::new(3).unwrap(), 3, &tree);
        let e4000 = Simulated::new(Model::named("e4000").unwrap());
        hold(&e4000, 1, &tree);
        hold(&e4000, 6, &tree);
    }
}

#[test]
fn cameras_see_as_much_as_asked_and_nothing_visible_is_lost() {
    let tree = tree(5000);
    for (frame, visible) in [(0, 20.0), (1, 0.0), (5, 50.0), (17, 100.0), (40, 1.0)] {
        let camera = camera(tree.boxes(), frame, visible);
        let (frustum, oracle) = (Frustum::new(&camera), Hexahedron::new(&camera));
        let (seen, careful) = (cull(tree.boxes(), &frustum), plain(tree.boxes(), &frustum));
        assert!((seen.count() as f64 - 50.0 * visible).abs() <= 3.0, "{visible}: {}", seen.count());
        for i in 0..5000 {
            assert!(seen.get(i) || !oracle.intersects(&tree.boxes().get(i)));
            assert!(careful.get(i) || !seen.get(i), "the plain test is the more cautious one");
        }
    }
}

/// What a simulated machine is charged: a kernel's time for each block, and the lines of its memory.
#[test]
fn a_simulated_machine_pays_for_boxes_and_for_their_memory() {
    let model = Model::named("e4000").unwrap();
    let tree = tree(4096);
    let camera = camera(tree.boxes(), 0, 20.0);
    let frustum = Frustum::new(&camera);
    let time = |way, kernel: &str| {
        let machine = Simulated::new(model.clone());
        let field = BoxField::new(&machine, &tree, false);
        let costs = Costs::measured_on(&model, kernel).unwrap();
        let mut scheme = Scheme::new("serial", &machine, 1, BTreeMap::new()).unwrap();
        let before = machine.now();
        scheme.run(&machine, &Frame::new(&field, way, &frustum, BoxTest::new(&frustum), costs)).unwrap();
        (machine.now() - before, machine.charged().unwrap())
    };
    let ((stream, read), (flat, tested)) = (time(Way::Stream, "scalar"), time(Way::Flat, "scalar"));
    assert_eq!((read, tested), (0, 64 * Costs::measured_on(&model, "scalar").unwrap().block()));
    let lines = 4096 * 24 / model.line_bytes as u64;
    assert!(stream >= lines * model.memory, "{stream} cycles for {lines} lines");
    assert!(flat >= tested + lines * model.memory);
    assert!(time(Way::Hierarchy, "scalar").0 < flat && time(Way::Flat, "avx2").0 < flat);
    assert_eq!(Costs::measured_on(&model, "avx512"), None);
}
