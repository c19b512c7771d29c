//! Rays through triangles on one thread, by each of the contenders in turn, round after round: medians in millions of
//! rays a second, and how many times as many as obvhs' binary hierarchy each took through in the same round.
//!
//! Three kinds: a camera's, in tiles of 4 x 4; bounces off what those hit, anyhow into the half-space before it; chords
//! between points at random in the scene's box, from before it. Every contender goes through a hierarchy made of the same
//! binary one but for obvhs' own wide one. Before anything is timed, what each hits is counted; crates round otherwise,
//! so rays that graze an edge may differ, and more than one in a thousand end the run.

mod contenders;
mod kinds;

use crate::clock::{self, Run, median};
use apportion::job::trace::World;
use apportion::scene;
use contenders::Built;
use std::hint::black_box;
use std::path::Path;

pub(crate) fn study(file: Option<&Path>) {
    let loaded = match file {
        Some(file) => scene::load(file).unwrap_or_else(|error| panic!("{error}")),
        None => scene::by_name("shell").expect("a generator of that name"),
    };
    let world = World::new(loaded);
    let triangles = &world.items().triangles;
    let built = Built::over(triangles);
    for (kind, rays) in kinds::all(&world, &built.watertight) {
        let mut contenders = contenders::all(&built, &rays);
        let hits: Vec<usize> = contenders.iter_mut().map(|one| (one.run)()).collect();
        let most = rays.len() / 1000;
        assert!(hits.iter().all(|&own| own.abs_diff(hits[0]) <= most), "{kind}: hits {hits:?}");
        let pass = |one: &mut contenders::Contender<'_>| {
            black_box((one.run)());
        };
        let mut runs: Vec<Run<'_>> =
            contenders.iter_mut().map(|one| Box::new(move || pass(one)) as Run<'_>).collect();
        let times = clock::rounds(&mut runs);
        drop(runs);
        println!("\n{}, {} triangles: {} rays, {kind}", world.scene().name, triangles.len(), rays.len());
        println!("{:40} median million rays/s; times the first; hits", "");
        for ((one, own), hits) in contenders.iter().zip(&times).zip(hits) {
            let millions = rays.len() as f64 * 1e3 / median(own.iter().copied());
            // As many times as fast as the first took times as long.
            let ratio = median(clock::ratios(&times[0], own));
            println!("{:40} {millions:8.2} {ratio:8.2}x {hits:9}", one.name);
        }
    }
}
