//! The choice of `auto`: which way of sharing suits a run of so many tasks.
//!
//! A way is a scheme with a number of processors: one processor; or one of [`SCHEMES`] with 2, 4, 8, … or
//! as many as there may be. Each way tried has a [`Line`], ticks = start + tasks x each, fitted to what
//! its runs took, as frames differ in size and small ones bear fewer processors than large ones.
//!
//! Steps, for a run of so many tasks: 1. a tour of ways that have had fewer than two runs: the first
//! scheme climbs from 2 processors as long as it stays near its best (where already 2 take twice as long
//! as one nothing else is tried); each other scheme is tried where the best so far stands and, where it
//! comes near, climbs and descends from there; 2. otherwise the way that promises least, each a little
//! better than its line says the fewer runs it has had of late, so that near rivals keep being compared.
//! Each doubling of the processors has to bring 2 %: "model no more than a scene needs".

use std::ops::ControlFlow;

/// The schemes tried, first the one with the fewest bad cases.
pub(super) const SCHEMES: [&str; 3] = ["work_stealing", "lock_free", "receiver_initiated"];

/// Runs of a way on the tour.
const RUNS: u32 = 2;
/// Weight of a way's first run, which may wake the team and warm the caches; the others have 1.
const FIRST: f64 = 0.25;
/// Less than the weight of two runs.
const TWICE: f64 = 1.2;
/// Weight of a way that shares from which on it is known well.
const SETTLED: f64 = 8.0;
/// What remains of a run's weight when the way has had another, and when any way has had one.
const FORGET: f64 = 0.97;
const AGE: f64 = 0.9998;
/// After runs of weight w a way may prove `DOUBT` / sqrt(w) better than its line says.
const DOUBT: f64 = 0.2;
/// How much a belief about the start counts beside one run at another size.
const BELIEF: f64 = 0.3;
/// Ways this much slower than the best one are no reason to look further in their direction.
const NEAR: f64 = 1.2;
/// With two processors slower than one by this, sharing is hopeless.
const HOPELESS: f64 = 2.0;
/// What a doubling of the processors has to bring.
const PAYS: f64 = 1.02;
/// A run that took this much longer than its line says was disturbed, and counts as no worse than this.
const DISTURBED: f64 = 2.0;

/// One processor, or a scheme with a number of processors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// One processor.
    Serial,
    /// A scheme of [`SCHEMES`], at one of [`levels`].
    Shared { scheme: usize, level: usize },
}

/// The numbers of processors worth trying where there may be `processors`: 2, 4, 8, … and all.
pub fn levels(processors: usize) -> Vec<usize> {
    let mut levels: Vec<usize> =
        (1..).map(|power| 1 << power).take_while(|&count| count < processors).collect();
    levels.extend((processors > 1).then_some(processors));
    levels
}

/// Ticks a task against one over the tasks, by least squares with fading weights: relative errors count alike
/// in small and large runs.
#[derive(Clone, Copy, Debug, Default)]
struct Line {
    runs: u32,
    weight: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
}

impl Line {
    fn add(&mut self, tasks: f64, ticks: f64) {
        let (x, mut y) = (1.0 / tasks, ticks / tasks);
        if self.weight > TWICE {
            y = y.min(DISTURBED * self.ticks(tasks, f64::INFINITY) / tasks);
        }
        self.fade(FORGET);
        let weight = if self.weight == 0.0 { FIRST } else { 1.0 };
        self.runs += 1;
        self.weight += weight;
        self.x += weight * x;
        self.y += weight * y;
        self.xx += weight * x * x;
        self.xy += weight * x * y;
    }

    fn fade(&mut self, by: f64) {
        for sum in [&mut self.weight, &mut self.x, &mut self.y, &mut self.xx, &mut self.xy] {
            *sum *= by;
        }
    }

    /// What a run of so many tasks should take if a task takes `least` at the very least; infinite where
    /// nothing is known.
    ///
    /// Runs of one size tell no start from tasks. Then both is believed, the start nothing or all that `least`
    /// leaves, and the better one counts, so that a way is tried at sizes far from those it has had.
    fn ticks(&self, tasks: f64, least: f64) -> f64 {
        if self.weight == 0.0 {
            return f64::INFINITY;
        }
        let (x, y) = (self.x / self.weight, self.y / self.weight);
        let (spread, tilt) = (self.xx / self.weight - x * x, self.xy / self.weight - x * y);
        let belief = BELIEF * x * x / self.weight;
        let with_start = |believed: f64| {
            let start = ((tilt + belief * believed) / (spread + belief)).max(0.0);
            let each = y - start * x;
            if each >= 0.0 { start + each * tasks } else { self.xy / self.xx }
        };
        with_start(0.0).min(with_start(((y - least) / x).max(0.0)))
    }
}

/// What has been tried, and what came of it.
pub(super) struct Choice {
    /// Processors by level.
    levels: Vec<usize>,
    serial: Line,
    /// By scheme and level.
    shared: [Vec<Line>; SCHEMES.len()],
}

impl Choice {
    /// A choice among so many processors.
    pub(super) fn new(levels: Vec<usize>) -> Self {
        let shared = std::array::from_fn(|_| vec![Line::default(); levels.len()]);
        Choice { levels, serial: Line::default(), shared }
    }

    /// What a run of so many tasks should take, ticks.
    fn ticks(&self, way: Way, tasks: f64) -> f64 {
        match way {
            Way::Serial => self.serial.ticks(tasks, f64::INFINITY),
            Way::Shared { scheme, level } => {
                let least = self.serial.y / self.serial.weight / self.levels[level] as f64;
                self.shared[scheme][level].ticks(tasks, least)
            }
        }
    }

    /// Takes note of a run.
    pub(super) fn ran(&mut self, way: Way, tasks: u64, ticks: u64) {
        self.age(1);
        let line = match way {
            Way::Serial => &mut self.serial,
            Way::Shared { scheme, level } => &mut self.shared[scheme][level],
        };
        line.add(tasks.max(1) as f64, ticks.max(1) as f64);
    }

    /// Lets so many runs pass whose times are not known.
    pub(super) fn age(&mut self, runs: i32) {
        let by = AGE.powi(runs);
        self.shared.iter_mut().flatten().chain([&mut self.serial]).for_each(|line| line.fade(by));
    }

    /// The way to take for a run of so many tasks.
    pub(super) fn next(&self, tasks: u64) -> Way {
        let tasks = tasks.max(1) as f64;
        if self.serial.weight < TWICE {
            return Way::Serial;
        }
        self.tour(tasks).unwrap_or_else(|| self.most_promising(tasks))
    }

    /// Whether a way is known well enough to be taken some times without looking at the clock.
    pub(super) fn is_settled(&self, way: Way) -> bool {
        match way {
            Way::Serial => self.serial.weight >= TWICE,
            Way::Shared { scheme, level } => self.shared[scheme][level].weight >= SETTLED,
        }
    }

    /// The most tasks, `tasks` times a power of two, up to which one processor is the way to take.
    pub(super) fn serial_up_to(&self, tasks: u64) -> u64 {
        let mut up_to = tasks;
        while up_to < 1 << 40 && self.next(2 * up_to.max(1)) == Way::Serial {
            up_to = 2 * up_to.max(1);
        }
        up_to
    }

    fn most_promising(&self, tasks: f64) -> Way {
        let (mut best, mut least) = (Way::Serial, self.ticks(Way::Serial, tasks));
        let mut price = 1.0;
        for level in 0..self.levels.len() {
            price *= PAYS;
            for scheme in 0..SCHEMES.len() {
                let way = Way::Shared { scheme, level };
                let doubt = DOUBT / self.shared[scheme][level].weight.sqrt();
                let promise = price * self.ticks(way, tasks) * (1.0 - doubt).max(0.0);
                if promise < least {
                    (best, least) = (way, promise);
                }
            }
        }
        best
    }

    /// The next way on the tour that has not been tried.
    fn tour(&self, tasks: f64) -> Option<Way> {
        // What has been tried once fades, but stays tried.
        // The best one of the schemes before: ticks and level.
        let mut best = (f64::INFINITY, 0);
        for scheme in 0..SCHEMES.len() {
            let at = |level| Way::Shared { scheme, level };
            let ticks = |level| self.ticks(at(level), tasks);
            let is_new = |level: usize| self.shared[scheme][level].runs < RUNS;
            let start = best.1;
            if start >= self.levels.len() {
                return None;
            }
            if is_new(start) {
                return Some(at(start));
            }
            if scheme == 0 && ticks(start) > HOPELESS * self.ticks(Way::Serial, tasks) {
                return None;
            }
            if ticks(start) > NEAR * best.0 {
                continue;
            }
            let mut peak = (ticks(start), start);
            // The first level on the way up or down that is new, as long as those before it are near the peak.
            let climb = |peak: &mut (f64, usize), level: usize| {
                if is_new(level) {
                    return ControlFlow::Break(Some(at(level)));
                }
                if ticks(level) > NEAR * peak.0 {
                    return ControlFlow::Break(None);
                }
                if ticks(level) < peak.0 {
                    *peak = (ticks(level), level);
                }
                ControlFlow::Continue(())
            };
            let up = (start + 1..self.levels.len()).try_for_each(|level| climb(&mut peak, level));
            if let ControlFlow::Break(Some(new)) = up {
                return Some(new);
            }
            let down = (0..start).rev().try_for_each(|level| climb(&mut peak, level));
            if let ControlFlow::Break(Some(new)) = down {
                return Some(new);
            }
            if peak.0 < best.0 {
                best = peak;
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::{Choice, Line, SCHEMES, Way, levels};

    /// 400 runs of given sizes where each way takes what `ticks` says; returns the last 100 ways, and what all
    /// runs cost beyond the best way's each time, in mean serial runs.
    fn choose(levels: usize, sizes: &[u64], ticks: impl Fn(Way, u64) -> f64) -> (Vec<Way>, f64) {
        let mut choice = Choice::new((1..=levels).map(|power| 1 << power).collect());
        let all = (0..SCHEMES.len()).flat_map(|s| (0..levels).map(move |l| (s, l)));
        let all = all.map(|(scheme, level)| Way::Shared { scheme, level }).chain([Way::Serial]);
        let all: Vec<Way> = all.collect();
        let (mut ways, mut beyond, mut serial) = (Vec::new(), 0.0, 0.0);
        for &tasks in sizes.iter().cycle().take(400) {
            let way = choice.next(tasks);
            let took = ticks(way, tasks);
            choice.ran(way, tasks, took as u64);
            beyond += took - all.iter().map(|&way| ticks(way, tasks)).fold(f64::INFINITY, f64::min);
            serial += ticks(Way::Serial, tasks);
            ways.push(way);
        }
        (ways.split_off(300), beyond / (serial / 400.0))
    }

    fn share_of(ways: &[Way], wanted: impl Fn(Way) -> bool) -> f64 {
        ways.iter().filter(|&&way| wanted(way)).count() as f64 / ways.len() as f64
    }

    #[test]
    fn levels_double_and_end_with_all() {
        assert!(levels(0).is_empty());
        assert!(levels(1).is_empty());
        assert_eq!(levels(2), [2]);
        assert_eq!(levels(13), [2, 4, 8, 13]);
        assert_eq!(levels(64), [2, 4, 8, 16, 32, 64]);
    }

    #[test]
    fn a_line_tells_start_from_tasks() {
        let mut line = Line::default();
        for tasks in [100.0, 1000.0, 300.0, 50.0, 700.0] {
            line.add(tasks, 5_000.0 + 20.0 * tasks);
        }
        for tasks in [10.0, 100.0, 5_000.0] {
            let truth = 5_000.0 + 20.0 * tasks;
            assert!(
                (line.ticks(tasks, 10.0) / truth - 1.0).abs() < 0.1,
                "{} for {truth}",
                line.ticks(tasks, 10.0)
            );
        }
    }

    #[test]
    fn one_processor_where_nothing_else_helps() {
        for levels in [0, 1, 6] {
            let (ways, cost) = choose(levels, &[300], |way, _| if way == Way::Serial { 1e4 } else { 3e4 });
            assert!(share_of(&ways, |way| way == Way::Serial) >= 0.98, "{levels}");
            assert!(cost <= 5.0, "{cost}");
        }
    }

    #[test]
    fn finds_the_peak_of_every_scheme_at_little_cost() {
        for scheme in 0..SCHEMES.len() {
            for level in 0..6 {
                // Speedups rise to a peak and fall; the others stay 15 % behind.
                let ticks = |way, tasks: u64| match way {
                    Way::Serial => 30.0 * tasks as f64,
                    Way::Shared { scheme: s, level: l } => {
                        let lag = if s == scheme { 1.0 } else { 1.15 };
                        let off = f64::from((l as i32 - level as i32).abs());
                        12.0 * tasks as f64 * lag * (1.0 + 0.25 * off)
                    }
                };
                let (ways, cost) = choose(6, &[300, 310, 290], ticks);
                let hits = share_of(&ways, |way| way == Way::Shared { scheme, level });
                assert!(hits > 0.9, "{scheme} at {level}: {hits}");
                assert!(cost < 20.0, "{cost} serial runs for {scheme} at {level}");
            }
        }
    }

    #[test]
    fn small_runs_stay_serial_where_large_ones_are_shared() {
        let ticks = |way, tasks: u64| match way {
            Way::Serial => 20.0 * tasks as f64,
            Way::Shared { level, .. } => {
                f64::from(3_000 << level) + 20.0 * tasks as f64 / f64::from(2 << level)
            }
        };
        let (ways, cost) = choose(3, &[50, 4_000], ticks);
        let of = |which: usize| ways.iter().skip(which).step_by(2).copied().collect::<Vec<_>>();
        assert!(share_of(&of(0), |way| way == Way::Serial) >= 0.9, "{ways:?}");
        assert!(share_of(&of(1), |way| matches!(way, Way::Shared { level: 2, .. })) >= 0.9, "{ways:?}");
        assert!(cost < 20.0, "{cost}");
    }

    #[test]
    fn more_processors_have_to_pay() {
        let (ways, _) = choose(6, &[300], |way, _| if way == Way::Serial { 1e4 } else { 6e3 });
        assert!(share_of(&ways, |way| matches!(way, Way::Shared { level: 0 | 1, .. })) > 0.7, "{ways:?}");
    }

    #[test]
    fn serial_up_to_a_size_is_serial() {
        let mut choice = Choice::new(vec![2]);
        assert!(!choice.is_settled(Way::Serial));
        for _ in 0..3 {
            choice.ran(Way::Serial, 10, 200);
        }
        assert!(choice.is_settled(Way::Serial));
        for scheme in (0..SCHEMES.len()).chain(0..SCHEMES.len()) {
            choice.ran(Way::Shared { scheme, level: 0 }, 10, 5_000);
        }
        assert_eq!(choice.next(10), Way::Serial);
        let up_to = choice.serial_up_to(10);
        assert!((80..1_000).contains(&up_to), "{up_to}");
    }
}
