//! Numbers of a whole cell, from those of its frames.

use super::Sample;
use hdrhistogram::Histogram;

/// The total and the percentiles of the frame times; none where the samples hold no frame time.
pub(crate) fn summary(samples: &[Sample]) -> Vec<Sample> {
    let times: Vec<f64> =
        samples.iter().filter(|sample| sample.metric == "frame_time").map(|sample| sample.value).collect();
    if times.is_empty() {
        return Vec::new();
    }
    let mut histogram: Histogram<u64> = Histogram::new(3).expect("three digits are within its bounds");
    for time in &times {
        histogram.record(time.round().max(1.0) as u64).expect("it grows as it needs");
    }
    let cell = |metric, value| Sample { metric, frame: None, value };
    vec![
        cell("frame_time_p50", histogram.value_at_quantile(0.5) as f64),
        cell("frame_time_p90", histogram.value_at_quantile(0.9) as f64),
        cell("frame_time_p99", histogram.value_at_quantile(0.99) as f64),
        cell("frame_time_max", histogram.max() as f64),
        cell("total_time", times.iter().sum()),
    ]
}
