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
    Scheme::new(name, settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect())
}

#[test]
fn every_scheme_makes_it_first_and_after_a_failure() {
    for about in SCHEMES {
        let (mut scheme, mut kept) = (scheme(about.name, &[]).unwrap(), Noting::new(&[1.0]));
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
