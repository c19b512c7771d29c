//! Rays that are told apart by little: those of a packet, and those that miss a mesh's box by less than rounding.

use super::super::super::traverse::RAYS;
use super::*;

/// Narrow packets towards corners of triangles, and as many from near those to one light, there being the end.
#[test]
fn rays_that_go_together_are_told_what_each_is_told_alone() {
    let mut random = SplitMix64::new(8);
    let meshes = [soup(&mut random, 60), soup(&mut random, 9)];
    for (what, way) in ways() {
        let reach = meshes[0].bounds.transformed(&way).size().max_element().max(1e-6);
        let stand: Vec<_> = (0..12)
            .map(|number| (number % 2, Affine3A::from_translation(point(&mut random) * (4.0 * reach)) * way))
            .collect();
        let places = placements(&meshes, &stand);
        let (coarse, _) = in_world(&meshes, &places);
        let size = Aabb::of_points(coarse.iter().flatten().copied()).size().max_element();
        let mut aimed = Vec::new();
        for packet in 0..60 {
            let [aim, ..] = coarse[random.below(coarse.len())];
            let from = aim + point(&mut random) * size;
            let apart = size * if packet % 3 == 0 { 1e-2 } else { 1e-4 };
            for _ in 0..RAYS {
                let at = aim + point(&mut random) * apart;
                aimed.push(match packet % 2 {
                    0 => Ray::new(from, at - from),
                    _ => Ray { far: 1.0, ..Ray::new(at, from - at) },
                });
            }
        }
        let instances = Instances::<Watertight>::new(&meshes, &places, &mut builder()).unwrap();
        let hit = hold(&instances, &aimed);
        let stayed = aimed.chunks(RAYS).filter(|rays| {
            let both = [
                instances.closest_together(rays, &mut [None; RAYS]),
                instances.occluded_together(rays, &mut [false; RAYS]),
            ];
            both == [Some(true); 2]
        });
        let stayed = stayed.count();
        // Where meshes are lines or points, all of them lie within a ray's width of another.
        let has_area = !["a line", "nothing"].contains(&what);
        assert!(!has_area || stayed > 20, "{what}: {stayed} of 60 packets stayed together");
        assert!(!has_area || hit > 100, "{what}: {hit} rays hit");
    }
}

/// Rays from far that pass by what sticks out furthest, as closely as they are rounded on their way into a mesh's space:
/// some are taken past its box in the world, and meet it.
#[test]
fn the_top_takes_rays_to_be_as_wide_as_they_are_rounded() {
    let mut random = SplitMix64::new(9);
    let corners = vec![Vec3::new(-1.0, 0.0, 0.1), Vec3::new(1.0, 0.3, 0.0), Vec3::new(0.2, 1.0, -0.2)];
    let meshes = [Mesh::new("one", corners, vec![[0, 1, 2]])];
    let (mut hit, mut passed) = (0, 0);
    for (what, way) in &ways()[..7] {
        let places = placements(&meshes, &[(0, *way)]);
        let (coarse, _) = in_world(&meshes, &places);
        let around = Aabb::of_points(coarse[0]);
        let size = around.size().max_element();
        let instances = Instances::<Watertight>::new(&meshes, &places, &mut builder()).unwrap();
        for number in 0..4000 {
            let away = size * 10.0_f32.powf(random.between(3.0, 5.0) as f32);
            let aim = coarse[0][number % 3];
            let from = aim - point(&mut random).normalize() * away;
            // By about as much as the origin is rounded.
            let ray = Ray::new(from, aim + point(&mut random) * (away * 6e-8) - from);
            let (expected, found) = (without_top(&instances, &ray), instances.closest(&ray));
            assert_eq!(bits(found), bits(expected), "{what}: {ray:?}");
            assert_eq!(instances.occluded(&ray), expected.is_some(), "{what}: {ray:?}");
            hit += usize::from(expected.is_some());
            // Whether as it is in the world it would have met the box.
            let (own, bounds) =
                (FineRay::from(&ray), [around.min, around.max].map(|corner| corner.as_dvec3()));
            let times = bounds.map(|corner| (corner - own.origin) / own.direction);
            let (near, far) = (times[0].min(times[1]).max_element(), times[0].max(times[1]).min_element());
            passed += usize::from(expected.is_some() && near > far);
        }
    }
    assert!(
        hit > 2000 && passed > 200,
        "{hit} hits, {passed} of them by rays that pass the box in the world"
    );
}
