//! How fast hierarchies are built: millions of triangles a second of every builder on one thread, and how many times as
//! fast two threads are, each way of sharing the work out.
//!
//! A rough sphere of 1,003,520 triangles, and a fourteenth of them, 71,680 that lie side by side. Within a round all builders of one sphere run in turn, so
//! that they meet the same weather; told are the medians of the rounds, and of the rounds' ratios with their quartiles.
//!
//! `cargo bench --bench builds`; a number after `--` sets the rounds.

use apportion::geometry::Aabb;
use apportion::job::build::Crew;
use apportion::machine::threads::TeamSettings;
use apportion::machine::{Machine, Threads};
use apportion::scene;
use apportion::scheme::tiles::Scheme;
use apportion::structure::bvh::BinaryBvh;
use apportion::structure::bvh::build::phased::{Phased, Way};
use apportion::structure::bvh::build::{BUILDERS, Builder, Input, Settings};
use apportion::structure::volume_tree::in_world;
use glam::Vec3;
use std::collections::BTreeMap;
use std::time::Duration;

/// Rounds where nobody says how many; odd, so that there is a median.
const ROUNDS: usize = 11;
/// The smaller mesh is the first of so many parts of the larger one.
const PARTS: usize = 14;

fn main() {
    let rounds = std::env::args().skip(1).find_map(|word| word.parse().ok()).unwrap_or(ROUNDS).max(1);
    let sphere = scene::by_name("noise-sphere").expect("it is generated");
    let (places, triangles) = in_world(&sphere).expect("its corners are numbered");
    let corners: Vec<[Vec3; 3]> =
        triangles.iter().map(|triangle| triangle.map(|corner| places[corner as usize])).collect();
    let settings =
        TeamSettings { spin: Duration::from_millis(20), pin_caller: true, ..TeamSettings::default() };
    let teams = [1, 2].map(|threads| Threads::with_settings(threads, &settings).expect("two threads"));
    for corners in [&corners[..corners.len() / PARTS], &corners] {
        println!("{} triangles, {rounds} rounds, medians", corners.len());
        let boxes: Vec<Aabb> = corners.iter().map(|corners| Aabb::of_points(*corners)).collect();
        let input = Input { boxes: &boxes, triangles: Some(corners) };
        alone(&input, &teams[0], rounds);
        together(&input, &teams, rounds);
    }
}

/// Every builder by itself.
fn alone(input: &Input<'_>, clock: &Threads, rounds: usize) {
    let mut bvh = BinaryBvh::default();
    let mut builders: Vec<_> = BUILDERS
        .iter()
        .map(|about| (about.name, Builder::new(about.name, &Settings::default()).expect("it is listed")))
        .map(|(name, builder)| (name, builder, Vec::new(), 0.0))
        .collect();
    for _ in 0..=rounds {
        for (_, builder, times, cost) in &mut builders {
            let before = clock.now();
            builder.build(input, &mut bvh).expect("the boxes are sound");
            times.push((clock.now() - before) as f64);
            *cost = bvh.cost(1.0, 1.0);
        }
    }
    for (name, _, mut times, cost) in builders {
        // The first build is for the memory.
        let time = middle(&mut times[1..])[1];
        let rate = input.boxes.len() as f64 * 1e3 / time;
        println!("  {name:16} {rate:7.2} M/s   {cost:8.2} steps a ray");
    }
}

/// Every way on one thread and on two, by turns, held against one piece on one thread.
fn together(input: &Input<'_>, teams: &[Threads; 2], rounds: usize) {
    for (name, way) in Way::ALL {
        let mut builder = Phased::new(way, &Settings::default()).expect("the settings are sound");
        let mut bvh = BinaryBvh::default();
        let mut schemes = [0, 1]
            .map(|i| Scheme::new("fixed_tiles", &teams[i], i + 1, BTreeMap::new()).expect("it is listed"));
        let (mut pairs, mut wholes) = (Vec::new(), Vec::new());
        for round in 0..=rounds {
            let mut times = [0.0; 3];
            for turn in 0..3 {
                let which = (turn + round) % 3;
                let before = teams[0].now();
                match which {
                    2 => {
                        builder.build_alone(input, &mut bvh).expect("the boxes are sound");
                    }
                    team => {
                        let mut crew = Crew::new(&teams[team], &mut schemes[team], team + 1);
                        builder.build(input, &mut bvh, &mut crew).expect("no panic");
                    }
                }
                times[which] = (teams[0].now() - before) as f64;
            }
            if round > 0 {
                pairs.push(times[0] / times[1]);
                wholes.push(times[2] / times[1]);
            }
        }
        let ([low, half, high], whole) = (middle(&mut pairs), middle(&mut wholes)[1]);
        println!("  {name:16} x {half:.3} [{low:.3}, {high:.3}] by two threads; x {whole:.3} over one piece");
    }
}

/// Lower quartile, median, upper quartile.
fn middle(values: &mut [f64]) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [1, 2, 3].map(|quarter| values[(values.len() * quarter / 4).min(values.len() - 1)])
}
