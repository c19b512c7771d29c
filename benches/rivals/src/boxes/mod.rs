//! Random boxes, 20 % of them visible, culled by each of the contenders in turn, round after round: medians in
//! nanoseconds a box, and how many times as long as the flat kernel on one thread each took in the same round.
//!
//! Before anything is timed, each contender's answer is held against the flat
//! kernel's. The crates round otherwise, so a box that touches a plane may be seen by one and not by another: such
//! boxes are counted and printed, and more than one in a thousand end the run.

mod contenders;

use apportion::geometry::Frustum;
use apportion::job::cull_boxes::{camera, random_boxes};
use apportion::structure::{BitMask, BoxTree, Boxes, cull};
use contenders::{Contender, Setting};

use crate::clock::{self, Run, least, median, ratios};

/// Frames of the camera path; a run is the whole of it.
const FRAMES: usize = 8;
/// Per cent of the boxes that are visible.
const VISIBLE: f64 = 20.0;

pub(crate) fn study() {
    for count in [4096, 1 << 20] {
        let all = random_boxes(count, 1);
        let (tree, flat) = (BoxTree::build(&all), all.iter().collect::<Boxes>());
        let cameras: Vec<_> = (0..FRAMES).map(|frame| camera(&flat, frame, VISIBLE)).collect();
        let setting = Setting { all: &all, flat: &flat, tree: &tree, cameras: &cameras };
        let mut contenders = contenders::all(&setting);
        let answers: Vec<_> = cameras.iter().map(|camera| cull(&flat, &Frustum::new(camera))).collect();
        let otherwise: Vec<usize> = contenders.iter_mut().map(|one| otherwise(one, &answers)).collect();
        let path = |one: &'_ mut Contender<'_>| (0..FRAMES).for_each(|frame| (one.run)(frame));
        let mut runs: Vec<Run<'_>> =
            contenders.iter_mut().map(|one| Box::new(move || path(one)) as Run<'_>).collect();
        let times = clock::rounds(&mut runs);
        drop(runs);
        println!("\n{count} boxes, {VISIBLE} % visible");
        println!("{:46} median, least ns a box; times the first; boxes seen otherwise", "");
        for ((one, own), otherwise) in contenders.iter().zip(&times).zip(otherwise) {
            let boxes = (count * FRAMES) as f64;
            let (middle, least) = (median(own.iter().copied()) / boxes, least(own) / boxes);
            let ratio = median(ratios(own, &times[0]));
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
