//! The page, from rows made up for it.

use apportion::record::{Host, Meta, PaperFigure, Question, Row};
use apportion::report::{ReportError, Run, page};
use std::path::Path;

/// Where a made-up run is from.
pub(crate) fn meta(experiment: &str) -> Meta {
    Meta {
        run: "20260301T120000Z".into(),
        experiment: experiment.into(),
        command: vec!["apportion".into(), "run".into(), experiment.into()],
        version: "0.1.0".into(),
        commit: None,
        host: Host {
            cpu: "A <chip> & \"more\"".into(),
            cores: 2,
            clock_mhz: Some(333),
            memory: Some(1 << 27),
            caches: vec![],
            system: "none".into(),
        },
        seed: 7,
        start: "2026-03-01T12:00:00Z".into(),
        end: Some("2026-03-01T12:01:00Z".into()),
        selection: serde_json::Value::Null,
    }
}

/// A row of a cell that ran once.
fn row(scheme: &str, settings: &str, machine: &str, processors: u32, metric: &str, value: f64) -> Row {
    Row {
        run: "20260301T120000Z".into(),
        experiment: "made-up".into(),
        job: "cull".into(),
        scene: "a <scene>".into(),
        structure: "skip_tree".into(),
        scheme: scheme.into(),
        settings: settings.into(),
        machine: machine.into(),
        processors,
        repeat: 0,
        frame: None,
        metric: metric.into(),
        unit: "x".into(),
        value,
    }
}

/// A run with something for every kind of figure: a plane of two settings, an accuracy that is paid for, frames.
fn run() -> Run {
    let mut rows = Vec::new();
    for (work, boxes, visited) in [(1.0, 1, 100.0), (1.0, 4, 180.0), (9.0, 1, 100.0), (9.0, 4, 180.0)] {
        let settings = format!("job.boxes={boxes};job.work={work}");
        for machine in ["e4000", "threads"] {
            for (scheme, share) in [("serial", 1.0), ("lock_free", 0.1), ("of <tomorrow> & 'co'", 0.4)] {
                let counts: &[u32] = if scheme == "serial" { &[1] } else { &[1, 2, 4, 8] };
                for &count in counts {
                    let time =
                        1e6 * work * (share + (1.0 - share) / f64::from(count)) / f64::from(boxes).sqrt();
                    let mut add = |frame, metric, value| {
                        let row = row(scheme, &settings, machine, count, metric, value);
                        rows.push(Row { frame, ..row });
                    };
                    add(None, "nodes_visited", visited);
                    add(None, "nodes_visible", 42.0);
                    add(None, "total_time", time);
                    add(None, "speedup", 1e6 * work / f64::from(boxes).sqrt() / time);
                    add(None, "load_imbalance", f64::from(count));
                    add(None, "traversal_share", 3.0);
                    for frame in 0..5 {
                        add(Some(frame), "frame_time", time * (1.0 + f64::from(frame)) / 15.0);
                    }
                }
            }
        }
    }
    let figure = |processors, value| PaperFigure {
        figure: "Fig. <1>".into(),
        scheme: "lock_free".into(),
        settings: String::new(),
        scene: None,
        machine: "e4000".into(),
        processors,
        metric: "speedup".into(),
        unit: "x".into(),
        value,
        source: "Paper \"0\"".into(),
        fact: None,
    };
    let paper = vec![figure(Some(4), 3.0), figure(None, 4.5)];
    let question = Question { title: "Made up: <b> & \"c\"".into(), reproduces: String::new(), paper };
    Run { meta: meta("made-up"), question, rows, timeline: Some(TIMELINE.into()), link: "made up/run".into() }
}

/// A run of animations: an exact one, a method at two knobs, all frames told, on one scene of BART's.
fn animated() -> Run {
    let mut rows = Vec::new();
    let methods = [("exact", 1.0, 100.0, 1.0), ("reuse:12", 0.25, 18.0, 0.6), ("reuse:4", 0.75, 24.0, 0.8)];
    for (repeat, (method, share, ratio, alike)) in
        (0..3).flat_map(|repeat| methods.map(|method| (repeat, method)))
    {
        let settings = format!("job.approximation={method};job.size=800x600");
        let mut add = |frame, metric, value| {
            let row = row("serial", &settings, "threads", 1, metric, value);
            let scene = "bart-museum-5".into();
            rows.push(Row { frame, repeat, job: "animate".into(), scene, experiment: "moves".into(), ..row });
        };
        let time = 4e6 * share;
        for (metric, value) in [
            ("total_time", 20.0 * time),
            ("frame_time_mean", 5.0 * time),
            ("frame_time_max", 7.0 * time),
            ("deviation", 0.37),
            ("continuity", 0.18),
            ("preprocessing_time", 3e6),
            ("primitives", 11_175.0),
            ("scene_bytes", 8.5e6),
            ("structure_bytes", 0.5e6),
            ("apnsr", ratio),
            ("ssim", alike),
            ("clock_time", 1e6),
            ("speedup", 1.0),
        ] {
            add(None, metric, value);
        }
        for frame in 0..4 {
            let here = time * f64::from(frame + 4);
            add(Some(frame), "frame_time", here * (1.0 + f64::from(repeat)));
            add(Some(frame), "rays_eye", 480_000.0 * share);
            add(Some(frame), "rays_shadow", 900_000.0 * share);
            for (metric, part) in [("rebuild_time", 0.2), ("visibility_time", 0.5), ("shading_time", 0.3)] {
                add(Some(frame), metric, part * here);
            }
            if method != "exact" {
                add(Some(frame), "pnsr", ratio + f64::from(frame));
            }
        }
    }
    let question = Question { title: "Moves".into(), reproduces: String::new(), paper: Vec::new() };
    Run { meta: meta("moves"), question, rows, timeline: None, link: "moves/run".into() }
}

#[test]
fn an_animation_is_told_as_bart_asks_for() {
    let run = animated();
    let mut table = apportion::report::table(&run.rows, &run.question.paper);
    table.made_on(&run.meta.host);
    let text = table.text();
    let report = text.split_once("BART's report: ").expect("it is there").1.replace("\n  ", " ");
    for words in [
        "model bart-museum-5, frames 4, primitives 11175, complexity level 5, resolution 800x600, mode interactive",
        "scene 8.50 MB",
        "average, ms",
        "2 cores at 333 MHz, 0.1 GiB of memory",
    ] {
        assert!(report.contains(words), "no `{words}` in\n{text}");
    }
    let line = report.lines().find(|line| line.starts_with("reuse:4 ")).expect("it has a line");
    let cells: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(cells, ["reuse:4", "15.0", "21.0", "60.0"], "average, worst and total are what differs");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    assert!(html(&run).contains("<td>11175<td>5<td>800x600<td>interactive<td>exact"), "the page has it too");
    // The cells of another job tell nothing of the kind.
    assert!(!html(&self::run()).contains("BART"), "of an animation alone");
}

#[test]
fn an_animations_frames_are_drawn_one_by_one() {
    let run = animated();
    let html = html(&run);
    let said = |kind: &str| said_in(&html, &format!("moves-{kind}"));
    assert!(
        said("by-frame-time").contains("from 8.00 ms (reuse:12) to 56.0 ms (exact)"),
        "{}",
        said("by-frame-time")
    );
    // Three repeats, each slower than the one before: paired, the ratio is the same in all.
    assert!(
        said("by-frame-ratio").contains("from 0.25 (reuse:12) to 0.75 (reuse:4)"),
        "{}",
        said("by-frame-ratio")
    );
    assert!(
        said("by-frame-pnsr").contains("the worst frame has 18.0 dB (reuse:12)"),
        "{}",
        said("by-frame-pnsr")
    );
    assert!(
        said("by-frame-rays").contains("480000 eye, 900000 shadow rays a frame"),
        "{}",
        said("by-frame-rays")
    );
    assert!(html.contains("Of exact; 1 of 3 configurations trace as many."));
    let parts = said("by-frame-parts");
    assert!(parts.contains("exact: 20.0 % rebuild, 50.0 % visibility, 30.0 % shading"), "{parts}");
    // A method is one line over its knob, least first, and of two measures of quality each has its panel.
    let accuracy = &html[html.find("<figure id=\"moves-accuracy-answer\"").expect("it is there")..];
    assert!(accuracy.contains("reuse: 4, 12"), "the legend has the knob");
    assert!(accuracy.contains("data-d=\"24,15 18,5\"") && accuracy.contains("data-d=\"0.8,15 0.6,5\""));
    // Where rows of frames were left out there is nothing to draw, and the table is the same.
    let mut whole = run.clone();
    whole.rows.retain(|row| row.frame.is_none());
    assert!(!self::html(&whole).contains("by-frame"));
    // Odd numbers break nothing.
    let mut odd = run;
    for (number, row) in odd.rows.iter_mut().enumerate() {
        row.value = [row.value, f64::NAN, f64::INFINITY, 0.0, -1.0][number % 5];
    }
    self::html(&odd);
    odd.charts().expect("they can be drawn");
}

const TIMELINE: &str = r#"{"traceEvents": [
    {"ph": "M", "name": "process_name", "pid": 1, "tid": 0, "args": {"name": "lock_free on e4000, P=2"}},
    {"ph": "X", "name": "working", "pid": 1, "tid": 0, "ts": 10.0, "dur": 30.0},
    {"ph": "X", "name": "sending", "pid": 1, "tid": 0, "ts": 40.0, "dur": 10.0},
    {"ph": "X", "name": "idle", "pid": 1, "tid": 1, "ts": 10.0, "dur": 20.0},
    {"ph": "X", "name": "working", "pid": 1, "tid": 1, "ts": 30.0, "dur": 20.0}
]}"#;

fn html(run: &Run) -> String {
    let html = page(std::slice::from_ref(run)).expect("it can be drawn");
    assert!(!html.contains("NaN") && !html.contains(">inf") && !html.contains(",inf"), "a number is none");
    html
}

#[test]
fn a_page_holds_a_figure_of_every_kind() {
    let run = run();
    let html = html(&run);
    if let Some(folder) = std::env::var_os("CHARTS_TO_LOOK_AT") {
        let both = page(&[run.clone(), animated()]).expect("it can be drawn");
        std::fs::write(Path::new(&folder).join("made-up.html"), both).expect("it is written");
    }
    for kind in ["plane", "speedup", "time", "accuracy-structure", "balance", "sharing", "frames", "timeline"]
    {
        assert!(html.contains(&format!("<figure id=\"made-up-{kind}\"")), "no {kind}");
        assert!(html.contains(&format!("<a href=\"#made-up-{kind}\"")), "no {kind} in the contents");
    }
    // Of the cells of a machine two are on the front: the fewest nodes, and the shortest time.
    assert!(html.contains("of 36 cells 2 are on the front"), "{}", said(&html, "accuracy-structure"));
    assert!(said(&html, "speedup").contains("lock_free"), "{}", said(&html, "speedup"));
    assert!(said(&html, "timeline").contains("62.5 % working"), "{}", said(&html, "timeline"));
    // One repeat on threads tells nothing apart.
    for words in ["How sure the measured speedups are", "it takes 6 repeats"] {
        assert!(html.contains(words), "no {words}");
    }
    for words in ["Fig. &lt;1&gt;", "<dt>Seed<dd>7", "commit not known", "made%20up/run/rows.csv"] {
        assert!(html.contains(words), "no {words}");
    }
    assert_eq!(page(&[run]).expect("it can be drawn"), html, "the same rows give the same bytes");
}

/// What the caption of a figure says.
fn said<'a>(html: &'a str, kind: &str) -> &'a str {
    said_in(html, &format!("made-up-{kind}"))
}

fn said_in<'a>(html: &'a str, id: &str) -> &'a str {
    let figure = &html[html.find(&format!("<figure id=\"{id}\"")).expect("it is there")..];
    let caption = &figure[figure.find("<figcaption>").expect("it has a caption")..];
    &caption[..caption.find("</figcaption>").expect("it ends")]
}

#[test]
fn no_name_gets_out_of_its_place() {
    let html = html(&run());
    for raw in ["of <tomorrow>", "a <scene>", "<chip>", "<b> &", "Paper \"0\""] {
        assert!(!html.contains(raw), "{raw} stands there as it is");
    }
    assert!(html.contains("of &lt;tomorrow&gt; &amp; &#39;co&#39;"));
    for chart in run().charts().expect("they can be drawn") {
        let svg = chart.file_name.ends_with(".svg");
        assert!(!svg || !chart.text.contains("of <tomorrow>"), "{}", chart.file_name);
    }
}

#[test]
fn nothing_is_fetched() {
    let html = html(&run());
    for word in ["src=", "http://", "https://", "@import", "<link rel=\"stylesheet"] {
        let found =
            html.match_indices(word).find(|(at, _)| !html[*at..].starts_with("http://www.w3.org/2000/svg"));
        assert!(found.is_none(), "{word} in {:?}", found.map(|(at, _)| &html[at..at + 60]));
    }
}

#[test]
fn without_rows_there_is_no_page() {
    assert!(matches!(page(&[]), Err(ReportError::Empty { .. })));
    let empty = Run { rows: Vec::new(), ..run() };
    let error = page(&[empty]).expect_err("there is nothing to show").to_string();
    assert!(error.contains("no rows to show") && error.contains("made up/run"), "{error}");
}

#[test]
fn odd_numbers_break_nothing() {
    let plain = run();
    let mut odd = plain.clone();
    odd.timeline = None;
    odd.question.paper = vec![PaperFigure { value: f64::NAN, ..plain.question.paper[0].clone() }];
    for (number, row) in odd.rows.iter_mut().enumerate() {
        row.value = [row.value, f64::NAN, f64::INFINITY, 0.0, -1.0][number % 5];
    }
    html(&odd);
    odd.charts().expect("they can be drawn");
    // A single point, on one machine; then one without any speedup.
    let keep = |row: &&Row| {
        row.machine == "e4000" && row.processors == 2 && row.settings.contains("boxes=1;job.work=1")
    };
    let mut single = plain.clone();
    single.timeline = None;
    single.question.paper = Vec::new();
    single.rows = plain.rows.iter().filter(keep).filter(|row| row.scheme == "lock_free").cloned().collect();
    assert!(html(&single).contains("<figure id=\"made-up-speedup\""));
    single.rows.retain(|row| row.metric != "speedup");
    assert!(!html(&single).contains("<figure"));
}

#[test]
fn two_runs_of_an_experiment_stand_side_by_side() {
    let html = page(&[run(), run()]).expect("it can be drawn");
    for id in ["made-up", "made-up-2", "made-up-2-speedup"] {
        assert_eq!(html.matches(&format!("id=\"{id}\"")).count(), 1, "{id}");
    }
}
