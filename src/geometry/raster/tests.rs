//! Coverage against edge functions in f64, pixel by pixel; clipping against the triangle in space.

use glam::{Affine3A, DVec3, Vec3};

use super::*;
use crate::geometry::{Camera, Lens};

const SIZE: [u32; 2] = [24, 16];

/// A small generator of its own, as this room uses no other.
struct Random(u64);

impl Random {
    fn below(&mut self, count: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % count
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.below(1 << 30) as f64 / (1u64 << 30) as f64
    }
}

fn filled(corners: [Corner; 3]) -> Vec<(u32, u32)> {
    let mut pixels = Vec::new();
    if let Some(coverage) = Coverage::new(corners, SIZE) {
        coverage.fill(|column, row, _| pixels.push((column, row)));
    }
    pixels
}

/// The oracle: each pixel's centre against three edge functions in f64, which hold these numbers exactly.
/// A centre on an edge counts if it would still be inside after the smallest step to the right and a still
/// smaller one down: that is the top-left rule.
fn expected(corners: [Corner; 3]) -> Vec<(u32, u32)> {
    let mut at = corners.map(|corner| corner.place.map(|place| place as f64 / 256.0));
    let cross =
        |a: [f64; 2], b: [f64; 2], p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    if cross(at[0], at[1], at[2]) < 0.0 {
        at.swap(0, 1);
    }
    let inside = |column: u32, row: u32| {
        let centre = [f64::from(column) + 0.5, f64::from(row) + 0.5];
        cross(at[0], at[1], at[2]) > 0.0
            && [(0, 1), (1, 2), (2, 0)].iter().all(|&(from, to)| {
                let (a, b) = (at[from], at[to]);
                let (right, down) = (a[1] - b[1], b[0] - a[0]);
                let value = cross(a, b, centre);
                value > 0.0 || (value == 0.0 && (right > 0.0 || (right == 0.0 && down > 0.0)))
            })
    };
    let pixels = (0..SIZE[1]).flat_map(|row| (0..SIZE[0]).map(move |column| (column, row)));
    pixels.filter(|&(column, row)| inside(column, row)).collect()
}

fn corner(place: [i64; 2]) -> Corner {
    Corner { place: place.map(|at| at as i32), nearness: 1.0 }
}

#[test]
fn coverage_is_that_of_the_edge_functions() {
    let mut random = Random(1);
    let mut covered = 0;
    for round in 0..20_000 {
        // Every third on whole and half pixels, where centres lie on edges.
        let step = if round % 3 == 0 { 128 } else { 1 };
        let corners = [(); 3].map(|()| {
            let mut along = |size: u32| {
                (random.below(u64::from(size) * 2 * 256 / step) * step) as i64 - i64::from(size) * 128
            };
            corner([along(SIZE[0]), along(SIZE[1])])
        });
        let found = filled(corners);
        covered += found.len();
        assert_eq!(found, expected(corners), "{corners:?}");
    }
    assert!(covered > 100_000, "{covered}");
}

#[test]
fn needles_points_and_giants() {
    let giant = 1 << 28;
    for corners in [
        [[0, 0], [0, 0], [0, 0]],
        [[128, 128], [128, 128], [900, 128]],
        [[0, 0], [1, 0], [0, 1]],
        [[128, 128], [129, 128], [128, 129]],
        [[-giant, -giant], [giant, -giant], [0, giant]],
        [[-giant, 100], [giant, 101], [giant, 3000]],
        [[5000, 5000], [9000, 5000], [5000, 9000]],
    ] {
        let corners = corners.map(corner);
        assert_eq!(filled(corners), expected(corners), "{corners:?}");
    }
    assert!(Coverage::new([[0, 0], [256, 256], [512, 512]].map(corner), SIZE).is_none());
}

#[test]
fn shared_edges_are_covered_exactly_once() {
    let mut random = Random(2);
    for _ in 0..300 {
        // A grid of points somewhat displaced, on steps that pixel centres share, and past the picture.
        let displaced = |place: i64, random: &mut Random| place * 640 - 640 + random.below(5) as i64 * 64;
        let points: Vec<Vec<_>> = (0..9)
            .map(|row| {
                let point = |column| corner([displaced(column, &mut random), displaced(row, &mut random)]);
                (0..13).map(point).collect::<Vec<_>>()
            })
            .collect();
        let mut times = vec![0; (SIZE[0] * SIZE[1]) as usize];
        for row in 0..8 {
            for column in 0..12 {
                let [a, b] = [points[row][column], points[row][column + 1]];
                let [c, d] = [points[row + 1][column], points[row + 1][column + 1]];
                for triangle in [[a, b, d], [d, c, a]] {
                    filled(triangle).iter().for_each(|(x, y)| times[(y * SIZE[0] + x) as usize] += 1);
                }
            }
        }
        // Displaced corners keep the inner part covered without a gap; the border may reach in.
        let inner = (2..14).flat_map(|row| (2..22).map(move |column| row * SIZE[0] as usize + column));
        assert!(inner.into_iter().all(|pixel| times[pixel] == 1), "{times:?}");
    }
}

fn camera(eye: Vec3) -> Camera {
    let lens = Lens::Symmetric { fov_y: 1.0, aspect: 1.5 };
    Camera::look_at(eye, eye + Vec3::new(1.0, 0.2, -2.0), Vec3::Y, lens, 0.5, 20.0).unwrap()
}

/// Nearness of each pixel by a ray through its centre, in f64: none where the ray misses or passes within
/// `margin` of an edge (in shares of the triangle), which snapping may decide either way, and of triangles
/// seen almost edge on, whose depth a snapped corner changes much.
fn by_ray(camera: &Camera, corners: [DVec3; 3], [column, row]: [u32; 2], margin: f64) -> Option<Option<f64>> {
    let [left, right, bottom, top] = camera.lens.tangents();
    let across = left + (right - left) * (f64::from(column) + 0.5) / f64::from(SIZE[0]);
    let along = top + (bottom - top) * (f64::from(row) + 0.5) / f64::from(SIZE[1]);
    let [r, u, f] = [camera.right, camera.up, camera.forward].map(Vec3::as_dvec3);
    let ray = f + r * across + u * along;
    let [a, b, c] = corners.map(|corner| corner - camera.eye.as_dvec3());
    let weights = [b.cross(c), c.cross(a), a.cross(b)].map(|normal| ray.dot(normal));
    let sum: f64 = weights.iter().sum();
    let depth = a.dot(b.cross(c)) / sum;
    let shares = weights.map(|weight| weight / sum);
    let near_edge = |at: f64| at.abs() < margin;
    let slant = sum.abs() / ((b - a).cross(c - a).length() * ray.length());
    if slant < 0.1 {
        return None;
    }
    let [near, far] = [camera.near, camera.far].map(f64::from);
    if shares.iter().any(|share| near_edge(*share)) || near_edge(depth - near) || near_edge(depth / far - 1.0)
    {
        return None;
    }
    let hit = shares.iter().all(|share| *share > 0.0) && depth > near && depth < far;
    Some(hit.then_some(1.0 / depth))
}

#[test]
fn triangles_in_space_are_where_rays_meet_them() {
    let mut random = Random(3);
    let (mut hits, mut misses) = (0, 0);
    for far in [0.0f32, 1e6] {
        let camera = camera(Vec3::new(far, -far, 2.0));
        for _ in 0..4000 {
            // Before and behind the eye, through the near and the far plane.
            let corners = [(); 3].map(|()| {
                let place = DVec3::from([(); 3].map(|()| random.between(-9.0, 9.0)));
                (camera.eye.as_dvec3() + place + camera.forward.as_dvec3() * random.between(-3.0, 22.0))
                    .as_vec3()
            });
            let eye = Eye::new(&camera, SIZE, &Affine3A::IDENTITY);
            let seen = corners.map(|corner| eye.see(corner));
            let mut picture = vec![0.0f32; (SIZE[0] * SIZE[1]) as usize];
            let mut pieces = 0;
            for piece in Clipped::new(&eye, seen).triangles() {
                pieces += 1;
                if let Some(coverage) = Coverage::new(piece, SIZE) {
                    coverage.fill(|x, y, nearness| {
                        let pixel = &mut picture[(y * SIZE[0] + x) as usize];
                        assert_eq!(*pixel, 0.0, "pieces of one triangle overlap");
                        *pixel = nearness;
                    });
                }
            }
            assert!(pieces <= 7);
            let corners = corners.map(Vec3::as_dvec3);
            let area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
            if area < 1.0 {
                continue;
            }
            if seen[0].outside.shared(seen[1].outside, seen[2].outside) {
                assert!(picture.iter().all(|pixel| *pixel == 0.0), "nothing outside the view is drawn");
            }
            for (index, pixel) in picture.iter().enumerate() {
                let place = [index as u32 % SIZE[0], index as u32 / SIZE[0]];
                match by_ray(&camera, corners, place, 0.02) {
                    Some(Some(nearness)) => {
                        hits += 1;
                        let error = (f64::from(*pixel) / nearness - 1.0).abs();
                        assert!(error < 0.05, "{place:?}: {pixel} where a ray finds {nearness}");
                    }
                    Some(None) => {
                        misses += 1;
                        assert_eq!(*pixel, 0.0, "{place:?} of {corners:?}");
                    }
                    None => {}
                }
            }
        }
    }
    assert!(hits > 50_000 && misses > 500_000, "{hits} and {misses}");
}

#[test]
fn nothing_finite_or_not_goes_wrong() {
    let eye = Eye::new(&camera(Vec3::ZERO), SIZE, &Affine3A::IDENTITY);
    let odd =
        [0.0, -0.0, 1.0, -3.0, 1e-40, 1e6, f32::MAX, f32::MIN, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    let mut random = Random(4);
    for _ in 0..100_000 {
        let mut number = || odd[random.below(odd.len() as u64) as usize];
        let corners = [(); 3].map(|()| eye.see(Vec3::new(number(), number(), number())));
        for piece in Clipped::new(&eye, corners).triangles() {
            if let Some(coverage) = Coverage::new(piece, SIZE) {
                coverage.fill(|x, y, _| assert!(x < SIZE[0] && y < SIZE[1]));
            }
        }
    }
}
