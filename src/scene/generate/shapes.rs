//! Boxes and cylinders as closed triangle meshes, wound anticlockwise seen from outside.

use glam::Vec3;

use super::super::Mesh;

/// Triangles of [`cuboid`].
pub(super) const CUBOID_TRIANGLES: u32 = 12;

/// The least number of triangles [`cylinder`] can be made of.
pub(super) const LEAST_CYLINDER: u32 = 8;

/// A box standing on the origin: centred in x and z, from 0 up in y; sizes in metres.
pub(in crate::scene) fn cuboid(name: &str, size: Vec3) -> Mesh {
    let corner = |i: u32| {
        let pick = |bit: u32| if i >> bit & 1 == 0 { -0.5 } else { 0.5 };
        Vec3::new(pick(0), pick(1) + 0.5, pick(2)) * size
    };
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new(name, (0..8).map(corner).collect(), triangles)
}

/// A cylinder about the y axis, standing on the origin, of exactly `count` triangles; sizes in metres.
///
/// With `n` sides in `h` rings there are `2 n h` triangles around and `2 (n - 2)` on the ends; what is
/// still wanting is made up by splitting triangles of the top at their middle, two more for each.
///
/// # Panics
/// If `count` is odd or below [`LEAST_CYLINDER`].
pub(in crate::scene) fn cylinder(name: &str, radius: f32, height: f32, count: u32) -> Mesh {
    assert!(count >= LEAST_CYLINDER && count.is_multiple_of(2), "{count} triangles cannot make a cylinder");
    // As many rings as keep the triangles around the side from getting skinny.
    let rings = (1..).find(|h| (count + 4) / (2 * (h + 1)) <= 12 * h).unwrap_or(1);
    let sides = ((count + 4) / (2 * (rings + 1))).max(3);
    let mut positions = Vec::new();
    for ring in 0..=rings {
        let y = height * ring as f32 / rings as f32;
        positions.extend((0..sides).map(|side| {
            let angle = f64::from(side) / f64::from(sides) * std::f64::consts::TAU;
            Vec3::new(radius * angle.cos() as f32, y, radius * -(angle.sin() as f32))
        }));
    }
    let mut triangles = Vec::new();
    let at = |ring: u32, side: u32| ring * sides + side % sides;
    for ring in 0..rings {
        for side in 0..sides {
            let (a, b) = (at(ring, side), at(ring, side + 1));
            let (c, d) = (at(ring + 1, side), at(ring + 1, side + 1));
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    let mut top = triangles.len();
    for side in 1..sides - 1 {
        triangles.push([at(rings, 0), at(rings, side), at(rings, side + 1)]);
    }
    triangles.extend((1..sides - 1).map(|side| [0, side + 1, side]));
    while (triangles.len() as u32) < count {
        let [a, b, c] = triangles[top];
        let middle = [a, b, c].map(|vertex| positions[vertex as usize]).into_iter().sum::<Vec3>() / 3.0;
        let new = positions.len() as u32;
        positions.push(middle);
        triangles[top] = [a, b, new];
        triangles.extend([[b, c, new], [c, a, new]]);
        top += 1;
    }
    Mesh::new(name, positions, triangles)
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    /// Each edge must be walked once each way, and the enclosed volume must be positive.
    fn check_closed(mesh: &Mesh) -> f32 {
        let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
        let mut volume = 0.0;
        for [a, b, c] in &mesh.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((*from, *to)).or_default() += 1;
                *edges.entry((*to, *from)).or_default() -= 1;
            }
            let [a, b, c] = [a, b, c].map(|vertex| mesh.positions[*vertex as usize]);
            volume += a.dot(b.cross(c)) / 6.0;
        }
        assert!(edges.values().all(|balance| *balance == 0), "{} has an open edge", mesh.name);
        volume
    }

    #[test]
    fn shapes_are_closed_and_of_the_right_count() {
        let unit = cuboid("cuboid", Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(unit.triangles.len() as u32, CUBOID_TRIANGLES);
        assert!((check_closed(&unit) - 6.0).abs() < 1e-5);
        for count in (LEAST_CYLINDER..3000).step_by(2) {
            let mesh = cylinder("cylinder", 1.0, 2.0, count);
            assert_eq!(mesh.triangles.len() as u32, count);
            let volume = check_closed(&mesh);
            assert!(volume > 2.5 && volume < 6.29, "{count} triangles hold {volume}");
        }
    }
}
