//! Two volumes with a point in common are never apart, and oriented boxes that are apart by a margin are told so: held
//! against separating axes in f64.

use super::*;
use crate::geometry::{Aabb, KDop, Obb, Sphere, Volume};
use glam::{DQuat, DVec3};
use proptest::prelude::*;

/// Points of a body: a few, perhaps flat, small or large.
fn points() -> impl Strategy<Value = Vec<Vec3>> {
    let point = (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0).prop_map(Vec3::from);
    let flat =
        prop_oneof![Just(Vec3::ONE), Just(Vec3::new(1.0, 1.0, 0.0)), Just(Vec3::X), Just(Vec3::splat(1e-6))];
    let scale = prop_oneof![Just(1.0f32), Just(1e-4), Just(1e5)];
    (prop::collection::vec(point, 1..20), flat, scale)
        .prop_map(|(points, flat, scale)| points.into_iter().map(|point| point * flat * scale).collect())
}

fn turn() -> impl Strategy<Value = DQuat> {
    let axis = (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64).prop_map(DVec3::from);
    // Small turns and right angles: axes that are parallel, all but or quite.
    let angle = prop_oneof![Just(0.0f64), Just(std::f64::consts::FRAC_PI_2), 0.0..1e-6f64, -3.2..3.2f64,];
    let axis = prop_oneof![axis, Just(DVec3::Y), Just(DVec3::Z)];
    (axis, angle)
        .prop_map(|(axis, angle)| DQuat::from_axis_angle(axis.try_normalize().unwrap_or(DVec3::X), angle))
}

/// The test one at a time and by eight on every unit: all say the same.
fn apart<V: Overlap>(a: &V, b: &V, way: &Way) -> bool {
    let moved = a.moved(way);
    let one = b.apart(&moved);
    let mut eight = V::Eight::UNUSED;
    eight.set(3, b);
    eight.set(5, a);
    let bits = u8::from(one) << 3 | u8::from(a.apart(&moved)) << 5;
    for unit in Unit::all() {
        assert_eq!(eight.apart(unit, &moved), bits, "{unit:?}: {a:?} {b:?}, an unused lane is not apart");
    }
    one
}

fn together<V: Overlap>(a: &[Vec3], b: &[Vec3], motion: &Rigid) -> Result<(), TestCaseError> {
    // The first point of `b` comes to lie on the last of `a`.
    let meeting = a[a.len() - 1].as_dvec3() - motion.point(b[0].as_dvec3());
    let motion = motion.then(&Rigid::shift(meeting));
    let (a, b) = (V::around(a), V::around(b));
    prop_assert!(!apart(&b, &a, &Way::new(&motion, 0.0)), "{a:?} {b:?} {motion:?}");
    prop_assert!(!apart(&a, &b, &Way::new(&motion.inverse(), 0.0)), "{a:?} {b:?} {motion:?}");
    // A little further off, but within reach.
    let off = motion.then(&Rigid::shift(DVec3::new(0.6, 0.0, -0.8) * 0.5));
    prop_assert!(!apart(&b, &a, &Way::new(&off, 0.5)), "{a:?} {b:?} {off:?}");
    Ok(())
}

/// Separating axes in f64: by how much the best of them separates, as a share of all extents.
fn gap(a: &Obb, b: &Obb, motion: &Rigid) -> f64 {
    let corners = |volume: &Obb| volume.corners().map(Vec3::as_dvec3);
    let (a_axes, b_axes) =
        (a.axes().map(Vec3::as_dvec3), b.axes().map(|axis| motion.rotation() * axis.as_dvec3()));
    let (a, b) = (corners(a), corners(b).map(|corner| motion.point(corner)));
    let crosses = a_axes.iter().flat_map(|u| b_axes.iter().map(|v| u.cross(*v)));
    let all: Vec<DVec3> = a_axes.iter().chain(&b_axes).copied().chain(crosses).collect();
    let size = a.iter().chain(&b).map(|corner| corner.distance(a[0])).fold(0.0, f64::max);
    let separates = |axis: &DVec3| {
        let ends = |corners: &[DVec3; 8]| {
            let along = corners.map(|corner| corner.dot(*axis));
            (
                along.into_iter().fold(f64::INFINITY, f64::min),
                along.into_iter().fold(f64::NEG_INFINITY, f64::max),
            )
        };
        let ((a_low, a_high), (b_low, b_high)) = (ends(&a), ends(&b));
        (b_low - a_high).max(a_low - b_high) / size
    };
    all.iter().map(separates).fold(f64::NEG_INFINITY, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_touches_is_never_apart(a in points(), b in points(), turn in turn()) {
        let motion = Rigid::new(turn, DVec3::ZERO);
        together::<Aabb>(&a, &b, &motion)?;
        together::<Obb>(&a, &b, &motion)?;
        together::<AlignedObb>(&a, &b, &motion)?;
        together::<Sphere>(&a, &b, &motion)?;
        together::<KDop<7>>(&a, &b, &motion)?;
        together::<KDop<9>>(&a, &b, &motion)?;
        together::<KDop<13>>(&a, &b, &motion)?;
    }

    #[test]
    fn oriented_boxes_find_every_separating_axis(
        a in points(), b in points(), turn in turn(), way in (-1.5..1.5f64, -1.5..1.5f64, -1.5..1.5f64),
    ) {
        let size = a.iter().chain(&b).map(|point| point.length()).fold(0.0, f32::max);
        let motion = Rigid::new(turn, DVec3::from(way) * f64::from(size));
        let (a, b) = (Obb::tight(&a), Obb::tight(&b));
        let gap = gap(&a, &b, &motion);
        let told = apart(&b, &a, &Way::new(&motion, 0.0));
        prop_assert!(told || gap < 1e-4, "a gap of {gap}: {a:?} {b:?} {motion:?}");
        prop_assert!(!told || gap > -1e-6, "overlapping by {gap}: {a:?} {b:?} {motion:?}");
    }
}

/// P2-F16: all nine cross products are zero, and what touches touches exactly.
#[test]
fn boxes_side_by_side() {
    let cube: Vec<Vec3> = Aabb { min: Vec3::ZERO, max: Vec3::ONE }.corners().into();
    for turn in [DQuat::IDENTITY, DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2)] {
        for (way, expected) in [(1.0, false), (0.5, false), (1.001, true), (50.0, true)] {
            let motion =
                Rigid::new(turn, DVec3::new(way, 0.3, if turn == DQuat::IDENTITY { 0.0 } else { 1.0 }));
            let cube = Obb::tight(&cube);
            assert_eq!(apart(&cube, &cube, &Way::new(&motion, 0.0)), expected, "{way} {turn}");
        }
    }
}

#[test]
fn huge_ones_and_no_numbers_are_not_apart() {
    let huge = Obb::tight(&[Vec3::splat(3e38), Vec3::splat(-3e38)]);
    let way = Way::new(&Rigid::shift(DVec3::X * 3e38), 0.0);
    assert!(!apart(&huge, &huge, &way));
    let odd = Obb::tight(&[Vec3::NAN]);
    assert!(!apart(&odd, &Obb::tight(&[Vec3::ONE]), &way));
    assert!(!apart(&Aabb::around(&[Vec3::NAN, Vec3::X]), &Aabb::around(&[Vec3::ONE]), &way));
    assert!(!apart(&AlignedObb::around(&[Vec3::NAN, Vec3::X]), &AlignedObb::around(&[Vec3::ONE]), &way));
    // Squares of which f32 keeps a bit or none.
    for size in [1e-19, 3e-22, 1.1e-23, 1e-40] {
        let (one, other) = (Vec3::new(1.0, 0.7, -0.9) * size, Vec3::new(-0.8, 1.0, 0.6) * size);
        let [a, b] = [[Vec3::ZERO, one], [one, one + other]].map(|points| Sphere::of_points(&points));
        assert!(!apart(&a, &b, &Way::new(&Rigid::IDENTITY, 0.0)), "{size}");
    }
    let unit = Sphere::of_points(&[Vec3::ZERO, Vec3::X]);
    assert!(!apart(&Sphere::of_points(&[Vec3::splat(3e38)]), &unit, &way));
}
