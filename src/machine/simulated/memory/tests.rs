use super::Access::{Read, Write};
use super::*;

fn machine(lines: usize) -> (Model, Coherence) {
    let mut model = Model::named("e4000").unwrap();
    (model.l1_lines, model.l2_lines) = (4, 8);
    (model.l1_hit, model.l2_hit, model.memory) = (1, 8, 75);
    (model.cache_to_cache, model.upgrade, model.bus_occupancy) = (100, 50, 7);
    let mut coherence = Coherence::new();
    coherence.grow(&model, lines, 3);
    (model, coherence)
}

#[test]
fn each_kind_of_access_has_its_price() {
    let (model, mut c) = machine(4);
    let mut at = |p, line, access, now| c.access(&model, (p, line), access, now, 0).done - now;
    assert_eq!(at(0, 0, Read, 0), 75, "cold");
    assert_eq!(at(0, 0, Read, 1000), 1, "hit");
    assert_eq!(at(0, 0, Write, 2000), 1, "exclusive turns modified silently");
    assert_eq!(at(1, 0, Read, 3000), 100, "the dirty owner serves it");
    assert_eq!(at(2, 0, Read, 4000), 100, "and stays the owner");
    assert_eq!(at(1, 0, Write, 5000), 50, "upgrade of a shared copy");
    assert_eq!(at(0, 0, Read, 6000), 100, "the old owner lost its copy");
    assert_eq!(at(2, 0, Write, 7000), 100, "write miss");
}

#[test]
fn the_bus_and_the_line_are_handed_on_one_at_a_time() {
    let (model, mut c) = machine(4);
    assert_eq!(c.access(&model, (0, 0), Write, 0, 0).done, 75);
    // Same line: waits until processor 0 has it. Other line: waits for the bus only.
    assert_eq!(c.access(&model, (1, 0), Write, 0, 0).done, 75 + 100);
    assert_eq!(c.access(&model, (2, 1), Read, 0, 0).done, 7 + 7 + 75);
}

#[test]
fn small_caches_evict() {
    let (model, mut c) = machine(64);
    c.access(&model, (0, 0), Write, 0, 0);
    c.access(&model, (0, 4), Read, 1000, 0);
    assert_eq!(c.access(&model, (0, 0), Read, 2000, 0).done - 2000, 8, "out of the first level only");
    c.access(&model, (0, 8), Read, 3000, 0);
    assert_eq!(c.access(&model, (0, 0), Read, 4000, 0).done - 4000, 75, "out of the second level");
}

#[test]
fn growing_keeps_what_is_cached() {
    let (model, mut c) = machine(4);
    c.access(&model, (2, 3), Write, 0, 0);
    c.grow(&model, 1000, 200);
    assert!(c.access(&model, (2, 3), Write, 1000, 0).hit);
    assert_eq!(c.access(&model, (150, 3), Read, 2000, 0).done - 2000, 100);
}

/// Three nodes of one processor, each with a router, 0 one link from 1 and from 2; pages of four lines.
fn network(home: Home) -> (Model, Coherence) {
    let (mut model, mut coherence) = machine(0);
    model.processors = 3;
    model.network = Network {
        topology: Topology::Hypercube,
        home,
        page: 128,
        away: 100,
        hop: 10,
        message: 5,
        at_memory: 20,
        ..Network::default()
    };
    coherence.grow(&model, 64, 3);
    (model, coherence)
}

#[test]
fn a_miss_takes_longer_the_farther_it_has_to_go() {
    let (model, mut c) = network(Home::FirstTouch);
    let mut at = |p, line, access, now| c.access(&model, (p, line), access, now, 0).done - now;
    assert_eq!(at(2, 0, Read, 0), 75, "whoever is first has it at home");
    assert_eq!(at(0, 1, Read, 1000), 75 + 110, "the same page, one link away");
    assert_eq!(at(1, 2, Read, 2000), 75 + 120, "two links away");
    assert_eq!(at(0, 0, Read, 3000), 75 + 110);
    assert_eq!(
        at(0, 0, Write, 4000),
        50 + 110,
        "an upgrade asks the directory, which tells processor 2 at home"
    );
    assert_eq!(at(1, 0, Read, 5000), 100 + (120 + 110 + 110) / 2, "to the home, to the owner, and back");
    assert_eq!(at(2, 0, Read, 6000), 75, "the line has gone home clean");
    assert_eq!(
        at(0, 0, Write, 7000),
        50 + 110 + 120,
        "the farther of the two who are told is two links away"
    );
}

#[test]
fn a_home_serves_one_request_after_the_other_and_two_homes_two() {
    let (model, mut c) = network(Home::Interleaved);
    let mut at = |p, line, access, now| c.access(&model, (p, line), access, now, 0).done - now;
    // Line 0 lies with node 0, line 4 with node 1, line 8 with node 2, line 12 with node 0 again.
    assert_eq!(at(0, 0, Read, 0), 75);
    assert_eq!(at(0, 1, Read, 0), 75 + 7, "after the one before");
    assert_eq!(at(1, 4, Read, 0), 75, "another home is free");
    assert_eq!(at(0, 12, Read, 0), 75 + 14);
    assert_eq!(at(0, 8, Read, 1000), 75 + 110);
    // A write that two others are told of keeps the home busy for two messages longer.
    assert_eq!(at(1, 8, Read, 2000), 75 + 120);
    assert_eq!(at(2, 8, Write, 3000), 75 + 120);
    assert_eq!(at(2, 9, Read, 3000), 75 + 7 + 2 * 5);
}

#[test]
fn an_operation_at_memory_leaves_no_copies() {
    let (model, mut c) = network(Home::Interleaved);
    assert_eq!(c.at_memory(&model, (0, 0), 0).done, 75);
    assert_eq!(c.at_memory(&model, (0, 0), 0).done, 75 + 20, "after the one before");
    assert_eq!(c.at_memory(&model, (1, 0), 1000).done, 1000 + 75 + 110);
    assert_eq!(c.access(&model, (2, 0), Read, 2000, 0).done, 2000 + 75 + 110);
    assert!(c.access(&model, (2, 0), Read, 3000, 0).hit);
    assert_eq!(c.at_memory(&model, (0, 0), 4000).done, 4000 + 75 + 110, "processor 2 is told");
    assert!(!c.access(&model, (2, 0), Read, 5000, 0).hit);
    c.access(&model, (1, 0), Write, 6000, 0);
    assert_eq!(
        c.at_memory(&model, (0, 0), 7000).done,
        7000 + 100 + 110 + 75,
        "the dirty line is fetched first"
    );
}
