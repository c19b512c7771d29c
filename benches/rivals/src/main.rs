//! Random boxes, 20 % of them visible, culled by each of the contenders in turn, round after round: medians in
//! nanoseconds a box, and how many times as long as the flat kernel on one thread each took in the same round.
//!
//! The least is what a computer busy with other things can still tell.
//!
//! `cargo run --release` in this folder. Before anything is timed, each contender's answer is held against the flat
//! kernel's. The crates round otherwise, so a box that touches a plane may be seen by one and not by another: such
//! boxes are counted and printed, and more than one in a thousand end the run.

mod contenders;

use apportion::geometry::Frustum;
use apportion::job::cull_boxes::{camera, random_boxes};
use apportion::structure::{BitMask, BoxTree, Boxes, cull};
use contenders::{Contender, Setting};
use std::time::{Duration, Instant};

/// Rounds, in each of which every contender runs for about [`SLICE`], over whole camera paths.
const ROUNDS: usize = 41;
const SLICE: Duration = Duration::from_millis(4);
const FRAMES: usize = 8;
/// Per cent of the boxes that are visible.
const VISIBLE: f64 = 20.0;

fn main() {
    for count in [4096, 1 << 20] {
        let all = random_boxes(count, 1);
        let (tree, flat) = (BoxTree::build(&all), all.iter().collect::<Boxes>());
        let cameras: Vec<_> = (0..FRAMES).map(|frame| camera(&flat, frame, VISIBLE)).collect();
        let setting = Setting { all: &all, flat: &flat, tree: &tree, cameras: &cameras };
        let mut contenders = contenders::all(&setting);
        let answers: Vec<_> = cameras.iter().map(|camera| cull(&flat, &Frustum::new(camera))).collect();
        let otherwise: Vec<usize> = contenders.iter_mut().map(|one| otherwise(one, &answers)).collect();
        let times = rounds(&mut contenders);
        println!("\n{count} boxes, {VISIBLE} % visible");
        println!("{:46} median, least ns a box; times the first; boxes seen otherwise", "");
        for ((one, own), otherwise) in contenders.iter().zip(&times).zip(otherwise) {
            let ratios = own.iter().zip(&times[0]).map(|(own, first)| own / first);
            let least = own.iter().copied().fold(f64::INFINITY, f64::min) / count as f64;
            let (middle, ratio) = (median(own.iter().copied()) / count as f64, median(ratios));
            println!("{:46} {middle:8.3} {least:8.3} {ratio:8.2}x {otherwise:5}", one.name);
        }
    }
}

/// How many boxes a contender sees otherwise than the flat kernel does, over all frames.
fn otherwise(one: &mut Contender<'_>, answers: &[BitMask]) -> usize {
    let Some(seen) = &mut one.seen else { return 0 };
    let mut otherwise = 0;
    for (frame, answer) in answers.iter().enumerate() {
        let mut found = vec![false; answer.len()];
        seen(frame).into_iter().for_each(|i| found[i as usize] = true);
        otherwise += (0..answer.len()).filter(|&i| found[i] != answer.get(i)).count();
    }
    let most = answers.iter().map(BitMask::len).sum::<usize>() / 1000;
    assert!(otherwise <= most, "{}: {otherwise} boxes seen otherwise", one.name);
    otherwise
}

/// The time of a frame, in nanoseconds, by contender and round.
fn rounds(contenders: &mut [Contender<'_>]) -> Vec<Vec<f64>> {
    let paths: Vec<u32> = contenders
        .iter_mut()
        .map(|one| {
            let once = (0..2).map(|_| path(one, 1)).min().expect("two");
            (SLICE.as_nanos() / once.as_nanos().max(1)).max(1) as u32
        })
        .collect();
    let mut times = vec![Vec::new(); contenders.len()];
    for _ in 0..ROUNDS {
        for ((one, &paths), times) in contenders.iter_mut().zip(&paths).zip(&mut times) {
            times.push(path(one, paths).as_secs_f64() * 1e9 / f64::from(paths) / FRAMES as f64);
        }
    }
    times
}

fn path(one: &mut Contender<'_>, times: u32) -> Duration {
    let start = Instant::now();
    for _ in 0..times {
        (0..FRAMES).for_each(|frame| (one.run)(frame));
    }
    start.elapsed()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
