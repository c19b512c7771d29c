//! The job `collide` as experiments use it, and bodies that bend.

use apportion::geometry::{Aabb, Obb, Rigid};
use apportion::job::collide::{Query, contacts, own_contacts};
use apportion::measure::{Cell, MeasureError, Options, Sample, SubjectCache, Value, subject};
use apportion::scene;
use apportion::structure::VolumeTree;
use apportion::structure::volume_tree::in_world;
use glam::{DQuat, DVec3, Vec3};
use std::path::Path;

fn cell(scene: &str, scheme: &str, machine: &str, settings: &[(&str, &str)]) -> Cell {
    let words = settings.iter().map(|(key, text)| ((*key).to_owned(), Value::Text((*text).to_owned())));
    Cell {
        experiment: "test".to_owned(),
        job: "collide".to_owned(),
        scene: scene.to_owned(),
        structure: "volume_tree".to_owned(),
        scheme: scheme.to_owned(),
        settings: words.collect(),
        machine: machine.to_owned(),
        processors: if scheme == "serial" { 1 } else { 4 },
    }
}

fn samples(cell: &Cell) -> Result<Vec<Sample>, MeasureError> {
    let options = Options { frames: 4, path_frames: None, repeats: 1, until: None, seed: 1, path: None };
    subject::open(cell, &options, &mut SubjectCache::default())?.sample(0)
}

fn of(samples: &[Sample], metric: &str) -> f64 {
    let found = samples.iter().find(|sample| sample.metric == metric && sample.frame.is_none());
    found.unwrap_or_else(|| panic!("no {metric} in {samples:?}")).value
}

/// P2-21: the place is deep in both trees, and nothing touches there, whatever is tested by.
#[test]
fn the_robot_stands_deep_in_the_factory_and_touches_nothing() {
    let deep = [("job.over", "nodes"), ("job.place", "deep"), ("job.query", "first")];
    let mut all = Vec::new();
    for volume in ["aabb", "aabb_as_obb"] {
        for (scheme, machine, tasks) in
            [("serial", "threads", "serial.tasks"), ("lock_free", "e4000", "lock_free.tasks")]
        {
            let settings = [&deep[..], &[("job.volume", volume), (tasks, "pairs")]].concat();
            let samples = samples(&cell("robot + factory-large", scheme, machine, &settings)).unwrap();
            assert_eq!(of(&samples, "contacts"), 0.0, "{volume} {scheme}");
            all.push(of(&samples, "box_tests"));
        }
    }
    // One place for both tests, and the same pairs on the way down: boxes along the axes are boxes along the axes.
    assert!(all.iter().all(|&tests| tests == all[0]) && all[0] > 300.0, "{all:?}");
}

/// Whoever has the rows can put the robot there again: the same body, found again by the same tests.
#[test]
fn the_place_that_was_found_is_told() {
    let deep = [("job.over", "nodes"), ("job.place", "deep"), ("job.volume", "aabb")];
    let told = samples(&cell("robot + factory-large", "serial", "threads", &deep)).unwrap();
    let place = |metric| {
        let all: Vec<_> = told.iter().filter(|sample| sample.metric == metric).collect();
        assert_eq!((all.len(), all[0].frame), (1, Some(0)), "{metric}: one place for all frames");
        all[0].value
    };
    let at = DVec3::new(place("mover_x"), place("mover_y"), place("mover_z"));
    let turn = DVec3::new(place("mover_turn_x"), place("mover_turn_y"), place("mover_turn_z"));
    assert!(at.length() > 1.0 && turn == DVec3::ZERO, "{at} {turn}");
    let tree = |name| VolumeTree::<Aabb>::over_nodes(&scene::by_name(name).unwrap());
    let motion = Rigid::new(DQuat::from_scaled_axis(turn), at);
    let again = contacts(&tree("factory-large"), &tree("robot"), &motion, Query::default());
    assert!(again.pairs.is_empty());
    assert_eq!(again.box_tests as f64, of(&told, "box_tests"));

    let told =
        samples(&cell("robot + factory-small", "serial", "threads", &[("job.place", "graze")])).unwrap();
    let turns: Vec<_> = told.iter().filter(|sample| sample.metric == "mover_turn_y").collect();
    let frames: Vec<_> = turns.iter().map(|sample| sample.frame).collect();
    assert_eq!(frames, [0, 1, 2, 3].map(Some), "it moves in each");
    assert!(turns[0].value == 0.0 && (turns[3].value - 0.25).abs() < 1e-9, "half of its turn of 0.5");
}

/// A sheet rolled up: each frame is held against trees of spheres built for it while it runs.
#[test]
fn a_sheet_that_rolls_up_touches_itself_by_trees_fitted_anew_and_built_anew() {
    for volume in ["obb", "aabb"] {
        let [fitted, built] = ["refit", "rebuild"].map(|tree| {
            let settings = [("job.bend", "1.25"), ("job.tree", tree), ("job.volume", volume)];
            samples(&cell("cloth", "work_stealing", "threads", &settings)).unwrap()
        });
        let by_frame = |samples: &[Sample], metric| -> Vec<f64> {
            samples.iter().filter(|s| s.metric == metric && s.frame.is_some()).map(|s| s.value).collect()
        };
        let contacts = by_frame(&fitted, "contacts");
        assert_eq!(contacts, by_frame(&built, "contacts"));
        assert!(contacts[0] == 0.0 && contacts[3] > 100.0, "{contacts:?}");
        assert_eq!(
            by_frame(&fitted, "box_tests")[0],
            by_frame(&built, "box_tests")[0],
            "flat, both are one tree"
        );
        let last = [&fitted, &built].map(|samples| by_frame(samples, "box_tests")[3]);
        // Of a sheet that keeps its lengths oriented boxes turn with it; aligned ones get looser where it crosses itself.
        assert!(volume == "obb" || last[0] > last[1], "{volume}: {last:?}");
    }
    let error = samples(&cell("cloth", "serial", "e4000", &[("job.bend", "1")])).unwrap_err().to_string();
    assert!(error.contains("a body that bends runs on threads only"), "{error}");
}

/// Each frame is held against trees of spheres while it runs.
#[test]
fn a_robot_that_runs_into_a_factory_under_every_kind_of_volume() {
    for volume in ["obb", "aabb", "aabb_as_obb", "sphere", "18dop"] {
        for query in ["all", "first"] {
            let settings = [("job.place", "graze"), ("job.volume", volume), ("job.query", query)];
            let samples =
                samples(&cell("robot + factory-small", "work_stealing", "threads", &settings)).unwrap();
            let contacts = of(&samples, "contacts");
            assert!(
                if query == "first" { contacts > 0.0 && contacts <= 1.0 } else { contacts > 10.0 },
                "{contacts}"
            );
        }
    }
}

#[test]
fn what_is_off_is_told() {
    for (scene, settings, part) in [
        ("robot", &[][..], "takes two scenes, the moving one first"),
        ("robot + nowhere", &[], "nowhere"),
        (
            "robot + robot",
            &[("job.volume", "cube")],
            "setting `job.volume` is `cube`, expected one of: obb, aabb",
        ),
        ("robot + nowhere", &[("job.volume", "26dop")], "expected one of: obb"),
        ("robot + robot", &[("job.gap", "-1")], "setting `job.gap` is `-1`, expected a number"),
        ("robot + robot", &[("job.place", "deep")], "no place for `robot` in `robot` where nothing touches"),
    ] {
        let error = samples(&cell(scene, "serial", "threads", settings)).unwrap_err().to_string();
        assert!(error.contains(part), "{error} lacks {part}");
    }
}

/// A galloping elephant: a tree fitted anew finds what one built anew finds.
#[test]
fn a_deforming_mesh_touches_itself_as_often_by_a_tree_fitted_anew() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes/anim_elephant-gallop");
    let Ok(frames) = std::fs::read(folder.join("frames.f32")) else { return };
    let mesh = scene::load(folder.join("topology.obj")).unwrap();
    let (positions, triangles) = in_world(&mesh).unwrap();
    let numbers: Vec<f32> =
        frames.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let poses: Vec<Vec<Vec3>> = numbers
        .chunks_exact(3 * positions.len())
        .map(|frame| frame.as_chunks::<3>().0.iter().map(|&point| Vec3::from_array(point)).collect())
        .collect();
    assert!(poses.len() > 10, "{} frames of {} corners", poses.len(), positions.len());
    let mut tree = VolumeTree::<Obb>::over_triangles(&poses[0], &triangles, 4).unwrap();
    let mut most = 0;
    for pose in poses.iter().step_by(poses.len() / 6) {
        tree.refit(pose).unwrap();
        tree.validate().unwrap();
        let anew = VolumeTree::<Obb>::over_triangles(pose, &triangles, 2).unwrap();
        let (fitted, anew) = (own_contacts(&tree, Query::default()), own_contacts(&anew, Query::default()));
        assert_eq!(fitted.pairs, anew.pairs);
        most = most.max(fitted.pairs.len());
    }
    assert!(most > 0, "no fold of its skin touches another");
}
