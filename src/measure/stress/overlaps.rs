//! Volumes against volumes: bodies that are known to share a point, or to come within reach, are never told apart,
//! whatever volume is around them and however they lie; and one and eight, on every vector unit, say the same.
//!
//! Oriented boxes must also find what separates them: they are held against separating axes in f64, up to the bound
//! on rounding that the test goes by.

use crate::geometry::overlap::{AlignedObb, Eight, Way};
use crate::geometry::{Aabb, KDop, Obb, Overlap, Rigid, Sphere, Unit, Volume};
use crate::machine::{Machine, Processor, Threads};
use crate::scene::SplitMix64;
use glam::{DQuat, DVec3, Vec3};

/// Pairs of bodies that a run tries on each processor.
const PAIRS: u64 = 256;

/// Pairs on each of up to so many processors; returns how many tests of one volume there were.
pub(super) fn check(team: &Threads, processors: usize, random: &mut SplitMix64) -> Result<u64, String> {
    let (processors, seed) = (1 + random.below(processors), random.next_u64());
    let run = team.run(processors, |cpu| {
        let mut random = SplitMix64::new(seed ^ cpu.id() as u64);
        (0..PAIRS).map(|_| Bodies::new(&mut random).hold(&mut random)).sum()
    });
    let tests: Result<Vec<u64>, String> = run.map_err(|e| e.to_string())?.into_iter().collect();
    Ok(tests?.iter().sum())
}

/// Two bodies, how the second is moved, and within what of each other they then come.
#[derive(Debug)]
struct Bodies {
    a: Vec<Vec3>,
    b: Vec<Vec3>,
    motion: Rigid,
    /// In metres.
    reach: f64,
}

impl Bodies {
    /// Bodies that share a point, or whose points come within reach.
    fn new(random: &mut SplitMix64) -> Self {
        let (a, b) = (points(random), points(random));
        let turn = Rigid::new(turn(random), DVec3::ZERO);
        let meeting = inside(&a, random) - turn.point(inside(&b, random));
        let reach = if random.below(2) == 0 { 0.0 } else { power(random, -6.0, 6.0) };
        // The rounding of f64 itself is not what is tried: that of the way is many times what is left out here.
        let off = direction(random) * (reach * random.between(0.0, 1.0).powf(0.1));
        Self { a, b, motion: turn.then(&Rigid::shift(meeting + off)), reach }
    }

    fn hold(&self, random: &mut SplitMix64) -> Result<u64, String> {
        let mut tests = 0;
        tests += self.never_apart::<Aabb>(random)?;
        tests += self.never_apart::<Obb>(random)?;
        tests += self.never_apart::<AlignedObb>(random)?;
        tests += self.never_apart::<Sphere>(random)?;
        tests += self.never_apart::<KDop<7>>(random)?;
        tests += self.never_apart::<KDop<9>>(random)?;
        tests += self.never_apart::<KDop<13>>(random)?;
        tests += self.separated_if_they_are(random)?;
        Ok(tests)
    }

    fn never_apart<V: Overlap>(&self, random: &mut SplitMix64) -> Result<u64, String> {
        let (a, b) = (V::around(&self.a), V::around(&self.b));
        for (to, from, motion) in [(a, b, self.motion), (b, a, self.motion.inverse())] {
            if apart(&to, &from, &Way::new(&motion, self.reach), random)? {
                return Err(format!("{to:?} and {from:?}, moved by {motion:?}, are called apart: {self:?}"));
            }
        }
        Ok(2)
    }

    /// The boxes put somewhere about each other: apart if some axis says so by more than rounding can take away, and
    /// not apart if none does.
    fn separated_if_they_are(&self, random: &mut SplitMix64) -> Result<u64, String> {
        let (a, b) = (Obb::tight(&self.a), Obb::tight(&self.b));
        let size = f64::from(a.half().element_sum() + b.half().element_sum());
        let off = self.motion.then(&Rigid::shift(direction(random) * (size * random.between(0.0, 2.0))));
        let told = apart(&a, &b, &Way::new(&off, 0.0), random)?;
        let (gap, slack) = gap(&a, &b, &off);
        match told {
            true if gap < -1e-9 * slack => {
                Err(format!("{a:?} and {b:?}, moved by {off:?}, overlap by {} m, told apart", -gap))
            }
            false if gap > slack => {
                Err(format!("{a:?} and {b:?}, moved by {off:?}, are {gap} m apart, and not told so"))
            }
            _ => Ok(1),
        }
    }
}

/// What the test says of one volume and another that is moved, by itself and in any lane on every unit.
fn apart<V: Overlap>(to: &V, from: &V, way: &Way, random: &mut SplitMix64) -> Result<bool, String> {
    let moved = from.moved(way);
    let (one, own) = (to.apart(&moved), from.apart(&moved));
    let (lane, other) = (random.below(8), random.below(8));
    let mut eight = V::Eight::UNUSED;
    eight.set(other, from);
    eight.set(lane, to);
    let mut bits = u8::from(own) << other;
    bits = bits & !(1 << lane) | u8::from(one) << lane;
    for unit in Unit::all() {
        let told = eight.apart(unit, &moved);
        if told != bits {
            return Err(format!("{unit:?}: {told:#b}, expected {bits:#b}: {to:?} {from:?} {way:?}"));
        }
    }
    Ok(one)
}

/// By how much the best of fifteen axes separates two boxes, and what rounding may take from that, in metres. A cross
/// product is left as long as it is: the shorter it is, the less it says.
fn gap(a: &Obb, b: &Obb, motion: &Rigid) -> (f64, f64) {
    let turned = |axis: Vec3| motion.rotation() * axis.as_dvec3();
    let (u, v) = (a.axes().map(Vec3::as_dvec3), b.axes().map(turned));
    let (p, q) = (a.half().as_dvec3(), b.half().as_dvec3());
    let way = motion.point(b.centre().as_dvec3()) - a.centre().as_dvec3();
    let along = |axis: DVec3| {
        let half = |axes: [DVec3; 3], half: DVec3| -> f64 {
            axes.iter().zip(half.to_array()).map(|(own, half)| own.dot(axis).abs() * half).sum()
        };
        way.dot(axis).abs() - half(u, p) - half(v, q)
    };
    let crosses = u.iter().flat_map(|u| v.map(|v| u.cross(v)));
    let gap = u.into_iter().chain(v).chain(crosses).map(along).fold(f64::NEG_INFINITY, f64::max);
    let sizes = [way, motion.translation(), a.centre().as_dvec3(), b.centre().as_dvec3(), p, p, q, q];
    let sum: f64 = sizes.iter().map(|size| size.abs().element_sum()).sum();
    // Twice the 32 halves of a last place in `Way`: once for the bound, once for the rounding itself.
    (gap, sum * (64.0 * f64::from(f32::EPSILON) / 2.0) + 1e-37)
}

fn direction(random: &mut SplitMix64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| random.between(-1.0, 1.0))).normalize_or(DVec3::X)
}

/// A number whose power of ten is evenly spread.
fn power(random: &mut SplitMix64, low: f64, high: f64) -> f64 {
    10f64.powf(random.between(low, high))
}

/// A body: a few points, perhaps in a plane, on a line or in one place, of any size and anywhere.
fn points(random: &mut SplitMix64) -> Vec<Vec3> {
    let size = power(random, -6.0, 6.0);
    let flat = [DVec3::ONE, DVec3::new(1.0, 1.0, 0.0), DVec3::Y, DVec3::new(1.0, 1e-6, 1e-3), DVec3::ZERO]
        [random.below(5)];
    let at = direction(random) * [0.0, size, 1e3, 1e6][random.below(4)];
    // Along the axes, or not.
    let own = if random.below(2) == 0 { DQuat::IDENTITY } else { turn(random) };
    let mut coordinate = [0.0; 3];
    (0..1 + random.below(12))
        .map(|_| {
            // Corners of a box now and then, so that faces and edges are shared.
            let corners = random.below(2) == 0;
            for x in &mut coordinate {
                *x = if corners { [-1.0, 1.0][random.below(2)] } else { random.between(-1.0, 1.0) };
            }
            (at + own * (DVec3::from_array(coordinate) * flat * size)).as_vec3()
        })
        .collect()
}

/// A point of a body's hull: a corner, a point of an edge, or one within.
fn inside(points: &[Vec3], random: &mut SplitMix64) -> DVec3 {
    let mut any = || points[random.below(points.len())].as_dvec3();
    let (p, q, r) = (any(), any(), any());
    let [s, t] = [0; 2].map(|_| random.between(0.0, 1.0));
    match random.below(3) {
        0 => p,
        1 => p.lerp(q, s),
        _ => p.lerp(q, s).lerp(r, t),
    }
}

/// None, tiny, by right angles, all but by right angles, about an axis or any.
fn turn(random: &mut SplitMix64) -> DQuat {
    let axis = if random.below(2) == 0 { DVec3::AXES[random.below(3)] } else { direction(random) };
    let right = std::f64::consts::FRAC_PI_2 * random.below(4) as f64;
    let angle = match random.below(5) {
        0 => 0.0,
        1 => right,
        2 => power(random, -12.0, -3.0),
        3 => right + power(random, -12.0, -3.0),
        _ => random.between(-3.2, 3.2),
    };
    DQuat::from_axis_angle(axis, angle)
}
