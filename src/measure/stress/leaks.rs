//! Rays from within closed meshes at their edges and corners, one by one and together: by the watertight test none gets
//! out, whatever builder made the hierarchy and however small, flat or far from the origin the mesh is.

use crate::geometry::hit::Watertight;
use crate::geometry::{Aabb, Unit};
use crate::machine::{Machine, Processor, Threads};
use crate::scene::SplitMix64;
use crate::structure::bvh::build::{BUILDERS, Builder, Input, Settings};
use crate::structure::bvh::{BinaryBvh, WideBvh, leaks, leaks_together};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// Rays of each kind that a run aims on each processor: enough that making the mesh and its hierarchy costs little
/// beside them.
const RAYS: u64 = 200_000;
/// Rays that [`leaks_together`] asks about at a time.
const PACKET: u64 = 16;

/// One mesh, and rays at its edges on all processors; returns how many rays there were.
pub(super) fn check(team: &Threads, processors: usize, random: &mut SplitMix64) -> Result<u64, String> {
    let ball = Ball::new(random);
    let about = &BUILDERS[random.below(BUILDERS.len())];
    let boxes: Vec<Aabb> =
        ball.triangles.iter().map(|corners| Aabb::of_points(corners.iter().copied())).collect();
    let mut binary = BinaryBvh::default();
    let built = Builder::new(about.name, &Settings::default()).and_then(|mut builder| {
        builder.build(&Input { boxes: &boxes, triangles: Some(&ball.triangles) }, &mut binary)
    });
    built.map_err(|error| format!("{}: {error}", about.name))?;
    let wide = WideBvh::<Watertight>::new(&binary, &ball.triangles);
    let first = random.next_u64() >> 8;
    let run = team.run(processors, |cpu| {
        let (one, packet) = (first + cpu.id() as u64 * RAYS, first + cpu.id() as u64 * (RAYS / PACKET));
        [
            leaks(&wide, &ball.triangles, ball.within, one..one + RAYS),
            leaks_together(&wide, &ball.triangles, ball.within, packet..packet + RAYS / PACKET),
        ]
    });
    let lost = run.map_err(|e| e.to_string())?;
    let [alone, together] = [0, 1].map(|kind| lost.iter().map(|lost| lost[kind]).sum::<u64>());
    if alone + together > 0 {
        return Err(format!(
            "{alone} rays one by one and {together} together got out of a mesh {}, by {} on {:?}",
            ball.about,
            about.name,
            Unit::best()
        ));
    }
    Ok(2 * RAYS * processors as u64)
}

/// A closed mesh with bumps, its triangles of all shapes, and a point within.
struct Ball {
    triangles: Vec<[Vec3; 3]>,
    within: Vec3,
    about: String,
}

impl Ball {
    fn new(random: &mut SplitMix64) -> Self {
        let (turns, steps) = (3 + random.below(90), 2 + random.below(60));
        let waves: [[f64; 2]; 3] =
            std::array::from_fn(|_| [random.between(1.0, 9.0), random.between(0.0, TAU)]);
        // Down to flakes and needles of a thousandth of their length.
        let squeeze = DVec3::from_array(std::array::from_fn(|_| {
            if random.below(2) == 0 { 1.0 } else { 10.0_f64.powf(random.between(-3.0, 0.0)) }
        }));
        let scale = 10.0_f64.powf(random.between(-18.0, 18.0));
        // Farther off, f32 rounds the flattest of them shut.
        let far = if random.below(2) == 0 { 0.0 } else { 10.0_f64.powf(random.between(0.0, 3.0)) };
        let shift = point(random) * (far * squeeze.min_element());
        let place = |at: DVec3| ((at * squeeze + shift) * scale).as_vec3();
        let bumps = |way: DVec3| {
            let angles = way.to_array().into_iter().zip(waves);
            1.0 + 0.2 * angles.map(|(part, [often, from])| (part * often + from).sin()).product::<f64>()
        };
        // Corners that triangles share are the same numbers: each is made by the same steps.
        let corner = |turn: usize, step: usize| {
            let (a, b) = ((turn % turns) as f64 / turns as f64 * TAU, step as f64 / steps as f64 * PI);
            let way = match step {
                0 => DVec3::Y,
                step if step == steps => DVec3::NEG_Y,
                _ => DVec3::new(b.sin() * a.cos(), b.cos(), b.sin() * a.sin()),
            };
            place(way * bumps(way))
        };
        let mut triangles = Vec::with_capacity(2 * turns * steps);
        for (turn, step) in (0..turns).flat_map(|turn| (0..steps).map(move |step| (turn, step))) {
            // At the poles a square's side is a point.
            if step > 0 {
                triangles.push([corner(turn, step), corner(turn + 1, step), corner(turn, step + 1)]);
            }
            if step + 1 < steps {
                triangles.push([corner(turn + 1, step), corner(turn + 1, step + 1), corner(turn, step + 1)]);
            }
        }
        let about = format!("of {turns} x {steps}, {squeeze}, {shift}, times {scale:e}");
        // A coarse ball is thin, so not far from its middle.
        Self { triangles, within: place(point(random) * 0.1), about }
    }
}

/// A point of the cube from -1 to 1.
fn point(random: &mut SplitMix64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| random.between(-1.0, 1.0)))
}
