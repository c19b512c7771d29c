//! Every kernel against the f64 oracle, the others, and itself on boxes within boxes. The long run over adversarial
//! boxes is `apportion stress cull_kernels`.

use super::*;
use crate::geometry::oracle::Hexahedron;
use crate::geometry::{Aabb, Camera, Lens, culling};
use glam::Vec3;
use proptest::prelude::*;

fn camera() -> impl Strategy<Value = Camera> {
    let place = (prop_oneof![Just(0.0f32), Just(30.0), Just(1e6)], -1.0f32..1.0, -1.0f32..1.0);
    let lens = prop_oneof![
        (0.001f32..2.6, 0.2f32..4.0).prop_map(|(fov_y, aspect)| Lens::Symmetric { fov_y, aspect }),
        (-2.0f32..1.0, 0.01f32..2.0).prop_map(|(left, width)| Lens::OffAxis {
            left,
            right: left + width,
            bottom: -0.3,
            top: 0.7
        }),
    ];
    let look = (-1.0f32..1.0, -0.9f32..0.9, -1.0f32..1.0).prop_map(Vec3::from);
    (place, look, lens, 0.01f32..2.0, 1.5f32..2000.0).prop_filter_map(
        "a camera",
        |((scale, x, y), look, lens, near, ratio)| {
            let eye = Vec3::new(x, y, -x) * scale;
            Camera::look_at(eye, eye + look * 16.0, Vec3::Y, lens, near, near * ratio).ok()
        },
    )
}

/// Sixty-four boxes from a point of the frustum's surroundings each, as shares of its depth.
fn boxes() -> impl Strategy<Value = Vec<(Vec3, Vec3)>> {
    let place = (-1.2f32..1.2, -1.2f32..1.2, -0.3f32..1.3).prop_map(Vec3::from);
    let size = (0.0f32..1.0, 0.0f32..1.0, 0.0f32..1.0).prop_map(Vec3::from);
    let scale = prop_oneof![-4.0f32..0.5, -8.0f32..-4.0, 0.5f32..30.0];
    let one = (place, size, scale).prop_map(|(place, size, scale)| (place, size * 10f32.powf(scale)));
    prop::collection::vec(one, BoxBlock::LEN)
}

fn around_camera(camera: &Camera, boxes: &[(Vec3, Vec3)]) -> Vec<Aabb> {
    let at = |&(place, half): &(Vec3, Vec3)| {
        let Vec3 { x, y, z } = place * camera.far;
        let centre = camera.eye + camera.right * x + camera.up * y + camera.forward * z;
        Aabb { min: centre - half * camera.far, max: centre + half * camera.far }
    };
    boxes.iter().map(at).collect()
}

fn hold(camera: &Camera, block: &BoxBlock) -> Result<(), TestCaseError> {
    let (frustum, oracle) = (Frustum::new(camera), Hexahedron::new(camera));
    let reference = BoxTest::with_kernel(&frustum, Kernel::named("scalar").unwrap()).sides(block);
    for kernel in Kernel::all() {
        let test = BoxTest::with_kernel(&frustum, kernel);
        prop_assert_eq!(test.sides(block), reference, "{:?}", kernel);
        let mut words = [0; 2];
        test.visible(&[BoxBlock::EMPTY, *block], &mut words);
        prop_assert_eq!(words, [0, reference.visible], "{:?}", kernel);
    }
    for i in 0..BoxBlock::LEN {
        let bounds = block.get(i);
        let is = |bits: u64| bits >> i & 1 == 1;
        let basic = culling::basic(&bounds, &frustum).side;
        prop_assert!(is(reference.visible) || !oracle.intersects(&bounds), "culled a visible {bounds:?}");
        prop_assert!(!is(reference.inside) || oracle.contains(&bounds), "inside: {bounds:?}");
        if matches!(basic, culling::Side::Outside(_)) {
            prop_assert!(!is(reference.visible), "basic culls {bounds:?}");
        }
        prop_assert!(is(reference.visible) || !(bounds.is_nan() || bounds.max.is_nan()));
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn kernels_keep_their_promise(camera in camera(), boxes in boxes()) {
        hold(&camera, &BoxBlock::of(&around_camera(&camera, &boxes)))?;
    }

    #[test]
    fn any_bits_at_all_are_taken(camera in camera(), bits in prop::collection::vec(any::<[u32; 6]>(), 64)) {
        let corner = |a, b, c| Vec3::new(f32::from_bits(a), f32::from_bits(b), f32::from_bits(c));
        let bounds = |[a, b, c, d, e, f]: [u32; 6]| Aabb { min: corner(a, b, c), max: corner(d, e, f) };
        let boxes: Vec<Aabb> = bits.into_iter().map(bounds).collect();
        hold(&camera, &BoxBlock::of(&boxes))?;
        // The same corners the right way round: few of the above are anything but empty.
        let turned = |bounds: &Aabb| Aabb { min: bounds.min.min(bounds.max), max: bounds.max.max(bounds.min) };
        hold(&camera, &BoxBlock::of(&boxes.iter().map(turned).collect::<Vec<_>>()))?;
    }

    #[test]
    fn within_a_box_outside_all_are_outside(
        camera in camera(),
        boxes in boxes(),
        parts in prop::collection::vec(any::<[u8; 6]>(), 64),
    ) {
        let large = around_camera(&camera, &boxes);
        let within = |(bounds, part): (&Aabb, &[u8; 6])| {
            // Many at one end: there the two corners are one and the same number.
            let [a, b, c, d, e, f] = part.map(|part| f32::from(part % 9) / 8.0);
            let at = |x, y, z| bounds.min + (bounds.max - bounds.min) * Vec3::new(x, y, z);
            let (one, other) = (at(a, b, c), at(d, e, f));
            let clamp = |corner: Vec3| corner.clamp(bounds.min, bounds.max);
            Aabb { min: clamp(one.min(other)), max: clamp(one.max(other)) }
        };
        let small: Vec<Aabb> = large.iter().zip(&parts).map(within).collect();
        prop_assert!(large.iter().zip(&small).all(|(large, small)| large.contains(small)));
        let test = BoxTest::new(&Frustum::new(&camera));
        let (large, small) = (test.sides(&BoxBlock::of(&large)), test.sides(&BoxBlock::of(&small)));
        prop_assert_eq!(small.visible & !large.visible, 0, "visible within one that is outside");
        prop_assert_eq!(large.inside & !small.visible, 0, "outside within one that is inside");
    }
}

#[test]
fn the_odd_ones() {
    let lens = Lens::Symmetric { fov_y: 1.0, aspect: 1.0 };
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, lens, 0.1, 100.0).unwrap();
    let behind = Aabb { min: Vec3::new(-1.0, -1.0, 5.0), max: Vec3::new(1.0, 1.0, 6.0) };
    let mut boxes = vec![behind; BoxBlock::LEN];
    let far = Vec3::splat(f32::INFINITY);
    boxes[1] = Aabb { min: behind.min, max: far };
    boxes[2] = Aabb { min: Vec3::new(0.0, f32::NAN, 0.0), max: Vec3::ONE };
    boxes[3] = Aabb { min: behind.max, max: behind.min };
    boxes[4] = Aabb { min: far, max: far };
    boxes[5] = Aabb { min: Vec3::splat(f32::MIN), max: Vec3::splat(f32::MAX) };
    boxes[6] = Aabb { min: Vec3::new(0.0, 0.0, -9.0), max: Vec3::new(0.0, 0.0, -9.0) };
    for kernel in Kernel::all() {
        let sides = BoxTest::with_kernel(&Frustum::new(&camera), kernel).sides(&BoxBlock::of(&boxes));
        assert_eq!(sides, BlockSides { visible: 0b111_0110, inside: 1 << 6 }, "{kernel:?}");
    }
    assert_eq!(Kernel::named(Kernel::best().name()), Some(Kernel::best()));
    assert_eq!(Kernel::named("mmx"), None);
}
