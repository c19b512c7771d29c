//! How far one sample lies above another, without assuming what either looks like.
//!
//! The estimate is Hodges' and Lehmann's (1963): the median of all differences. Its interval holds every shift that
//! Wilcoxon's rank-sum test would not refuse; the test's distribution is counted out, so that it holds for few
//! numbers and for any confidence.

use super::{Interval, middle};

/// The shift from `a` to `b` with its interval: what has to be added to the numbers of `a` to make them lie as those
/// of `b`. Exchanging the samples turns the sign. None where a sample is empty or holds a number that is not finite.
///
/// `risk` is the chance that the interval misses: 0.05 for a 95 % interval. Where there are too few numbers to tell,
/// whatever they are, its ends are infinite.
pub fn shift(a: &[f64], b: &[f64], risk: f64) -> Option<Interval> {
    if !a.iter().chain(b).all(|number| number.is_finite()) {
        return None;
    }
    let mut differences: Vec<f64> = b.iter().flat_map(|b| a.iter().map(move |a| b - a)).collect();
    differences.sort_by(f64::total_cmp);
    let median = middle(&differences)?;
    let outside = ranks_outside(a.len(), b.len(), risk);
    let (low, high) = match outside.checked_sub(1) {
        Some(end) => (differences[end], differences[differences.len() - 1 - end]),
        None => (f64::NEG_INFINITY, f64::INFINITY),
    };
    Some(Interval { median, low, high })
}

/// How many differences from each end lie outside the interval or at its end; 0 where no end can be found.
fn ranks_outside(a: usize, b: usize, risk: f64) -> usize {
    // The counts of the rank sum are the coefficients of a Gaussian binomial: the product of (1 - x^(b+i)) / (1 - x^i).
    let mut counts = vec![0.0; a * b + 1];
    counts[0] = 1.0;
    for i in 1..=a {
        for at in (b + i..counts.len()).rev() {
            counts[at] -= counts[at - b - i];
        }
        for at in i..counts.len() {
            counts[at] += counts[at - i];
        }
    }
    let all: f64 = counts.iter().sum();
    let mut tail = 0.0;
    let within = |count: &&f64| {
        tail += **count;
        tail <= risk / 2.0 * all
    };
    counts.iter().take_while(within).count()
}

/// Cuts a list into at most `most` runs of neighbours, as even as can be.
pub fn blocks<T>(list: &[T], most: usize) -> impl Iterator<Item = &[T]> {
    let count = most.min(list.len());
    (0..count).map(move |block| &list[block * list.len() / count..(block + 1) * list.len() / count])
}

#[cfg(test)]
mod tests {
    use super::{blocks, ranks_outside, shift};

    #[test]
    fn the_ranks_are_those_of_the_tables() {
        // Two-sided 5 % of the tables of Mann and Whitney's U: 2 for 5 and 5, 23 for 10 and 10, 37 for 12 and 12; the
        // interval begins one further in.
        for (a, b, table) in [(5, 5, 2), (10, 10, 23), (12, 12, 37), (4, 4, 0), (5, 8, 6), (8, 5, 6)] {
            assert_eq!(ranks_outside(a, b, 0.05), table + 1, "{a} and {b}");
        }
        assert_eq!(ranks_outside(3, 3, 0.05), 0, "6 numbers cannot tell");
        assert_eq!(ranks_outside(1, 1, 0.05), 0);
    }

    #[test]
    fn a_shift_is_found_and_turns_its_sign() {
        let a = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let b = a.map(|number| number + 10.0);
        let forth = shift(&a, &b, 0.05).expect("there are numbers");
        let back = shift(&b, &a, 0.05).expect("there are numbers");
        assert_eq!(forth.median, 10.0);
        assert!(forth.low > 5.0 && forth.high < 15.0, "{forth:?}");
        assert_eq!((forth.low, forth.median, forth.high), (-back.high, -back.median, -back.low));
    }

    #[test]
    fn nothing_is_told_of_nothing_and_little_of_little() {
        assert_eq!(shift(&[], &[1.0], 0.05), None);
        assert_eq!(shift(&[f64::NAN], &[1.0], 0.05), None);
        let one = shift(&[1.0], &[3.0], 0.05).expect("there are numbers");
        assert_eq!((one.low, one.median, one.high), (f64::NEG_INFINITY, 2.0, f64::INFINITY));
    }

    #[test]
    fn blocks_hold_all_in_order() {
        let list: Vec<u32> = (0..29).collect();
        let cut: Vec<&[u32]> = blocks(&list, 12).collect();
        assert_eq!(cut.len(), 12);
        assert!(cut.iter().all(|block| (2..=3).contains(&block.len())));
        assert_eq!(cut.concat(), list);
        assert_eq!(blocks(&list[..2], 12).count(), 2);
        assert_eq!(blocks::<u32>(&[], 12).count(), 0);
    }
}
