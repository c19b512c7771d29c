//! Waves are held against rays followed one by one.

use glam::Vec3;

use super::tests::scene;
use super::*;
use crate::geometry::hit::Cone;
use crate::geometry::{Camera, Sphere};
use crate::machine::Threads;
use crate::scene::{Material, PointLight, Primitive, Scene, Shape, SplitMix64};
use crate::scheme::tiles::share;
use crate::structure::bvh::Intersector;
use crate::structure::bvh::build::{Builder, Settings};

/// The corner of everything with tinted glass, glass that is not bent and mirrors a little, and seven lights: some
/// within the glass, in the eye, or where they light nothing.
fn nasty() -> (Scene, Camera) {
    let (mut scene, camera) = scene(1.0);
    let tinted = Material { absorption: Vec3::new(0.9, 0.1, 2.0), ..Material::dielectric("tinted", 1.3) };
    let film = Material {
        mirror: Vec3::new(0.2, 0.3, 0.4),
        transmission: Vec3::splat(0.5),
        ..Material::matt("film", Vec3::new(0.1, 0.0, 0.3))
    };
    let [tinted, film] = [tinted, film].map(|material| scene.add_material(material));
    let sphere = |centre: Vec3, radius: f32| Shape::Sphere(Sphere { centre, radius });
    let (base, tip) = (Vec3::new(-2.0, 0.0, 1.5), Vec3::new(-2.1, 1.2, 1.6));
    let cone = Shape::Cone(Cone { base, base_radius: 0.5, tip, tip_radius: 0.3 });
    // The second is the eye's own.
    let shapes = [
        (sphere(Vec3::new(-0.6, 0.5, 1.2), 0.45), tinted),
        (sphere(camera.eye, 0.05), film),
        (sphere(Vec3::new(0.9, 0.3, 1.6), 0.3), film),
        (cone, tinted),
    ];
    for (shape, material) in shapes {
        scene.primitives.push(Primitive { shape, material: Some(material) });
    }
    let lights =
        [camera.eye, Vec3::new(0.3, 0.7, 0.4), Vec3::new(0.0, -5.0, 0.0), Vec3::NAN, Vec3::splat(1e30)];
    scene.lights.extend(lights.map(|position| PointLight { position, colour: Vec3::new(0.1, 0.2, 0.15) }));
    (scene, camera)
}

/// Of one camera, by waves and ray by ray: the bits of colours and distances, and counts.
type Pictures = [(Vec<[u32; 4]>, Counts); 2];

fn both(
    world: &World,
    by: &dyn Intersector,
    eye: Eye,
    look: Look,
    tile: (u32, u32),
    draft: &Draft,
) -> Pictures {
    let tracer = Tracer::new(world, by, look);
    let (width, height) = eye.size();
    let threads = Threads::new(1).unwrap();
    let mut film = Film::new(&threads, width, height).unwrap();
    let frame = Frame::new(tracer, eye, tile, &mut film).drafted(draft);
    let shares = share("serial", &threads, 1, &frame).unwrap();
    let waves = film.pixels().map(|pixel| pixel.map(f32::to_bits)).collect();
    let mut counts = Counts::default();
    let mut one_by_one = Vec::new();
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let pixel = draft.known(x, y).unwrap_or_else(|| {
            let ray = eye.ray(x, y);
            let hit = by.closest(&ray);
            counts.eye += 1;
            let [r, g, b] = tracer.seen(&ray, hit, &mut counts).to_array();
            [r, g, b, hit.map_or(f32::INFINITY, |hit| hit.t)]
        });
        one_by_one.push(pixel.map(f32::to_bits));
    }
    [(waves, shares[0].found), (one_by_one, counts)]
}

#[test]
fn waves_see_what_rays_followed_one_by_one_see() {
    let (scene, camera) = nasty();
    let world = World::new(scene);
    let list = List(world.items());
    let mut builder = Builder::new("binned_sah", &Settings::default()).unwrap();
    let hierarchy = Hierarchy::new(world.items(), &mut builder, TriangleKind::Watertight).unwrap();
    let by: [&dyn Intersector; 2] = [&list, &hierarchy];
    let mut random = SplitMix64::new(5);
    let mut deepest = 0;
    for depth in [0, 1, 2, 5, 9] {
        for most_lights in [u32::MAX, 7, 3, 1, 0] {
            let look = Look { depth, most_lights, ..Look::default() };
            // Neither is a multiple of squares or of what is asked about together, and one tile takes many turns.
            for (size, tile) in [((43, 29), Tiles::OF_PAPER), ((29, 37), (29, 37)), ((1, 1), (1, 1))] {
                let eye = Eye::new(&camera, size.0, size.1);
                let mut draft = Draft::new(size);
                if most_lights == 7 {
                    let pixels = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
                    pixels
                        .filter(|_| random.below(3) == 0)
                        .for_each(|(x, y)| draft.set(x, y, [0.5, 0.25, 0.0, 9.0]));
                }
                for (number, by) in by.into_iter().enumerate() {
                    let [waves, one_by_one] = both(&world, by, eye, look, tile, &draft);
                    let what = format!("depth {depth}, {most_lights} lights, {size:?} in {tile:?}, {number}");
                    assert_eq!(waves.1, one_by_one.1, "{what}");
                    assert!(waves.0 == one_by_one.0, "{what}: another picture");
                    deepest = deepest.max(waves.1.deepest);
                }
            }
        }
    }
    assert_eq!(deepest, 9);
}
