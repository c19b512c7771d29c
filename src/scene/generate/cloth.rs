//! A rippled sheet, for queries of a body that bends into itself.
//!
//! Its ripples have lengths that do not divide its own, so where it is rolled up further than once about, the layers
//! cross instead of lying in each other.

use glam::{Affine3A, Vec3};

use super::super::{Mesh, Scene};
use super::{Aisles, Generator};

/// Cells along x, and along z.
const CELLS: [u32; 2] = [160, 48];
/// Along x and along z, in metres.
const SIZE: [f64; 2] = [1.0, 0.3];
/// How high the ripples are, in metres, and how many there are along each side.
const HEIGHT: f64 = 0.004;
const RIPPLES: [f64; 2] = [9.3, 3.7];

pub(super) const CLOTH: Generator = Generator {
    name: "cloth",
    about: "rippled sheet of 1 m by 0.3 m, 15,360 triangles, to be rolled up into itself",
    generate: cloth,
    aisles: || Aisles::NONE,
};

fn cloth() -> Scene {
    let [columns, rows] = CELLS.map(|cells| cells + 1);
    let point = |i: u32| {
        let share = [i % columns, i / columns].map(f64::from);
        let [x, z] = [0, 1].map(|axis| share[axis] / f64::from(CELLS[axis]));
        let [a, b] = [x * RIPPLES[0], z * RIPPLES[1]].map(|ripple| (ripple * std::f64::consts::TAU).sin());
        Vec3::new((x * SIZE[0]) as f32, (HEIGHT * a * b) as f32, (z * SIZE[1]) as f32)
    };
    let positions = (0..columns * rows).map(point).collect();
    // Anticlockwise seen from above.
    let cell = |i: u32| {
        let a = i % CELLS[0] + i / CELLS[0] * columns;
        let [b, c, d] = [a + 1, a + columns, a + columns + 1];
        [[a, c, b], [b, c, d]]
    };
    let triangles = (0..CELLS[0] * CELLS[1]).flat_map(cell).collect();
    let mut scene = Scene::new("cloth");
    let mesh = scene.add_mesh(Mesh::new("cloth", positions, triangles));
    scene.add_node(None, "cloth", Affine3A::IDENTITY, Some(mesh));
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_one_sheet_seen_from_above() {
        let scene = cloth();
        scene.validate().unwrap();
        assert_eq!(scene.instances(), (1, 15_360));
        let mesh = &scene.meshes[0];
        let mut area = 0.0;
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
            let normal = (b - a).cross(c - a);
            assert!(normal.y > 0.0, "{corners:?}");
            area += f64::from(normal.y) / 2.0;
        }
        assert!((area - SIZE[0] * SIZE[1]).abs() < 1e-5, "{area}");
        let height = scene.bounds().size().y;
        assert!(height > 0.007 && height <= 0.008, "{height}");
    }
}
