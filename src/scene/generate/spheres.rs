//! Flocks of spheres (Parker et al. 1999, sec. 4 and Fig. 5: 35 million of them, read from a simulation): primitives,
//! not meshes. Evenly spread in a cube and small enough that one sees into it; the more the smaller.

use glam::{Affine3A, Mat3A, Vec3, Vec3A};

use super::super::{Flock, Material, PointLight, Primitive, Scene, Shape, SplitMix64, View};
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
    about: "the same, 1,000,000",
    generate: || flock("spheres-1m", 1_000_000),
    aisles: || Aisles::NONE,
};

pub(super) const ALL: Generator = Generator {
    name: "spheres-35m",
    about: "the same, 35,000,000: a flock of 280,000 in 125 places, turned and mirrored (stand-in for the 35 million of Parker et al.)",
    generate: many_flocks,
    aisles: || Aisles::NONE,
};

/// Edge of the cube about the origin, in metres.
const EDGE: f64 = 20.0;
/// Flocks along an edge of the cube of the largest scene, and spheres of each: 35 million in all.
const ACROSS: u32 = 5;
const EACH: u32 = 280_000;
/// Edge of the cube a sphere has on average, over its greatest radius: about 2 % of space is filled.
const SPARSE: f64 = 5.0;

fn flock(name: &str, count: u32) -> Scene {
    let mut scene = lit(name);
    scene.primitives = spheres(EDGE, count);
    scene
}

/// A cube of flocks, all the same one but for how they are turned and mirrored. What is in memory is one of them.
fn many_flocks() -> Scene {
    let mut scene = lit("spheres-35m");
    let edge = EDGE / f64::from(ACROSS);
    let mut random = SplitMix64::new(35);
    let mut flock = Flock { name: "flock".into(), primitives: spheres(edge, EACH), nodes: Vec::new() };
    for place in 0..ACROSS.pow(3) {
        let at = [place % ACROSS, place / ACROSS % ACROSS, place / ACROSS.pow(2)];
        let at = at.map(|at| ((f64::from(at) + 0.5) * edge - EDGE / 2.0) as f32);
        // One of the 48 ways in which a cube comes to lie on itself: nothing is rounded.
        let mut axes = [Vec3A::X, Vec3A::Y, Vec3A::Z];
        (0..3).for_each(|axis| axes.swap(axis, axis + random.below(3 - axis)));
        let [x, y, z] = axes.map(|axis| if random.below(2) == 0 { axis } else { -axis });
        let turned = Affine3A { matrix3: Mat3A::from_cols(x, y, z), translation: Vec3A::from(at) };
        flock.nodes.push(scene.add_node(None, format!("flock {place}"), turned, None));
    }
    scene.flocks.push(flock);
    scene
}

/// No spheres yet, but what they are made of and seen by.
fn lit(name: &str) -> Scene {
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
    let half = EDGE as f32 / 2.0;
    scene.lights = vec![
        PointLight { position: Vec3::new(-2.0, 3.0, 2.5) * half, colour: Vec3::splat(0.75) },
        PointLight { position: Vec3::new(3.0, 1.0, 1.0) * half, colour: Vec3::splat(0.3) },
    ];
    scene.view =
        Some(View { eye: Vec3::new(1.4, 1.1, 2.3) * half, look: Vec3::ZERO, up: Vec3::Y, fov_y: 1.05 });
    scene
}

/// Spheres in a cube about the origin.
fn spheres(edge: f64, count: u32) -> Vec<Primitive> {
    let mut random = SplitMix64::new(1999);
    let greatest = edge / f64::from(count).cbrt() / SPARSE * 2.0;
    (0..count).map(|_| sphere(&mut random, edge, greatest)).collect()
}

fn sphere(random: &mut SplitMix64, edge: f64, greatest: f64) -> Primitive {
    let radius = random.between(0.3, 1.0) * greatest;
    let room = edge / 2.0 - radius;
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

    #[test]
    fn thirty_five_million_are_one_flock_in_many_places() {
        let scene = ALL.generate();
        scene.validate().unwrap();
        assert_eq!(scene.primitives_placed(), 35_000_000);
        assert_eq!((scene.flocks.len(), scene.flocks[0].primitives.len()), (1, 280_000));
        let size = scene.bounds().size();
        assert!(size.min_element() > 19.99 && size.max_element() <= 20.001, "{size}");
        let mut ways: Vec<_> = scene.nodes.iter().map(|node| format!("{}", node.transform.matrix3)).collect();
        ways.sort();
        ways.dedup();
        assert!(ways.len() > 40, "{} ways of 48", ways.len());
    }
}
