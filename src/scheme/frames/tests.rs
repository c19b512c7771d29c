use super::*;

/// A structure whose cost is what the next number of a list says, that notes what was done to it.
struct Noting {
    costs: Vec<f64>,
    done: Vec<&'static str>,
    fails: bool,
}

impl Noting {
    fn new(costs: &[f64]) -> Self {
        Self { costs: costs.iter().rev().copied().collect(), done: Vec::new(), fails: false }
    }

    fn note(&mut self, what: &'static str) -> Result<(), &'static str> {
        self.done.push(what);
        if self.costs.len() > 1 && self.done.len() > 1 {
            self.costs.pop();
        }
        if std::mem::take(&mut self.fails) { Err(what) } else { Ok(()) }
    }
}

impl Kept for Noting {
    type Error = &'static str;

    fn rebuild(&mut self) -> Result<(), &'static str> {
        self.note("rebuild")
    }

    fn refit(&mut self) -> Result<(), &'static str> {
        self.note("refit")
    }

    fn cost(&self) -> f64 {
        *self.costs.last().unwrap()
    }
}

fn scheme(name: &str, settings: &[(&str, &str)]) -> Result<Scheme, SettingError> {
    let settings = settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    Scheme::new(name, settings, Mode::Predetermined)
}

/// What each frame costs by a structure made for each.
struct Table(Vec<Vec<f64>>);

impl Foretold for Table {
    type Error = std::convert::Infallible;

    fn count(&self) -> usize {
        self.0.len()
    }

    fn costs(&mut self, made: usize, end: usize) -> Result<Vec<f64>, Self::Error> {
        Ok(self.0[made][made..end].to_vec())
    }
}

/// What frames cost altogether by structures made anew for some of them, each for so much more than the share `price` of
/// the frame it is made for.
fn total(table: &[Vec<f64>], price: f64, anew: impl Fn(usize) -> bool) -> f64 {
    let mut made = 0;
    let frames = (0..table.len()).map(|frame| {
        let is_anew = frame > 0 && anew(frame);
        made = if is_anew { frame } else { made };
        table[made][frame] + if is_anew { price * table[frame][frame] } else { 0.0 }
    });
    frames.sum()
}

#[test]
fn what_is_planned_is_the_best_of_all_plans() {
    let mut state = 3_u64;
    for round in 0..60 {
        let count = round % 9;
        // A linear congruence (Knuth's multiplier): any costs will do.
        let mut cost = |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let most = if round % 2 == 0 { 1.0 } else { 8.0 };
            1.0 + most * (state >> 40) as f64 / f64::from(1 << 24)
        };
        let table: Vec<Vec<f64>> = (0..count).map(|_| (0..count).map(&mut cost).collect()).collect();
        for percent in ["0", "10", "50", "400"] {
            let price = percent.parse::<f64>().unwrap() / 100.0;
            let mut scheme = scheme("rebuild_when_best", &[("percent", percent)]).unwrap();
            scheme.plan(&mut Table(table.clone())).unwrap();
            let mut kept = Noting::new(&[1.0]);
            scheme.prepare(&mut kept).unwrap();
            let found: Vec<Upkeep> = (0..count).map(|_| scheme.next(&mut kept).unwrap()).collect();
            let found = total(&table, price, |frame| found[frame] == Upkeep::Rebuilt);
            let plans = (0..1u32 << count).map(|plan| total(&table, price, |frame| plan >> frame & 1 == 1));
            let best = plans.fold(f64::INFINITY, f64::min);
            assert!((found - best).abs() < 1e-9 * best.max(1.0), "{found}, but {best} by {table:?}");
        }
    }
}

#[test]
fn a_plan_holds_where_costs_cannot_be_told_and_no_further_than_frames_were_foretold() {
    let mut scheme = scheme("rebuild_when_best", &[]).unwrap();
    let mut table = vec![vec![1.0; 70]; 70];
    table[0][2] = f64::NAN;
    scheme.plan(&mut Table(table)).unwrap();
    let mut kept = Noting::new(&[1.0]);
    let rebuilt: Vec<usize> =
        (0..72).filter(|_| scheme.next(&mut kept).unwrap() == Upkeep::Rebuilt).collect();
    // The first, which nothing was made before; one before the cost that cannot be told; one as 64 are the most, where
    // it does not matter; and those beyond.
    assert_eq!(rebuilt.len(), 5, "{rebuilt:?}");
    assert_eq!((rebuilt[0], &rebuilt[3..]), (0, &[70, 71][..]));
    assert!((1..=2).contains(&rebuilt[1]) && rebuilt[2] <= rebuilt[1] + 64, "{rebuilt:?}");
    let mut unknowable = self::scheme("rebuild_when_best", &[]).unwrap();
    unknowable.plan(&mut Table(vec![vec![f64::NAN; 4]; 4])).unwrap();
    assert!((0..4).all(|_| unknowable.next(&mut kept).unwrap() == Upkeep::Rebuilt));
}

#[test]
fn who_looks_ahead_is_refused_where_nobody_may() {
    for about in SCHEMES {
        let interactive = Scheme::new(about.name, BTreeMap::new(), Mode::Interactive);
        assert_eq!(interactive.is_err(), about.looks_ahead, "{}", about.name);
        if let Err(error) = interactive {
            assert!(error.to_string().contains("looks ahead"), "{error}");
        }
        assert!(Scheme::new(about.name, BTreeMap::new(), Mode::Predetermined).is_ok());
    }
}

#[test]
fn every_scheme_makes_it_first_and_after_a_failure() {
    for about in SCHEMES {
        let (mut scheme, mut kept) = (scheme(about.name, &[]).unwrap(), Noting::new(&[1.0]));
        scheme.plan(&mut Table(vec![vec![1.0; 4]; 4])).unwrap();
        assert_eq!(scheme.next(&mut kept), Ok(Upkeep::Rebuilt), "{}", about.name);
        let then = scheme.next(&mut kept).unwrap();
        assert_eq!(then == Upkeep::Rebuilt, about.name == "rebuild_each_frame", "{}", about.name);
        kept.fails = true;
        assert!(scheme.next(&mut kept).is_err());
        let before = kept.done.len();
        assert_eq!(scheme.next(&mut kept), Ok(Upkeep::Rebuilt), "{}", about.name);
        assert_eq!(kept.done[before..], ["rebuild"], "{}: what failed is not refitted", about.name);
    }
}

#[test]
fn the_threshold_is_of_the_cost_when_it_was_last_made() {
    let mut scheme = scheme("rebuild_on_threshold", &[("percent", "120")]).unwrap();
    // Made at 10; 12 is not above 120 %, 12.5 is; made at 20, of which 23 is not; a cost that is NaN is.
    let mut kept = Noting::new(&[10.0, 12.0, 12.5, 20.0, 23.0, f64::NAN, 1.0]);
    let all: Vec<_> = (0..5).map(|_| scheme.next(&mut kept).unwrap()).collect();
    use Upkeep::{Rebuilt, Refitted};
    assert_eq!(all, [Rebuilt, Refitted, Rebuilt, Refitted, Rebuilt]);
    assert_eq!(kept.done, ["rebuild", "refit", "refit", "rebuild", "refit", "refit", "rebuild"]);
}

#[test]
fn what_cannot_be_is_refused() {
    assert!(matches!(scheme("asleep", &[]), Err(SettingError::NoScheme { shape: "frames", .. })));
    assert!(matches!(scheme("refit_only", &[("percent", "120")]), Err(SettingError::Unknown { .. })));
    for percent in ["99", "-1", "x", "NaN"] {
        let wrong = scheme("rebuild_on_threshold", &[("percent", percent)]);
        assert!(matches!(wrong, Err(SettingError::Value { .. })), "{percent}");
    }
}
