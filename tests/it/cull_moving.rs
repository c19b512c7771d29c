//! The setting `scene.moving` as experiments use it: each frame is held against the oracle while it runs.

use apportion::measure::{Cell, MeasureError, Options, Sample, SubjectCache, Value, subject};

fn cell(machine: &str, share: f64, steps: &str, settings: &[(&str, &str)]) -> Cell {
    let words = settings.iter().map(|(key, text)| ((*key).to_owned(), Value::Text((*text).to_owned())));
    let moving = ("scene.moving".to_owned(), Value::Float(share));
    Cell {
        experiment: "test".to_owned(),
        job: "cull".to_owned(),
        scene: "factory-small".to_owned(),
        structure: "skip_tree".to_owned(),
        scheme: "serial".to_owned(),
        settings: words.chain([moving, ("job.steps".to_owned(), Value::Text(steps.to_owned()))]).collect(),
        machine: machine.to_owned(),
        processors: 1,
    }
}

/// Two paths, as a run with repeats has them: in the second, things go back to where they began.
fn samples(cell: &Cell) -> Result<Vec<Sample>, MeasureError> {
    let options = Options { frames: 20, path_frames: None, repeats: 2, until: None, seed: 1, path: None };
    let mut cache = SubjectCache::default();
    let mut subject = subject::open(cell, &options, &mut cache)?;
    subject.sample(0)?;
    subject.sample(1)
}

fn of(samples: &[Sample], metric: &str) -> f64 {
    let found = samples.iter().find(|sample| sample.metric == metric);
    found.unwrap_or_else(|| panic!("no {metric} in {samples:?}")).value
}

#[test]
fn all_kinds_of_volumes_and_steps_stand_the_oracle_while_things_move() {
    for volume in ["aabb", "obb", "sphere", "18dop"] {
        for (steps, path) in [("basic", "walk"), ("plane+tr", "translation"), ("tr", "rotation")] {
            let more = [
                ("job.volume", volume),
                ("scene.path", path),
                ("job.accuracy", "true"),
                ("job.baseline", "plane"),
            ];
            let refitted = [0.0, 0.1, 1.0].map(|share| {
                let samples = samples(&cell("threads", share, steps, &more)).expect("the oracle agrees");
                assert!(of(&samples, "nodes_visible") > 0.0 && of(&samples, "refit_time") >= 0.0);
                of(&samples, "nodes_refitted")
            });
            let [none, some, all] = refitted;
            assert!(none == 0.0 && some > 0.0 && all > some && all <= 254.0, "{refitted:?}");
        }
    }
}

#[test]
fn a_share_that_is_none_and_machines_that_bill_no_refit_are_refused() {
    for (machine, share, part) in [
        ("threads", 1.5, "setting `scene.moving` is `1.5`, expected a number from 0 to 1"),
        ("threads", f64::NAN, "expected a number from 0 to 1"),
        ("e4000", 0.5, "expected the job `cull` on `threads`, found `cull` on `e4000`"),
    ] {
        let error = samples(&cell(machine, share, "basic", &[])).unwrap_err();
        assert!(error.is_usage() && error.to_string().contains(part), "{error} lacks {part}");
    }
}
