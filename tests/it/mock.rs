//! A subject that needs no scene: its frame times follow Amdahl's law, so that speedups are known beforehand.

use apportion::measure::{
    Cell, Experiment, Known, MeasureError, Options, Plan, Sample, Selection, Subject, Value,
};

/// Names for experiments of these tests.
pub(crate) fn known() -> Known {
    let words = |list: &[&str]| list.iter().map(|word| (*word).to_owned()).collect();
    Known {
        jobs: words(&["mock"]),
        schemes: words(&["serial", "queue", "ring", "stealing", "rectangles"]),
        suits: |_, scheme| scheme != "rectangles",
        machines: words(&["threads", "e4000"]),
        fits: |scheme, machine, _| !(scheme == "stealing" && machine == "e4000"),
        learns: |_| false,
    }
}

/// An experiment with a sweep, a paper's figure at a count and one at the peak.
pub(crate) const EXPERIMENT: &str = r#"
title = "A mock: speedups <known> & exact"
reproduces = "nothing"
job = "mock"
scene = "box"
frames = 20
quick_frames = 2
repeats = 3
machines = ["e4000", "threads"]
processors = { e4000 = "1-13", "*" = "1-cores" }
schemes = ["queue", "serial", "ring", "stealing"]

[settings]
"job.work" = 300

[sweep]
"ring.receivers" = [1, 2]

[[paper]]
figure = "Fig. 1"
scheme = "ring"
scene = "box"
machine = "e4000"
processors = 8
metric = "speedup"
unit = "x"
value = 4.0
source = "Paper 0"

[[paper]]
figure = "Fig. 2"
scheme = "queue"
machine = "e4000"
metric = "speedup"
unit = "x"
value = 1.9
source = "Paper 0"
"#;

/// The experiment above.
pub(crate) fn experiment() -> Experiment {
    Experiment::parse("mock", "mock.toml", EXPERIMENT, &known()).expect("it is well-formed")
}

/// Its plan on a computer with two cores.
pub(crate) fn plan(selection: &Selection) -> Plan {
    Plan::new(&experiment(), selection, &known(), 2).expect("the selection fits")
}

/// The share of a cell's work that cannot be shared out.
fn serial_share(cell: &Cell) -> f64 {
    match cell.scheme.as_str() {
        "ring" => 0.1 / cell.settings.get("ring.receivers").and_then(Value::number).unwrap_or(1.0),
        "queue" => 0.45,
        _ => 0.02,
    }
}

/// What the mock's frames take, ns.
pub(crate) fn frame_time(cell: &Cell) -> f64 {
    let processors = f64::from(cell.processors);
    let share = serial_share(cell);
    // Each processor more costs a little, so that curves have a peak.
    1_000.0 * (share + (1.0 - share) / processors) * (1.0 + 0.004 * (processors - 1.0))
}

struct Mock {
    time: f64,
    frames: u32,
}

impl Subject for Mock {
    fn sample(&mut self, _repeat: u32) -> Result<Vec<Sample>, MeasureError> {
        let frame = |frame| Sample { metric: "frame_time", frame: Some(frame), value: self.time };
        let nodes = Sample { metric: "nodes_visited", frame: None, value: 77.0 };
        Ok((0..self.frames).map(frame).chain([nodes]).collect())
    }
}

/// Makes a mock ready.
pub(crate) fn open(cell: &Cell, options: &Options) -> Result<Box<dyn Subject>, MeasureError> {
    Ok(Box::new(Mock { time: frame_time(cell), frames: options.frames }))
}
