//! Cameras and boxes, ordinary and adversarial.

use glam::Vec3;
use proptest::prelude::*;

use crate::geometry::{Aabb, Camera, Frustum, Lens};

pub(super) fn direction() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, -0.9f32..0.9, -1.0f32..1.0)
        .prop_map(|(x, y, z)| Vec3::new(x, y, z))
        .prop_filter("a direction across the up axis", |v| v.x.abs() + v.z.abs() > 0.05)
}

pub(super) fn lens() -> impl Strategy<Value = Lens> {
    prop_oneof![
        (0.02f32..2.6, 0.2f32..4.0).prop_map(|(fov_y, aspect)| Lens::Symmetric { fov_y, aspect }),
        (0.0005f32..0.02).prop_map(|fov_y| Lens::Symmetric { fov_y, aspect: 1.0 }),
        (-2.0f32..1.0, 0.01f32..2.0, -2.0f32..1.0, 0.01f32..2.0).prop_map(|(left, w, bottom, h)| {
            Lens::OffAxis { left, right: left + w, bottom, top: bottom + h }
        }),
    ]
}

/// Cameras at the origin, in a hall and a thousand kilometres away; short and long depth ranges.
pub(super) fn camera() -> impl Strategy<Value = Camera> {
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
pub(super) fn bounds(camera: &Camera) -> impl Strategy<Value = Aabb> + use<> {
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
pub(super) fn near_the_eye(camera: &Camera) -> impl Strategy<Value = Aabb> + use<> {
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
pub(super) fn touching(camera: &Camera) -> impl Strategy<Value = Aabb> + use<> {
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

pub(super) fn pair() -> impl Strategy<Value = (Camera, Aabb)> {
    camera().prop_flat_map(|camera| {
        let boxes = prop_oneof![bounds(&camera), near_the_eye(&camera), touching(&camera)];
        (Just(camera), boxes)
    })
}
