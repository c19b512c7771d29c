//! What the frames of an animation took, in the numbers BART asks for (Lext, Assarsson and Möller 2001, Measurement
//! report proposal, Deviation and continuity; P3-10, P3-12).

/// What frames took. Average and worst are in the unit of the times; the other two have none, and hardly hang on how
/// fast a machine is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTimes {
    /// The mean of all frames.
    pub average: f64,
    /// The slowest frame.
    pub worst: f64,
    /// The standard deviation, of `n - 1`, over the average (eq. 1 and 2); none of a single frame.
    pub deviation: Option<f64>,
    /// The greatest change from one frame to the next over the average (eq. 3); none of a single frame. It is a maximum:
    /// one hiccup of the system sets it, and so does a first frame that finds the caches cold (P3-F10).
    pub continuity: Option<f64>,
}

impl FrameTimes {
    /// Of times in the order of their frames; none of no frames, or of times whose mean is not above 0.
    pub fn of(times: &[f64]) -> Option<Self> {
        let average = times.iter().sum::<f64>() / times.len() as f64;
        // Nor is NaN, the mean of nothing.
        if !(average > 0.0 && average.is_finite()) {
            return None;
        }
        let squares: f64 = times.iter().map(|time| (time - average) * (time - average)).sum();
        let several = times.len() > 1;
        let deviation = several.then(|| (squares / (times.len() - 1) as f64).sqrt() / average);
        let change = times.windows(2).map(|pair| (pair[0] - pair[1]).abs()).fold(0.0, f64::max);
        Some(Self {
            average,
            worst: times.iter().copied().fold(f64::MIN, f64::max),
            deviation,
            continuity: several.then_some(change / average),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_times_give_known_numbers() {
        // By hand: mean 5, squares 9 + 1 + 1 + 1 + 0 + 0 + 4 + 16 = 32, over 7.
        let times = FrameTimes::of(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]).unwrap();
        assert_eq!((times.average, times.worst, times.continuity), (5.0, 9.0, Some(0.4)));
        assert!((times.deviation.unwrap() - (32.0_f64 / 7.0).sqrt() / 5.0).abs() < 1e-15);
        // The change downward counts as well.
        assert_eq!(FrameTimes::of(&[4.0, 1.0, 1.0]).unwrap().continuity, Some(1.5));
        let even = FrameTimes::of(&[3.0; 10]).unwrap();
        assert_eq!((even.deviation, even.continuity), (Some(0.0), Some(0.0)));
    }

    #[test]
    fn a_faster_machine_has_the_same_deviation_and_continuity() {
        let slow: Vec<f64> = (0..300).map(|k| 100.0 + f64::from(k * k % 77)).collect();
        let fast: Vec<f64> = slow.iter().map(|time| time / 2.0).collect();
        let [slow, fast] = [slow, fast].map(|times| FrameTimes::of(&times).unwrap());
        assert_eq!((slow.deviation, slow.continuity), (fast.deviation, fast.continuity));
        assert_eq!((slow.average, slow.worst), (2.0 * fast.average, 2.0 * fast.worst));
    }

    #[test]
    fn too_few_frames_have_no_deviation_and_no_frames_have_nothing() {
        let one = FrameTimes::of(&[7.0]).unwrap();
        assert_eq!((one.average, one.worst, one.deviation, one.continuity), (7.0, 7.0, None, None));
        for none in [&[][..], &[0.0, 0.0], &[f64::NAN, 1.0], &[f64::INFINITY]] {
            assert_eq!(FrameTimes::of(none), None, "{none:?}");
        }
    }
}
