//! The exact test against the oracle in whole numbers. The long run is `apportion stress contacts`.

use super::*;
use crate::geometry::oracle::{GridPoint, triangles_meet};
use proptest::prelude::*;

/// Numbers to make triangles of.
pub(super) struct Random(pub(super) u64);

impl Random {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as f64 / (1u64 << 31) as f64
    }

    pub(super) fn triangle(&mut self) -> Triangle {
        std::array::from_fn(|_| DVec3::new(self.number(), self.number(), self.number()))
    }
}

/// Corners on a grid so coarse that they often share a plane, a line or a place; or a fine one.
fn corner() -> impl Strategy<Value = GridPoint> {
    prop_oneof![
        4 => prop::array::uniform3(-2..=2),
        2 => prop::array::uniform3(-20..=20),
        1 => prop::array::uniform3(-(1 << 19)..=1 << 19),
    ]
}

fn real(triangle: &[GridPoint; 3], scale: f64) -> Triangle {
    triangle.map(|corner| DVec3::from_array(corner.map(f64::from)) * scale)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn meets_as_in_whole_numbers(a in prop::array::uniform3(corner()), b in prop::array::uniform3(corner()), power in -60i32..60) {
        let scale = 2f64.powi(power);
        let expected = triangles_meet(&a, &b);
        prop_assert_eq!(meet(&real(&a, scale), &real(&b, scale)), expected);
        prop_assert_eq!(meet(&real(&b, scale), &real(&a, scale)), expected);
        if expected {
            prop_assert!(closer(&real(&a, scale), &real(&b, scale), 0.0));
        }
    }
}

#[test]
fn far_from_the_origin_and_no_numbers() {
    let far = DVec3::splat(1e6);
    let a = [far, far + DVec3::X, far + DVec3::Y];
    let touching = [far + DVec3::new(0.25, 0.25, 0.0), far + DVec3::Z, far + DVec3::new(1.0, 0.0, 1.0)];
    assert!(meet(&a, &touching));
    let mut lifted = touching;
    lifted[0].z = lifted[0].z.next_up();
    assert!(!meet(&a, &lifted), "one step of f64 above");
    assert!(meet(&[DVec3::NAN; 3], &a) && meet(&a, &[DVec3::INFINITY; 3]));
}
