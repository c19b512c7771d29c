//! Properties of the kernels, held against the oracle without any tolerance.

use glam::Vec3;
use proptest::prelude::*;

use super::*;
use crate::geometry::oracle::Hexahedron;
use crate::geometry::{Camera, Lens};

fn verdicts(bounds: &Aabb, frustum: &Frustum) -> Vec<(String, Verdict)> {
    let mut all = vec![("basic".to_string(), basic(bounds, frustum))];
    for first in 0..PLANE_COUNT as u8 {
        all.push((format!("from plane {first}"), from_plane(bounds, frustum, first)));
    }
    if let Some(octant) = OctantTest::new(frustum) {
        all.push(("octant".to_string(), octant.classify(bounds, None)));
        for first in 0..PLANE_COUNT as u8 {
            all.push((format!("octant from {first}"), octant.classify(bounds, Some(first))));
        }
    }
    all
}

fn hold_against_oracle(camera: &Camera, bounds: &Aabb) -> Result<(), TestCaseError> {
    let (frustum, oracle) = (Frustum::new(camera), Hexahedron::new(camera));
    let expected = basic(bounds, &frustum).side;
    for (name, verdict) in verdicts(bounds, &frustum) {
        match verdict.side {
            Side::Outside(plane) => {
                prop_assert!(plane < 6);
                prop_assert!(!oracle.intersects(bounds), "{name} culled a visible box");
                prop_assert!(matches!(expected, Side::Outside(_)), "{name} culls, basic does not");
            }
            Side::Inside => {
                prop_assert!(oracle.contains(bounds), "{name} says inside");
                prop_assert_eq!(expected, Side::Inside, "{}", name);
            }
            Side::Intersecting => prop_assert_eq!(expected, Side::Intersecting, "{}", name),
        }
        prop_assert!((1..=8).contains(&verdict.tests), "{name} did {} tests", verdict.tests);
    }
    Ok(())
}

fn direction() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, -0.9f32..0.9, -1.0f32..1.0)
        .prop_map(|(x, y, z)| Vec3::new(x, y, z))
        .prop_filter("a direction across the up axis", |v| v.x.abs() + v.z.abs() > 0.05)
}

fn lens() -> impl Strategy<Value = Lens> {
    prop_oneof![
        (0.02f32..2.6, 0.2f32..4.0).prop_map(|(fov_y, aspect)| Lens::Symmetric { fov_y, aspect }),
        (0.0005f32..0.02).prop_map(|fov_y| Lens::Symmetric { fov_y, aspect: 1.0 }),
        (-2.0f32..1.0, 0.01f32..2.0, -2.0f32..1.0, 0.01f32..2.0).prop_map(|(left, w, bottom, h)| {
            Lens::OffAxis { left, right: left + w, bottom, top: bottom + h }
        }),
    ]
}

/// Cameras at the origin, in a hall and a thousand kilometres away; short and long depth ranges.
fn camera() -> impl Strategy<Value = Camera> {
    let eye = prop_oneof![
        Just(Vec3::ZERO),
        (-50.0f32..50.0, -5.0f32..5.0, -50.0f32..50.0).prop_map(|(x, y, z)| Vec3::new(x, y, z)),
        (-1e6f32..1e6, -1e6f32..1e6, -1e6f32..1e6).prop_map(|(x, y, z)| Vec3::new(x, y, z)),
    ];
    (eye, direction(), lens(), 0.01f32..2.0, 1.5f32..2000.0).prop_filter_map(
        "a camera",
        |(eye, forward, lens, near, ratio)| {
            Camera::look_at(eye, eye + forward * 16.0, Vec3::Y, lens, near, near * ratio).ok()
        },
    )
}

/// A box around a point of the camera's surroundings, given in shares of the frustum's own size.
fn bounds(camera: &Camera) -> impl Strategy<Value = Aabb> + use<> {
    let camera = *camera;
    let place = (-1.6f32..1.6, -1.6f32..1.6, -0.3f32..1.3);
    let exponent = prop_oneof![-3.0f32..0.5, -7.0f32..-3.0, 0.5f32..30.0];
    let stretch = (0.0f32..1.0, 0.0f32..1.0, 0.0f32..1.0);
    (place, exponent, stretch).prop_map(move |((x, y, z), exponent, stretch)| {
        let [_, right, _, top] = camera.lens.tangents();
        let depth = camera.far * z;
        let width = depth.abs().max(camera.near);
        let centre = camera.eye
            + camera.forward * depth
            + camera.right * (x * width * right.abs() as f32)
            + camera.up * (y * width * top.abs() as f32);
        let half = Vec3::from(stretch) * 10f32.powf(exponent) * camera.far;
        Aabb { min: centre - half, max: centre + half }
    })
}

/// A long box near the narrow end, before or behind the eye: where the octant test is in danger.
fn near_the_eye(camera: &Camera) -> impl Strategy<Value = Aabb> + use<> {
    let camera = *camera;
    let place = (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..4.0);
    let stretch = (-4.0f32..0.5, -4.0f32..0.5, -4.0f32..0.5);
    (place, stretch).prop_map(move |((x, y, z), (a, b, c))| {
        let depth = camera.near * z.signum() * 5f32.powf(z.abs());
        let [_, right, _, top] = camera.lens.tangents().map(|tangent| (tangent as f32 * depth).abs());
        let centre = camera.eye + camera.forward * depth + camera.right * (x * right) + camera.up * (y * top);
        let half = Vec3::new(a, b, c).map(|exponent| 10f32.powf(exponent)) * depth.abs();
        Aabb { min: centre - half, max: centre + half }
    })
}

/// A box with a corner on a face, an edge or a corner of the frustum, as near as f32 can tell: where
/// rounding decides.
fn touching(camera: &Camera) -> impl Strategy<Value = Aabb> + use<> {
    let corners = Frustum::new(camera).corners;
    let faces = [[0, 2, 4, 6], [1, 3, 5, 7], [0, 1, 2, 3], [4, 5, 6, 7], [2, 3, 6, 7], [0, 1, 4, 5]];
    let size = (-2.0f32..2.0, -2.0f32..2.0, -2.0f32..2.0);
    (0..6usize, 0.0f32..1.0, 0.0f32..1.0, size).prop_map(move |(face, u, v, size)| {
        let [a, b, c, d] = faces[face].map(|corner| corners[corner]);
        // Pulled toward the ends, so that edges and corners come up too.
        let [u, v] = [u, v].map(|share| (share * 1.4 - 0.2).clamp(0.0, 1.0));
        let point = a.lerp(b, u).lerp(c.lerp(d, u), v);
        Aabb::of_points([point, point + Vec3::from(size)])
    })
}

fn pair() -> impl Strategy<Value = (Camera, Aabb)> {
    camera().prop_flat_map(|camera| {
        let boxes = prop_oneof![bounds(&camera), near_the_eye(&camera), touching(&camera)];
        (Just(camera), boxes)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn kernels_keep_their_promise((camera, bounds) in pair()) {
        hold_against_oracle(&camera, &bounds)?;
    }

    #[test]
    fn any_bits_at_all_are_taken((camera, bits) in (camera(), prop::array::uniform6(any::<u32>()))) {
        let [a, b, c, d, e, f] = bits.map(f32::from_bits);
        let bounds = Aabb { min: Vec3::new(a, b, c), max: Vec3::new(d, e, f) };
        let (frustum, oracle) = (Frustum::new(&camera), Hexahedron::new(&camera));
        for (name, verdict) in verdicts(&bounds, &frustum) {
            match verdict.side {
                Side::Outside(_) => prop_assert!(!oracle.intersects(&bounds), "{name}"),
                Side::Inside => prop_assert!(oracle.contains(&bounds), "{name}"),
                Side::Intersecting => {}
            }
            prop_assert!(!bounds.is_nan() || verdict.side == Side::Intersecting);
        }
    }
}

fn plain_camera() -> Camera {
    let lens = Lens::Symmetric { fov_y: std::f32::consts::FRAC_PI_3, aspect: 4.0 / 3.0 };
    Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, lens, 0.1, 100.0).unwrap()
}

#[test]
fn known_boxes_and_costs() {
    let frustum = Frustum::new(&plain_camera());
    let cube = |x: f32, y: f32, z: f32| Aabb { min: Vec3::new(x, y, z) - 1.0, max: Vec3::new(x, y, z) + 1.0 };
    assert_eq!(basic(&cube(0.0, 0.0, -50.0), &frustum), Verdict { side: Side::Inside, tests: 6 });
    assert_eq!(basic(&cube(-90.0, 0.0, -50.0), &frustum), Verdict { side: Side::Outside(0), tests: 1 });
    assert_eq!(basic(&cube(0.0, 0.0, 5.0), &frustum).side, Side::Outside(0));
    assert_eq!(basic(&cube(0.0, -60.0, -50.0), &frustum), Verdict { side: Side::Outside(5), tests: 6 });
    let cached = from_plane(&cube(0.0, -60.0, -50.0), &frustum, 5);
    assert_eq!(cached, Verdict { side: Side::Outside(5), tests: 1 });
    let octant = OctantTest::new(&frustum).unwrap();
    let crossing = octant.classify(&cube(0.0, -28.9, -50.1), None);
    assert_eq!(crossing, Verdict { side: Side::Intersecting, tests: 4 });
    assert_eq!(octant.classify(&cube(0.0, 0.0, -50.0), None), Verdict { side: Side::Inside, tests: 7 });
}

#[test]
fn empty_and_nan_boxes() {
    let frustum = Frustum::new(&plain_camera());
    let octant = OctantTest::new(&frustum).unwrap();
    assert_eq!(basic(&Aabb::EMPTY, &frustum), Verdict { side: Side::Outside(0), tests: 0 });
    for hole in 0..6 {
        let mut numbers = [-1.0, -1.0, 500.0, 1.0, 1.0, 501.0];
        numbers[hole] = f32::NAN;
        let [a, b, c, d, e, f] = numbers;
        let bounds = Aabb { min: Vec3::new(a, b, c), max: Vec3::new(d, e, f) };
        assert_eq!(basic(&bounds, &frustum).side, Side::Intersecting);
        assert_eq!(from_plane(&bounds, &frustum, 2).side, Side::Intersecting);
        assert_eq!(octant.classify(&bounds, Some(2)).side, Side::Intersecting);
    }
}

#[test]
fn asymmetric_frusta_have_no_octant_test() {
    let lens = Lens::OffAxis { left: -0.5, right: 0.6, bottom: -0.5, top: 0.5 };
    let camera = Camera::look_at(Vec3::ZERO, Vec3::X, Vec3::Y, lens, 0.1, 10.0).unwrap();
    assert!(OctantTest::new(&Frustum::new(&camera)).is_none());
}

/// P1-F03: a box wider than the frustum is goes through all six planes.
#[test]
fn octant_test_is_off_for_large_boxes() {
    let frustum = Frustum::new(&plain_camera());
    let half = Vec3::splat(frustum.least_distance * 0.6);
    let centre = Vec3::new(0.0, 0.0, -50.0);
    let verdict = OctantTest::new(&frustum).unwrap();
    let verdict = verdict.classify(&Aabb { min: centre - half, max: centre + half }, None);
    assert_eq!(verdict, Verdict { side: Side::Inside, tests: 6 });
}

/// P1-F04: in the narrow end of the frustum a long box, small enough for the octant test, can be within
/// the three planes of its octant and cross a fourth. The paper would call it inside.
#[test]
fn octant_does_not_claim_inside_across_a_plane_that_was_not_chosen() {
    let mut random = 1u32;
    let mut next = || {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (random >> 8) as f32 / 16_777_216.0
    };
    let lens = Lens::Symmetric { fov_y: std::f32::consts::FRAC_PI_3, aspect: 4.0 / 3.0 };
    let look = Vec3::new(1.0, 0.6, -1.3);
    let camera = Camera::look_at(Vec3::ZERO, look, Vec3::Y, lens, 0.1, 100.0).unwrap();
    let (frustum, oracle) = (Frustum::new(&camera), Hexahedron::new(&camera));
    let octant = OctantTest::new(&frustum).unwrap();
    let mut caught = 0;
    for _ in 0..20_000 {
        let centre = camera.forward * (0.2 + 2.0 * next()) + camera.right * (next() - 0.5);
        let half = Vec3::new(next(), next() * 0.2, next());
        let bounds = Aabb { min: centre - half, max: centre + half };
        let verdict = octant.classify(&bounds, None);
        assert_eq!(verdict.side == Side::Inside, oracle.contains(&bounds));
        // One for the octant, its three planes, and more: only then had the three said inside.
        caught += u32::from(verdict.side == Side::Intersecting && verdict.tests > 4);
    }
    assert!(caught > 20, "only {caught} boxes put the test in danger");
}
