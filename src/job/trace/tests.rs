use std::collections::BTreeMap;

use glam::{Affine3A, Vec2, Vec3};

use super::spots::Spots;
use super::*;
use crate::geometry::hit::Cone;
use crate::geometry::{Camera, Lens, Sphere};
use crate::machine::simulated::Model;
use crate::machine::{Machine, Simulated, Threads};
use crate::scene::{
    Corners, Material, Materials, Mesh, PointLight, Primitive, Scene, Shape, SplitMix64, Texture, by_name,
};
use crate::scheme::tiles::{SCHEMES, Scheme, share};
use crate::structure::bvh::Intersector;

const LENS: Lens = Lens::Symmetric { fov_y: 0.8, aspect: 1.25 };

/// A floor with a texture, a mirror behind, a glass ball, a cylinder, a tilted triangle with bent normals, two lights.
pub(super) fn scene(scale: f32) -> (Scene, Camera) {
    let mut scene = Scene::new("corner of everything");
    let checks = [[255, 255, 255], [40, 90, 200], [40, 90, 200], [250, 240, 10]].to_vec();
    scene.textures.push(Texture { name: "checks".into(), width: 2, height: 2, pixels: checks });
    let checked = Material { texture: Some(0), ..Material::matt("checked", Vec3::ONE) };
    let materials = [
        checked,
        Material::metal("mirror", Vec3::splat(0.9), 50),
        Material::dielectric("glass", 1.5),
        Material::polished("coat", Vec3::new(0.6, 0.1, 0.1), 1.4),
    ];
    let [checked, mirror, glass, coat] = materials.map(|material| scene.add_material(material));
    let mut sheet = |corners: [[f32; 3]; 3], material: u32| {
        let mut mesh = Mesh::new("sheet", corners.map(|at| Vec3::from(at) * scale).to_vec(), vec![[0, 1, 2]]);
        mesh.shading.materials = Materials::One(material);
        mesh.shading.coordinates = Corners::of_vertices(vec![Vec2::ZERO, Vec2::X * 3.0, Vec2::Y * 3.0]);
        if material == coat {
            mesh.shading.normals = Corners::of_vertices(vec![Vec3::Z, Vec3::new(0.4, 0.0, 1.0), Vec3::ONE]);
        }
        let mesh = scene.add_mesh(mesh);
        scene.add_node(None, "sheet", Affine3A::IDENTITY, Some(mesh));
    };
    sheet([[-9.0, 0.0, 9.0], [9.0, 0.0, 9.0], [0.0, 0.0, -9.0]], checked);
    sheet([[-3.0, 0.0, -2.0], [3.0, 0.0, -2.2], [0.0, 4.0, -2.0]], mirror);
    sheet([[-1.8, 0.1, 0.0], [-0.8, 0.2, 0.3], [-1.2, 1.4, -0.2]], coat);
    let ball = Sphere { centre: Vec3::new(0.3, 0.7, 0.4) * scale, radius: 0.6 * scale };
    let (base, tip) = (Vec3::new(1.3, 0.0, -0.4) * scale, Vec3::new(1.5, 1.5, -0.3) * scale);
    let cone = Cone { base, base_radius: 0.4 * scale, tip, tip_radius: 0.1 * scale };
    scene.primitives = vec![
        Primitive { shape: Shape::Sphere(ball), material: Some(glass) },
        Primitive { shape: Shape::Cone(cone), material: None },
    ];
    scene.lights = vec![
        PointLight { position: Vec3::new(2.0, 5.0, 4.0) * scale, colour: Vec3::splat(0.6) },
        PointLight { position: Vec3::new(-4.0, 3.0, 1.0) * scale, colour: Vec3::new(0.3, 0.2, 0.2) },
    ];
    scene.validate().unwrap();
    let (eye, look) = (Vec3::new(0.5, 1.6, 4.5) * scale, Vec3::new(0.1, 0.7, 0.0) * scale);
    let camera = Camera::look_at(eye, look, Vec3::Y, LENS, 0.1 * scale, 100.0 * scale).unwrap();
    (scene, camera)
}

/// Without a scheme: pixel by pixel, ray by ray.
fn plain(scene: &Scene, camera: &Camera, (width, height): (u32, u32), look: Look) -> (Image, Counts) {
    let world = World::new(scene.clone());
    let list = List(world.items());
    let tracer = Tracer::new(&world, &list, look);
    let eye = Eye::new(camera, width, height);
    let mut counts = Counts::default();
    let mut pixels = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let ray = eye.ray(x, y);
            counts.eye += 1;
            pixels.push(tracer.seen(&ray, tracer.intersector.closest(&ray), &mut counts).to_array());
        }
    }
    (Image { width, height, pixels }, counts)
}

pub(super) fn bits(image: &Image) -> Vec<[u32; 3]> {
    image.pixels.iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

/// Every scheme on every count of processors gives the same bits, also in tiles that do not fit.
fn check_all<M: Machine>(machine: &M, expected: &(Image, Counts), tile: (u32, u32)) {
    let (scene, camera) = scene(1.0);
    let world = World::new(scene.clone());
    let list = List(world.items());
    let (width, height) = (expected.0.width, expected.0.height);
    for about in SCHEMES.iter().filter(|about| machine.is_native() || !about.native_only) {
        for processors in [1, 2, 3, 7] {
            let mut film = Film::new(machine, width, height).unwrap();
            let eye = Eye::new(&camera, width, height);
            let frame = Frame::new(Tracer::new(&world, &list, Look::default()), eye, tile, &mut film);
            let costs =
                TileCosts::new((0..frame.tiles().count()).map(|i| (i * 37 % 91) as f64).collect(), 2.0);
            let frame = frame.charged(&costs);
            let mut scheme = Scheme::new(about.name, machine, processors, BTreeMap::new()).unwrap();
            let mut counts = Counts::default();
            scheme.run(machine, &frame).unwrap().into_iter().for_each(|share| counts += share.found);
            let what = format!("{} x {processors} on {}", about.name, machine.name());
            assert_eq!(counts, expected.1, "{what}");
            assert!(bits(&film.image()) == bits(&expected.0), "{what}: another picture");
        }
    }
}

#[test]
fn pictures_are_the_same_bit_for_bit_whoever_makes_them() {
    let (scene, camera) = scene(1.0);
    // Neither a multiple of 32 x 4 nor of the others.
    let expected = plain(&scene, &camera, (75, 61), Look::default());
    let threads = Threads::new(7).unwrap();
    let simulated = Simulated::new(Model::named("e4000").unwrap());
    for tile in [Tiles::OF_PAPER, (7, 5), (1, 1000)] {
        check_all(&threads, &expected, tile);
    }
    check_all(&simulated, &expected, Tiles::OF_PAPER);
}

#[test]
fn tiles_cover_each_pixel_once() {
    for (size, tile) in
        [((75, 61), (32, 4)), ((64, 8), (32, 4)), ((1, 1), (32, 4)), ((5, 7), (1, 1)), ((9, 9), (0, 99))]
    {
        let tiles = Tiles::new(size, tile);
        let mut seen = vec![0; (size.0 * size.1) as usize];
        for (across, down) in (0..tiles.count()).map(|number| tiles.pixels(number)) {
            assert!(!across.is_empty() && !down.is_empty());
            down.for_each(|y| across.clone().for_each(|x| seen[(y * size.0 + x) as usize] += 1));
        }
        assert!(seen.iter().all(|times| *times == 1), "{size:?} {tile:?}");
    }
}

#[test]
fn every_class_of_rays_is_there_and_counted_and_depth_ends_it() {
    let (scene, camera) = scene(1.0);
    let look = |depth| Look { depth, ..Look::default() };
    let (_, flat) = plain(&scene, &camera, (40, 32), look(0));
    assert_eq!((flat.eye, flat.reflection, flat.refraction, flat.deepest), (1280, 0, 0, 0));
    assert!(flat.shadow > 0);
    let (_, deep) = plain(&scene, &camera, (40, 32), look(6));
    assert!(
        deep.reflection > 0 && deep.refraction > 0 && deep.shadow > flat.shadow && deep.deepest == 6,
        "{deep:?}"
    );
}

/// Scaling by a power of 2 rounds nothing, so a picture that hangs on no length of its own stays the same bit for bit.
#[test]
fn no_length_in_metres_is_hidden_anywhere() {
    let (one, camera) = scene(1.0);
    let expected = plain(&one, &camera, (50, 40), Look::default());
    for scale in [2.0_f32.powi(-30), 2.0_f32.powi(-10), 2.0_f32.powi(20), 2.0_f32.powi(30)] {
        let (scaled, camera) = scene(scale);
        let found = plain(&scaled, &camera, (50, 40), Look::default());
        assert!(found.1 == expected.1 && bits(&found.0) == bits(&expected.0), "at {scale}");
    }
}

/// A convex body lit from the eye has no shadow on it: none of its own surface, wherever it lies.
#[test]
fn surfaces_do_not_shadow_themselves_far_from_the_origin() {
    let shell = by_name("shell").unwrap().meshes.remove(0);
    // Every eightieth triangle: the list is slow, and those left still lie in all directions.
    let triangles: Vec<[u32; 3]> = shell.triangles.iter().copied().step_by(80).collect();
    for (far, is_ball) in [0.0, 1.0, 1e3, 1e6].into_iter().flat_map(|far| [(far, false), (far, true)]) {
        let away = Vec3::new(far, -0.7 * far, 0.3 * far);
        let mut scene = Scene::new("ball");
        if is_ball {
            let sphere = Sphere { centre: away, radius: 50.0 };
            scene.primitives.push(Primitive { shape: Shape::Sphere(sphere), material: None });
        } else {
            let positions: Vec<Vec3> = shell.positions.iter().map(|at| *at * 50.0 + away).collect();
            let mesh = scene.add_mesh(Mesh::new("ball", positions, triangles.clone()));
            scene.add_node(None, "ball", Affine3A::IDENTITY, Some(mesh));
        }
        let eye = away + Vec3::new(110.0, 60.0, 90.0);
        scene.lights.push(PointLight { position: eye, colour: Vec3::ONE });
        let world = World::new(scene.clone());
        let list = List(world.items());
        let tracer = Tracer::new(&world, &list, Look { ambient: Vec3::ZERO, ..Look::default() });
        let (mut random, mut seen, mut dark) = (SplitMix64::new(3), 0, 0);
        for _ in 0..2000 {
            let [x, y, z] = [(); 3].map(|()| random.between(-20.0, 20.0) as f32);
            let ray = crate::geometry::Ray::new(eye, (away + Vec3::new(x, y, z) - eye).normalize());
            let Some(hit) = tracer.intersector.closest(&ray) else { continue };
            // Between the triangles that are left one sees the inside of those behind, which others may shade.
            if hit.t > eye.distance(away) {
                continue;
            }
            seen += 1;
            dark += u32::from(tracer.seen(&ray, Some(hit), &mut Counts::default()) == Vec3::ZERO);
        }
        assert!(seen > 10 && dark == 0, "{dark} dark of {seen} at {far}");
    }
}

/// A square floor of one material about the origin, seen from straight above.
fn floor(material: Material, light: Vec3) -> (Scene, Camera) {
    let mut scene = Scene::new("floor");
    let material = scene.add_material(material);
    let corners = [[-9.0, 0.0, 9.0], [9.0, 0.0, 9.0], [9.0, 0.0, -9.0], [-9.0, 0.0, -9.0]];
    let mut mesh = Mesh::new("floor", corners.map(Vec3::from).to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    mesh.shading.materials = Materials::One(material);
    let mesh = scene.add_mesh(mesh);
    scene.add_node(None, "floor", Affine3A::IDENTITY, Some(mesh));
    scene.lights.push(PointLight { position: light, colour: Vec3::ONE });
    let camera = Camera::look_at(Vec3::Y * 3.0, Vec3::ZERO, Vec3::Z, LENS, 0.1, 10.0).unwrap();
    (scene, camera)
}

/// What the middle of the picture shows.
fn middle(scene: &Scene, camera: &Camera, look: Look) -> Vec3 {
    Vec3::from(plain(scene, camera, (1, 1), look).0.pixels[0])
}

#[test]
fn each_term_is_what_its_formula_says() {
    let look = Look {
        depth: 3,
        ambient: Vec3::splat(0.25),
        background: Vec3::new(0.5, 0.25, 0.125),
        ..Look::default()
    };
    let close = |found: Vec3, expected: Vec3| {
        // Shadow rays start a little above the floor.
        assert!(found.distance(expected) < 5e-5, "{found} and not {expected}");
    };
    let red = Vec3::new(0.8, 0.4, 0.2);
    // 60 degrees from the normal.
    let light = Vec3::new(3.0_f32.sqrt(), 1.0, 0.0);
    let (scene, camera) = floor(Material::matt("red", red), light);
    close(middle(&scene, &camera, look), red * (0.25 + 0.5));
    let mut shaded = scene.clone();
    let ball = Sphere { centre: light * 0.5, radius: 0.1 };
    shaded.primitives.push(Primitive { shape: Shape::Sphere(ball), material: None });
    close(middle(&shaded, &camera, look), red * 0.25);
    let mut behind = scene;
    behind.lights[0].position.y = -1.0;
    close(middle(&behind, &camera, look), red * 0.25);
    // The mirrored eye direction is straight up, so cos^2 of the highlight is a quarter.
    let shiny = Material { highlight: Vec3::ONE, exponent: 2, ..Material::matt("shiny", Vec3::ZERO) };
    let (scene, camera) = floor(shiny, light);
    close(middle(&scene, &camera, look), Vec3::splat(0.25));
    let (scene, camera) =
        floor(Material { highlight: Vec3::ZERO, ..Material::metal("mirror", red, 9) }, light);
    close(middle(&scene, &camera, look), red * look.background);
    let film = Material { transmission: Vec3::splat(0.5), ..Material::matt("film", Vec3::ZERO) };
    let (scene, camera) = floor(film, light);
    close(middle(&scene, &camera, look), look.background * 0.5);
    // Straight from above the coat mirrors R0 = (0.5 / 2.5)^2.
    let (scene, camera) = floor(Material::polished("coat", red, 1.5), light);
    close(middle(&scene, &camera, look), red * 0.96 * 0.75 + look.background * 0.04);
}

/// Through a ball's middle nothing is bent: in, (out or back), each at R0; the light fades by the way within.
#[test]
fn glass_mirrors_lets_through_and_fades() {
    let plain_glass = Material { highlight: Vec3::ZERO, ..Material::dielectric("glass", 1.5) };
    let look = Look { depth: 1, ambient: Vec3::ZERO, background: Vec3::ONE, ..Look::default() };
    let see = |material: Material, depth: u32| {
        let mut scene = Scene::new("ball");
        let material = scene.add_material(material);
        let ball = Sphere { centre: Vec3::ZERO, radius: 1.0 };
        scene.primitives.push(Primitive { shape: Shape::Sphere(ball), material: Some(material) });
        let camera = Camera::look_at(Vec3::Z * 4.0, Vec3::ZERO, Vec3::Y, LENS, 0.1, 10.0).unwrap();
        middle(&scene, &camera, Look { depth, ..look }).x
    };
    assert!((see(plain_glass.clone(), 0) - 0.0).abs() < 1e-6);
    assert!((see(plain_glass.clone(), 1) - 0.04).abs() < 1e-5, "mirrored outside");
    let through = 0.96 * 0.96;
    assert!((see(plain_glass.clone(), 2) - (0.04 + through)).abs() < 1e-5, "and let through twice");
    assert!((see(plain_glass.clone(), 40) - 1.0).abs() < 1e-4, "all of it in the end");
    let tinted = Material { absorption: Vec3::splat(0.3), ..plain_glass };
    assert!((see(tinted, 2) - (0.04 + through * (-0.6_f32).exp())).abs() < 1e-5);
}

#[test]
fn light_is_wholly_mirrored_inside_beyond_the_critical_angle() {
    // From below a surface of glass whose outside is up, at 60 degrees; the critical angle is 41.8.
    let mut scene = floor(Material { highlight: Vec3::ZERO, ..Material::dielectric("g", 1.5) }, Vec3::Y).0;
    scene.lights.clear();
    let world = World::new(scene.clone());
    let list = List(world.items());
    let look = Look { depth: 1, ambient: Vec3::ZERO, background: Vec3::ONE, ..Look::default() };
    let tracer = Tracer::new(&world, &list, look);
    for (sine, expected) in [(0.87, (1, 0)), (0.6, (1, 1)), (0.0, (1, 1))] {
        let direction = Vec3::new(sine, (1.0_f32 - sine * sine).sqrt(), 0.0);
        let ray = crate::geometry::Ray::new(-direction, direction);
        let mut counts = Counts::default();
        let seen = tracer.seen(&ray, tracer.intersector.closest(&ray), &mut counts);
        assert_eq!((counts.reflection, counts.refraction), expected, "{sine}");
        assert!((seen - Vec3::ONE).abs().max_element() < 1e-5, "no light is lost: {seen}");
    }
}

#[test]
fn costs_are_measured_once_and_charged_without_tracing() {
    let (scene, camera) = scene(1.0);
    let world = World::new(scene.clone());
    let list = List(world.items());
    let threads = Threads::new(1).unwrap();
    let mut film = Film::new(&threads, 70, 30).unwrap();
    let tracer = Tracer::new(&world, &list, Look::default());
    let frame = Frame::new(tracer, Eye::new(&camera, 70, 30), Tiles::OF_PAPER, &mut film);
    let (costs, counts) = TileCosts::measure(&threads, &frame, 2).unwrap();
    assert_eq!((costs.len(), counts.eye), (3 * 8, 2100));
    assert!(costs.nanoseconds().iter().all(|cost| *cost > 0.0));
    let model = Model::named("e4000").unwrap();
    let costs = costs.on(&model);
    let total: u64 = (0..costs.len()).map(|tile| costs.cycles(tile)).sum();
    let machine = Simulated::new(model);
    for processors in [1, 5] {
        let shares = share("decreasing_tiles", &machine, processors, &Costed(&costs)).unwrap();
        assert_eq!(shares.iter().map(|share| share.visited).sum::<u64>(), 24);
        assert_eq!(machine.charged(), Some(total));
    }
}

#[test]
fn nothing_is_all_background_and_films_have_bounds() {
    let nothing = Scene::new("nothing");
    assert!(default_view(&nothing, 1.0).is_none());
    let camera = scene(1.0).1;
    let (image, counts) = plain(&nothing, &camera, (3, 2), Look::default());
    assert!(image.pixels.iter().all(|pixel| Vec3::from(*pixel) == Look::default().background));
    assert_eq!(counts, Counts { eye: 6, ..Counts::default() });
    let threads = Threads::new(1).unwrap();
    assert!(Film::new(&threads, 0, 5).is_none() && Film::new(&threads, u32::MAX, u32::MAX).is_none());
}

#[test]
fn the_default_view_shows_every_corner_of_the_scene() {
    for (name, aspect) in
        [("robot", 1.5), ("factory-small", 0.5), ("far-outlier", 2.0), ("cylinder-196", 1.0)]
    {
        let scene = by_name(name).unwrap();
        let camera = default_view(&scene, aspect).unwrap();
        let [_, right, _, top] = camera.lens.tangents().map(|tangent| tangent as f32);
        let bounds = scene.bounds();
        let mut widest = 0.0_f32;
        for corner in 0..8 {
            let pick =
                |axis: usize| if corner >> axis & 1 == 1 { bounds.max[axis] } else { bounds.min[axis] };
            let to = Vec3::new(pick(0), pick(1), pick(2)) - camera.eye;
            let ahead = to.dot(camera.forward);
            let (x, y) = (to.dot(camera.right) / ahead / right, to.dot(camera.up) / ahead / top);
            assert!(ahead > 0.0 && x.abs() <= 1.0 && y.abs() <= 1.0, "{name}: {x} {y}");
            widest = widest.max(x.abs()).max(y.abs());
        }
        assert!(widest > 0.8, "{name} fills {widest} of the picture");
    }
}

/// Mirrored and squeezed nodes: normals stay on the side the triangles are anticlockwise from, and across the surface.
#[test]
fn normals_follow_their_nodes() {
    let squeeze = Affine3A::from_scale(Vec3::new(1.0, 0.25, 2.0));
    let mirror = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    for place in [Affine3A::IDENTITY, squeeze, mirror, mirror * squeeze * Affine3A::from_rotation_z(0.7)] {
        let mut scene = Scene::new("n");
        let corners = vec![Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
        let mut mesh = Mesh::new("n", corners, vec![[0, 1, 2]]);
        mesh.shading.normals = Corners::of_vertices(vec![Vec3::ONE * 1e-20; 3]);
        let mesh = scene.add_mesh(mesh);
        scene.add_node(None, "n", place, Some(mesh));
        let world = World::new(scene.clone());
        let [a, b, c] = world.items().triangles[0];
        let out = (a + b + c) / 3.0 * 2.0;
        let ray = crate::geometry::Ray::new(out, -out);
        let hit = List(world.items()).closest(&ray);
        let mut spots = Spots::default();
        spots.find(&world, &[hit]);
        let surface = spots.surface(&world, 0, &ray, &hit.expect("it is aimed at"));
        let across = (b - a).cross(c - a).normalize();
        assert!(surface.flat.distance(across) < 1e-5);
        // A mirrored mesh is wound the other way, and its normals are outward still.
        let side = if place.matrix3.determinant() < 0.0 { -across } else { across };
        assert!(surface.smooth.distance(side) < 1e-4, "{} and {side}", surface.smooth);
        assert_eq!(surface.material, &Material::default());
    }
}
