//! The tests that Paper I compares with: a volume's eight corners, transformed.
//!
//! **Perspective space** (Paper I sec. 2, DirectModel; the baseline of its Table 1): the corners are divided
//! by their depth and bounded by a box, which is compared with that of the frustum. Behind the eye the
//! division turns things over, so a volume that reaches there is tested in clip space instead (finding
//! P1-F14). **Clip space** (Bubeníček sec. 2): the corners are compared with their own depth, plane by
//! plane; nothing is divided.

use glam::{DMat3, Vec3, Vec4};

use super::{ALL, Side, Space, Verdict};
use crate::geometry::{Frustum, PLANE_COUNT, Volume};

/// Bound on the rounding of one transformed coordinate, relative to its terms: five sums and products that make a
/// corner, the matrix' own rounding, four products and sums; half an ulp each.
const ROUNDING: f32 = 12.0 / 16_777_216.0;

/// From a place relative to the eye to clip space: x, y and z within -w and w are in view.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection {
    eye: Vec3,
    /// x, y, z, w.
    rows: [Vec4; 4],
}

impl Projection {
    pub(super) fn new(frustum: &Frustum) -> Self {
        let camera = &frustum.camera;
        let [left, right, bottom, top] = camera.lens.tangents();
        let (near, far) = (f64::from(camera.near), f64::from(camera.far));
        // How far right, up and forward: the axes as they were rounded are not quite at right angles.
        let axes = [camera.right, camera.up, camera.forward].map(Vec3::as_dvec3);
        let seen = DMat3::from_cols(axes[0], axes[1], axes[2]).inverse().transpose();
        let across = |axis: glam::DVec3, low: f64, high: f64| {
            ((axis * 2.0 - seen.z_axis * (high + low)) / (high - low)).extend(0.0)
        };
        let depth = (seen.z_axis * ((far + near) / (far - near))).extend(-2.0 * far * near / (far - near));
        let rows = [
            across(seen.x_axis, left, right),
            across(seen.y_axis, bottom, top),
            depth,
            seen.z_axis.extend(0.0),
        ];
        Self { eye: frustum.eye, rows: rows.map(|row| row.as_vec4()) }
    }

    /// Tests a volume by its corners; each plane counts as one test.
    #[inline]
    pub(super) fn classify<V: Volume>(&self, volume: &V, space: Space) -> Verdict {
        let corners = volume.corners_from(self.eye);
        let size = corners.iter().fold(Vec3::ZERO, |size, corner| size + corner.abs()).extend(8.0);
        // Taken of all corners at once; NaN and infinity reach it.
        let slack = self.rows.map(|row| row.abs().dot(size) * ROUNDING + f32::MIN_POSITIVE);
        let clip = corners.map(|corner| self.rows.map(|row| row.dot(corner.extend(1.0))));
        let before_the_eye = clip.iter().all(|corner| corner[3] > 2.0 * slack[3]);
        let (outside, inside) = match space {
            Space::Perspective if before_the_eye => perspective(&clip, &slack),
            _ => clip_space(&clip, &slack),
        };
        let side = match outside {
            0 if inside == ALL => Side::Inside,
            0 => Side::Intersecting,
            planes => Side::Outside(planes.trailing_zeros() as u8),
        };
        Verdict { side, tests: PLANE_COUNT as u32, inside }
    }
}

/// The planes that all corners are certainly outside and certainly inside of, as bits in the order left, right,
/// near, far, up, down.
fn clip_space(clip: &[[f32; 4]; 8], slack: &[f32; 4]) -> (u8, u8) {
    let (mut outside, mut inside) = (ALL, ALL);
    for [x, y, z, w] in clip {
        for (plane, (beyond, axis)) in
            [(-x - w, 0), (x - w, 0), (-z - w, 2), (z - w, 2), (y - w, 1), (-y - w, 1)]
                .into_iter()
                .enumerate()
        {
            // The sum rounds once more than its terms did.
            let slack = (slack[axis] + slack[3]) * 1.1;
            // A NaN is neither.
            let (out, within) = (beyond > slack, beyond < -slack);
            outside &= !(u8::from(!out) << plane);
            inside &= !(u8::from(!within) << plane);
        }
    }
    (outside, inside)
}

/// The same by the box around the divided corners; all of them must lie before the eye.
fn perspective(clip: &[[f32; 4]; 8], slack: &[f32; 4]) -> (u8, u8) {
    let (mut low, mut high, mut nearest) = (Vec3::INFINITY, Vec3::NEG_INFINITY, f32::INFINITY);
    for [x, y, z, w] in clip {
        let at = Vec3::new(*x, *y, *z) / *w;
        (low, high, nearest) = (low.min(at), high.max(at), nearest.min(*w));
    }
    // A divided coordinate beyond 1 by this much belongs to one beyond its w by more than both may err.
    let slack = [0, 1, 2].map(|axis| (slack[axis] + slack[3]) / nearest * 1.1 + ROUNDING);
    let (mut outside, mut inside) = (0, 0);
    for (plane, (least, most, axis)) in [
        (-high.x, -low.x, 0),
        (low.x, high.x, 0),
        (-high.z, -low.z, 2),
        (low.z, high.z, 2),
        (low.y, high.y, 1),
        (-high.y, -low.y, 1),
    ]
    .into_iter()
    .enumerate()
    {
        outside |= u8::from(least > 1.0 + slack[axis]) << plane;
        inside |= u8::from(most < 1.0 - slack[axis]) << plane;
    }
    (outside, inside)
}
