//! What was held is held after any transform, without tolerance; and what comes out is not much larger.

use glam::{DMat3, DQuat, DVec3};
use proptest::prelude::*;

use super::*;
use crate::geometry::oracle::Exact;

/// Whether a volume holds a point, exactly.
trait Holds: Exact + Movable {
    fn of(points: &[Vec3]) -> Self;
    fn holds(&self, point: DVec3) -> bool;
}

impl Holds for Aabb {
    fn of(points: &[Vec3]) -> Self {
        Aabb::of_points(points.iter().copied())
    }
    fn holds(&self, point: DVec3) -> bool {
        point.cmpge(self.min.as_dvec3()).all() && point.cmple(self.max.as_dvec3()).all()
    }
}

impl Holds for Sphere {
    fn of(points: &[Vec3]) -> Self {
        Sphere::of_points(points)
    }
    fn holds(&self, point: DVec3) -> bool {
        point.distance(self.centre.as_dvec3()) <= f64::from(self.radius)
    }
}

impl Holds for Obb {
    fn of(points: &[Vec3]) -> Self {
        Obb::of_points(points, &[])
    }
    fn holds(&self, point: DVec3) -> bool {
        let [x, y, z] = self.axes.map(Vec3::as_dvec3);
        let at = DMat3::from_cols(x, y, z).inverse() * (point - self.centre.as_dvec3());
        // Taking the middle away rounds in double precision.
        at.abs().cmple(self.half.as_dvec3() * (1.0 + 1e-14) + 1e-14 * point.abs().max_element()).all()
    }
}

impl<const D: usize> Holds for KDop<D> {
    fn of(points: &[Vec3]) -> Self {
        KDop::of_points(points)
    }
    fn holds(&self, point: DVec3) -> bool {
        self.slabs().all(|(direction, low, high)| {
            let at = direction.as_dvec3().dot(point);
            (f64::from(low)..=f64::from(high)).contains(&at)
        })
    }
}

fn point() -> impl Strategy<Value = Vec3> {
    let axis = prop_oneof![4 => -10.0f32..10.0, 1 => Just(1.0f32), 1 => -1e-6f32..1e-6];
    (axis.clone(), axis.clone(), axis).prop_map(Vec3::from)
}

fn points() -> impl Strategy<Value = Vec<Vec3>> {
    let from = prop_oneof![3 => Just(Vec3::ZERO), 1 => Just(Vec3::new(3e6, -1e5, 7e6))];
    (prop::collection::vec(point(), 1..20), from)
        .prop_map(|(points, from)| points.into_iter().map(|point| point + from).collect())
}

fn turn() -> impl Strategy<Value = DQuat> {
    let part = || -1.0f64..1.0;
    (part(), part(), part(), part())
        .prop_filter_map("a turn", |(x, y, z, w)| DVec3::new(x, y, z).try_normalize().map(|axis| (axis, w)))
        .prop_map(|(axis, w)| DQuat::from_axis_angle(axis, w * 4.0))
}

/// Rigid motions, and what a scene may hold as well: mirrored, stretched, flattened to nothing.
fn transform() -> impl Strategy<Value = DAffine3> {
    let size = prop_oneof![Just(1.0f64), Just(-1.0), Just(0.0), 0.001f64..100.0];
    let scale = prop_oneof![
        3 => Just(DVec3::ONE),
        1 => (size.clone(), size.clone(), size).prop_map(|(x, y, z)| DVec3::new(x, y, z)),
    ];
    let way = prop_oneof![(-10.0f64..10.0).boxed(), (-1e7f64..1e7).boxed()];
    (turn(), scale, (way.clone(), way.clone(), way), turn()).prop_map(|(turn, scale, way, skew)| {
        let matrix3 = DMat3::from_quat(turn) * DMat3::from_diagonal(scale) * DMat3::from_quat(skew);
        DAffine3 { matrix3, translation: DVec3::from(way) }
    })
}

fn follows<V: Holds>(points: &[Vec3], by: &DAffine3) -> Result<(), TestCaseError> {
    let (rest, exact) = (V::of(points), |point: &Vec3| by.transform_point3(point.as_dvec3()));
    let moved = rest.moved(by);
    for point in points.iter().filter(|point| rest.holds(point.as_dvec3())) {
        prop_assert!(moved.holds(exact(point)), "{rest:?} moved to {moved:?} lost {point}");
    }
    let halves = [&points[..points.len() / 2], &points[points.len() / 2..]];
    let parts = halves.map(|half| V::of(half).moved(by)).into_iter().filter(|part| !part.is_empty());
    let around = moved.around(parts.clone());
    for part in parts {
        for corner in points.iter().map(exact).filter(|point| part.holds(*point)) {
            prop_assert!(around.holds(corner), "{around:?} around {part:?} lost {corner}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn what_was_held_is_held_after_any_transform(points in points(), by in transform()) {
        follows::<Aabb>(&points, &by)?;
        follows::<Sphere>(&points, &by)?;
        follows::<Obb>(&points, &by)?;
        follows::<KDop<7>>(&points, &by)?;
        follows::<KDop<9>>(&points, &by)?;
        follows::<KDop<13>>(&points, &by)?;
    }

    #[test]
    fn a_rigid_motion_hardly_grows_spheres_and_oriented_boxes(
        points in prop::collection::vec(point(), 1..20), turn in turn(),
    ) {
        let by = DAffine3::from_rotation_translation(turn, DVec3::new(3.0, -2.0, 5.0));
        let (sphere, oriented) = (Sphere::of(&points), Obb::of(&points));
        prop_assert!(sphere.moved(&by).radius <= sphere.radius + 1e-5);
        prop_assert!(oriented.moved(&by).half.cmple(oriented.half + 1e-4).all());
        let by = DAffine3::from_translation(DVec3::new(0.5, 2.0, -8.0));
        let (bounds, dop) = (Aabb::of(&points), KDop::<13>::of(&points));
        prop_assert!(bounds.moved(&by).size().cmple(bounds.size() + 1e-4).all());
        for ((_, low, high), (_, new_low, new_high)) in dop.slabs().zip(dop.moved(&by).slabs()) {
            prop_assert!(new_high - new_low <= high - low + 1e-3, "{dop:?}");
        }
    }
}

fn odd_ends<V: Holds>() {
    let empty = V::of(&[]);
    assert!(empty.is_empty() && empty.moved(&DAffine3::from_translation(DVec3::ONE)).is_empty());
    let rest = V::of(&[Vec3::ZERO, Vec3::ONE, Vec3::new(0.0, 2.0, 0.5), Vec3::X]);
    for way in [f64::NAN, f64::INFINITY, -1e39, 1e150] {
        let moved = rest.moved(&DAffine3::from_translation(DVec3::new(0.0, way, 0.0)));
        assert!(moved.is_nan() && !moved.is_empty(), "{way}: {moved:?}");
        let around = rest.around([rest, moved, rest].into_iter());
        assert!(around.is_nan() && !around.is_empty(), "{around:?}");
        assert!(!rest.around([rest, rest].into_iter()).is_nan());
        assert!(around.around([rest, rest].into_iter()).holds(DVec3::ONE * 0.5), "it is found again");
    }
    assert!(V::of(&[Vec3::NAN]).moved(&DAffine3::IDENTITY).is_nan());
    let large = rest.moved(&DAffine3::from_translation(DVec3::splat(1e15)));
    assert!(large.holds(DVec3::splat(1e15)) && large.radius() < 1e10);
}

#[test]
fn nowhere_spreads_and_heals() {
    odd_ends::<Aabb>();
    odd_ends::<Sphere>();
    odd_ends::<Obb>();
    odd_ends::<KDop<7>>();
    odd_ends::<KDop<9>>();
    odd_ends::<KDop<13>>();
}
