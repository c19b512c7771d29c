//! Medians, and how sure one can be of them; what an animation's frames took; how far a picture is off.
//!
//! They stand here and not in `measure`, because the report summarises rows too and sees nothing but this room.

mod frames;
mod picture;
mod shift;
mod similarity;

pub use frames::FrameTimes;
pub use picture::{average_pnsr, error_free_pnsr, least_error_pnsr, mean_square_error, pnsr};
pub use shift::{blocks, shift};
pub use similarity::structural_similarity;

/// How many times the bootstrap draws; the interval's ends move by under 1 % of its width beyond this.
const DRAWS: usize = 2_000;

/// A median with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The median of the numbers.
    pub median: f64,
    /// 2.5 % of the bootstrap's medians are lower.
    pub low: f64,
    /// 2.5 % of the bootstrap's medians are higher.
    pub high: f64,
}

impl Interval {
    /// How far the further end lies from the median, as a share of the median.
    pub fn spread(&self) -> f64 {
        (self.high - self.median).max(self.median - self.low) / self.median.abs()
    }
}

/// The median; none of no numbers. The mean of the middle two where there is no middle one.
pub fn median(numbers: &[f64]) -> Option<f64> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    middle(&sorted)
}

fn middle(sorted: &[f64]) -> Option<f64> {
    let half = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        length if length % 2 == 1 => Some(sorted[half]),
        _ => Some(f64::midpoint(sorted[half - 1], sorted[half])),
    }
}

/// The value below which a share of the numbers lies, between two of them by their distance; none of no numbers.
pub fn quantile(numbers: &[f64], share: f64) -> Option<f64> {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    let place = share.clamp(0.0, 1.0) * last as f64;
    let (below, above) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    Some(below + (above - below) * place.fract())
}

/// Beyond so many scaled median absolute deviations from the median a number is an outlier.
pub const OUTLIER: f64 = 3.0;

/// How many of the numbers are outliers: further than [`OUTLIER`] scaled median absolute deviations from the
/// median. They are to be counted, not dropped. Numbers of which more than half are equal have none.
pub fn outliers(numbers: &[f64]) -> usize {
    let Some(median) = median(numbers) else { return 0 };
    let off: Vec<f64> = numbers.iter().map(|number| (number - median).abs()).collect();
    // 1.4826: makes the deviation that of the normal distribution with the same spread.
    let limit = OUTLIER * 1.4826 * self::median(&off).unwrap_or(0.0);
    off.iter().filter(|off| limit > 0.0 && **off > limit).count()
}

/// The median with its 95 % percentile bootstrap interval (Efron 1979); none of no numbers.
///
/// The same numbers and seed give the same interval, so that a report drawn twice is the same report.
pub fn interval(numbers: &[f64], seed: u64) -> Option<Interval> {
    let median = median(numbers)?;
    let mut random = SplitMix(seed);
    let mut draw = vec![0.0; numbers.len()];
    let mut medians: Vec<f64> = (0..DRAWS)
        .filter_map(|_| {
            draw.fill_with(|| numbers[random.below(numbers.len())]);
            draw.sort_by(f64::total_cmp);
            middle(&draw)
        })
        .collect();
    medians.sort_by(f64::total_cmp);
    Some(Interval { median, low: medians[DRAWS / 40], high: medians[DRAWS - 1 - DRAWS / 40] })
}

/// The sum of one list over the sum of another, pair by pair the same thing under two conditions, with its 95 %
/// percentile bootstrap interval over the pairs; none of no pairs, or where the lists differ in length.
pub fn ratio_interval(over: &[f64], under: &[f64], seed: u64) -> Option<Interval> {
    if over.len() != under.len() || over.is_empty() {
        return None;
    }
    let mut random = SplitMix(seed);
    let mut ratios: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let (mut above, mut below) = (0.0, 0.0);
            for _ in 0..over.len() {
                let pair = random.below(over.len());
                above += over[pair];
                below += under[pair];
            }
            above / below
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    let median = over.iter().sum::<f64>() / under.iter().sum::<f64>();
    Some(Interval { median, low: ratios[DRAWS / 40], high: ratios[DRAWS - 1 - DRAWS / 40] })
}

/// SplitMix64 (Steele, Lea and Flood, OOPSLA 2014): small, seeded, good enough to draw from a list.
struct SplitMix(u64);

impl SplitMix {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let high = u128::from(z ^ (z >> 31)) * limit as u128;
        (high >> 64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::{interval, median, ratio_interval};

    #[test]
    fn the_ratio_of_sums_lies_in_its_interval() {
        let under: Vec<f64> = (1..=30).map(f64::from).collect();
        let twice: Vec<f64> = under.iter().map(|number| 2.0 * number).collect();
        let exact = ratio_interval(&twice, &under, 1).expect("there are pairs");
        assert_eq!((exact.low, exact.median, exact.high), (2.0, 2.0, 2.0));
        let noisy: Vec<f64> = under.iter().map(|number| number * (1.5 + number % 3.0)).collect();
        let ratio = ratio_interval(&noisy, &under, 1).expect("there are pairs");
        assert!(1.5 < ratio.low && ratio.low < ratio.median && ratio.median < ratio.high, "{ratio:?}");
        assert_eq!(ratio_interval(&[], &[], 1), None);
        assert_eq!(ratio_interval(&[1.0], &[], 1), None);
    }

    #[test]
    fn medians_of_none_one_even_and_odd() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0]), Some(3.0));
        assert_eq!(median(&[4.0, 1.0]), Some(2.5));
        assert_eq!(median(&[9.0, 1.0, 2.0]), Some(2.0));
    }

    #[test]
    fn the_interval_holds_the_median_and_is_the_same_again() {
        let numbers: Vec<f64> = (0..40).map(|i| f64::from(i * 7 % 40)).collect();
        let first = interval(&numbers, 1).expect("there are numbers");
        assert!(first.low <= first.median && first.median <= first.high, "{first:?}");
        assert!(first.high - first.low > 1.0 && first.high - first.low < 25.0, "{first:?}");
        assert_eq!(interval(&numbers, 1), Some(first));
        assert_eq!(interval(&[], 1), None);
        let one = interval(&[2.0], 1).expect("there is a number");
        assert_eq!((one.low, one.median, one.high), (2.0, 2.0, 2.0));
    }
}
