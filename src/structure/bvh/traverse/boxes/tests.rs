//! What is told of the boxes on a ray's way, against f64 and against rays one by one.

use super::super::super::BinaryBvh;
use super::super::super::build::{Builder, Input, Settings};
use super::super::RayCounts;
use super::*;
use crate::geometry::{Aabb, Ray, Unit};
use crate::scene::SplitMix64;
use glam::{DVec3, Vec3};

fn over(boxes: &[Aabb]) -> (BoxBvh, Vec<u32>) {
    let mut binary = BinaryBvh::default();
    let mut builder = Builder::new("binned_sah", &Settings::default()).unwrap();
    builder.build(&Input::of(boxes), &mut binary).unwrap();
    BoxBvh::new(&binary, boxes)
}

/// Boxes of all sizes, some of them flat or points, as far from the origin and as large as told.
fn boxes(random: &mut SplitMix64, count: usize, scale: f32, shift: Vec3) -> Vec<Aabb> {
    let mut draw = || Vec3::from_array([(); 3].map(|()| random.between(0.0, 1.0) as f32));
    let one = |number: usize| {
        let (at, mut size) = (draw() * 10.0, draw());
        if number.is_multiple_of(4) {
            size[number / 4 % 3] = 0.0;
        } else if number.is_multiple_of(7) {
            size = Vec3::ZERO;
        }
        Aabb { min: (at + shift) * scale, max: (at + size + shift) * scale }
    };
    (0..count).map(one).collect()
}

/// Whether a ray meets a box, in f64; `None` where that cannot be told for certain.
fn meets(ray: &FineRay, bounds: &Aabb) -> Option<bool> {
    let (mut enters, mut leaves) = (f64::from(ray.near), f64::from(ray.far));
    for axis in 0..3 {
        let (from, rate) = (ray.origin[axis], ray.direction[axis]);
        let [a, b] = [bounds.min[axis], bounds.max[axis]].map(|at| f64::from(at) - from);
        if rate == 0.0 {
            if a > 0.0 || b < 0.0 {
                return Some(false);
            }
            continue;
        }
        let (a, b) = if rate < 0.0 { (b / rate, a / rate) } else { (a / rate, b / rate) };
        (enters, leaves) = (enters.max(a), leaves.min(b));
    }
    let room = 1e-12 * enters.abs().max(leaves.abs());
    if (leaves - enters).abs() <= room { None } else { Some(enters < leaves) }
}

fn asked(bvh: &BoxBvh, order: &[u32], ray: &FineRay, error: f64) -> Vec<u32> {
    let mut asked = Vec::new();
    bvh.walk(ray, error, |place, far| {
        asked.push(order[place]);
        far
    });
    asked
}

#[test]
fn no_box_on_the_way_is_passed_over_at_any_scale_and_place() {
    let mut random = SplitMix64::new(3);
    for (scale, shift) in
        [(1.0, Vec3::ZERO), (1e-30, Vec3::ZERO), (1e30, Vec3::ONE), (1.0, Vec3::new(1e5, -3e4, 7.0))]
    {
        let boxes = boxes(&mut random, 300, scale, shift);
        let (mut bvh, order) = over(&boxes);
        let (mut met, mut told) = (0, 0);
        for number in 0..1500 {
            let mut draw = || DVec3::from_array([(); 3].map(|()| random.between(0.0, 1.0)));
            let share = [DVec3::ONE, DVec3::new(0.0, 0.5, 1.0), draw()][number % 3];
            // At a corner, at an edge, within.
            let [min, max] = [boxes[number % 300].min, boxes[number % 300].max].map(|at| at.as_dvec3());
            let aim = min + (max - min) * share;
            let mut direction = (draw() - 0.5) * f64::from(scale) * 20.0;
            if number.is_multiple_of(5) {
                direction[number / 5 % 3] = 0.0;
            }
            let mut ray =
                FineRay { origin: aim - direction, direction: direction * 0.7, near: 0.0, far: 3.0 };
            if number.is_multiple_of(6) {
                ray = FineRay { near: -2.0, far: 0.5, ..ray };
            }
            for unit in Unit::all() {
                bvh.unit = unit;
                let all = asked(&bvh, &order, &ray, 0.0);
                for (item, bounds) in boxes.iter().enumerate() {
                    if meets(&ray, bounds) == Some(true) {
                        met += 1;
                        assert!(all.contains(&(item as u32)), "{item} {unit:?} {ray:?} {bounds:?}");
                    }
                }
                told += all.len();
            }
        }
        assert!(met > 2000 && told < 3 * met, "{told} told of {met} that are met");
    }
}

#[test]
fn a_ray_is_as_wide_as_its_error() {
    let wall = Aabb { min: Vec3::new(-1.0, 0.0, 4.0), max: Vec3::new(1.0, 1.0, 5.0) };
    let (bvh, order) = over(&[wall]);
    let along = |y: f64| {
        let ray = Ray::new(Vec3::new(0.5, 0.0, 0.0), Vec3::Z);
        let origin = DVec3::new(0.5, y, 0.0);
        !asked(&bvh, &order, &FineRay { origin, ..FineRay::from(&ray) }, 1e-3).is_empty()
    };
    // The greatest coordinates are 5 and 0.5.
    assert!(along(1.0) && along(1.0 + 5e-3) && along(-5e-3));
    assert!(!along(1.0 + 3e-2) && !along(-3e-2));
}

/// Also of boxes that each ray passes as closely as it is rounded.
#[test]
fn rays_that_are_told_to_miss_all_boxes_miss_them_one_by_one() {
    let mut random = SplitMix64::new(4);
    let (mut missed, mut met) = (0, 0);
    for (scale, shift) in
        [(1.0, Vec3::ZERO), (1e-30, Vec3::ZERO), (1e30, Vec3::ONE), (1.0, Vec3::new(1e5, -3e4, 7.0))]
    {
        let boxes = boxes(&mut random, 4, scale, shift);
        let (bvh, _) = over(&boxes);
        for number in 0..4000 {
            let mut point = || Vec3::from_array([(); 3].map(|()| random.between(-1.0, 1.0) as f32)) * scale;
            let Aabb { min, max } = boxes[number % 4];
            let side = |axis: usize| if number >> (2 + axis) & 1 == 1 { max[axis] } else { min[axis] };
            let beside = [0.0, 1e-6, 3.0][number / 96 % 3];
            let aim = Vec3::new(side(0), side(1), side(2)) + point() * beside;
            let from = aim - point() * 20.0;
            let apart = [0.0, 1e-6, 0.3][number % 3];
            let rays: Vec<Ray> =
                (0..16).map(|_| Ray { far: 1.5, ..Ray::new(from, aim + point() * apart - from) }).collect();
            let asks = |ray: &Ray| {
                let mut asks = false;
                bvh.walk(&FineRay::from(ray), 0.0, |_, far| {
                    asks = true;
                    far
                });
                asks
            };
            let is_missed = bvh.is_missed_by(&rays, 0.0);
            assert!(!(is_missed && rays.iter().any(asks)), "{number} at {scale}: {rays:?}, {boxes:?}");
            missed += usize::from(is_missed);
            met += usize::from(!is_missed);
        }
        let ray = Ray::new(shift * scale, Vec3::new(1.0, 1.0, 1.0) * scale);
        for bad in
            [Ray { near: -1.0, ..ray }, Ray::new(Vec3::NAN, ray.direction), Ray::new(ray.origin, Vec3::ZERO)]
        {
            assert!(!bvh.is_missed_by(&[ray, bad], 0.0), "it is told one by one");
        }
    }
    assert!(missed > 1000 && met > 5000, "{missed} packets miss, {met} may not");
}

#[test]
fn nearer_ones_come_first_and_the_end_is_the_end() {
    let slices: Vec<Aabb> = (0..3000)
        .map(|at| Aabb { min: Vec3::new(-1.0, -1.0, at as f32), max: Vec3::new(1.0, 1.0, at as f32 + 0.5) })
        .collect();
    let (bvh, order) = over(&slices);
    let ray = FineRay::from(&Ray::new(Vec3::new(0.3, 0.2, -1.0), Vec3::Z));
    let all = asked(&bvh, &order, &ray, 0.0);
    assert!(all.len() == 3000 && all.is_sorted(), "{} of 3000 are told", all.len());
    let mut seen = Vec::new();
    let mut counts = RayCounts::default();
    bvh.walk_counted(&ray, 0.0, &mut counts, |place, far| {
        seen.push(order[place]);
        // The ray ends within the eighth.
        if order[place] == 7 { 8.2 } else { far }
    });
    assert!(seen.len() == 8 && (3..60).contains(&counts.nodes), "{seen:?} {counts:?}");
    let mut count = 0;
    bvh.walk(&ray, 0.0, |_, _| {
        count += 1;
        f32::NEG_INFINITY
    });
    assert_eq!(count, 1);
}

#[test]
fn nothing_is_asked_of_what_is_not() {
    let ray = FineRay::from(&Ray::new(Vec3::ZERO, Vec3::X));
    assert!(asked(&over(&[]).0, &[], &ray, 0.0).is_empty());
    let (bvh, order) = over(&[Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE }; 3]);
    assert_eq!(asked(&bvh, &order, &ray, 0.0).len(), 3);
    for bad in [
        FineRay { direction: DVec3::ZERO, ..ray },
        FineRay { direction: DVec3::NAN, ..ray },
        FineRay { direction: DVec3::INFINITY, ..ray },
        FineRay { origin: DVec3::new(0.0, f64::NAN, 0.0), ..ray },
        FineRay { far: f32::NAN, ..ray },
        FineRay { near: f32::NAN, ..ray },
        FineRay { near: 2.0, far: 1.0, ..ray },
    ] {
        assert!(asked(&bvh, &order, &bad, 0.0).is_empty(), "{bad:?}");
    }
}
