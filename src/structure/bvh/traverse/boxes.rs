//! One ray through boxes, whatever is in them.

use super::super::BoxBvh;
use super::super::wide::WIDTH;
use super::count::{Count, Uncounted};
use super::waiting::{PLACES, Stack};
use crate::geometry::hit::{Probe, Seek, Slab, Span};
use crate::geometry::lanes::{Kind, Lanes};
use crate::geometry::{FineRay, Ray};
use std::mem::MaybeUninit;

impl BoxBvh {
    /// Goes through the items in whose boxes a ray may end, nearer ones first. `item` is told an item's place in the
    /// order and how far the ray still reaches, in its `t`, and answers how far it reaches from then on; below the ray's
    /// `near`, no further item is asked about.
    ///
    /// `error` is by how much the ray may be beside where it is said to be, along each axis: a share of the sum of its
    /// origin's and the boxes' greatest coordinates. No box is passed over that it meets so, nor one that begins as far
    /// off as it reaches: of hits equally near all are seen. Where the ray goes through a box may be told wrong by
    /// 2^-19 of how far off that is, so an item's own test may be.
    #[inline]
    pub fn walk(&self, ray: &FineRay, error: f64, item: impl FnMut(usize, f32) -> f32) {
        self.walk_counted(ray, error, &mut Uncounted, item);
    }

    /// The same, counted.
    #[inline]
    pub(in crate::structure::bvh) fn walk_counted(
        &self,
        ray: &FineRay,
        error: f64,
        count: &mut impl Count,
        mut item: impl FnMut(usize, f32) -> f32,
    ) {
        let Some(probe) = Probe::new(ray, self.scale, error) else { return };
        let mut far = ray.far;
        on_unit(self, &probe, probe.reach(far), count, |place| {
            far = item(place, far);
            (far >= ray.near).then(|| probe.reach(far))
        });
    }

    /// Goes with several rays through the items in whose boxes one of them may end, nearer ones first; `error` as for one.
    /// `item` is told an item's place in the order, and shortens in `fars` how far each ray still reaches, below its
    /// `near` if it is over; it answers whether to go on. Tells whether the rays go the same way: if not, nothing is
    /// asked.
    pub(in crate::structure::bvh) fn walk_together(
        &self,
        rays: &[Ray],
        fars: &mut [f32],
        error: f64,
        mut item: impl FnMut(usize, &mut [f32]) -> bool,
    ) -> bool {
        let Some(span) = Span::about(rays, self.scale, error as f32) else { return false };
        let reach = |fars: &[f32]| {
            let under_way = rays.iter().zip(fars).filter(|(ray, far)| **far >= ray.near);
            under_way.map(|(_, far)| Span::reach(*far)).reduce(f32::max)
        };
        if let Some(farthest) = reach(fars) {
            let mut item = |place| if item(place, fars) { reach(fars) } else { None };
            on_unit(self, &span, farthest, &mut Uncounted, &mut item);
        }
        true
    }

    /// Whether it can be told of several rays together that none of them ends in an item's box; `error` as for one.
    pub fn is_missed_by(&self, rays: &[Ray], error: f64) -> bool {
        let Some(span) = Span::about(rays, self.scale, error as f32) else { return false };
        let mut is_missed = true;
        on_unit(self, &span, span.far, &mut Uncounted, |_| {
            is_missed = false;
            None
        });
        is_missed
    }
}

#[inline]
fn on_unit<S: Seek, C: Count>(
    bvh: &BoxBvh,
    probe: &S,
    reach: f32,
    count: &mut C,
    item: impl FnMut(usize) -> Option<f32>,
) {
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1,bmi2,popcnt,lzcnt")]
    fn avx2<S: Seek, C: Count>(
        bvh: &BoxBvh,
        probe: &S,
        reach: f32,
        count: &mut C,
        item: impl FnMut(usize) -> Option<f32>,
    ) {
        // SAFETY: this function has the feature.
        unsafe { through::<crate::geometry::lanes::x86::Lanes8, S, C>(bvh, probe, reach, count, item) }
    }
    match bvh.unit.0 {
        // SAFETY: a `Unit` is only made where it is there, this one where the bit instructions are too.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx2 => unsafe { avx2(bvh, probe, reach, count, item) },
        // SAFETY: every x86-64 processor has the unit.
        #[cfg(target_arch = "x86_64")]
        Kind::Sse2 => unsafe {
            through::<crate::geometry::lanes::x86::Lanes4, S, C>(bvh, probe, reach, count, item)
        },
        // SAFETY: every 64-bit ARM processor with an operating system has the unit.
        #[cfg(target_arch = "aarch64")]
        Kind::Neon => unsafe {
            through::<crate::geometry::lanes::arm::Lanes4, S, C>(bvh, probe, reach, count, item)
        },
        // SAFETY: one lane needs no unit.
        Kind::Scalar => unsafe { through::<f32, S, C>(bvh, probe, reach, count, item) },
    }
}

/// # Safety
/// The processor has the lanes' vector unit.
#[inline(always)]
unsafe fn through<L: Lanes, S: Seek, C: Count>(
    bvh: &BoxBvh,
    probe: &S,
    reach: f32,
    count: &mut C,
    item: impl FnMut(usize) -> Option<f32>,
) {
    let mut places = [const { MaybeUninit::uninit() }; PLACES];
    if bvh.waiting <= PLACES {
        // SAFETY: the processor is the caller's.
        return unsafe { walk::<L, S, C>(bvh, probe, reach, count, Stack::of(&mut places), item) };
    }
    let mut many = vec![MaybeUninit::uninit(); bvh.waiting];
    // SAFETY: as above.
    unsafe { walk::<L, S, C>(bvh, probe, reach, count, Stack::of(&mut many), item) }
}

/// The walk itself: each item answers how far boxes may begin from then on, or that it is over. In addition: `stack` has
/// as many places as may wait.
#[inline(always)]
unsafe fn walk<L: Lanes, S: Seek, C: Count>(
    bvh: &BoxBvh,
    probe: &S,
    mut reach: f32,
    count: &mut C,
    mut stack: Stack<'_>,
    mut item: impl FnMut(usize) -> Option<f32>,
) {
    if bvh.nodes.is_empty() {
        return;
    }
    // SAFETY: the processor is the caller's.
    let feeler = unsafe { probe.spread::<L>() };
    let rows = probe.rows();
    let mut at = bvh.root;
    'next: loop {
        while at.blocks() == 0 {
            count.node();
            // SAFETY: children are nodes that are there, and rows are below six.
            let node = unsafe { bvh.nodes.get_unchecked(at.index()) };
            let mut enters = [0.0f32; WIDTH];
            let mut hit = 0u64;
            for from in (0..WIDTH).step_by(L::LEN) {
                // SAFETY: the processor is the caller's; `from` steps by the lanes' number below 8.
                unsafe {
                    let first = [node.row(rows[0], from), node.row(rows[1], from), node.row(rows[2], from)];
                    let last = [
                        node.row(rows[0] ^ 1, from),
                        node.row(rows[1] ^ 1, from),
                        node.row(rows[2] ^ 1, from),
                    ];
                    let [first, last] = feeler.slab(L::splat(reach), first, last);
                    hit |= last.at_least(first) << from;
                    first.store(&mut enters, from);
                }
            }
            if hit == 0 {
                break;
            }
            // SAFETY: there is one, and no more wait than the collapse counted.
            at = unsafe { stack.nearest(hit, &enters, node) };
        }
        // A node none of whose boxes is met falls through with no items.
        for of in 0..at.blocks() {
            match item(at.index() + of) {
                Some(further) => reach = further,
                None => return,
            }
        }
        loop {
            let Some(waiting) = stack.pop() else { return };
            if waiting.enters() <= reach {
                at = waiting.child();
                continue 'next;
            }
        }
    }
}

#[cfg(test)]
mod tests {
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
                let mut point =
                    || Vec3::from_array([(); 3].map(|()| random.between(-1.0, 1.0) as f32)) * scale;
                let Aabb { min, max } = boxes[number % 4];
                let side = |axis: usize| if number >> (2 + axis) & 1 == 1 { max[axis] } else { min[axis] };
                let beside = [0.0, 1e-6, 3.0][number / 96 % 3];
                let aim = Vec3::new(side(0), side(1), side(2)) + point() * beside;
                let from = aim - point() * 20.0;
                let apart = [0.0, 1e-6, 0.3][number % 3];
                let rays: Vec<Ray> = (0..16)
                    .map(|_| Ray { far: 1.5, ..Ray::new(from, aim + point() * apart - from) })
                    .collect();
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
            for bad in [
                Ray { near: -1.0, ..ray },
                Ray::new(Vec3::NAN, ray.direction),
                Ray::new(ray.origin, Vec3::ZERO),
            ] {
                assert!(!bvh.is_missed_by(&[ray, bad], 0.0), "it is told one by one");
            }
        }
        assert!(missed > 1000 && met > 5000, "{missed} packets miss, {met} may not");
    }

    #[test]
    fn nearer_ones_come_first_and_the_end_is_the_end() {
        let slices: Vec<Aabb> = (0..3000)
            .map(|at| Aabb {
                min: Vec3::new(-1.0, -1.0, at as f32),
                max: Vec3::new(1.0, 1.0, at as f32 + 0.5),
            })
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
}
