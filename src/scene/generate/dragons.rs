//! Large meshes, many times over: stand-ins for the scenes of Bubenicek 2020, sec. 4.1 to 4.3 (BU-10).
//!
//! The thesis has 60 copies of a scanned dragon of 7.2 million triangles, far apart and packed, and 20 of
//! a model of about 16 million. What stands in for both here is generated: a knobbly tube along a trefoil
//! knot, closed, winding about itself and of a stated number of triangles. The scanned dragon can be brought
//! with `--scene FILE`. Two more meshes show where midpoint subdivision fails (BU-F06): one whose triangles
//! all have the same centroid, one with a triangle far away from all others.

use std::f64::consts::TAU;

use glam::{Affine3A, DVec3, Vec3};

use super::super::{Mesh, Scene};
use super::{Aisles, Generator};

/// Rings along the tube and corners of each: 2 x 784 x 64 = 100,352 triangles.
const DRAGON: [u32; 2] = [784, 64];
/// As much larger as the thesis's second model is: 2 x 1172 x 95 = 222,680 triangles.
const PILLAR: [u32; 2] = [1172, 95];
/// Triangles that share a centroid.
const SPOKES: u32 = 4096;
/// How far away the outlier lies, in metres.
const FAR: f32 = 8192.0;

/// Metres from copy to copy, far apart: as much air between two as they are wide.
const FAR_APART: f32 = 24.0;
/// Packed: a knot is 11.9 m wide.
const PACKED: f32 = 12.0;

/// One knot, 12 m wide.
pub(super) const ONE: Generator = Generator {
    name: "dragon",
    about: "knobbly knot, closed, 100,352 triangles (stand-in: Bubenicek sec. 4.1 has a dragon of 7.2 million)",
    generate: || grid("dragon", DRAGON, 1, 1, FAR_APART),
    aisles: || aisles(1, 1, FAR_APART),
};

/// Sixty, far apart.
pub(super) const SPLIT: Generator = Generator {
    name: "dragons-split",
    about: "60 knobbly knots far apart, 6.0 million triangles (stand-in: Bubenicek sec. 4.1 has 432 million)",
    generate: || grid("dragons-split", DRAGON, 10, 6, FAR_APART),
    aisles: || aisles(10, 6, FAR_APART),
};

/// Sixty, side by side.
pub(super) const PACKED_SIXTY: Generator = Generator {
    name: "dragons-packed",
    about: "60 knobbly knots side by side, 6.0 million triangles (stand-in: Bubenicek sec. 4.2)",
    generate: || grid("dragons-packed", DRAGON, 10, 6, PACKED),
    aisles: || aisles(10, 6, PACKED),
};

/// Twenty of another.
pub(super) const POMPEII: Generator = Generator {
    name: "pompeii",
    about: "20 knobbly knots of 222,680 triangles (stand-in: Bubenicek sec. 4.3 has 20 of 16 million)",
    generate: || grid("pompeii", PILLAR, 5, 4, FAR_APART),
    aisles: || aisles(5, 4, FAR_APART),
};

/// All triangles with one centroid.
pub(super) const SPOKED: Generator = Generator {
    name: "equal-centroids",
    about: "4096 triangles with the same centroid: no midpoint can part them (BU-F06)",
    generate: || alone("equal-centroids", spokes()),
    aisles: || aisles(1, 1, FAR_APART),
};

/// A knot and one triangle far away.
pub(super) const OUTLIER: Generator = Generator {
    name: "far-outlier",
    about: "knobbly knot of 100,352 triangles and one triangle 8 km away (BU-F06)",
    generate: || alone("far-outlier", with_outlier(knot(DRAGON))),
    aisles: || aisles(1, 1, FAR_APART),
};

fn alone(name: &str, mesh: Mesh) -> Scene {
    let mut scene = Scene::new(name);
    let mesh = scene.add_mesh(mesh);
    scene.add_node(None, name, Affine3A::IDENTITY, Some(mesh));
    scene
}

/// Copies in columns along x and rows along z.
fn grid(name: &str, size: [u32; 2], columns: u32, rows: u32, pitch: f32) -> Scene {
    let mut scene = Scene::new(name);
    let mesh = scene.add_mesh(knot(size));
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let place = Vec3::new(column as f32, 0.0, row as f32) * pitch;
        scene.add_node(None, format!("copy {row} {column}"), Affine3A::from_translation(place), Some(mesh));
    }
    scene
}

/// Through the middles of the knots, which are open, and between them.
fn aisles(columns: u32, rows: u32, pitch: f32) -> Aisles {
    let lanes = |count: u32| {
        let middles = (0..count).map(|lane| lane as f32 * pitch);
        let lanes = middles.flat_map(|middle| [middle - 0.5, middle + 0.5]);
        lanes.collect()
    };
    Aisles { x: lanes(columns), z: lanes(rows), far: (columns + rows + 1) as f32 * pitch }
}

/// The middle line of the tube: a trefoil knot about the y axis, in metres.
fn line(along: f64) -> DVec3 {
    let reach = 3.6 + 1.3 * (3.0 * along).cos();
    DVec3::new(reach * (2.0 * along).cos(), 2.2 + 1.3 * (3.0 * along).sin(), reach * (2.0 * along).sin())
}

/// A knobbly tube along a trefoil knot: `rings` rings of `sides` corners, twice as many triangles as the two
/// make multiplied.
fn knot([rings, sides]: [u32; 2]) -> Mesh {
    let mut positions = Vec::with_capacity((rings * sides) as usize);
    for ring in 0..rings {
        let along = f64::from(ring) / f64::from(rings) * TAU;
        let ahead = (line(along + 1e-4) - line(along - 1e-4)).normalize();
        // The line never runs straight up, so that "up" always gives a frame, and the same one after a round.
        let across = ahead.cross(DVec3::Y).normalize();
        let over = across.cross(ahead);
        for side in 0..sides {
            let around = f64::from(side) / f64::from(sides) * TAU;
            let knob = (40.0 * along).sin() * (5.0 * around).cos();
            let scale = (230.0 * along + 3.0 * around).sin() * (17.0 * around).sin();
            let radius = 0.75 + 0.12 * knob + 0.03 * scale;
            let place = line(along) + (across * around.cos() + over * around.sin()) * radius;
            positions.push(place.as_vec3());
        }
    }
    let at = |ring: u32, side: u32| ring % rings * sides + side % sides;
    let cells = (0..rings).flat_map(|ring| (0..sides).map(move |side| (ring, side)));
    let triangles = cells.flat_map(|(ring, side)| {
        let [a, b] = [at(ring, side), at(ring, side + 1)];
        let [c, d] = [at(ring + 1, side), at(ring + 1, side + 1)];
        [[a, b, d], [a, d, c]]
    });
    Mesh::new("knot", positions, triangles.collect())
}

/// A star of triangles about one point, each turned a little further. All coordinates are small multiples
/// of 1/64, so that the three corners of each add up to exactly three times that point.
fn spokes() -> Mesh {
    let centre = Vec3::new(0.0, 2.0, 0.0);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for spoke in 0..SPOKES {
        let turn = f64::from(spoke) * 2.399_963_229_728_653;
        let rise = 1.0 - 2.0 * f64::from(spoke) / f64::from(SPOKES);
        let flat = (1.0 - rise * rise).sqrt();
        let out = DVec3::new(flat * turn.cos(), rise, flat * turn.sin());
        let aside = out.cross(if rise.abs() < 0.9 { DVec3::Y } else { DVec3::X }).normalize();
        let dyadic = |place: DVec3| (place * 64.0).round().as_vec3() / 64.0;
        let (one, other) = (dyadic(out * 1.9), dyadic(aside * 0.5 - out * 0.9));
        let first = positions.len() as u32;
        positions.extend([centre + one, centre + other, centre - one - other]);
        triangles.push([first, first + 1, first + 2]);
    }
    Mesh::new("spokes", positions, triangles)
}

fn with_outlier(mut mesh: Mesh) -> Mesh {
    let first = mesh.positions.len() as u32;
    let place = Vec3::new(FAR, 2.0, 0.0);
    mesh.positions.extend([place, place + Vec3::Y, place + Vec3::Z]);
    mesh.triangles.push([first, first + 1, first + 2]);
    Mesh::new(mesh.name, mesh.positions, mesh.triangles)
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[test]
    fn knots_are_closed_and_of_the_stated_count() {
        for (size, count) in [(DRAGON, 100_352), (PILLAR, 222_680), ([3, 3], 18)] {
            let mesh = knot(size);
            assert_eq!(mesh.triangles.len(), count);
            let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
            for [a, b, c] in &mesh.triangles {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    *edges.entry((*from, *to)).or_default() += 1;
                    *edges.entry((*to, *from)).or_default() -= 1;
                }
            }
            assert!(edges.values().all(|balance| *balance == 0), "{size:?} has an open edge");
        }
        let size = knot(DRAGON).bounds.size();
        assert!(size.x.max(size.z) < PACKED && size.y > 3.0, "a knot is {size}");
    }

    #[test]
    fn spokes_share_their_centroid_exactly() {
        let mesh = spokes();
        for triangle in &mesh.triangles {
            let sum: Vec3 = triangle.map(|vertex| mesh.positions[vertex as usize]).into_iter().sum();
            assert_eq!(sum, Vec3::new(0.0, 6.0, 0.0));
        }
    }

    #[test]
    fn copies_share_one_mesh() {
        let scene = SPLIT.generate();
        assert_eq!((scene.meshes.len(), scene.instances()), (1, (60, 6_021_120)));
        assert_eq!(POMPEII.generate().instances(), (20, 4_453_600));
    }
}
