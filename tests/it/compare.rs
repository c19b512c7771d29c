//! Two runs held against each other: what the statistics promise, on made-up rows.

use apportion::record::Row;
use apportion::report::comparison::{Comparison, Verdict, compare};
use proptest::prelude::*;

/// SplitMix64: made-up noise that is the same each time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Log-normal, 3 % wide; one frame in ten is disturbed and takes up to four times as long.
    fn noise(&mut self) -> f64 {
        let normal = (0..12).map(|_| self.next()).sum::<f64>() - 6.0;
        let disturbed = if self.next() < 0.1 { 1.0 + 3.0 * self.next() } else { 1.0 };
        (0.03 * normal).exp() * disturbed
    }
}

fn row(scheme: &str, machine: &str, repeat: u32, frame: Option<u32>, metric: &str, value: f64) -> Row {
    let word = |word: &str| word.to_owned();
    let processors = if scheme == "serial" { 1 } else { 2 };
    Row {
        run: word("id"),
        experiment: word("made-up"),
        job: word("mock"),
        scene: word("box"),
        structure: word("none"),
        scheme: word(scheme),
        settings: word("job.work=1"),
        machine: word(machine),
        processors,
        repeat,
        frame,
        metric: word(metric),
        unit: word(if metric == "frame_time" { "ns" } else { "rows" }),
        value,
    }
}

/// The rows of one finished cell: `time` of a repeat and a frame.
fn cell(
    scheme: &str,
    machine: &str,
    (repeats, frames): (u32, u32),
    mut time: impl FnMut(u32, u32) -> f64,
) -> Vec<Row> {
    let mut rows = Vec::new();
    for repeat in 0..repeats {
        for frame in 0..frames {
            rows.push(row(scheme, machine, repeat, Some(frame), "frame_time", time(repeat, frame)));
        }
        rows.push(row(scheme, machine, repeat, None, "cell_complete", f64::from(frames)));
    }
    rows
}

const SCHEMES: [&str; 4] = ["serial", "lock_free", "work_stealing", "auto"];

/// A run of four schemes whose frames differ, with noise from a seed, all slower by `factor`.
fn made_up(seed: u64, size: (u32, u32), factor: f64) -> Vec<Row> {
    let mut random = Random(seed);
    let mut cells = |scheme| {
        cell(scheme, "threads", size, |_, frame| {
            factor * (1_000.0 + 400.0 * f64::from(frame)) * random.noise()
        })
    };
    SCHEMES.iter().flat_map(|scheme| cells(scheme)).collect()
}

fn by_time(a: &[Row], b: &[Row]) -> Comparison {
    compare(a, b, "frame_time").expect("there are cells in both")
}

fn verdicts(comparison: &Comparison) -> Vec<Verdict> {
    comparison.pairs.iter().map(|pair| pair.verdict).chain([comparison.verdict]).collect()
}

fn inverted(verdict: Verdict) -> Verdict {
    match verdict {
        Verdict::Better => Verdict::Worse,
        Verdict::Worse => Verdict::Better,
        same => same,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn exchanging_the_runs_inverts_the_verdict(seed in 0_u64..1_000, factor in 0.7_f64..1.4, repeats in 1_u32..30) {
        let (a, b) = (made_up(seed, (repeats, 3), 1.0), made_up(seed + 1_000, (repeats + 3, 3), factor));
        let (forth, back) = (by_time(&a, &b), by_time(&b, &a));
        prop_assert_eq!(verdicts(&forth).into_iter().map(inverted).collect::<Vec<_>>(), verdicts(&back));
        for (forth, back) in forth.pairs.iter().zip(&back.pairs) {
            prop_assert!((forth.ratio.median * back.ratio.median - 1.0).abs() < 1e-9);
            prop_assert!(forth.ratio.high.is_infinite() || (forth.ratio.high * back.ratio.low - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn scaling_both_runs_changes_nothing_and_one_its_ratio(seed in 0_u64..1_000, scale in 1e-3_f64..1e3) {
        let scaled = |rows: &[Row]| {
            let mut rows = rows.to_vec();
            rows.iter_mut().filter(|row| row.metric == "frame_time").for_each(|row| row.value *= scale);
            rows
        };
        let (a, b) = (made_up(seed, (12, 3), 1.0), made_up(seed + 1_000, (12, 3), 1.1));
        let (plain, both, one) = (by_time(&a, &b), by_time(&scaled(&a), &scaled(&b)), by_time(&a, &scaled(&b)));
        prop_assert_eq!(verdicts(&plain), verdicts(&both));
        for ((plain, both), one) in plain.pairs.iter().zip(&both.pairs).zip(&one.pairs) {
            prop_assert!((both.ratio.median / plain.ratio.median - 1.0).abs() < 1e-9);
            prop_assert!((one.ratio.low / plain.ratio.low / scale - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn a_run_against_itself_is_one_and_cannot_tell() {
    for rows in [made_up(1, (20, 4), 1.0), cell("serial", "threads", (9, 2), |_, _| 5.0)] {
        let comparison = by_time(&rows, &rows);
        assert!(verdicts(&comparison).iter().all(|verdict| *verdict == Verdict::CannotTell));
        for pair in &comparison.pairs {
            assert!((pair.ratio.median - 1.0).abs() < 1e-12, "{pair:?}");
            assert!(pair.ratio.low <= 1.0 && pair.ratio.high >= 1.0, "{pair:?}");
        }
    }
}

#[test]
fn one_repeat_cannot_tell_whatever_it_says() {
    let comparison = by_time(&made_up(1, (1, 50), 1.0), &made_up(2, (1, 50), 10.0));
    assert!(verdicts(&comparison).iter().all(|verdict| *verdict == Verdict::CannotTell));
    assert!(comparison.pairs[0].ratio.high.is_infinite());
    assert!(comparison.text().contains("too few repeats"), "{}", comparison.text());
}

/// Of 200 made-up pairs with an eighth of their repeats disturbed as a whole, the true ratio lies outside any of
/// the intervals in no more than 5 %; no verdict is false; and what is planted is found.
#[test]
fn intervals_hold_the_truth_and_five_per_cent_are_found() {
    let busy = |mut rows: Vec<Row>, seed: u64| {
        let mut random = Random(seed);
        let busy: Vec<bool> = (0..24).map(|_| random.next() < 0.125).collect();
        let frames = rows.iter_mut().filter(|row| row.metric == "frame_time");
        frames.filter(|row| busy[row.repeat as usize]).for_each(|row| row.value *= 1.6);
        rows
    };
    let (mut missed, mut false_verdicts, mut found) = (0, 0, 0);
    for seed in 0..200 {
        let a = busy(made_up(seed, (24, 8), 1.0), seed + 5_000);
        let same = by_time(&a, &busy(made_up(seed + 1_000, (24, 8), 1.0), seed + 6_000));
        let slow = by_time(&a, &busy(made_up(seed + 1_000, (24, 8), 1.05), seed + 6_000));
        missed += usize::from(same.pairs.iter().any(|pair| pair.ratio.low > 1.0 || pair.ratio.high < 1.0));
        false_verdicts += usize::from(verdicts(&same).iter().any(|verdict| *verdict != Verdict::CannotTell));
        found += usize::from(slow.verdict == Verdict::Worse);
    }
    // 5 % are 10; two standard deviations of so many tries more are 16.
    assert!(missed <= 16, "{missed} of 200 miss the truth");
    assert!(false_verdicts <= 2, "{false_verdicts} of 200 verdicts are false");
    assert!(found >= 190, "{found} of 200 slowdowns are found");
}

#[test]
fn one_slow_cell_among_many_makes_the_run_worse_and_two_ways_are_mixed() {
    let a = made_up(1, (24, 8), 1.0);
    let changed = |scheme: &str, factor: f64, rows: &[Row]| {
        let mut rows = rows.to_vec();
        let its = rows.iter_mut().filter(|row| row.scheme == scheme && row.metric == "frame_time");
        its.for_each(|row| row.value *= factor);
        rows
    };
    let slow = changed("lock_free", 1.2, &made_up(2, (24, 8), 1.0));
    let comparison = by_time(&a, &slow);
    assert_eq!(comparison.verdict, Verdict::Worse);
    assert_eq!(comparison.pairs.iter().filter(|pair| pair.verdict == Verdict::Worse).count(), 1);
    assert_eq!(by_time(&a, &changed("auto", 0.8, &slow)).verdict, Verdict::Mixed);
}

#[test]
fn more_is_better_where_the_metric_says_so() {
    let speedups = |factor: f64| {
        let mut rows = made_up(1, (9, 1), factor);
        for row in rows.iter_mut().filter(|row| row.metric == "frame_time") {
            "speedup".clone_into(&mut row.metric);
            row.frame = None;
        }
        rows
    };
    let comparison = compare(&speedups(1.0), &speedups(2.0), "speedup").expect("there are cells in both");
    assert_eq!(comparison.verdict, Verdict::Better);
}

#[test]
fn simulated_cells_are_exact() {
    let run = |time: f64| cell("lock_free", "e4000", (1, 3), |_, frame| time + f64::from(frame));
    assert_eq!(by_time(&run(1e6), &run(1e6)).verdict, Verdict::CannotTell);
    let comparison = by_time(&run(1e6), &run(1e6 + 1.0));
    assert_eq!(comparison.verdict, Verdict::Worse, "a machine that says the same each time hides nothing");
    assert_eq!(comparison.pairs[0].ratio.low, comparison.pairs[0].ratio.high);
}

#[test]
fn cells_of_one_run_only_are_listed_and_unfinished_ones_are_not_there() {
    let (mut a, b) = (made_up(1, (9, 2), 1.0), made_up(2, (9, 2), 1.0));
    a.retain(|row| row.scheme != "auto" && !(row.scheme == "serial" && row.metric == "cell_complete"));
    let comparison = by_time(&a, &b);
    let only: Vec<&str> = comparison.only_b.iter().map(|key| key.scheme.as_str()).collect();
    assert_eq!((comparison.pairs.len(), only), (2, vec!["serial", "auto"]));
    assert!(comparison.text().contains("only in B: threads, box, job.work=1, auto, 2 processors"));
    assert!(comparison.csv().contains("auto,job.work=1,threads,2,frame_time,ns,,,,,,only in B\n"));
    assert!(comparison.json().contains("\"verdict\": \"cannot tell\""));
    let error = compare(&[], &b, "frame_time").expect_err("there is nothing to compare");
    assert!(error.to_string().contains("(A has 0, B has 4)"), "{error}");
}

#[test]
fn numbers_without_a_ratio_are_refused() {
    for value in [0.0, -3.0, f64::NAN, f64::INFINITY] {
        let good = cell("serial", "threads", (3, 1), |_, _| 5.0);
        let bad = cell("serial", "threads", (3, 1), |repeat, _| if repeat == 2 { value } else { 5.0 });
        let error = compare(&good, &bad, "frame_time").expect_err("it has no ratio").to_string();
        let expected = format!("run B: frame_time of box serial on threads x 1 is {value}: a ratio needs");
        assert!(error.contains(&expected), "{error}");
    }
}

#[test]
fn the_text_fits_eighty_columns() {
    let text = by_time(&made_up(1, (9, 2), 1.0), &made_up(2, (9, 2), 1.0)).text();
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}
