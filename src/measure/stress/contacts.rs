//! Triangles against triangles: the exact test of the collision study against the oracle in whole numbers, on random
//! and adversarial triangles of a grid.

use crate::geometry::contact::{self, Triangle};
use crate::geometry::oracle::{GridPoint, triangles_meet};
use crate::machine::{Machine, Processor, Threads};
use crate::scene::SplitMix64;
use glam::DVec3;

/// Pairs of triangles that a run tries on each processor.
const PAIRS: u64 = 4096;

/// The grid's own bound, less room for what is added to a corner.
const FAR: i32 = (1 << 19) - (1 << 17);

type Grid = [GridPoint; 3];

/// Pairs on each of up to so many processors; returns how many were tried.
pub(super) fn check(team: &Threads, processors: usize, random: &mut SplitMix64) -> Result<u64, String> {
    let (processors, seed) = (1 + random.below(processors), random.next_u64());
    let run = team.run(processors, |cpu| {
        let mut random = SplitMix64::new(seed ^ cpu.id() as u64);
        (0..PAIRS).try_for_each(|_| one(&mut random))
    });
    run.map_err(|e| e.to_string())?.into_iter().collect::<Result<(), String>>()?;
    Ok(PAIRS * processors as u64)
}

/// One pair, in both orders, as it is and wherever it can be put without rounding.
fn one(random: &mut SplitMix64) -> Result<(), String> {
    let (a, b) = pair(random);
    let expected = triangles_meet(&a, &b);
    // Where f64 holds every corner of the grid, and in size between the 1e-70 and the 1e70 that the test is exact for.
    let shift = [0; 3].map(|_| match random.below(3) {
        0 => 0.0,
        1 => whole(random, 1 << 30) as f64,
        _ => (whole(random, 1 << 20) as f64) * 2f64.powi(32),
    });
    let shift = [DVec3::ZERO, DVec3::from_array(shift)][random.below(2)];
    let scale = if random.below(2) == 0 { 1.0 } else { 2f64.powi(whole(random, 205) - 27) };
    let real = |grid: &Grid| grid.map(|at| (DVec3::from_array(at.map(f64::from)) + shift) * scale);
    let (s, t) = (real(&a), real(&b));
    let told = [contact::meet(&s, &t), contact::meet(&t, &s)];
    // What touches is nearer than any distance.
    let near = !expected || contact::closer(&s, &t, random.between(0.0, 2.0) * scale);
    if told == [expected; 2] && near {
        return Ok(());
    }
    let seen = |triangle: &Triangle| format!("{triangle:?}");
    Err(format!(
        "{a:?} and {b:?} {}, told {told:?} and near {near} at {} and {}",
        if expected { "meet" } else { "do not meet" },
        seen(&s),
        seen(&t)
    ))
}

/// A whole number, at most so far from 0.
fn whole(random: &mut SplitMix64, most: i32) -> i32 {
    random.below(2 * most as usize + 1) as i32 - most
}

fn point(random: &mut SplitMix64, most: i32) -> GridPoint {
    [0; 3].map(|_| whole(random, most))
}

/// `at + way * times`.
fn along(at: GridPoint, way: GridPoint, times: i32) -> GridPoint {
    [0, 1, 2].map(|k| at[k] + way[k] * times)
}

/// A triangle of any shape; now and then flat as an edge or a point.
fn triangle(random: &mut SplitMix64, most: i32) -> Grid {
    let [at, way] = [0; 2].map(|_| point(random, most));
    match random.below(8) {
        0 => [at; 3],
        1 => [0; 3].map(|_| along(at, way.map(|step| step / 4), whole(random, 4))),
        _ => [at, way, point(random, most)],
    }
}

/// Two triangles, of which many all but touch, or just do; the corners of each in any order.
fn pair(random: &mut SplitMix64) -> (Grid, Grid) {
    let most = [1, 2, 3, 20, 1000, 1 << 15][random.below(6)];
    let (mut a, mut b) = match random.below(7) {
        0 => (triangle(random, most), triangle(random, most)),
        1 => in_one_plane(random, most),
        2 => corner_on_face(random, most),
        3 => edge_on_edge(random, most),
        4 => with_corners_of_the_first(random, most),
        // A large one and a small one; a needle through the other.
        5 => (triangle(random, FAR / 2), triangle(random, most)),
        _ => needle(random, most),
    };
    for corners in [&mut a, &mut b] {
        corners.rotate_left(random.below(3));
        if random.below(2) == 0 {
            corners.swap(0, 1);
        }
        // One step of the grid off, now and then.
        if random.below(3) == 0 {
            corners[random.below(3)][random.below(3)] += whole(random, 1);
        }
    }
    let largest = a.iter().chain(&b).flatten().map(|at| at.abs()).max().unwrap_or(0);
    let room = if largest < FAR { FAR - largest } else { 0 };
    let at = if random.below(2) == 0 { [0; 3] } else { point(random, room) };
    let put = |grid: Grid| grid.map(|corner| along(corner, at, 1));
    (put(a), put(b))
}

fn in_one_plane(random: &mut SplitMix64, most: i32) -> (Grid, Grid) {
    let [at, u, v] = [0; 3].map(|_| point(random, most));
    let mut one = || [0; 3].map(|_| along(along(at, u, whole(random, 3)), v, whole(random, 3)));
    (one(), one())
}

/// The second has a corner on a face, an edge or a corner of the first.
fn corner_on_face(random: &mut SplitMix64, most: i32) -> (Grid, Grid) {
    let [at, u, v] = [0; 3].map(|_| point(random, most));
    let steps = 1 + random.below(4);
    let (i, j) = (random.below(steps + 1), random.below(steps + 1));
    let (i, j) = if i + j > steps { (steps - i, steps - j) } else { (i, j) };
    let on = along(along(at, u, i as i32), v, j as i32);
    let first = [at, along(at, u, steps as i32), along(at, v, steps as i32)];
    (first, [on, along(on, point(random, most), 1), along(on, point(random, most), 1)])
}

fn edge_on_edge(random: &mut SplitMix64, most: i32) -> (Grid, Grid) {
    let [on, u, v] = [0; 3].map(|_| point(random, most));
    let mut one = |way| {
        let far = along(on, point(random, most), 1);
        [along(on, way, whole(random, 3)), along(on, way, whole(random, 3)), far]
    };
    (one(u), one(v))
}

fn with_corners_of_the_first(random: &mut SplitMix64, most: i32) -> (Grid, Grid) {
    let a = triangle(random, most);
    let mut b = triangle(random, most);
    for corner in &mut b {
        if random.below(2) == 0 {
            *corner = a[random.below(3)];
        }
    }
    (a, b)
}

/// Thin as one step of the grid, and through or past a point of the other.
fn needle(random: &mut SplitMix64, most: i32) -> (Grid, Grid) {
    let (a, way) = (triangle(random, most), point(random, most));
    let middle = [0, 1, 2].map(|k| (a[0][k] + a[1][k] + a[2][k]) / 3);
    let tip = along(middle, way, 4);
    let beside = along(tip, point(random, 1), 1);
    (a, [tip, beside, along(middle, way, -4)])
}
