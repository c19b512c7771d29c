//! Nested shells: closed surfaces that lie close to each other everywhere and touch nowhere, so that a
//! collision query of one against another has to search deeply and finds nothing. Their boxes overlap all over,
//! and only triangles tell them apart: the harder the smaller the gap.
//!
//! The triangles of the outer one sag inward by less than 0.01 % of the radius, so the gaps hold.

use glam::Affine3A;

use super::super::Scene;
use super::geodesic::geodesic;
use super::{Aisles, Generator};

/// How often each edge of the icosahedron is divided: 20 x 59 x 59 = 69,620 triangles, about as many as the
/// Stanford bunny has.
const FREQUENCY: u32 = 59;

/// Radius 1 m.
pub(super) const OUTER: Generator = Generator {
    name: "shell",
    about: "geodesic sphere of radius 1 m, 69,620 triangles, to hold the two below for collision queries",
    generate: || shell("shell", 1.0),
    aisles: || Aisles::NONE,
};

/// Radius 0.95 m.
pub(super) const FIVE_PERCENT: Generator = Generator {
    name: "shell-5",
    about: "the same of radius 0.95 m: within `shell`, a gap of 5 %",
    generate: || shell("shell-5", 0.95),
    aisles: || Aisles::NONE,
};

/// Radius 0.99 m.
pub(super) const ONE_PERCENT: Generator = Generator {
    name: "shell-1",
    about: "the same of radius 0.99 m: within `shell`, a gap of 1 %",
    generate: || shell("shell-1", 0.99),
    aisles: || Aisles::NONE,
};

fn shell(name: &str, radius: f64) -> Scene {
    let mut scene = Scene::new(name);
    let mesh = scene.add_mesh(geodesic(name, radius, FREQUENCY));
    scene.add_node(None, name, Affine3A::IDENTITY, Some(mesh));
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The least and the greatest distance of the surface from the origin. The least lies within a triangle,
    /// where the foot of the perpendicular from the origin is.
    fn distances(scene: &Scene) -> (f64, f64) {
        let mesh = &scene.meshes[0];
        let place = |vertex: u32| mesh.positions[vertex as usize].as_dvec3();
        let planes = mesh.triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(place);
            (b - a).cross(c - a).normalize().dot(a)
        });
        let corners = mesh.positions.iter().map(|position| position.as_dvec3().length());
        (planes.fold(f64::INFINITY, f64::min), corners.fold(0.0, f64::max))
    }

    #[test]
    fn shells_have_their_radii_and_the_gaps_hold() {
        let mut around = f64::INFINITY;
        for (generator, radius) in [(OUTER, 1.0), (ONE_PERCENT, 0.99), (FIVE_PERCENT, 0.95)] {
            let scene = generator.generate();
            scene.validate().unwrap();
            assert_eq!((scene.instances(), scene.meshes[0].positions.len()), ((1, 69_620), 34_812));
            let (least, most) = distances(&scene);
            assert!((most - radius).abs() < 1e-6, "{}: {most}", generator.name);
            assert!(least > radius * 0.9999 && least < radius, "{}: {least}", generator.name);
            assert!(most < around - 0.009, "{} touches the one around it", generator.name);
            around = least;
        }
    }
}
