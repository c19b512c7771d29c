//! Tables and charts of a mock run.

use crate::{mock, page};
use apportion::measure::{Selection, run};
use apportion::record::{Question, Row, RowLog, read_rows};
use apportion::report::{Chart, Run, table};
use std::sync::atomic::AtomicBool;

fn rows() -> Vec<Row> {
    rows_of(&Selection::default())
}

fn rows_of(selection: &Selection) -> Vec<Row> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("rows.jsonl");
    let (mut log, kept) = RowLog::open(&path).expect("it opens");
    let plan = mock::plan(&Selection { frames: Some(2), ..selection.clone() });
    let stop = AtomicBool::new(false);
    run(&plan, "id", (&mut log, &kept), &mut mock::open, &mut |_| {}, &stop).expect("it runs");
    read_rows(&path).expect("the log is whole")
}

#[test]
fn the_table_holds_the_paper_beside_the_best_setting() {
    let table = table(&rows(), &mock::experiment().paper);
    let first = &table.lines[0];
    let eight = 1.0 / ((0.05 + 0.95 / 8.0) * (1.0 + 0.004 * 7.0));
    assert_eq!(first.settings, "job.work=300;ring.receivers=2");
    assert!((first.simulated.expect("it was simulated") - eight).abs() < 1e-9);
    assert!((first.error_simulated.expect("the paper has it") - (eight / 4.0 - 1.0)).abs() < 1e-9);
    assert_eq!((first.measured, first.error_measured), (None, None), "threads ran no eight processors");
    assert_eq!((table.lines[1].processors, table.lines[1].measured.is_some()), (None, true));
    // Then each cell once: threads stand beside the simulated machine where both ran, stealing has lines of its own.
    assert_eq!(table.lines.len(), 2 + 40 + 2);
    let own = table.lines.iter().filter(|line| line.machine == "threads");
    assert!(own.clone().all(|line| line.scheme == "stealing" && line.simulated.is_none()));
    assert_eq!(own.count(), 2);
}

#[test]
fn csv_and_json_hold_the_same_lines() {
    let table = table(&rows(), &mock::experiment().paper);
    let csv = table.csv();
    let mut lines = csv.lines();
    assert_eq!(
        lines.next(),
        Some(
            "figure,scheme,settings,scene,machine,processors,metric,unit,paper,simulated,measured,error_simulated,error_measured"
        )
    );
    assert_eq!(lines.count(), table.lines.len());
    assert!(csv.lines().all(|line| line.matches(',').count() == 12), "{csv}");
    let json: serde_json::Value = serde_json::from_str(&table.json()).expect("it is JSON");
    let json = json.as_array().expect("an array");
    assert_eq!(json.len(), table.lines.len());
    assert_eq!(json[0]["figure"], "Fig. 1");
    assert_eq!(json[0]["measured"], serde_json::Value::Null);
}

#[test]
fn the_text_says_what_a_reader_looks_for() {
    let text = table(&rows(), &mock::experiment().paper).text();
    for part in [
        "paper | simulated | measured",
        "peak",
        "mean absolute error of 2 figures, simulated",
        "speedup on e4000, box, job.work=300",
        "speedup on threads, box, job.work=300: median [95 % interval]",
        "ring receivers=2",
    ] {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    assert!(!text.contains("figures, measured"), "the papers' machines were of another kind: {text}");
    assert_eq!(table(&[], &[]).text(), "no rows to show");
}

#[test]
fn a_peak_over_fewer_processors_is_not_held_against_the_papers() {
    let selection = Selection { processors: Some("1-2,4".to_owned()), ..Selection::default() };
    let experiment = mock::experiment();
    let mut narrowed = table(&rows_of(&selection), &experiment.paper);
    let whole = |machine: &str| apportion::measure::Plan::whole_counts(&experiment, machine, 2);
    narrowed.hold_peaks_to(whole);
    assert_eq!(narrowed.lines[1].error_simulated, None);
    assert!(narrowed.lines[1].simulated.is_some());
    assert!(narrowed.text().contains("peak of 1-2,4"), "{}", narrowed.text());
    let mut all = table(&rows(), &experiment.paper);
    all.hold_peaks_to(whole);
    assert!(all.lines[1].error_simulated.is_some() && !all.text().contains("peak of"), "{}", all.text());
}

/// A run on threads whose speedups are given: scheme, then one for each repeat.
fn measured(speedups: &[(&str, &[f64])]) -> Vec<Row> {
    let template = rows().into_iter().find(|row| row.machine == "threads").expect("threads ran");
    let row = |scheme: &str, repeat: usize, metric: &str, value: f64| Row {
        scheme: scheme.to_owned(),
        processors: 2,
        repeat: repeat as u32,
        frame: None,
        metric: metric.to_owned(),
        value,
        ..template.clone()
    };
    let mut rows = Vec::new();
    for (scheme, values) in speedups {
        for (repeat, value) in values.iter().enumerate() {
            rows.push(row(scheme, repeat, "speedup", *value));
            rows.push(row(scheme, repeat, "lost_time", 3.0));
        }
    }
    rows
}

#[test]
fn a_run_says_what_it_cannot_tell() {
    // Paired: the queue is always a tenth slower than the ring, though both drift by more than that.
    let ring = [1.5, 1.8, 1.4, 1.9, 1.6, 1.7, 1.5];
    let queue = ring.map(|speedup| 0.9 * speedup);
    let stealing = [1.6, 1.7, 1.5, 1.8, 1.7, 1.6, 0.2];
    let text = table(&measured(&[("ring", &ring), ("queue", &queue), ("stealing", &stealing)]), &[]).text();
    assert!(text.contains("cannot tell ring from stealing at P=2"), "{text}");
    assert!(text.contains("(kept): stealing at P=2 1 of 7"), "{text}");
    assert!(text.contains("other work took 3.0 % of a core"), "{text}");
    let text = table(&measured(&[("ring", &ring), ("queue", &queue)]), &[]).text();
    assert!(!text.contains("cannot tell"), "{text}");
    let text = table(&measured(&[("ring", &ring[..3]), ("queue", &queue[..3])]), &[]).text();
    assert!(text.contains("cannot tell schemes apart at P=2: it takes 6 repeats"), "{text}");
}

#[test]
fn speedups_that_are_not_sure_are_named() {
    let rows = measured(&[("ring", &[1.5; 7]), ("queue", &[1.0, 1.4, 1.0, 1.4, 1.0, 1.4, 1.2])]);
    let loose = apportion::report::loose(&rows, 5.0);
    assert_eq!(loose.len(), 1);
    assert!(loose[0].contains("queue at P=2 (16.7 %)"), "{loose:?}");
}

/// The files drawn from those rows.
fn charts(title: &str, rows: Vec<Row>, with_paper: bool) -> Vec<Chart> {
    let paper = if with_paper { mock::experiment().paper } else { Vec::new() };
    let question = Question { title: title.to_owned(), reproduces: String::new(), paper };
    let run = Run { meta: page::meta("mock"), question, rows, timeline: None, link: "run".to_owned() };
    let charts = run.charts().expect("they can be drawn");
    if let Some(folder) = std::env::var_os("CHARTS_TO_LOOK_AT") {
        for chart in &charts {
            std::fs::write(std::path::Path::new(&folder).join(&chart.file_name), &chart.text)
                .expect("it is written");
        }
    }
    charts
}

/// The words of a drawing.
fn words(svg: &str) -> Vec<&str> {
    svg.split("<text")
        .skip(1)
        .filter_map(|text| text.split_once('>')?.1.split_once('<'))
        .map(|(word, _)| word)
        .collect()
}

#[test]
fn a_chart_a_machine_with_a_curve_a_scheme() {
    let title = mock::experiment().title;
    let all = charts(&title, rows(), true);
    let names: Vec<&str> = all.iter().map(|chart| chart.file_name.as_str()).collect();
    assert_eq!(
        names,
        [
            "speedup-e4000-box-job.work-300.svg",
            "speedup-threads-box-job.work-300.svg",
            "speedup.vl.json",
            "time.svg",
            "time.vl.json",
            "frames.svg",
            "frames.vl.json",
        ]
    );
    for chart in &all {
        assert!(!chart.text.contains("NaN") && !chart.text.contains("inf,"), "{}", chart.file_name);
        if chart.file_name.ends_with(".json") {
            let specification: serde_json::Value = serde_json::from_str(&chart.text).expect("it is JSON");
            assert!(specification["data"]["values"].as_array().is_some_and(|values| !values.is_empty()));
        } else {
            assert!(chart.text.trim_end().ends_with("</svg>"));
            assert!(!chart.text.contains("var("), "{}: a file has its colours in it", chart.file_name);
        }
    }
    let svg = &all[0].text;
    assert!(svg.contains("speedups &lt;known&gt; &amp; exact"), "the title is escaped");
    for word in ["serial", "queue", "ring, best receivers", "peak", "processors", "speedup, x"] {
        assert!(words(svg).contains(&word), "no `{word}` among {:?}", words(svg));
    }
    // The best of a ring says which ring that is.
    assert!(words(svg).iter().any(|word| word.contains("ring: receivers=")), "{:?}", words(svg));
    // The same rows give the same drawing, byte by byte.
    let again = charts(&title, rows(), true);
    assert!(all.iter().zip(&again).all(|(one, other)| one.text == other.text));
}

#[test]
fn many_processors_stand_on_powers_of_two() {
    let selection = Selection {
        machines: vec!["e4000".to_owned()],
        processors: Some("1,2,8,64,1024".to_owned()),
        schemes: vec!["ring".to_owned()],
        ..Selection::default()
    };
    let charts = charts("Many", rows_of(&selection), false);
    let labels = words(&charts[0].text);
    for count in ["1", "4", "64", "1024"] {
        assert!(labels.contains(&count), "no {count} on the axis: {labels:?}");
    }
    // The one parallel scheme has two settings: these are then the question, a curve each.
    for curve in ["ring receivers=1", "ring receivers=2"] {
        assert!(labels.contains(&curve), "no {curve} in the legend");
    }
}
