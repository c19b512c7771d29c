//! Flocks of spheres (Parker et al. 1999, sec. 4 and Fig. 5: 35 million of them, read from a simulation): primitives,
//! not meshes. Evenly spread in a cube and small enough that one sees into it; the more the smaller.

use glam::Vec3;

use super::super::{Material, PointLight, Primitive, Scene, Shape, SplitMix64, View};
use super::{Aisles, Generator};
use crate::geometry::Sphere;

pub(super) const THOUSANDS: Generator = Generator {
    name: "spheres-10k",
    about: "10,000 spheres in a cube, matt, metal and polished: primitives, no meshes",
    generate: || flock("spheres-10k", 10_000),
    aisles: || Aisles::NONE,
};

pub(super) const MILLION: Generator = Generator {
    name: "spheres-1m",
    about: "the same, 1,000,000 (stand-in for the 35 million of Parker et al.)",
    generate: || flock("spheres-1m", 1_000_000),
    aisles: || Aisles::NONE,
};

/// Edge of the cube about the origin, in metres.
const EDGE: f64 = 20.0;
/// Edge of the cube a sphere has on average, over its greatest radius: about 2 % of space is filled.
const SPARSE: f64 = 5.0;

fn flock(name: &str, count: u32) -> Scene {
    let mut scene = Scene::new(name);
    let red = Vec3::new(0.75, 0.2, 0.12);
    let materials = [
        Material::matt("clay", red),
        Material::metal("brass", Vec3::new(0.8, 0.6, 0.25), 60),
        Material::polished("lacquer", Vec3::new(0.15, 0.3, 0.6), 1.5),
    ];
    for material in materials {
        scene.add_material(material);
    }
    let mut random = SplitMix64::new(1999);
    let greatest = EDGE / f64::from(count).cbrt() / SPARSE * 2.0;
    scene.primitives = (0..count).map(|_| sphere(&mut random, greatest)).collect();
    let half = EDGE as f32 / 2.0;
    scene.lights = vec![
        PointLight { position: Vec3::new(-2.0, 3.0, 2.5) * half, colour: Vec3::splat(0.75) },
        PointLight { position: Vec3::new(3.0, 1.0, 1.0) * half, colour: Vec3::splat(0.3) },
    ];
    scene.view =
        Some(View { eye: Vec3::new(1.4, 1.1, 2.3) * half, look: Vec3::ZERO, up: Vec3::Y, fov_y: 1.05 });
    scene
}

fn sphere(random: &mut SplitMix64, greatest: f64) -> Primitive {
    let radius = random.between(0.3, 1.0) * greatest;
    let room = EDGE / 2.0 - radius;
    let [x, y, z] = [(); 3].map(|()| random.between(-room, room) as f32);
    let material = Some(random.below(3) as u32);
    let sphere = Sphere { centre: Vec3::new(x, y, z), radius: radius as f32 };
    Primitive { shape: Shape::Sphere(sphere), material }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flocks_have_their_number_and_stay_in_their_cube() {
        let scene = THOUSANDS.generate();
        scene.validate().unwrap();
        assert_eq!(scene.primitives.len(), 10_000);
        let size = scene.bounds().size();
        assert!(size.min_element() > 19.9 && size.max_element() <= 20.001, "{size}");
        let filled: f64 = scene
            .primitives
            .iter()
            .map(|primitive| match primitive.shape {
                Shape::Sphere(sphere) => f64::from(sphere.radius).powi(3) * 4.19,
                Shape::Cone(_) => 0.0,
            })
            .sum();
        assert!((0.01..0.2).contains(&(filled / EDGE.powi(3))), "{filled}");
    }
}
