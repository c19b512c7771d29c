//! Rays that go in packets against the list, ray by ray.

use super::super::Guess;
use super::*;

#[test]
fn packets_tell_what_the_list_tells() {
    let random = &mut Random(3);
    for apart in [0.0, 0.001, 0.05, 0.3] {
        let triangles = soup(random, 400);
        let mut rays = Vec::new();
        for _ in 0..40 {
            let (from, to) = (random.point() * 3.0, random.point() * 0.5);
            rays.extend((0..16).map(|_| {
                let origin = from + random.point() * apart * 0.1;
                let far = if random.below(5) == 0 { 1.0 } else { f32::INFINITY };
                Ray { near: 0.1, far, ..Ray::new(origin, to + random.point() * apart - origin) }
            }));
            // As shadow rays do: from places near one another to one light, there being the end.
            rays.extend((0..16).map(|_| {
                let origin = to + random.point() * apart;
                Ray { far: 1.0, ..Ray::new(origin, from - origin) }
            }));
        }
        rays.truncate(16 * 79 + 11);
        assert!(hold_both(&triangles, &halved(&triangles, 2), &rays) > 50, "{apart}");
        // Longer than are taken as they are.
        for ray in &mut rays {
            (ray.direction, ray.near, ray.far) = (ray.direction * 3e4, ray.near / 3e4, ray.far / 3e4);
        }
        assert!(hold_both(&triangles, &halved(&triangles, 2), &rays) > 50, "{apart}");
    }
}

/// Each ray passes a corner as closely as it is rounded, on the outside of its packet, also where all but come to the
/// light.
#[test]
fn packets_to_a_light_meet_what_their_rays_graze() {
    let random = &mut Random(7);
    let (mut hit, mut missed) = (0, 0);
    for (scale, shift) in [(1.0, Vec3::ZERO), (1e-12, Vec3::ZERO), (1.0, Vec3::new(300.0, -20.0, 7.0))] {
        for packet in 0..150 {
            let (light, middle) = (random.point() * 2.0, random.point());
            let apart = [0.2, 0.01][packet % 2];
            let place = |point: Vec3| point * scale + shift;
            let origins: Vec<Vec3> = (0..16).map(|_| place(middle + random.point() * apart)).collect();
            let rays: Vec<Ray> = origins
                .iter()
                .map(|origin| Ray { far: 1.0, ..Ray::new(*origin, place(light) - *origin) })
                .collect();
            let triangles: Vec<[Vec3; 3]> = rays
                .iter()
                .map(|ray| {
                    let corner = ray.at([0.1, 0.9, 0.999][random.below(3)]);
                    let out = (ray.origin - place(middle)).normalize() * (0.01 * scale);
                    [corner, corner + out * 2.0, corner + out + random.point() * (0.01 * scale)]
                })
                .collect();
            let some = hold_both(&triangles, &halved(&triangles, 1), &rays);
            (hit, missed) = (hit + some, missed + 16 - some);
        }
    }
    assert!(hit > 500 && missed > 500, "{hit} rays hit, {missed} do not");
}

#[test]
fn packets_that_come_apart_tell_what_the_list_tells() {
    let random = &mut Random(6);
    let triangles = soup(random, 3000);
    let bvh = halved(&triangles, 2);
    let mut rays = Vec::new();
    // So narrow that they stay together, and so wide that they do not, by turns.
    for packet in 0..40 {
        let from = Vec3::splat(3.0) + random.point();
        let apart = if packet % 20 < 10 { 1e-5 } else { 0.1 };
        rays.extend((0..16).map(|_| Ray::new(from, random.point() * apart - from)));
    }
    assert!(hold_both(&triangles, &bvh, &rays) > 300);
    let wide = WideBvh::<Watertight>::new(&bvh, &triangles);
    for unit in Unit::all() {
        let stayed = |rays: &[Ray]| {
            [
                wide.packet::<false>(unit, rays, &mut Guess::default()),
                wide.packet::<true>(unit, rays, &mut Guess::default()),
            ]
            .map(|packet| packet.map(|packet| packet.stayed))
        };
        let packets: Vec<_> = rays.chunks(16).map(stayed).collect();
        for way in [0, 1] {
            let there = |stayed| packets.iter().any(|packet| packet[way] == Some(stayed));
            assert!(there(true) && there(false), "{unit:?} {packets:?}");
        }
    }
}
