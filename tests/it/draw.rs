//! The job `draw` as users run it: rows of each metric, settings that are off, scenes of their own.

use apportion::measure::{Cell, MeasureError, Options, Sample, SubjectCache, Value, subject};
use std::collections::BTreeMap;
use std::path::Path;

fn cell(scene: &str, machine: &str, settings: &[(&str, &str)]) -> Cell {
    let value = |text: &str| text.parse().map_or_else(|_| Value::Text(text.to_owned()), Value::Integer);
    Cell {
        experiment: "test".to_owned(),
        job: "draw".to_owned(),
        scene: scene.to_owned(),
        structure: "skip_tree".to_owned(),
        scheme: "serial".to_owned(),
        settings: settings
            .iter()
            .map(|(key, text)| ((*key).to_owned(), value(text)))
            .collect::<BTreeMap<_, _>>(),
        machine: machine.to_owned(),
        processors: 1,
    }
}

fn sample(cache: &mut SubjectCache, cell: &Cell) -> Result<Vec<Sample>, MeasureError> {
    let options = Options { frames: 3, path_frames: None, repeats: 1, until: None, seed: 1, path: None };
    subject::open(cell, &options, cache)?.sample(0)
}

fn of(samples: &[Sample], metric: &str) -> f64 {
    let found = samples.iter().find(|sample| sample.metric == metric);
    found.unwrap_or_else(|| panic!("no {metric} in {samples:?}")).value
}

#[test]
fn culling_saves_vertices_and_changes_no_pixel() {
    let mut cache = SubjectCache::default();
    let mut run = |culling: &str, leaf: &str| {
        let settings = [
            ("scene.copies", "9"),
            ("job.culling", culling),
            ("job.leaf", leaf),
            ("job.width", "64"),
            ("job.height", "48"),
        ];
        sample(&mut cache, &cell("dragon", "threads", &settings)).unwrap()
    };
    let (off, coarse, fine) = (run("off", "unsplit"), run("on", "unsplit"), run("coherent", "1/288"));
    assert_eq!((of(&off, "leaves"), of(&off, "draw_calls")), (9.0, 9.0));
    assert_eq!(of(&off, "triangles_drawn"), 903_168.0);
    assert!(of(&fine, "leaves") > 288.0 * 9.0 && of(&fine, "split_medians") == 0.0);
    let decreases =
        |metric: &str| of(&off, metric) >= of(&coarse, metric) && of(&coarse, metric) > of(&fine, metric);
    assert!(decreases("triangles_drawn") && decreases("triangles_outside"));
    for metric in ["pixels_covered", "pixel_tests", "triangles_set_up"] {
        assert!(of(&off, metric) == of(&fine, metric) && of(&off, metric) > 0.0, "{metric}");
    }
    assert!(of(&fine, "traversal_time") > 0.0 && !off.iter().any(|sample| sample.metric == "traversal_time"));
    for metric in ["draw_time", "split_time", "split_rate", "build_time", "build_rate", "nodes_visited"] {
        assert!(of(&fine, metric) > 0.0, "{metric}");
    }
}

#[test]
fn simulated_machines_cull_what_threads_cull() {
    let mut cache = SubjectCache::default();
    let settings = [("scene.copies", "9"), ("job.leaf", "5000")];
    let mut cull = |machine: &str| sample(&mut cache, &cell("dragon", machine, &settings)).unwrap();
    let (threads, simulated) = (cull("threads"), cull("e4000"));
    for metric in ["draw_calls", "nodes_visited", "leaves"] {
        assert_eq!(of(&threads, metric), of(&simulated, metric), "{metric}");
    }
    assert!(of(&simulated, "frame_time") > 0.0);
    let off = cell("dragon", "e4000", &[("job.culling", "off")]);
    let error = sample(&mut cache, &off).unwrap_err();
    assert!(error.is_usage() && error.to_string().contains("does not draw"), "{error}");
}

#[test]
fn settings_that_are_off_are_named() {
    let mut cache = SubjectCache::default();
    for (setting, part) in [
        (("job.leaf", "0"), "a share of the largest mesh such as 1/288"),
        (("job.culling", "of"), "expected one of: on, coherent, off"),
        (("job.width", "0"), "a number from 1 to 16384"),
        (("job.leafs", "3"), "no setting `job.leafs`"),
        (("scene.copies", "0"), "setting `scene.copies` is `0`, expected a number from 1 to 10000"),
        (("scene.spacing", "wide"), "expected a number from 0 to 1000"),
        (("scene.path", "above"), "expected one of: walk, both"),
        (("scene.moving", "0.5"), "expected the job `cull` on `threads`, found `draw` on `threads`"),
    ] {
        let error = sample(&mut cache, &cell("factory-small", "threads", &[setting])).unwrap_err();
        assert!(error.is_usage() && error.to_string().contains(part), "{error} lacks {part}");
    }
}

#[test]
fn any_scene_of_a_file_is_split_and_repeated() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("square.obj");
    std::fs::write(&file, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n").unwrap();
    let own = file.display().to_string();
    let sponza = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes/sponza/sponza.obj");
    let mut scenes = vec![own];
    if sponza.exists() {
        scenes.push(sponza.display().to_string());
    } else {
        eprintln!("skipped: {} is not here", sponza.display());
    }
    let mut cache = SubjectCache::default();
    for scene in scenes {
        let settings =
            [("scene.copies", "4"), ("job.leaf", "1/8"), ("job.width", "80"), ("job.height", "60")];
        let samples = sample(&mut cache, &cell(&scene, "threads", &settings)).unwrap();
        assert!(of(&samples, "leaves") >= 8.0, "{scene}");
    }
}
