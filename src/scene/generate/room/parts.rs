//! What the room is furnished with.

use std::f64::consts::TAU;

use glam::{DVec3, Vec2, Vec3};

use super::super::noise_sphere::{lattice, normals};
use crate::scene::generate::geodesic;
use crate::scene::{Corners, Mesh, SplitMix64, Texture};

/// Outlines from the axis outward and up, as (radius, height) in metres.
pub(in crate::scene::generate) const POT: [(f64, f64); 10] = [
    (0.0, 0.0),
    (0.07, 0.0),
    (0.12, 0.05),
    (0.13, 0.1),
    (0.1, 0.16),
    (0.07, 0.17),
    (0.05, 0.185),
    (0.015, 0.19),
    (0.02, 0.21),
    (0.0, 0.22),
];
/// A vase, open at the top, with an inside.
pub(in crate::scene::generate) const VASE: [(f64, f64); 9] = [
    (0.0, 0.0),
    (0.05, 0.0),
    (0.06, 0.06),
    (0.035, 0.16),
    (0.055, 0.24),
    (0.05, 0.24),
    (0.03, 0.16),
    (0.052, 0.06),
    (0.0, 0.01),
];
/// The stand of a lamp.
pub(in crate::scene::generate) const STAND: [(f64, f64); 7] =
    [(0.0, 0.0), (0.16, 0.0), (0.15, 0.02), (0.02, 0.05), (0.015, 0.6), (0.015, 1.4), (0.0, 1.41)];
/// Its shade, open at both ends.
pub(in crate::scene::generate) const SHADE: [(f64, f64); 4] =
    [(0.24, 1.25), (0.12, 1.6), (0.117, 1.6), (0.237, 1.25)];

/// An outline turned about the y axis, each of its pieces cut into `cuts` along a smooth curve through its corners.
pub(in crate::scene::generate) fn lathe(name: &str, outline: &[(f64, f64)], sides: u32, cuts: u32) -> Mesh {
    let point = |at: i64| {
        let (radius, height) = outline[at.clamp(0, outline.len() as i64 - 1) as usize];
        DVec3::new(radius, height, 0.0)
    };
    let mut curve = Vec::new();
    for piece in 0..outline.len() as i64 - 1 {
        let [a, b, c, d] = [-1, 0, 1, 2].map(|off| point(piece + off));
        for cut in 0..cuts {
            let t = f64::from(cut) / f64::from(cuts);
            // Catmull-Rom.
            let bend = (b * 3.0 - a - c * 3.0 + d) * t + (a * 2.0 - b * 5.0 + c * 4.0 - d);
            curve.push((b * 2.0 + ((c - a) + bend * t) * t) * 0.5);
        }
    }
    curve.push(point(outline.len() as i64 - 1));
    let ring = |at: DVec3| {
        (0..sides).map(move |side| {
            let (sin, cos) = (f64::from(side) / f64::from(sides) * TAU).sin_cos();
            // A curve may swing past the axis.
            DVec3::new(at.x.max(0.0) * cos, at.y.max(0.0), -at.x.max(0.0) * sin).as_vec3()
        })
    };
    let rings = curve.len() as u32;
    let positions: Vec<Vec3> = curve.into_iter().flat_map(ring).collect();
    let at = |ring: u32, side: u32| ring * sides + side % sides;
    let cells = (0..rings - 1).flat_map(|ring| (0..sides).map(move |side| (ring, side)));
    let triangles = cells.flat_map(|(ring, side)| {
        let [a, b, c, d] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(up, on)| at(ring + up, side + on));
        [[a, b, d], [a, d, c]]
    });
    // On the axis a side of a cell has no length, and one of its triangles no area.
    let has_area = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|vertex| positions[vertex as usize]);
        (b - a).cross(c - a) != Vec3::ZERO
    };
    let triangles = triangles.filter(has_area).collect();
    smooth(Mesh::new(name, positions, triangles))
}

/// A ball standing at its middle.
pub(in crate::scene::generate) fn ball(radius: f64, frequency: u32) -> Mesh {
    let mut mesh = geodesic("ball", radius, frequency);
    mesh.shading.normals = Corners::of_vertices(mesh.positions.clone());
    mesh
}

/// A rectangle from its corners, lower left first, anticlockwise; its texture so many times across and up.
pub(in crate::scene::generate) fn sheet(name: &str, corners: [Vec3; 4], times: [f32; 2]) -> Mesh {
    let mut mesh = Mesh::new(name, corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    let [across, up] = times;
    let at = [(0.0, up), (across, up), (across, 0.0), (0.0, 0.0)].map(|(u, v)| Vec2::new(u, v));
    mesh.shading.coordinates = Corners::of_vertices(at.to_vec());
    mesh
}

/// A deep carpet of exactly `count` triangles, which must be even: rows of cells, the last as long as it comes.
pub(in crate::scene::generate) fn carpet(length: f32, width: f32, count: usize) -> Mesh {
    assert!(count.is_multiple_of(2), "cells have two triangles");
    let cells = count / 2;
    let columns = ((cells as f32 * length / width).sqrt() as usize).max(1);
    let rows = cells.div_ceil(columns);
    let position = |row: usize, column: usize| {
        let (x, z) = (column as f32 / columns as f32 - 0.5, row as f32 / rows as f32 - 0.5);
        let at = DVec3::new(f64::from(x * length), 0.0, f64::from(z * width));
        let height = 0.012 + 0.004 * lattice(at * 12.0) + 0.003 * lattice(at * 90.0);
        Vec3::new(at.x as f32, height as f32, at.z as f32)
    };
    let positions = (0..=rows).flat_map(|row| (0..=columns).map(move |column| (row, column)));
    let positions = positions.map(|(row, column)| position(row, column)).collect();
    let triangles = (0..cells).flat_map(|cell| {
        let a = (cell / columns * (columns + 1) + cell % columns) as u32;
        let c = a + columns as u32 + 1;
        [[a, c, c + 1], [a, c + 1, a + 1]]
    });
    smooth(Mesh::new("carpet", positions, triangles.collect()))
}

fn smooth(mut mesh: Mesh) -> Mesh {
    mesh.shading.normals = Corners::of_vertices(normals(&mesh.positions, &mesh.triangles));
    mesh
}

/// Floor boards.
pub(in crate::scene::generate) fn boards() -> Texture {
    picture("boards", 256, 256, |x, y| {
        let board = (x / 32) as f64;
        let shift = lattice(DVec3::new(board, 7.0, 0.0)) * 128.0;
        let gap = x % 32 == 0 || (f64::from(y) + shift).rem_euclid(256.0) < 1.0;
        let grain = lattice(DVec3::new(f64::from(x) * 0.4, (f64::from(y) + shift) * 0.03, board * 5.0));
        let light = if gap { 0.35 } else { 0.8 + 0.12 * grain + 0.1 * lattice(DVec3::new(board, 0.0, 3.0)) };
        [190.0, 140.0, 90.0].map(|part| part * light)
    })
}

/// Hills under a sun.
pub(in crate::scene::generate) fn painting() -> Texture {
    let mut random = SplitMix64::new(16);
    let hills: Vec<f64> = (0..4).map(|_| random.between(0.0, 50.0)).collect();
    picture("painting", 384, 256, |x, y| {
        let (x, y) = (f64::from(x) / 256.0, f64::from(y) / 256.0);
        let hill =
            |at: usize| 0.45 + 0.13 * at as f64 + 0.1 * lattice(DVec3::new(x * 3.0 + hills[at], 0.5, 0.0));
        match (0..4).rev().find(|at| y > hill(*at)) {
            Some(at) => {
                [[120.0, 140.0, 170.0], [90.0, 130.0, 110.0], [70.0, 110.0, 60.0], [50.0, 80.0, 35.0]][at]
            }
            None if (x - 1.1).hypot(y - 0.2) < 0.08 => [255.0, 235.0, 170.0],
            None => [240.0 - 60.0 * y, 190.0 + 40.0 * y, 150.0 + 160.0 * y],
        }
    })
}

fn picture(name: &str, width: u32, height: u32, colour: impl Fn(u32, u32) -> [f64; 3]) -> Texture {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels = places.map(|(x, y)| colour(x, y).map(|part| part.round() as u8)).collect();
    Texture { name: name.to_owned(), width, height, pixels }
}
