//! The job `build` as experiments use it: each frame is held against one processor's hierarchy while it runs.

use apportion::measure::{Cell, MeasureError, Options, Sample, SubjectCache, Value, subject};

fn cell(scheme: &str, machine: &str, processors: u32, settings: &[(&str, &str)]) -> Cell {
    let words = settings.iter().map(|(key, text)| ((*key).to_owned(), Value::Text((*text).to_owned())));
    Cell {
        experiment: "test".to_owned(),
        job: "build".to_owned(),
        scene: "cloth".to_owned(),
        structure: "bvh".to_owned(),
        scheme: scheme.to_owned(),
        settings: words.collect(),
        machine: machine.to_owned(),
        processors,
    }
}

fn samples(cell: &Cell) -> Result<Vec<Sample>, MeasureError> {
    let options = Options { frames: 3, path_frames: None, repeats: 1, until: None, seed: 1, path: None };
    let mut subject = subject::open(cell, &options, &mut SubjectCache::default())?;
    subject.sample(0)?;
    // Once more: nothing may be left of the first time.
    subject.sample(1)
}

fn of(samples: &[Sample], metric: &str, frame: Option<u32>) -> f64 {
    let found = samples.iter().find(|sample| sample.metric == metric && sample.frame == frame);
    found.unwrap_or_else(|| panic!("no {metric} of {frame:?} in {samples:?}")).value
}

#[test]
fn every_way_builds_under_every_scheme() {
    for how in ["sah_sah", "grid_sah", "grid_bih"] {
        for (scheme, machine, processors) in [
            ("serial", "threads", 1),
            ("fixed_tiles", "threads", 2),
            ("work_stealing", "threads", 3),
            ("serial", "opteron16", 1),
            ("fixed_tiles", "opteron16", 16),
        ] {
            let told = samples(&cell(scheme, machine, processors, &[("job.how", how), ("job.bend", "1")]));
            let told = told.unwrap_or_else(|error| panic!("{how} by {scheme} on {machine}: {error}"));
            assert!(of(&told, "sah_cost", Some(2)) > 1.0 && of(&told, "structure_rate", None) > 0.0);
        }
    }
    for how in ["sweep_sah", "morton", "spatial_splits"] {
        samples(&cell("serial", "threads", 1, &[("job.how", how)])).unwrap();
    }
}

/// The three-way scheme on real threads and simulated ones; what keeping the shape costs grows as the body rolls up.
#[test]
fn refitting_saves_time_and_costs_rays() {
    let settings = [("job.what", "refit"), ("job.bend", "4"), ("job.count", "500")];
    let refitted = samples(&cell("fixed_tiles", "threads", 2, &settings)).unwrap();
    let built = samples(&cell("fixed_tiles", "threads", 2, &settings[1..])).unwrap();
    for metric in ["sah_cost", "nodes_per_ray"] {
        assert_eq!(
            of(&refitted, metric, Some(0)),
            of(&built, metric, Some(0)),
            "both are built over what is flat"
        );
        let (kept, anew) = (of(&refitted, metric, Some(2)), of(&built, metric, Some(2)));
        assert!(kept > anew, "{metric}: {kept} with the shape of the first frame, {anew} built anew");
    }
    let time = |processors, scheme: &str, settings: &[_]| {
        let told = samples(&cell(scheme, "opteron16", processors, settings)).unwrap();
        of(&told, "frame_time", Some(1))
    };
    let (one, eight) = (time(1, "serial", &settings), time(8, "fixed_tiles", &settings));
    let anew = time(8, "fixed_tiles", &settings[1..]);
    assert!(eight < one / 3.0 && eight < anew / 3.0, "{one} by one, {eight} by eight, {anew} built by eight");
}

#[test]
fn what_cannot_be_is_told() {
    let wrong = |scheme: &str, machine: &str, settings: &[(&str, &str)]| {
        samples(&cell(scheme, machine, 1, settings)).expect_err("it cannot be").to_string()
    };
    let error = wrong("work_stealing", "threads", &[("job.what", "refit")]);
    assert!(error.contains("job.what") && error.contains("fixed_tiles"), "{error}");
    for (scheme, machine) in [("fixed_tiles", "threads"), ("serial", "opteron16")] {
        let error = wrong(scheme, machine, &[("job.how", "morton")]);
        assert!(error.contains("job.how") && error.contains("serial"), "{error}");
    }
    let error = wrong("serial", "threads", &[("job.how", "sah")]);
    assert!(error.contains("sah_sah, grid_sah, grid_bih, binned_sah"), "{error}");
}
