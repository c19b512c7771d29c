use glam::{Affine3A, Mat3A, Vec3, Vec3A};

use super::tests::{bits, scene};
use super::*;
use crate::geometry::Aabb;
use crate::geometry::hit::Cone;
use crate::geometry::{Hit, Ray, Sphere};
use crate::scene::{Bent, Flock, Mesh, Primitive, Scene, Shape, SplitMix64, by_name};
use crate::structure::bvh::Intersector;
use crate::structure::bvh::build::{Builder, Settings};

fn builder() -> Builder {
    Builder::new("binned_sah", &Settings::default()).unwrap()
}

fn point(random: &mut SplitMix64, within: f64) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| random.between(-within, within) as f32))
}

fn picture(world: &World, camera: &crate::geometry::Camera, levels: Levels, kind: TriangleKind) -> Image {
    let hierarchy = Hierarchy::of(world, levels, &mut builder(), kind).unwrap();
    let threads = crate::machine::Threads::new(1).unwrap();
    let mut film = Film::new(&threads, 90, 70).unwrap();
    let tracer = Tracer::new(world, &hierarchy, Look::default());
    let frame = Frame::new(tracer, Eye::new(camera, 90, 70), Tiles::OF_PAPER, &mut film);
    crate::scheme::tiles::share("serial", &threads, 1, &frame).unwrap();
    film.image()
}

#[test]
fn two_levels_make_the_picture_of_one_bit_for_bit_where_nothing_is_moved() {
    let (everything, camera) = scene(1.0);
    for (_, kind) in TriangleKind::ALL {
        let world = World::new(everything.clone());
        let [one, two] = [Levels::One, Levels::Two].map(|levels| picture(&world, &camera, levels, *kind));
        assert!(bits(&one) == bits(&two), "{kind:?}");
    }
    // Meshes of many triangles, brought to where they stand beforehand.
    let mut robot = by_name("robot").unwrap();
    let transforms = robot.world_transforms();
    let placed = std::mem::take(&mut robot.nodes);
    let meshes = std::mem::take(&mut robot.meshes);
    robot.roots.clear();
    for (node, transform) in placed.iter().zip(transforms) {
        let Some(mesh) = node.mesh else { continue };
        let mut mesh = meshes[mesh as usize].clone();
        mesh.positions.iter_mut().for_each(|position| *position = transform.transform_point3(*position));
        let mesh = robot.add_mesh(mesh);
        robot.add_node(None, "placed", Affine3A::IDENTITY, Some(mesh));
    }
    let camera = default_view(&robot, 9.0 / 7.0).unwrap();
    let world = World::new(robot);
    let [one, two] =
        [Levels::One, Levels::Two].map(|levels| picture(&world, &camera, levels, TriangleKind::Watertight));
    assert!(bits(&one) == bits(&two) && one.pixels.iter().any(|pixel| *pixel != one.pixels[0]));
}

/// Spheres and cones, alone and in flocks that stand in places of all sorts, some of them flat.
fn flocks() -> Scene {
    let mut random = SplitMix64::new(8);
    let mut some = |count: usize| {
        let one = |number: usize| {
            let radius = random.between(0.0, 0.4) as f32;
            let shape = if number.is_multiple_of(3) {
                let [base, tip] = [(); 2].map(|()| point(&mut random, 2.0));
                Shape::Cone(Cone { base, base_radius: radius, tip, tip_radius: 0.5 * radius })
            } else {
                Shape::Sphere(Sphere { centre: point(&mut random, 2.0), radius })
            };
            Primitive { shape, material: None }
        };
        (0..count).map(one).collect::<Vec<_>>()
    };
    let mut scene = Scene::new("flocks");
    scene.primitives = some(20);
    let turn = Mat3A::from_rotation_z(0.8) * Mat3A::from_rotation_x(-1.9);
    let squeeze = |x: f32, y: f32, z: f32| Mat3A::from_diagonal(Vec3::new(x, y, z));
    for (primitives, ways) in [
        (
            some(70),
            vec![Mat3A::IDENTITY, turn, squeeze(-1.0, 1.0, 1.0) * turn, squeeze(1.0, 0.05, 2.0) * turn],
        ),
        (Vec::new(), vec![turn]),
        (some(15), vec![squeeze(1.0, 0.0, 1.0), squeeze(1e-3, 1e-3, 1e-3), Mat3A::ZERO, Mat3A::IDENTITY]),
        (some(1), Vec::new()),
    ] {
        let nodes = ways.into_iter().enumerate().map(|(number, matrix3)| {
            let translation = Vec3A::new(number as f32, -0.5, 2.0);
            scene.add_node(None, "place", Affine3A { matrix3, translation }, None)
        });
        let nodes = nodes.collect();
        scene.flocks.push(Flock { name: "flock".into(), primitives, nodes });
    }
    scene.validate().unwrap();
    scene
}

fn rays(count: usize) -> Vec<Ray> {
    let mut random = SplitMix64::new(9);
    let one = |number: usize| {
        let (from, to) = (point(&mut random, 6.0), point(&mut random, 2.0));
        let mut ray = Ray::new(from, to - from);
        match number % 8 {
            0 => ray.direction[number / 8 % 3] = 0.0,
            1 => ray = Ray { near: 0.3, far: 1.1, ..ray },
            2 => ray = Ray { near: -0.5, ..ray },
            3 => ray = Ray::new(from - ray.direction * 1e4, ray.direction * 1e-3),
            _ => {}
        }
        ray
    };
    (0..count).map(one).collect()
}

#[test]
fn flocks_are_met_where_the_list_meets_them_bit_for_bit() {
    let world = World::new(flocks());
    assert_eq!(World::count(world.scene()), world.items().len());
    let list = List(world.items());
    let mut all = rays(4000);
    let plain = Ray::new(Vec3::splat(-9.0), Vec3::ONE);
    for odd in [f32::NAN, f32::INFINITY] {
        all.push(Ray { origin: Vec3::new(0.0, odd, 0.0), ..plain });
        all.push(Ray { direction: Vec3::new(0.0, odd, 1.0), ..plain });
        all.extend([Ray { near: odd, ..plain }, Ray { far: odd, ..plain }]);
    }
    all.push(Ray { direction: Vec3::ZERO, ..plain });
    for levels in [Levels::One, Levels::Two] {
        let hierarchy = Hierarchy::of(&world, levels, &mut builder(), TriangleKind::Watertight).unwrap();
        let mut together = vec![None; all.len()];
        hierarchy.closest_coherent(&all, &mut together);
        let mut met = vec![0; world.items().len()];
        for (ray, packet) in all.iter().zip(together) {
            let (found, expected) = (hierarchy.closest(ray), list.closest(ray));
            assert_eq!(found, expected, "{levels:?} {ray:?}");
            assert_eq!(packet, expected, "{levels:?} {ray:?}");
            assert_eq!(hierarchy.occluded(ray), expected.is_some(), "{levels:?} {ray:?}");
            if let Some(hit) = found {
                met[hit.item as usize] += 1;
            }
        }
        // Of what stands alone, of each place of the first flock, and of the one that is not flat of the other.
        let of = |range: std::ops::Range<usize>| met[range].iter().sum::<usize>();
        assert!(
            (0..5).all(|part| of([0, 20, 90, 160, 230][part]..[20, 90, 160, 230, 300][part]) > 40),
            "{met:?}"
        );
        assert!(of(300..315) == 0 && of(330..345) == 0 && of(345..360) > 10, "{met:?}");
    }
}

#[test]
fn surfaces_of_flocks_lie_on_them_and_face_outward() {
    let world = World::new(flocks());
    let hierarchy = Hierarchy::of(&world, Levels::Two, &mut builder(), TriangleKind::Watertight).unwrap();
    let mut held = 0;
    for ray in rays(3000) {
        let Some(hit) = hierarchy.closest(&ray) else { continue };
        let (primitive, Some(transform)) = world.primitive(hit.item) else { continue };
        let Shape::Sphere(sphere) = primitive.shape else { continue };
        let surface = world.on_primitive(&ray, &hit);
        let (back, radius) = (transform.matrix3.as_dmat3().inverse(), f64::from(sphere.radius));
        let own =
            |at: Vec3| back * (at - Vec3::from(transform.translation)).as_dvec3() - sphere.centre.as_dvec3();
        let off = own(surface.point).length() / radius - 1.0;
        assert!(off.abs() < 1e-4 / radius, "{off} off {sphere:?}");
        // What leads out of it there is the gradient of its own distance.
        let out = (back.transpose() * own(surface.point)).normalize().as_vec3();
        assert!(surface.flat.distance(out) < 1e-3, "{} and {out}", surface.flat);
        let [above, below] = [1.0, -1.0].map(|way| own(surface.point + surface.flat * surface.apart * way));
        assert!(above.length() > radius && below.length() < radius, "rays leave it on their side");
        held += 1;
    }
    assert!(held > 300, "{held}");
}

#[test]
fn a_world_that_moves_is_followed_by_both_levels() {
    let mut random = SplitMix64::new(10);
    let mut scene = by_name("robot").unwrap();
    let bounds = scene.bounds();
    let nodes: Vec<u32> = scene.roots.clone();
    let shape = Shape::Sphere(Sphere { centre: bounds.centre(), radius: 0.2 * bounds.half_diagonal() });
    let primitives = vec![Primitive { shape, material: None }];
    scene.flocks.push(Flock { name: "ball".into(), primitives, nodes });
    let mut world = World::new(scene.clone());
    let mut builder = builder();
    let kind = TriangleKind::Watertight;
    let mut all =
        [Levels::One, Levels::Two].map(|levels| Hierarchy::of(&world, levels, &mut builder, kind).unwrap());
    for frame in 0..3 {
        for (number, node) in scene.nodes.iter_mut().enumerate().filter(|(number, _)| number % 5 == frame) {
            node.transform.translation += Vec3A::splat(0.02 * number as f32);
        }
        scene.meshes[3].positions.iter_mut().for_each(|position| *position *= 1.1);
        let is_seen = |node: u32| node % 7 != frame as u32;
        let Mesh { positions, shading, .. } = &scene.meshes[3];
        let bounds_of_bent = Aabb::of_points(positions.iter().copied());
        let normals = shading.normals.values.clone();
        let mut pose = scene.pose(0.0);
        pose.visible = (0..scene.nodes.len() as u32).map(is_seen).collect();
        pose.bent = vec![Bent { mesh: 3, positions: positions.clone(), normals, bounds: bounds_of_bent }];
        world.follow(&pose);
        let mut seen = scene.clone();
        for (number, node) in seen.nodes.iter_mut().enumerate() {
            node.mesh = node.mesh.filter(|_| is_seen(number as u32));
        }
        seen.flocks[0].nodes.retain(|node| is_seen(*node));
        let fresh = World::new(seen);
        assert_eq!(world.items().triangles, fresh.items().triangles);
        for (hierarchy, levels) in all.iter_mut().zip([Levels::One, Levels::Two]) {
            hierarchy.update(&world, &[3], &mut builder).unwrap();
            let expected = Hierarchy::of(&fresh, levels, &mut builder, kind).unwrap();
            let mut met = 0;
            for _ in 0..500 {
                let aim = bounds.centre() + point(&mut random, 0.4) * bounds.size();
                let from = bounds.centre() + point(&mut random, 2.0) * bounds.size();
                let ray = Ray::new(from, aim - from);
                let found: Option<Hit> = hierarchy.closest(&ray);
                assert_eq!(found, expected.closest(&ray), "frame {frame}, {levels:?}, {ray:?}");
                met += usize::from(found.is_some());
            }
            assert!(met > 50, "{met} in frame {frame}");
        }
    }
}
