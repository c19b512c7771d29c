//! Bodies that are given by half-spaces: every corner such a body has lies on three of their planes.

use glam::{DMat3, DVec3};

use crate::geometry::KDop;

/// An outward normal of unit length and a distance term: what is outside has a product above zero.
type HalfSpace = (DVec3, f64);

/// The half-spaces of a k-DOP, relative to the eye.
pub(super) fn half_spaces<const D: usize>(volume: &KDop<D>, eye: DVec3) -> Vec<HalfSpace> {
    let slab = |(direction, low, high): (glam::Vec3, f32, f32)| {
        let along = direction.as_dvec3();
        let (length, at) = (along.length(), along.dot(eye));
        let normal = along / length;
        [(-normal, (f64::from(low) - at) / length), (normal, (at - f64::from(high)) / length)]
    };
    volume.slabs().flat_map(slab).collect()
}

/// The corners of the body that the half-spaces have in common, if it is bounded; points within a billionth
/// of its size count as in it.
pub(super) fn vertices(spaces: &[HalfSpace]) -> Vec<DVec3> {
    let size = spaces.iter().fold(1e-30, |size: f64, (_, d)| size.max(d.abs()));
    let mut found = Vec::new();
    for (i, (a, at_a)) in spaces.iter().enumerate() {
        for (j, (b, at_b)) in spaces.iter().enumerate().skip(i + 1) {
            for (c, at_c) in spaces.iter().skip(j + 1) {
                let rows = DMat3::from_cols(*a, *b, *c).transpose();
                if rows.determinant().abs() < 1e-12 {
                    continue;
                }
                let point = rows.inverse() * -DVec3::new(*at_a, *at_b, *at_c);
                if spaces.iter().all(|(normal, d)| normal.dot(point) + d <= 1e-9 * size) {
                    found.push(point);
                }
            }
        }
    }
    found
}

/// Whether the half-spaces, of which some make a bounded body, have a point in common.
pub(super) fn have_a_point(spaces: &[HalfSpace]) -> bool {
    !vertices(spaces).is_empty()
}
