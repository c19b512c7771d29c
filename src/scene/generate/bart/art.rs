//! The piece of art in the museum: triangles that fly from one constellation to the next, each on its own, as no
//! transform could take them (stress 2).

use std::f64::consts::TAU;

use glam::{DMat3, DQuat, DVec3, Vec3};

use crate::scene::{Bend, BendKey, Corners, Mesh, SplitMix64};

/// Where its middle floats, in metres.
const MIDDLE: DVec3 = DVec3::new(0.0, 2.1, 0.0);

/// The mesh and its five constellations, at 0 to 4 s: a tetrahedron, whose four faces are cut into `4^k` triangles; all
/// strewn in a cylinder and turned at random; a cube; a sphere; a blossom.
///
/// Each triangle has three vertices of its own and normals at them.
pub(super) fn art(k: u32) -> (Mesh, Bend) {
    let faces = tetrahedron(1 << (k - 1));
    let mut random = SplitMix64::new(u64::from(k));
    // As long as the edges of the tetrahedron's triangles.
    let edge = 1.3 * (8.0_f64 / 3.0).sqrt() / f64::from(1 << (k - 1));
    let round = |point: DVec3| point.normalize() * 0.85;
    let cube = |point: DVec3| point / point.abs().max_element() * 0.62;
    let keys = [
        key(0.0, faces.iter().map(|face| flat(face.map(|point| point * 1.3)))),
        key(1.0, faces.iter().map(|_| strewn(&mut random, edge))),
        key(2.0, faces.iter().map(|face| flat(face.map(cube)))),
        key(3.0, faces.iter().map(|face| face.map(|point| (round(point), point.normalize())))),
        key(4.0, faces.iter().map(|face| flat(face.map(blossom)))),
    ];
    let count = faces.len() as u32;
    let triangles = (0..count).map(|at| [3 * at, 3 * at + 1, 3 * at + 2]).collect();
    let mut mesh = Mesh::new("art", keys[0].positions.clone(), triangles);
    mesh.shading.normals = Corners::of_vertices(keys[0].normals.clone());
    (mesh, Bend { mesh: 0, keys: keys.to_vec() })
}

/// A vertex and its normal, about the middle.
type Corner = (DVec3, DVec3);

fn key(time: f64, triangles: impl Iterator<Item = [Corner; 3]>) -> BendKey {
    let (positions, normals) = triangles
        .flatten()
        .map(|(at, normal)| ((at + MIDDLE).as_vec3(), normal.as_vec3()))
        .unzip::<Vec3, Vec3, _, _>();
    BendKey { time, positions, normals }
}

/// A triangle with its own normal at all corners.
fn flat([a, b, c]: [DVec3; 3]) -> [Corner; 3] {
    let normal = (b - a).cross(c - a).normalize_or(DVec3::Y);
    [(a, normal), (b, normal), (c, normal)]
}

/// A regular triangle somewhere in a cylinder, evenly spread, turned at random.
fn strewn(random: &mut SplitMix64, edge: f64) -> [Corner; 3] {
    let (angle, out) = (random.between(0.0, TAU), random.between(0.0, 1.0).sqrt() * 1.5);
    let place = DVec3::new(out * angle.cos(), random.between(-1.2, 1.6), out * angle.sin());
    // Three even numbers make an even rotation (Shoemake, Graphics Gems III, 1992).
    let (low, first, second) = (random.between(0.0, 1.0), random.between(0.0, TAU), random.between(0.0, TAU));
    let (a, b) = ((1.0 - low).sqrt(), low.sqrt());
    let turn = DMat3::from_quat(DQuat::from_xyzw(
        a * first.sin(),
        a * first.cos(),
        b * second.sin(),
        b * second.cos(),
    ));
    let (half, low, high) = (edge / 2.0, edge / 12.0_f64.sqrt(), edge / 3.0_f64.sqrt());
    let corners = [DVec3::new(-half, -low, 0.0), DVec3::new(half, -low, 0.0), DVec3::new(0.0, high, 0.0)];
    corners.map(|corner| (place + turn * corner, turn * DVec3::Z))
}

/// A ball with petals.
fn blossom(point: DVec3) -> DVec3 {
    let out = point.normalize();
    let about = out.z.atan2(out.x);
    let petals = (6.0 * about).cos() * (1.0 - out.y * out.y);
    out * (0.7 + 0.25 * petals + 0.12 * (7.0 * out.y).cos())
}

/// The faces of a tetrahedron with corners at distance 1, each cut into the square of `frequency` triangles,
/// anticlockwise seen from outside.
fn tetrahedron(frequency: u32) -> Vec<[DVec3; 3]> {
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]]
        .map(|corner| DVec3::from(corner) / 3.0_f64.sqrt());
    let mut triangles = Vec::with_capacity(4 * (frequency * frequency) as usize);
    for [a, b, c] in
        [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]].map(|face| face.map(|corner: usize| corners[corner]))
    {
        let at = |row: u32, column: u32| {
            let [down, on] = [row, column].map(|steps| f64::from(steps) / f64::from(frequency));
            a + (b - a) * (down - on) + (c - a) * on
        };
        for row in 0..frequency {
            for column in 0..=row {
                let (left, right) = (at(row + 1, column), at(row + 1, column + 1));
                triangles.push([at(row, column), left, right]);
                if column < row {
                    triangles.push([at(row, column), right, at(row, column + 1)]);
                }
            }
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_constellation_has_all_triangles_and_unit_normals() {
        for k in 3..=6 {
            let (mesh, bend) = art(k);
            assert_eq!((mesh.triangles.len(), bend.keys.len()), (1 << (2 * k), 5));
            for key in &bend.keys {
                assert_eq!((key.positions.len(), key.normals.len()), (3 << (2 * k), 3 << (2 * k)));
                assert!(key.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-5));
                let (corners, _) = key.positions.as_chunks::<3>();
                assert!(corners.iter().all(|[a, b, c]| (*b - *a).cross(*c - *a).length() > 1e-7));
            }
            let closed = |key: &BendKey| {
                let (corners, _) = key.positions.as_chunks::<3>();
                let middle = MIDDLE.as_vec3();
                corners
                    .iter()
                    .map(|c| (c[0] - middle).dot((c[1] - middle).cross(c[2] - middle)) / 6.0)
                    .sum::<f32>()
            };
            // Each is closed and has its outside out: their volumes are those of the bodies.
            assert!((closed(&bend.keys[0]) - 1.3_f32.powi(3) * 8.0 / 27.0 * 3.0_f32.sqrt()).abs() < 1e-3);
            assert!(
                closed(&bend.keys[3]) > 1.9 && closed(&bend.keys[3]) < 2.573,
                "a ball of 0.85 m, from within"
            );
            let radii = bend.keys[3].positions.iter().map(|at| at.distance(MIDDLE.as_vec3()));
            assert!(radii.into_iter().all(|radius| (radius - 0.85).abs() < 1e-5));
        }
    }

    #[test]
    fn the_cylinder_is_filled_evenly() {
        let (_, bend) = art(6);
        let (corners, _) = bend.keys[1].positions.as_chunks::<3>();
        let middles: Vec<Vec3> =
            corners.iter().map(|c| (c[0] + c[1] + c[2]) / 3.0 - MIDDLE.as_vec3()).collect();
        let share = |is_in: &dyn Fn(&Vec3) -> bool| {
            middles.iter().filter(|at| is_in(at)).count() as f64 / middles.len() as f64
        };
        assert_eq!(share(&|at| at.x.hypot(at.z) <= 1.5 && (-1.2..=1.6).contains(&at.y)), 1.0);
        // Half of the radius holds a quarter of the volume.
        assert!((share(&|at| at.x.hypot(at.z) < 0.75) - 0.25).abs() < 0.03);
        assert!((share(&|at| at.y < 0.2) - 0.5).abs() < 0.03 && (share(&|at| at.x < 0.0) - 0.5).abs() < 0.03);
    }
}
