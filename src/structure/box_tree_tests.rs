use super::*;
use crate::geometry::{Camera, Lens};
use crate::structure::cull;
use proptest::prelude::*;

fn cameras() -> Vec<Frustum> {
    let lens = Lens::Symmetric { fov_y: 0.8, aspect: 1.3 };
    let at = |eye: Vec3, look: Vec3, far| {
        Frustum::new(&Camera::look_at(eye, look, Vec3::Y, lens, 0.1, far).unwrap())
    };
    let close = at(Vec3::new(2.0, 1.0, -3.0), Vec3::new(-5.0, 2.0, 4.0), 30.0);
    vec![at(Vec3::splat(-40.0), Vec3::ZERO, 500.0), at(Vec3::ZERO, Vec3::X, 15.0), close]
}

/// The tree is one of these boxes, and its mask that of the flat kernel; says how many blocks that took.
fn hold(all: &[Aabb]) -> u64 {
    let tree = BoxTree::build(all);
    let mut seen = vec![false; all.len()];
    for (place, &i) in tree.order().iter().enumerate() {
        assert!(!std::mem::replace(&mut seen[i as usize], true), "box {i} twice");
        let kept = BoxBlock::of([&all[i as usize]]).get(0);
        // As text, in which a NaN is itself.
        assert_eq!(format!("{:?}", tree.boxes().get(place)), format!("{kept:?}"));
    }
    assert_eq!(tree.order().len(), all.len());
    let mut tested = 0;
    for frustum in cameras() {
        let flat = cull(tree.boxes(), &frustum);
        assert_eq!(tree.cull(&frustum), flat, "{} boxes", all.len());
        // In parts, over words that held something else.
        let mut words = vec![0x5555_5555_5555_5555; flat.words().len()];
        let view = tree.view();
        let (half, groups) = (view.groups.len() / 2, view.groups.len());
        let (left, right) = words.split_at_mut(half * BoxBlock::LEN);
        let test = BoxTest::new(&frustum);
        let mut count = |looked| tested += u64::from(matches!(looked, Looked::Block(_)));
        view.cull_groups(&frustum, &test, 0..half, left, &mut count);
        view.cull_groups(&frustum, &test, half..groups, right, &mut count);
        assert_eq!(words, flat.words());
    }
    tested
}

fn cube(centre: Vec3, half: f32) -> Aabb {
    Aabb { min: centre - half, max: centre + half }
}

fn grid(side: u32) -> Vec<Aabb> {
    let at = |i: u32| {
        Vec3::new((i % side) as f32, (i / side % side) as f32, (i / side / side) as f32) - side as f32 / 2.0
    };
    (0..side * side * side).map(|i| cube(at(i), 0.3)).collect()
}

#[test]
fn few_boxes_and_boxes_all_alike() {
    for count in [0, 1, 2, 63, 64, 65, 128, 4095, 4096, 4097, 8200] {
        hold(&vec![cube(Vec3::new(3.0, 0.0, 0.0), 1.0); count]);
        hold(&vec![Aabb::EMPTY; count]);
        hold(&vec![cube(Vec3::NAN, 1.0); count]);
    }
}

#[test]
fn odd_boxes_among_others() {
    let mut all = grid(24);
    for i in (0..all.len()).step_by(97) {
        all[i] = match i / 97 % 6 {
            0 => Aabb::EMPTY,
            1 => cube(Vec3::NAN, 1.0),
            2 => Aabb { min: all[i].min, max: Vec3::INFINITY },
            3 => cube(Vec3::splat(1e30), 1e20),
            4 => cube(Vec3::splat(f32::MAX), 0.0),
            _ => Aabb { min: Vec3::splat(f32::MIN), max: Vec3::splat(f32::MAX) },
        };
    }
    hold(&all);
}

/// What it is for: of boxes in a hall, and of the same with one far away, a few blocks need a look.
#[test]
fn most_blocks_are_settled_by_the_boxes_around_them() {
    let mut all = grid(32);
    let looked_at = hold(&all);
    let blocks = 3 * (all.len() / BoxBlock::LEN) as u64;
    assert!(looked_at * 2 < blocks, "{looked_at} of {blocks}");
    all.push(cube(Vec3::new(1e9, -1e9, 1e9), 1.0));
    assert!(hold(&all) < looked_at * 5 / 4 + 3);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_mask_is_the_flat_one(
        boxes in prop::collection::vec((-20.0f32..20.0, -9.0f32..9.0, -20.0f32..20.0, 0.0f32..6.0), 0..9000),
        far in prop_oneof![Just(0.0f32), Just(1e6)],
    ) {
        let all: Vec<Aabb> = boxes.iter().map(|&(x, y, z, half)| cube(Vec3::new(x, y, z) + far, half)).collect();
        hold(&all);
    }
}
