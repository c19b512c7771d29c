//! Every way through a wide hierarchy against the list gone through one by one, and that against f64.

use super::super::{BinaryBvh, BinaryNode, Intersector, WideBvh, leaks, leaks_together};
use super::{RayCounts, TriangleList};
use crate::geometry::hit::{Fast, TriangleTest, Watertight};
use crate::geometry::oracle::{Crossing, nearest_crossing};
use crate::geometry::{Aabb, Hit, Ray, Unit};
use glam::Vec3;

mod packets;

/// A number from 0 to 1, and the next one each time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }
    fn point(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }
    fn below(&mut self, n: usize) -> usize {
        ((self.next() * n as f32) as usize).min(n - 1)
    }
}

fn around(triangles: &[[Vec3; 3]], items: &[u32]) -> Aabb {
    let finite = |item: &&u32| triangles[**item as usize].iter().all(|corner| corner.is_finite());
    Aabb::of_points(items.iter().filter(finite).flat_map(|item| triangles[*item as usize]))
}

/// Halves items, sorted along the longest side, as long as there are more than `leaf`.
fn halved(triangles: &[[Vec3; 3]], leaf: usize) -> BinaryBvh {
    let mut made = BinaryBvh { nodes: Vec::new(), order: (0..triangles.len() as u32).collect() };
    if triangles.is_empty() {
        return made;
    }
    let whole = BinaryNode { bounds: Aabb::EMPTY, first: 0, count: triangles.len() as u32 };
    made.nodes.push(whole);
    let mut next = 0;
    while next < made.nodes.len() {
        let BinaryNode { first, count, .. } = made.nodes[next];
        let items = &mut made.order[first as usize..(first + count) as usize];
        let bounds = around(triangles, items);
        made.nodes[next].bounds = bounds;
        if count as usize > leaf {
            let axis = bounds.size().max_position();
            items.sort_by(|a, b| triangles[*a as usize][0][axis].total_cmp(&triangles[*b as usize][0][axis]));
            made.nodes[next].first = made.nodes.len() as u32;
            made.nodes[next].count = 0;
            let half = count / 2;
            for (first, count) in [(first, half), (first + half, count - half)] {
                made.nodes.push(BinaryNode { bounds: Aabb::EMPTY, first, count });
            }
        }
        next += 1;
    }
    made
}

/// As out of balance as can be: each node has one item and all the others.
fn chain(triangles: &[[Vec3; 3]]) -> BinaryBvh {
    let order: Vec<u32> = (0..triangles.len() as u32).collect();
    let mut nodes = vec![BinaryNode { bounds: around(triangles, &order), first: 1, count: 0 }];
    for i in 0..order.len() - 1 {
        nodes.push(BinaryNode { bounds: around(triangles, &order[i..=i]), first: i as u32, count: 1 });
        let rest = around(triangles, &order[i + 1..]);
        let is_last = i + 2 == order.len();
        let (first, count) = if is_last { (i as u32 + 1, 1) } else { (nodes.len() as u32 + 1, 0) };
        nodes.push(BinaryNode { bounds: rest, first, count });
    }
    BinaryBvh { nodes, order }
}

/// Triangles of all sorts: small, large, flat on the axes' planes, needles, points, twice the same.
fn soup(random: &mut Random, n: usize) -> Vec<[Vec3; 3]> {
    let mut made: Vec<[Vec3; 3]> = Vec::new();
    for i in 0..n {
        let (at, size) = (random.point(), 0.3 * random.next());
        let mut triangle = [at, at + random.point() * size, at + random.point() * size];
        match random.below(8) {
            0 => triangle.iter_mut().for_each(|corner| corner[i % 3] = 0.25),
            1 => triangle[2] = triangle[1],
            2 => triangle[2] = triangle[0].lerp(triangle[1], 0.5) + random.point() * 1e-6,
            3 if i > 0 => triangle = made[random.below(i)],
            4 => triangle = triangle.map(|corner| (corner * 4.0).round() / 4.0),
            _ => {}
        }
        made.push(triangle);
    }
    made
}

/// Rays of all sorts around triangles: at random, along axes, from and to corners, edges and middles, with ends.
fn rays(random: &mut Random, triangles: &[[Vec3; 3]], n: usize) -> Vec<Ray> {
    let mut made = Vec::new();
    for i in 0..n {
        let mut aim = || {
            let some = triangles.get(random.below(triangles.len().max(1))).copied().unwrap_or_default();
            match random.below(4) {
                0 => some[0],
                1 => some[1].lerp(some[2], random.next()),
                2 => (some[0] + some[1] + some[2]) / 3.0,
                _ => random.point() * 1.5,
            }
        };
        let (from, to) = (aim(), aim());
        let mut ray = Ray::new(from, to - from);
        match i % 8 {
            0 => ray.direction[i / 8 % 3] = 0.0,
            1 => {
                let axis = i / 8 % 3;
                ray.direction = Vec3::ZERO.with_x(if i % 16 == 1 { 1.0 } else { -1.0 });
                ray.direction = if axis == 0 { ray.direction } else { Vec3::Y * (axis as f32 - 1.5) };
                ray.origin -= ray.direction * 2.0;
            }
            2 => ray = Ray { near: 0.3, far: 1.0, ..ray },
            3 => ray = Ray { near: -0.5, far: 1.0, ..ray },
            4 => ray.origin -= ray.direction,
            5 => ray = Ray::new(from - ray.direction * 1e4, ray.direction * 1e-3),
            _ => {}
        }
        made.push(ray);
    }
    made
}

fn bits(hit: Option<Hit>) -> Option<[u32; 4]> {
    hit.map(|hit| [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.item])
}

/// Holds all ways of a hierarchy against the list; tells how many rays hit.
fn hold<T: TriangleTest>(triangles: &[[Vec3; 3]], binary: &BinaryBvh, rays: &[Ray]) -> usize {
    let (wide, list) = (WideBvh::<T>::new(binary, triangles), TriangleList::<T>::new(triangles));
    let expected: Vec<Option<Hit>> = rays.iter().map(|ray| list.closest(ray)).collect();
    for unit in Unit::all() {
        let mut together = vec![None; rays.len()];
        wide.closest_coherent_on(unit, rays, &mut together);
        let mut hidden = vec![false; rays.len()];
        wide.occluded_coherent_on(unit, rays, &mut hidden);
        for (((ray, hit), packet), hidden) in rays.iter().zip(&expected).zip(together).zip(hidden) {
            let told = wide.closest_on(unit, ray);
            assert_eq!(bits(told), bits(*hit), "{} {unit:?} {ray:?}: {told:?}, {hit:?}", T::NAME);
            assert_eq!(bits(packet), bits(*hit), "{} {unit:?} {ray:?} in a packet", T::NAME);
            assert_eq!(wide.occluded_on(unit, ray), hit.is_some(), "{} {unit:?} {ray:?}", T::NAME);
            assert_eq!(hidden, hit.is_some(), "{} {unit:?} {ray:?} in a packet", T::NAME);
        }
    }
    expected.iter().flatten().count()
}

fn hold_both(triangles: &[[Vec3; 3]], binary: &BinaryBvh, rays: &[Ray]) -> usize {
    hold::<Fast>(triangles, binary, rays).min(hold::<Watertight>(triangles, binary, rays))
}

#[test]
fn tells_what_the_list_tells_at_any_scale_and_place() {
    let random = &mut Random(1);
    let places = [
        (1.0, Vec3::ZERO),
        (1e-20, Vec3::ZERO),
        (1e20, Vec3::ZERO),
        (1.0, Vec3::new(1e4, -3e3, 7e5)),
        (1e-30, Vec3::splat(3e-28)),
        (3e37, Vec3::ZERO),
    ];
    for (scale, shift) in places {
        for n in [1, 2, 3, 9, 200] {
            let place = |point: Vec3| point * scale + shift;
            let triangles: Vec<_> = soup(random, n).into_iter().map(|corners| corners.map(place)).collect();
            let near = soup(random, n);
            let mut rays = rays(random, &near, 600);
            for ray in &mut rays {
                (ray.origin, ray.direction) = (place(ray.origin), ray.direction * scale);
            }
            let hit = hold_both(&triangles, &halved(&triangles, 1 + n % 5), &rays);
            assert!(n < 200 || hit > 20, "{scale} {shift}: {hit} rays hit");
        }
    }
}

#[test]
fn tells_what_the_list_tells_of_rays_at_its_corners_and_edges() {
    let random = &mut Random(2);
    for _ in 0..6 {
        let triangles = soup(random, 150);
        let rays = rays(random, &triangles, 1500);
        assert!(hold_both(&triangles, &halved(&triangles, 3), &rays) > 300);
    }
}

#[test]
fn odd_triangles_and_odd_rays_hit_nothing_and_hide_nothing() {
    let random = &mut Random(4);
    let mut triangles = soup(random, 60);
    for (i, odd) in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].into_iter().enumerate() {
        triangles[7 * i + 2][i].y = odd;
        triangles[7 * i + 3] = [Vec3::splat(odd); 3];
    }
    let mut made = rays(random, &triangles, 800);
    let plain = Ray::new(Vec3::splat(-3.0), Vec3::ONE);
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for x in odd {
        made.push(Ray { origin: Vec3::new(x, 0.0, 0.0), ..plain });
        made.push(Ray { direction: Vec3::new(1.0, x, 0.0), ..plain });
        made.push(Ray { near: x, ..plain });
        made.push(Ray { far: x, ..plain });
    }
    made.push(Ray { direction: Vec3::ZERO, ..plain });
    made.push(Ray { direction: -Vec3::ZERO, ..plain });
    made.push(Ray { near: 2.0, far: 1.0, ..plain });
    made.push(Ray { direction: Vec3::splat(1e-42), ..plain });
    made.push(Ray { direction: Vec3::splat(3e38), ..plain });
    for binary in [halved(&triangles, 4), chain(&triangles)] {
        assert!(hold_both(&triangles, &binary, &made) > 50);
    }
    for triangles in [vec![], vec![[Vec3::NAN; 3]; 5]] {
        assert_eq!(hold_both(&triangles, &halved(&triangles, 1), &made), 0);
    }
}

#[test]
fn the_lowest_of_equals_is_told_and_a_ray_may_end_where_it_hits() {
    let wall = [Vec3::new(-1.0, -1.0, 2.0), Vec3::new(3.0, -1.0, 2.0), Vec3::new(-1.0, 3.0, 2.0)];
    let triangles = vec![wall; 40];
    let ray = Ray::new(Vec3::ZERO, Vec3::Z);
    for binary in [halved(&triangles, 1), halved(&triangles, 40), chain(&triangles)] {
        let wide = WideBvh::<Watertight>::new(&binary, &triangles);
        let hit = wide.closest(&ray).unwrap();
        assert_eq!((hit.t, hit.u, hit.v, hit.item), (2.0, 0.25, 0.25, 0));
        assert!(wide.occluded(&Ray { far: 2.0, ..ray }) && wide.occluded(&Ray { near: 2.0, ..ray }));
        assert!(!wide.occluded(&Ray { far: 1.9999998, ..ray }));
        let mut counts = RayCounts::default();
        assert_eq!(wide.closest_counted(&ray, &mut counts), Some(hit));
        assert!(counts.nodes > 0 && counts.blocks >= 10, "{counts:?}");
    }
    // More wait than there are places for on the stack.
    let many: Vec<_> = (0..3000).map(|i| wall.map(|corner| corner + Vec3::Z * (3000 - i) as f32)).collect();
    let chained = WideBvh::<Fast>::new(&chain(&many), &many);
    assert_eq!(chained.closest(&ray).unwrap().item, 2999);
}

/// A triangle's hit may be told or not where f64 sees the ray this close to an edge, as a weight; and elsewhere the
/// place where it is told may be this far off, in shares of what there is to see: both times one over the steepness.
const ROUNDING: f64 = 4e-6;

fn hold_against_f64<T: TriangleTest>() {
    let random = &mut Random(5);
    let mut held = 0;
    for _ in 0..5 {
        let triangles: Vec<[Vec3; 3]> = (0..80)
            .map(|_| {
                let at = random.point();
                [at, at + random.point(), at + random.point()]
            })
            .collect();
        let list = TriangleList::<T>::new(&triangles);
        for ray in rays(random, &triangles, 2000) {
            if ray.near < 0.0 || ray.direction == Vec3::ZERO {
                continue;
            }
            let size = 1.0 + f64::from((ray.origin.length() + 3.0) / ray.direction.length());
            let hit = list.closest(&ray);
            if let Some(hit) = hit {
                let Some(crossing) = Crossing::of(&ray, &triangles[hit.item as usize]) else { continue };
                let bound = ROUNDING * size / crossing.steepness;
                if bound > 0.01 {
                    continue;
                }
                assert!((crossing.t - f64::from(hit.t)).abs() <= bound, "{ray:?}: {hit:?}, {crossing:?}");
                assert!(crossing.inside_by() >= -bound * 10.0, "{ray:?}: {hit:?}, {crossing:?}");
                held += 1;
            }
            // Nothing that is surely met lies nearer.
            if let Some((_, crossing)) = nearest_crossing(&ray, &triangles, 0.01) {
                let bound = ROUNDING * size / crossing.steepness;
                let is_sure = bound < 0.001
                    && crossing.t > f64::from(ray.near) + bound
                    && crossing.t < f64::from(ray.far) - bound;
                let told = hit.is_some_and(|hit| f64::from(hit.t) <= crossing.t + bound);
                assert!(!is_sure || told, "{ray:?}: {hit:?}, {crossing:?}");
            }
        }
    }
    assert!(held > 3000, "{held}");
}

#[test]
fn the_fast_test_is_right_within_its_rounding() {
    hold_against_f64::<Fast>();
}

#[test]
fn the_watertight_test_is_right_within_its_rounding() {
    hold_against_f64::<Watertight>();
}

/// A closed ball of bumps and of triangles of all shapes.
fn ball(n: usize, squeeze: Vec3) -> Vec<[Vec3; 3]> {
    use std::f32::consts::{PI, TAU};
    let at = |i: usize, j: usize| {
        let (a, b) = (i as f32 / n as f32 * TAU, j as f32 / n as f32 * PI);
        let way = match j {
            0 => Vec3::Y,
            j if j == n => Vec3::NEG_Y,
            _ => Vec3::new(b.sin() * a.cos(), b.cos(), b.sin() * a.sin()),
        };
        way * (1.0 + 0.2 * (5.0 * way.x).sin() * (7.0 * way.z).cos()) * squeeze
    };
    let mut made = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let next = (i + 1) % n;
        made.push([at(i, j), at(next, j), at(i, j + 1)]);
        made.push([at(next, j), at(next, j + 1), at(i, j + 1)]);
    }
    made
}

#[test]
fn no_ray_slips_between_triangles() {
    let balls = [
        (Vec3::ONE, Vec3::ZERO),
        (Vec3::new(1.0, 1.0, 1e-3), Vec3::ZERO),
        (Vec3::splat(1e-12), Vec3::ZERO),
        (Vec3::ONE, Vec3::new(300.0, -2000.0, 50.0)),
    ];
    for (squeeze, shift) in balls {
        let triangles: Vec<[Vec3; 3]> =
            ball(60, squeeze).into_iter().map(|corners| corners.map(|corner| corner + shift)).collect();
        let wide = WideBvh::<Watertight>::new(&halved(&triangles, 2), &triangles);
        for within in [Vec3::ZERO, Vec3::new(0.3, -0.2, 0.1)] {
            let within = within * squeeze + shift;
            assert_eq!(leaks(&wide, &triangles, within, 0..125_000), 0, "{squeeze} {shift}");
            assert_eq!(leaks_together(&wide, &triangles, within, 0..8_000), 0, "{squeeze} {shift}");
        }
    }
}
