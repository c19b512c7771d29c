use proptest::prelude::*;

use super::*;

/// Twice the area of a polygon seen along z, exactly enough for small whole numbers.
fn area(corners: &[Vec3]) -> f64 {
    let ring = corners.iter().zip(corners.iter().cycle().skip(1));
    ring.map(|(a, b)| f64::from(a.x) * f64::from(b.y) - f64::from(a.y) * f64::from(b.x)).sum()
}

fn polygon(points: &[(i32, i32)]) -> Vec<Vec3> {
    points.iter().map(|(x, y)| Vec3::new(*x as f32, *y as f32, 0.0)).collect()
}

/// As many triangles as there must be, none turned over, all corners used, and together as large as the polygon: for
/// one that does not cross itself no set of triangles is so that does not cover it once.
fn check(corners: &[Vec3]) {
    let outline = triangulate(corners).unwrap();
    assert_eq!(outline.triangles.len(), corners.len() - 2);
    assert!(!outline.is_crossed, "{corners:?}");
    let areas =
        outline.triangles.iter().map(|triangle| area(&triangle.map(|corner| corners[corner as usize])));
    let (sign, whole) = (area(corners).signum(), area(corners));
    let areas: Vec<f64> = areas.collect();
    assert!(areas.iter().all(|area| area * sign >= 0.0), "{corners:?}: {areas:?}");
    assert_eq!(areas.iter().sum::<f64>(), whole, "{corners:?}: {:?}", outline.triangles);
    let mut used: Vec<u32> = outline.triangles.concat();
    used.sort_unstable();
    used.dedup();
    assert_eq!(used.len(), corners.len(), "{corners:?}");
}

/// Also turned over, and begun at every corner.
fn check_all_ways(points: &[(i32, i32)]) {
    let mut corners = polygon(points);
    for _ in 0..2 {
        for _ in 0..corners.len() {
            check(&corners);
            corners.rotate_left(1);
        }
        corners.reverse();
    }
}

#[test]
fn polygons_of_all_kinds_are_covered_once() {
    for points in [
        &[(0, 0), (4, 0), (4, 3), (0, 3)][..],
        // An arrow head, whose first diagonal lies outside.
        &[(0, 0), (4, 4), (0, 8), (2, 4)],
        // Corners on straight edges, and some twice.
        &[(0, 0), (2, 0), (4, 0), (4, 2), (4, 4), (2, 4), (0, 4), (0, 2)],
        &[(0, 0), (4, 0), (4, 0), (4, 4), (0, 4), (0, 4)],
        // A star, a comb, a spiral.
        &[(0, 5), (-1, 1), (-5, 0), (-1, -1), (0, -5), (1, -1), (5, 0), (1, 1)],
        &[(0, 0), (9, 0), (9, 5), (8, 1), (7, 5), (6, 1), (5, 5), (4, 1), (3, 5), (2, 1), (1, 5)],
        &[
            (0, 0),
            (9, 0),
            (9, 9),
            (1, 9),
            (1, 3),
            (6, 3),
            (6, 6),
            (3, 6),
            (3, 5),
            (5, 5),
            (5, 4),
            (2, 4),
            (2, 8),
            (8, 8),
            (8, 1),
            (0, 1),
        ],
        // A square with a square hole, which a cut leads to and back from.
        &[(0, 0), (9, 0), (9, 9), (0, 9), (0, 0), (3, 3), (3, 6), (6, 6), (6, 3), (3, 3)],
        // It touches itself in a corner, and on an edge.
        &[(0, 0), (4, 0), (2, 2), (4, 4), (0, 4), (2, 2)],
        &[(0, 0), (8, 0), (8, 4), (4, 0), (0, 4)],
        // A spike that leads nowhere.
        &[(0, 0), (4, 0), (4, 4), (8, 4), (4, 4), (0, 4)],
    ] {
        check_all_ways(points);
    }
}

#[test]
fn what_crosses_itself_or_has_no_area_ends() {
    for (points, is_crossed) in [
        (&[(0, 0), (4, 4), (4, 0), (0, 4)][..], true),
        (&[(0, 5), (3, -4), (-5, 2), (5, 2), (-3, -4)], true),
        (&[(0, 0), (1, 0), (2, 0), (3, 0), (1, 0)], false),
        (&[(2, 2), (2, 2), (2, 2), (2, 2)], false),
        (&[(0, 0), (4, 0), (0, 0), (4, 0), (0, 0)], false),
    ] {
        let outline = triangulate(&polygon(points)).unwrap();
        assert_eq!(
            (outline.triangles.len(), outline.is_crossed),
            (points.len() - 2, is_crossed),
            "{points:?}"
        );
    }
}

#[test]
fn the_normal_tells_the_side_in_space_and_far_away() {
    let arrow = [[0.0, 0.0], [4.0, 4.0], [0.0, 8.0], [2.0, 4.0]];
    for far in [0.0, 1e6] {
        for place in [
            |[x, y]: [f32; 2], far: f32| Vec3::new(x, y, 0.1 * x) + far,
            |[x, y]: [f32; 2], far: f32| Vec3::new(x, 0.1 * y, y) + far,
            |[x, y]: [f32; 2], far: f32| Vec3::new(0.2 * x, x, y) + far,
        ] {
            let corners: Vec<Vec3> = arrow.iter().map(|point| place(*point, far)).collect();
            let outline = triangulate(&corners).unwrap();
            assert!(!outline.is_crossed);
            let has_diagonal = |triangle: &[u32; 3]| triangle.contains(&1) && triangle.contains(&3);
            assert!(outline.triangles.iter().all(has_diagonal), "{:?}", outline.triangles);
        }
    }
}

#[test]
fn concave_polygons_with_very_many_corners_are_cut_in_time_or_refused() {
    // A spiral, whose ears are few at any time.
    let spiral = |turns: i32| {
        let ring = |at: i32, inset: i32| {
            let radius = at * 4 + inset;
            [(-radius, -radius), (radius, -radius), (radius, radius), (-radius - 4, radius)]
        };
        let outward = (1..turns).flat_map(|at| ring(at, 0));
        let inward = (1..turns).rev().flat_map(|at| ring(at, 1).into_iter().rev());
        polygon(&outward.chain(inward).collect::<Vec<_>>())
    };
    check(&spiral(50));
    assert_eq!(triangulate(&spiral(1000)).unwrap().triangles.len(), 8 * 999 - 2);
    assert!(triangulate(&spiral(3000)).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// About a point, in the order of their directions: such corners make a polygon that does not cross itself.
    #[test]
    fn stars_are_covered_once(points in prop::collection::vec((-9i32..10, -9i32..10), 3..24)) {
        let mut points: Vec<(i32, i32)> = points.into_iter().filter(|point| *point != (0, 0)).collect();
        points.sort_by(|a, b| {
            let half = |p: &(i32, i32)| p.1 < 0 || (p.1 == 0 && p.0 < 0);
            half(a).cmp(&half(b)).then((b.0 * a.1).cmp(&(a.0 * b.1)))
        });
        // One in each direction, and less than half a turn from one to the next.
        points.dedup_by(|a, b| a.0 * b.1 == a.1 * b.0 && a.0 * b.0 + a.1 * b.1 > 0);
        let ring = points.iter().zip(points.iter().cycle().skip(1));
        prop_assume!(points.len() > 2 && ring.clone().all(|(a, b)| a.0 * b.1 - a.1 * b.0 > 0));
        check_all_ways(&points);
    }

    #[test]
    fn any_corners_give_their_triangles(points in prop::collection::vec((-3i32..4, -3i32..4), 3..40)) {
        let outline = triangulate(&polygon(&points)).unwrap();
        prop_assert_eq!(outline.triangles.len(), points.len() - 2);
    }
}
