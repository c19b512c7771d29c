//! Spheres of nearly equal triangles.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::super::Mesh;

/// Corners of each of the twenty faces of an icosahedron, anticlockwise seen from outside, as indices into
/// [`corners`].
const FACES: [[u32; 3]; 20] = [
    [0, 1, 2],
    [0, 2, 3],
    [0, 3, 4],
    [0, 4, 5],
    [0, 5, 1],
    [1, 6, 2],
    [2, 7, 3],
    [3, 8, 4],
    [4, 9, 5],
    [5, 10, 1],
    [2, 6, 7],
    [3, 7, 8],
    [4, 8, 9],
    [5, 9, 10],
    [1, 10, 6],
    [11, 7, 6],
    [11, 8, 7],
    [11, 9, 8],
    [11, 10, 9],
    [11, 6, 10],
];

/// A closed sphere about the origin, radius in metres: each face of an icosahedron is cut into the square of
/// `frequency` triangles on a plane grid and its vertices are moved out to the sphere. `20 f^2` triangles,
/// `10 f^2 + 2` vertices, each shared by all triangles about it; all on the sphere, so that the triangles lie
/// just within it: by at most `0.3 / f^2` of the radius.
///
/// # Panics
/// If `frequency` is 0.
pub(in crate::scene) fn geodesic(name: &str, radius: f64, frequency: u32) -> Mesh {
    assert!(frequency > 0, "a sphere of no triangles");
    let corners = corners();
    let mut positions: Vec<Vec3> = Vec::new();
    let mut triangles = Vec::new();
    // A vertex is told by the corners it lies between and its share of each, as whole numbers: two faces give
    // the same to a vertex they share, though not bit for bit the same place.
    let mut index_of: HashMap<[(u32, u32); 3], u32> = HashMap::new();
    for face in FACES {
        let mut at = |row: u32, column: u32| {
            let shares = [frequency - row, row - column, column];
            let mut key =
                [0, 1, 2].map(|i| if shares[i] == 0 { (u32::MAX, 0) } else { (face[i], shares[i]) });
            key.sort_unstable();
            *index_of.entry(key).or_insert_with(|| {
                let between: DVec3 = (0..3).map(|i| corners[face[i] as usize] * f64::from(shares[i])).sum();
                positions.push((between.normalize() * radius).as_vec3());
                positions.len() as u32 - 1
            })
        };
        for row in 0..frequency {
            for column in 0..=row {
                let [a, b] = [at(row, column), at(row + 1, column)];
                let c = at(row + 1, column + 1);
                triangles.push([a, b, c]);
                if column < row {
                    triangles.push([a, c, at(row, column + 1)]);
                }
            }
        }
    }
    Mesh::new(name, positions, triangles)
}

/// The twelve corners of an icosahedron at distance 1: a top, a ring of five, another turned by half a step, and
/// a bottom. The rings lie at a height of 1 / sqrt 5.
fn corners() -> [DVec3; 12] {
    let height = 0.2f64.sqrt();
    std::array::from_fn(|corner| match corner {
        0 => DVec3::Y,
        11 => DVec3::NEG_Y,
        _ => {
            let (ring, step) = ((corner - 1) / 5, (corner - 1) % 5);
            let angle = (step as f64 + 0.5 * ring as f64) * std::f64::consts::TAU / 5.0;
            let rise = if ring == 0 { height } else { -height };
            DVec3::new(2.0 * height * angle.sin(), rise, 2.0 * height * angle.cos())
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_are_closed_round_and_of_the_right_counts() {
        for (frequency, radius) in [(1, 1.0), (2, 1e-3), (3, 0.95), (8, 1.0), (59, 1e6)] {
            let sphere = geodesic("sphere", radius, frequency);
            let square = (frequency * frequency) as usize;
            assert_eq!((sphere.triangles.len(), sphere.positions.len()), (20 * square, 10 * square + 2));
            // Each edge is walked once each way, so that three sides of a triangle make one and a half edges,
            // and corners, edges and faces add up to a sphere's 2 (Euler).
            let mut edges: HashMap<(u32, u32), u32> = HashMap::new();
            for [a, b, c] in &sphere.triangles {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    *edges.entry((*from, *to)).or_default() += 1;
                }
            }
            assert!(edges.iter().all(|((from, to), count)| *count == 1 && edges.contains_key(&(*to, *from))));
            assert_eq!(sphere.positions.len() + sphere.triangles.len() - edges.len() / 2, 2);
            for position in &sphere.positions {
                assert!((position.as_dvec3().length() / radius - 1.0).abs() < 1e-7, "{position}");
            }
            for corners in &sphere.triangles {
                let [a, b, c] = corners.map(|vertex| sphere.positions[vertex as usize].as_dvec3());
                let within = 1.0 - (b - a).cross(c - a).normalize().dot(a) / radius;
                assert!(within > 0.0 && within < 0.3 / f64::from(frequency * frequency), "{within}");
            }
            let solid_angle: f64 = sphere.triangles.iter().map(|corners| seen(&sphere, *corners)).sum();
            assert!((solid_angle / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-5, "{solid_angle}");
        }
    }

    /// The solid angle of a triangle seen from the origin, positive if it is anticlockwise from outside (van
    /// Oosterom and Strackee, "The Solid Angle of a Plane Triangle", IEEE Trans. Biomed. Eng. 1983, eq. 8).
    fn seen(sphere: &Mesh, corners: [u32; 3]) -> f64 {
        let [a, b, c] = corners.map(|vertex| sphere.positions[vertex as usize].as_dvec3().normalize());
        let angle = 2.0 * a.dot(b.cross(c)).atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        assert!(angle > 0.0, "a triangle faces inward");
        angle
    }
}
