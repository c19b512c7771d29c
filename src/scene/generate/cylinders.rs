//! Cylinders of long skinny triangles that lie along no axis (Ize, thesis ch. 3 and 4): what boxes fit worst.
//!
//! A side is two triangles as long as the cylinder and an end is a fan, so `n` sides make `4 n - 4` triangles: 196, 596,
//! 1,996, 3,996 and 19,996, the thesis' counts, are 50, 150, 500, 1,000 and 5,000 sides. Its length, width and
//! direction are not told there; here it is ten times as long as wide, along (1, 1, 1).

use std::f64::consts::TAU;

use glam::{Affine3A, DVec3};

use super::super::{Mesh, Scene};
use super::{Aisles, Generator};

pub(super) const SIDES_50: Generator = Generator {
    name: "cylinder-196",
    about: "diagonal cylinder of 196 skinny triangles (Ize ch. 4)",
    generate: || generate("cylinder-196", 50),
    aisles: || Aisles::NONE,
};

pub(super) const SIDES_150: Generator = Generator {
    name: "cylinder-596",
    about: "the same of 596 (Ize ch. 3)",
    generate: || generate("cylinder-596", 150),
    aisles: || Aisles::NONE,
};

pub(super) const SIDES_500: Generator = Generator {
    name: "cylinder-1996",
    about: "the same of 1,996",
    generate: || generate("cylinder-1996", 500),
    aisles: || Aisles::NONE,
};

pub(super) const SIDES_1000: Generator = Generator {
    name: "cylinder-3996",
    about: "the same of 3,996",
    generate: || generate("cylinder-3996", 1000),
    aisles: || Aisles::NONE,
};

pub(super) const SIDES_5000: Generator = Generator {
    name: "cylinder-19996",
    about: "the same of 19,996",
    generate: || generate("cylinder-19996", 5000),
    aisles: || Aisles::NONE,
};

fn generate(name: &str, sides: u32) -> Scene {
    let mut scene = Scene::new(name);
    let mesh = scene.add_mesh(diagonal(name, sides));
    scene.add_node(None, name, Affine3A::IDENTITY, Some(mesh));
    scene
}

/// From (-5, -5, -5) to (5, 5, 5) metres.
fn diagonal(name: &str, sides: u32) -> Mesh {
    let end = DVec3::splat(5.0);
    let axis = end.normalize();
    let across = DVec3::new(1.0, -1.0, 0.0).normalize();
    let over = axis.cross(across);
    let radius = end.length() / 10.0;
    let corner = |end: DVec3, side: u32| {
        let (sin, cos) = (f64::from(side) / f64::from(sides) * TAU).sin_cos();
        (end + (across * cos + over * sin) * radius).as_vec3()
    };
    let ends = [-end, end].into_iter();
    let positions = ends.flat_map(|end| (0..sides).map(move |side| corner(end, side))).collect();
    let around = (0..sides).flat_map(|side| {
        let next = (side + 1) % sides;
        [[side, next, sides + next], [side, sides + next, sides + side]]
    });
    let fans = (1..sides - 1).flat_map(|side| [[0, side + 1, side], [sides, sides + side, sides + side + 1]]);
    Mesh::new(name, positions, around.chain(fans).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::describe;

    #[test]
    fn counts_are_the_thesis_and_triangles_skinny() {
        for generator in [SIDES_50, SIDES_150, SIDES_500, SIDES_1000, SIDES_5000] {
            let scene = generator.generate();
            scene.validate().unwrap();
            let holds = describe(&scene);
            assert_eq!(generator.name, format!("cylinder-{}", holds.instanced_triangles));
            assert!(holds.aspect_p50 > 70.0 && holds.zero_area == 0, "{holds:?}");
            // Outward: the volume within is positive, and nearly that of a round cylinder.
            let mesh = &scene.meshes[0];
            let volume: f64 = mesh.triangles.iter().fold(0.0, |sum, corners| {
                let [a, b, c] = corners.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
                sum + a.dot(b.cross(c)) / 6.0
            });
            let length = 300.0_f64.sqrt();
            let round = TAU / 2.0 * length * length / 400.0 * length;
            assert!(volume > 0.99 * round && volume < round, "{volume} of {round}");
        }
    }
}
