use super::super::TriangleList;
use super::super::build::Settings;
use super::*;
use crate::geometry::hit::Fast;
use crate::geometry::oracle::Crossing;
use crate::scene::SplitMix64;
use glam::{DVec3, Mat3A, Vec3A};

mod narrow;

fn builder() -> Builder {
    Builder::new("binned_sah", &Settings::default()).unwrap()
}

fn point(random: &mut SplitMix64) -> Vec3 {
    Vec3::from_array([(); 3].map(|()| random.between(-1.0, 1.0) as f32))
}

/// Triangles of all sorts, some flat on the planes of axes, some twice there, some without area.
fn soup(random: &mut SplitMix64, count: usize) -> Mesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for number in 0..count {
        let first = positions.len() as u32;
        let at = point(random);
        let mut corners = [at, at + point(random) * 0.4, at + point(random) * 0.4];
        match number % 7 {
            0 => corners.iter_mut().for_each(|corner| corner[number / 7 % 3] = 1.0),
            1 => corners[2] = corners[1],
            _ => {}
        }
        positions.extend(corners);
        triangles.push([first, first + 1, first + 2]);
        if number.is_multiple_of(5) {
            triangles.push([first, first + 1, first + 2]);
        }
    }
    Mesh::new("soup", positions, triangles)
}

/// Places of all sorts, with what there is to say of each; those that are flat or skewed are held in the world.
fn ways() -> Vec<(&'static str, Affine3A)> {
    let turn = Mat3A::from_rotation_z(0.8) * Mat3A::from_rotation_x(-1.9);
    let squeeze = |x: f32, y: f32, z: f32| Mat3A::from_diagonal(Vec3::new(x, y, z));
    let at = |matrix: Mat3A, x: f32, y: f32, z: f32| Affine3A {
        matrix3: matrix,
        translation: Vec3A::new(x, y, z),
    };
    vec![
        ("as it is", Affine3A::IDENTITY),
        ("turned", at(turn, 3.0, 0.1, -0.7)),
        ("mirrored", at(squeeze(-1.0, 1.0, 1.0) * turn, -2.5, 0.2, 0.4)),
        ("tiny", at(turn * squeeze(1e-5, 1e-5, 1e-5), 1.5, 1.5, 1.5)),
        ("huge", at(turn * squeeze(3e4, 3e4, 3e4), 7e4, 0.0, 0.0)),
        ("squeezed", at(turn * squeeze(1.0, 1e-4, 20.0), 0.0, 4.0, 30.0)),
        ("skewed", at(squeeze(1.0, 0.1, 3.0) * turn, -1.0, -3.0, 0.5)),
        ("far away", at(turn, 1e6, -3e5, 2e5)),
        ("much skewed", at(squeeze(1.0, 1e-4, 3.0) * turn, 1.0, -3.0, -2.5)),
        ("flat", at(turn * squeeze(1.0, 0.0, 1.0), -4.0, 3.0, 2.5)),
        ("a line", at(squeeze(1.0, 0.0, 0.0), 5.0, 3.0, 2.5)),
        ("nothing", at(Mat3A::ZERO, 2.0, 2.0, 2.0)),
    ]
}

fn placements(meshes: &[Mesh], stand: &[(u32, Affine3A)]) -> Vec<Placement> {
    let mut first = 0;
    let mut one = |(mesh, transform): &(u32, Affine3A)| {
        let made = Placement { mesh: *mesh, first, transform: *transform };
        first += meshes[*mesh as usize].triangles.len() as u32;
        made
    };
    stand.iter().map(&mut one).collect()
}

/// All triangles in the world: to f32, as one level has them, and in f64.
fn in_world(meshes: &[Mesh], places: &[Placement]) -> (Vec<[Vec3; 3]>, Vec<[DVec3; 3]>) {
    let corners = places.iter().flat_map(|place| {
        let mesh = &meshes[place.mesh as usize];
        let matrix = place.transform.matrix3.as_dmat3();
        let at = Vec3::from(place.transform.translation).as_dvec3();
        mesh.triangles.iter().map(move |corners| {
            let position = |vertex: u32| mesh.positions[vertex as usize];
            let coarse = corners.map(|vertex| place.transform.transform_point3(position(vertex)));
            (coarse, corners.map(|vertex| matrix * position(vertex).as_dvec3() + at))
        })
    });
    corners.unzip()
}

/// Rays at corners, edges and middles of triangles from near and far, along axes, with ends.
fn rays(random: &mut SplitMix64, triangles: &[[Vec3; 3]], from: f32, count: usize) -> Vec<Ray> {
    let one = |number: usize| {
        let [a, b, c] = triangles[random.below(triangles.len())];
        let (aim, share) = (random.below(4), random.between(0.0, 1.0) as f32);
        let aim = [a, b.lerp(c, share), (a + b + c) / 3.0, a.lerp(b.lerp(c, 0.3), share)][aim];
        let mut direction = point(random);
        if number.is_multiple_of(7) {
            direction = Vec3::AXES[number / 7 % 3];
        }
        let length = from * 10.0_f32.powf(random.between(-2.0, 1.0) as f32);
        let direction = direction * (1.0 + share);
        let ray = Ray::new(aim - direction * length, direction);
        match number % 6 {
            0 => Ray { near: 0.2 * length, far: 1.2 * length, ..ray },
            1 => Ray { near: -length, ..ray },
            _ => ray,
        }
    };
    (0..count).map(one).collect()
}

fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.item])
}

/// Every place by itself, without the top.
fn without_top<T: TriangleTest>(instances: &Instances<T>, ray: &Ray) -> Option<Hit> {
    let hits = instances.stand.iter().filter_map(|standing| {
        let hit = instances.bvh(standing).closest(&standing.take_in(ray))?;
        Some(Hit { item: standing.first + hit.item, ..hit })
    });
    hits.min_by(|a, b| a.t.total_cmp(&b.t).then(a.item.cmp(&b.item)))
}

/// Holds all ways of asking against going through the places one by one; tells how many rays hit.
fn hold<T: TriangleTest>(instances: &Instances<T>, rays: &[Ray]) -> usize {
    let mut together = vec![None; rays.len()];
    instances.closest_coherent(rays, &mut together);
    let mut hidden = vec![false; rays.len()];
    instances.occluded_coherent(rays, &mut hidden);
    let mut hits = 0;
    for ((ray, packet), hidden) in rays.iter().zip(together).zip(hidden) {
        let (expected, found) = (without_top(instances, ray), instances.closest(ray));
        assert_eq!(bits(found), bits(expected), "{ray:?}: {found:?} and {expected:?}");
        assert_eq!(bits(packet), bits(expected), "{ray:?} in a packet");
        assert_eq!(instances.occluded(ray), expected.is_some(), "{ray:?}");
        assert_eq!(hidden, expected.is_some(), "{ray:?} in a packet");
        let mut counts = RayCounts::default();
        assert_eq!(bits(instances.closest_counted(ray, &mut counts)), bits(expected));
        hits += usize::from(found.is_some());
    }
    hits
}

#[test]
fn the_top_loses_no_hit_however_meshes_stand() {
    let mut random = SplitMix64::new(1);
    let meshes = [soup(&mut random, 60), soup(&mut random, 9)];
    for (what, way) in ways() {
        let stand: Vec<_> = (0..20)
            .map(|number| {
                let moved = Affine3A::from_translation(point(&mut random) * 5.0);
                (number % 2, if number == 0 { way } else { moved * way })
            })
            .collect();
        let places = placements(&meshes, &stand);
        let (coarse, _) = in_world(&meshes, &places);
        let size = Aabb::of_points(coarse[..60].iter().flatten().copied()).size().max_element().max(1e-3);
        let aimed = rays(&mut random, &coarse, size, 3000);
        let hit = hold(&Instances::<Watertight>::new(&meshes, &places, &mut builder()).unwrap(), &aimed);
        hold(&Instances::<Fast>::new(&meshes, &places, &mut builder()).unwrap(), &aimed);
        let has_area = !["a line", "nothing"].contains(&what);
        assert!(!has_area || hit > 600, "{what}: {hit} rays hit");
    }
    let all: Vec<_> = ways().into_iter().enumerate().map(|(i, (_, way))| (i as u32 % 2, way)).collect();
    let places = placements(&meshes, &all);
    let instances = Instances::<Watertight>::new(&meshes, &places, &mut builder()).unwrap();
    assert_eq!(instances.hierarchies(), 2 + 4, "what has a way back shares its mesh's");
    let aimed = rays(&mut random, &in_world(&meshes, &places).0, 3.0, 5000);
    assert!(hold(&instances, &aimed) > 1000);
}

/// What is told is a crossing in f64, and nothing that is surely met lies before it: to a bound that grows with the
/// distances and the place's skew, and with nothing else.
#[test]
fn what_is_told_is_so_in_f64() {
    let mut random = SplitMix64::new(2);
    let meshes = [soup(&mut random, 25)];
    for (what, way) in ways() {
        let places = placements(&meshes, &[(0, way)]);
        let (coarse, fine) = in_world(&meshes, &places);
        let around = Aabb::of_points(coarse.iter().flatten().copied());
        let instances = Instances::<Watertight>::new(&meshes, &places, &mut builder()).unwrap();
        let skew = Place::new(&way).map_or(1.0, |(_, skew)| if skew > MOST_SKEW { 1.0 } else { skew });
        let size = around.size().max_element();
        let mut held = 0;
        for ray in rays(&mut random, &coarse, size, 3000) {
            // What is before the start is looked for from another start, rounded.
            if ray.near < 0.0 {
                continue;
            }
            let own = FineRay::from(&ray);
            let greatest = ray.origin.abs().max(around.min.abs()).max(around.max.abs()).max_element();
            let off = skew * f64::from(greatest) * 2e-6;
            // By how much `t` and the weights may be wrong, if not by much.
            let bounds = |crossing: &Crossing, [a, b, c]: &[DVec3; 3]| {
                let longest = (*b - *a).length().max((*c - *b).length()).max((*a - *c).length());
                let height = (*b - *a).cross(*c - *a).length() / longest;
                let across = off / crossing.steepness;
                let [t, weight] = [across / own.direction.length(), across / height];
                (weight < 0.05).then_some((t, weight))
            };
            let told = instances.closest(&ray);
            if let Some(hit) = told {
                let triangle = &fine[hit.item as usize];
                if let Some(crossing) = Crossing::of_fine(&own, triangle)
                    && let Some((t, weight)) = bounds(&crossing, triangle)
                {
                    held += 1;
                    assert!(
                        (crossing.t - f64::from(hit.t)).abs() <= t,
                        "{what} {ray:?} {hit:?} {crossing:?}"
                    );
                    assert!(crossing.inside_by() >= -weight, "{what} {ray:?} {hit:?} {crossing:?}");
                    let [_, u, v] = crossing.weights;
                    let apart = (u - f64::from(hit.u)).abs().max((v - f64::from(hit.v)).abs());
                    assert!(apart <= weight, "{what} {ray:?} {hit:?} {crossing:?}");
                }
            }
            for triangle in &fine {
                let Some(crossing) = Crossing::of_fine(&own, triangle) else { continue };
                let Some((t, weight)) = bounds(&crossing, triangle) else { continue };
                let within = crossing.t > f64::from(ray.near) + t && crossing.t < f64::from(ray.far) - t;
                if within && crossing.inside_by() > weight {
                    let is_so = told.is_some_and(|hit| f64::from(hit.t) <= crossing.t + t);
                    assert!(is_so, "{what} {ray:?}: {told:?} and {crossing:?}");
                }
            }
        }
        let has_area = !["a line", "nothing", "tiny", "far away"].contains(&what);
        assert!(!has_area || held > 300, "{what}: {held} held");
    }
}

#[test]
fn where_nothing_is_moved_it_is_one_level_bit_for_bit() {
    fn same<T: TriangleTest>() {
        let mut random = SplitMix64::new(3);
        let empty = Mesh::new("empty", vec![Vec3::ONE], Vec::new());
        let meshes = [soup(&mut random, 40), empty, soup(&mut random, 200), soup(&mut random, 1)];
        let places = placements(&meshes, &[0, 1, 2, 3, 0, 1].map(|mesh| (mesh, Affine3A::IDENTITY)));
        let (triangles, _) = in_world(&meshes, &places);
        let list = TriangleList::<T>::new(&triangles);
        let instances = Instances::<T>::new(&meshes, &places, &mut builder()).unwrap();
        let mut aimed = rays(&mut random, &triangles, 1.0, 3000);
        let plain = Ray::new(Vec3::splat(-3.0), Vec3::ONE);
        for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            aimed.push(Ray { origin: Vec3::new(odd, 0.0, 0.0), ..plain });
            aimed.push(Ray { direction: Vec3::new(1.0, odd, 0.0), ..plain });
            aimed.extend([Ray { near: odd, ..plain }, Ray { far: odd, ..plain }]);
        }
        aimed.extend(
            [Vec3::ZERO, -Vec3::ZERO, Vec3::splat(1e-42), Vec3::splat(3e38)]
                .map(|direction| Ray { direction, ..plain }),
        );
        aimed.push(Ray { near: 2.0, far: 1.0, ..plain });
        let mut hits = 0;
        for ray in &aimed {
            let (found, expected) = (instances.closest(ray), list.closest(ray));
            assert_eq!(bits(found), bits(expected), "{ray:?}: {found:?} and {expected:?}");
            assert_eq!(instances.occluded(ray), expected.is_some());
            hits += usize::from(found.is_some());
        }
        assert!(hits > 1000, "{hits}");
        hold(&instances, &aimed);
    }
    same::<Watertight>();
    same::<Fast>();
}

#[test]
fn of_places_on_top_of_each_other_the_lowest_number_is_told() {
    let mut random = SplitMix64::new(4);
    let mesh = soup(&mut random, 30);
    let meshes = [mesh.clone(), mesh];
    for (what, way) in ways() {
        let stand: Vec<_> = (0..40).map(|number| (number % 2, way)).collect();
        let mut places = placements(&meshes, &stand);
        places.rotate_left(17);
        let instances = Instances::<Watertight>::new(&meshes, &places, &mut builder()).unwrap();
        let (triangles, _) = in_world(&meshes, &placements(&meshes, &stand));
        let aimed = rays(&mut random, &triangles[..36], 1.0, 400);
        let each = meshes[0].triangles.len() as u32;
        let found: Vec<_> = aimed.iter().filter_map(|ray| instances.closest(ray)).collect();
        assert!(found.iter().all(|hit| hit.item < each), "{what}");
        hold(&instances, &aimed);
    }
}

#[test]
fn ten_thousand_places_hold_one_mesh() {
    let mut random = SplitMix64::new(5);
    let meshes = [soup(&mut random, 20)];
    let stand: Vec<_> = (0..10_000)
        .map(|_| {
            let turn = Mat3A::from_rotation_z(random.between(0.0, 6.0) as f32);
            (0, Affine3A { matrix3: turn, translation: Vec3A::from(point(&mut random) * 30.0) })
        })
        .collect();
    let places = placements(&meshes, &stand);
    let (coarse, _) = in_world(&meshes, &places);
    let instances = Instances::<Watertight>::new(&meshes, &places, &mut builder()).unwrap();
    assert_eq!(instances.hierarchies(), 1);
    let mut binary = BinaryBvh::default();
    let boxes: Vec<_> = coarse.iter().map(|corners| Aabb::of_points(*corners)).collect();
    builder().build(&Input::of(&boxes), &mut binary).unwrap();
    let flat = WideBvh::<Watertight>::new(&binary, &coarse);
    assert!(instances.bytes() * 4 < flat.bytes(), "{} and {} bytes", instances.bytes(), flat.bytes());
    let aimed = rays(&mut random, &coarse, 3.0, 4000);
    let differs = |ray: &&Ray| match (instances.closest(ray), flat.closest(ray)) {
        (Some(found), Some(expected)) => (found.t - expected.t).abs() > 1e-4 * expected.t.abs().max(1e-3),
        (found, expected) => found.is_some() != expected.is_some(),
    };
    // Those aimed at corners and edges of what is rounded in two ways.
    let other = aimed.iter().filter(differs).count();
    assert!(other < 400, "{other} of 4000 rays end elsewhere");
    let inner: Vec<Ray> = aimed.iter().filter(|ray| ray.near == 0.0).copied().take(300).collect();
    assert!(hold(&instances, &inner) > 200);
}

#[test]
fn what_moves_is_followed() {
    let mut random = SplitMix64::new(6);
    let mut meshes = vec![soup(&mut random, 40), soup(&mut random, 30), soup(&mut random, 10)];
    let mut builder = builder();
    let mut moving = Instances::<Watertight>::new(&meshes, &[], &mut builder).unwrap();
    assert_eq!((moving.hierarchies(), moving.closest(&Ray::new(Vec3::ZERO, Vec3::X))), (0, None));
    let all = ways();
    for frame in 0..6_u32 {
        let mut changed = Vec::new();
        if frame % 2 == 1 {
            meshes[1] = soup(&mut random, 25);
            changed.push(1);
        }
        // Not all are seen each time.
        let stand: Vec<_> = (0..9)
            .filter(|number| (number + frame) % 4 != 0)
            .map(|number| {
                let moved = Affine3A::from_translation(Vec3::splat(frame as f32));
                (number % 3, moved * all[(number + frame) as usize % 4].1)
            })
            .collect();
        let places = placements(&meshes, &stand);
        moving.update(&meshes, &changed, &places, &mut builder).unwrap();
        let fresh = Instances::<Watertight>::new(&meshes, &places, &mut builder).unwrap();
        let aimed = rays(&mut random, &in_world(&meshes, &places).0, 2.0, 800);
        for ray in &aimed {
            assert_eq!(bits(moving.closest(ray)), bits(fresh.closest(ray)), "frame {frame}, {ray:?}");
        }
        assert!(hold(&moving, &aimed) > 100);
    }
    moving.update(&meshes, &[], &[], &mut builder).unwrap();
    assert_eq!(moving.hierarchies(), 0, "what stands nowhere is not kept");
}

#[test]
fn triangles_that_are_no_numbers_are_never_met_or_refused() {
    let mut mesh = soup(&mut SplitMix64::new(7), 5);
    let places = [Placement { mesh: 0, first: 0, transform: Affine3A::IDENTITY }];
    mesh.positions[6].y = f32::NAN;
    let [_, b, c] = [6, 7, 8].map(|vertex| mesh.positions[vertex]);
    let ray = Ray::new(b.lerp(c, 0.5) + Vec3::Z, Vec3::NEG_Z);
    let instances = Instances::<Watertight>::new(&[mesh.clone()], &places, &mut builder()).unwrap();
    assert!(instances.closest(&ray).is_none_or(|hit| hit.item != 3));
    mesh.positions[6..9].fill(Vec3::NAN);
    let error = Instances::<Watertight>::new(&[mesh], &places, &mut builder()).unwrap_err();
    assert!(matches!(error, BuildError::NoBox { .. }), "{error}");
}
