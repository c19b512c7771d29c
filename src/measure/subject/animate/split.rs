//! What the frames of a cell go into, in a pass apart from the one whose frames are timed.

use super::super::trace::film;
use super::{AnimateStage, Asked, MeasureError, Sample, failed};
use crate::job::animate::Split;
use crate::machine::{Machine, Threads};

/// Readings of which the cost of one is the mean.
const READINGS: u32 = 1000;

/// Goes through the frames on one processor.
///
/// # Errors
/// The pass failed, or a picture is not what it should be.
pub(super) fn split(asked: &Asked, stage: &AnimateStage, one: &Threads) -> Result<Vec<Sample>, MeasureError> {
    let mut animator = asked.animator(&stage.scene, false)?;
    animator.prepare(&stage.times).map_err(failed)?;
    let mut film = film(one, animator.traced())?;
    let tick = 1.0 / one.ticks_per_nanosecond();
    let (mut samples, mut readings) = (Vec::new(), 0);
    for (frame, time) in stage.times.iter().enumerate() {
        let (image, split) = animator.split(*time, one, &mut film).map_err(failed)?;
        if asked.is_exact() && !stage.compare(frame, &image, one)?.same {
            let message = format!("frame {frame}: split up it is not the picture that one processor makes");
            return Err(MeasureError::Failed(message));
        }
        let Split { rebuild_ticks, visibility_ticks, shading_ticks, readings: own } = split;
        readings += own;
        for (metric, ticks) in [
            ("rebuild_time", rebuild_ticks),
            ("visibility_time", visibility_ticks),
            ("shading_time", shading_ticks),
        ] {
            samples.push(Sample::of_frame(metric, frame, ticks as f64 * tick));
        }
    }
    let before = one.now();
    (0..READINGS).for_each(|_| {
        std::hint::black_box(one.now());
    });
    let reading = (one.now() - before) as f64 * tick / f64::from(READINGS);
    let a_frame = readings as f64 / stage.times.len().max(1) as f64;
    samples.push(Sample::of_path("clock_time", a_frame * reading));
    Ok(samples)
}
