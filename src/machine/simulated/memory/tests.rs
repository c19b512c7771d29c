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
