use super::*;
use crate::geometry::Aabb;
use crate::machine::Threads;
use crate::machine::simulated::{Model, Simulated};
use crate::scheme::tiles::SCHEMES;
use crate::structure::bvh::BinaryBvh;
use crate::structure::bvh::build::phased::{Alone, Phased, Way};
use crate::structure::bvh::build::{Builder, Input, Settings};
use crate::structure::bvh::refit::Refitted;
use glam::Vec3;
use std::sync::Mutex;

fn boxes(count: usize, turn: usize) -> Vec<Aabb> {
    let at =
        |i: usize| Vec3::new((i * 7919 % 1009) as f32, (i * 104_729 % 997) as f32, (i * turn % 883) as f32);
    (0..count).map(at).map(|at| Aabb { min: at, max: at + 2.5 }).collect()
}

/// Every scheme and way on a machine, held against a team of one.
fn same_everywhere<M: Machine>(machine: &M, processors: usize) {
    let boxes = boxes(20_000, 1_299_709);
    for (name, way) in Way::ALL {
        let mut builder = Phased::new(way, &Settings::default()).unwrap();
        let mut expected = BinaryBvh::default();
        builder.build(&Input::of(&boxes), &mut expected, &mut Alone).unwrap();
        expected.validate(&boxes).unwrap();
        for about in SCHEMES.iter().filter(|about| machine.is_native() || !about.native_only) {
            let processors = if about.name == "serial" { 1 } else { processors };
            let mut scheme = Scheme::new(about.name, machine, processors, Default::default()).unwrap();
            let mut bvh = BinaryBvh::default();
            let costs = Model::named("e4000").map(|model| Costs::measured_on(&model)).unwrap();
            let mut crew = Crew::new(machine, &mut scheme, processors).charging(costs);
            builder.build(&Input::of(&boxes), &mut bvh, &mut crew).unwrap();
            assert_eq!(bvh, expected, "{name} by {}", about.name);
            let mut bad = boxes.clone();
            bad[12_345].max.x = f32::NAN;
            let error = builder.build(&Input::of(&bad), &mut bvh, &mut crew).unwrap_err().to_string();
            assert!(error.contains("12345"), "{error}");
        }
    }
}

fn refitted_everywhere<M: Machine>(machine: &M, processors: usize) {
    for count in [0, 1, 2, 9, 3000] {
        let (before, after) = (boxes(count, 3), boxes(count, 1_299_709));
        let mut bvh = BinaryBvh::default();
        Builder::new("binned_sah", &Settings::default())
            .unwrap()
            .build(&Input::of(&before), &mut bvh)
            .unwrap();
        let mut expected = bvh.clone();
        crate::structure::bvh::refit::refit(&mut expected, &after);
        let job = Refit::new(machine, processors, SUBTREES, &bvh);
        for _ in 0..3 {
            let renewed = Mutex::new(vec![0; 50]);
            let renew = |piece: usize| {
                renewed.lock().unwrap()[piece] += 1;
                1
            };
            job.run(machine, &mut bvh, |item| after[item as usize], 50, renew).unwrap();
            assert_eq!(bvh, expected, "{count} items");
            assert_eq!(renewed.into_inner().unwrap(), [1; 50], "each piece once");
        }
    }
}

#[test]
fn a_hierarchy_built_by_threads_is_the_same() {
    let machine = Threads::new(4).unwrap();
    for processors in [1, 2, 4] {
        same_everywhere(&machine, processors);
    }
}

#[test]
fn a_hierarchy_built_by_simulated_processors_is_the_same() {
    same_everywhere(&Simulated::new(Model::named("e4000").unwrap()), 7);
}

#[test]
fn refitting_is_the_same_on_every_machine() {
    let threads = Threads::new(3).unwrap();
    for processors in [1, 2, 3] {
        refitted_everywhere(&threads, processors);
    }
    refitted_everywhere(&Simulated::new(Model::named("e4000").unwrap()), 7);
}

/// Ticks that building takes so many simulated processors; and what it charges one that builds in one piece.
fn ticks(way: Way, boxes: &[Aabb], processors: usize) -> (u64, u64) {
    let model = Model::named("opteron16").unwrap();
    let costs = Costs::measured_on(&model);
    let machine = Simulated::new(model);
    let mut scheme = Scheme::new("fixed_tiles", &machine, processors, Default::default()).unwrap();
    let mut builder = Phased::new(way, &Settings::default()).unwrap();
    let mut bvh = BinaryBvh::default();
    let effort = builder.build_alone(&Input::of(boxes), &mut bvh).unwrap();
    let mut crew = Crew::new(&machine, &mut scheme, processors).charging(costs);
    builder.build(&Input::of(boxes), &mut bvh, &mut crew).unwrap();
    (machine.now(), costs.of_building(&effort))
}

#[test]
fn what_building_does_is_charged() {
    let boxes = boxes(50_000, 1_299_709);
    for (name, way) in Way::ALL {
        let ((one, whole), (eight, _)) = (ticks(way, &boxes, 1), ticks(way, &boxes, 8));
        assert!(one > whole / 2 && one < whole * 2, "{name}: {one} ticks in phases, {whole} in one piece");
        // A grid has more cells than there are items for each of eight.
        assert!(eight < one * 2 / 3 && eight > one / 8, "{name}: {eight} ticks by eight, {one} by one");
    }
}

#[test]
fn what_refitting_does_is_charged() {
    let boxes = boxes(50_000, 3);
    let model = Model::named("opteron16").unwrap();
    let costs = Costs::measured_on(&model);
    let mut bvh = BinaryBvh::default();
    Builder::new("binned_sah", &Settings::default()).unwrap().build(&Input::of(&boxes), &mut bvh).unwrap();
    let mut ticks = |processors| {
        let machine = Simulated::new(model.clone());
        let job = Refit::new(&machine, processors, SUBTREES, &bvh).charging(costs);
        job.run(&machine, &mut bvh, |item| boxes[item as usize], 50, |_| 1000).unwrap();
        machine.now()
    };
    let (one, eight) = (ticks(1), ticks(8));
    let done = Refitted { nodes: 50_000, items: 50_000 };
    assert!(one > costs.of_refitting(&done) + costs.of_renewing(50_000), "{one} ticks");
    assert!(eight < one / 4 && eight > one / 8, "{eight} ticks by eight, {one} by one");
}
