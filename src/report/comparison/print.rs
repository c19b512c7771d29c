//! A comparison for readers and for programs.

use super::{Comparison, FLOOR, Pair, Verdict};
use crate::record::statistics::Interval;
use crate::record::{Better, CellKey, THREADS, quoted};
use crate::report::group::split;
use crate::report::text::align;
use serde::Serialize;
use std::fmt;

/// Other work that takes so much more of a core, in points of per cent, shows in all metrics but `frame_time`.
const BUSIER: f64 = 5.0;

/// A line of a comparison as programs read it. A number that is not there is empty: of a cell in one run only all
/// of them, of too few repeats the ends of the interval.
#[derive(Serialize)]
struct Line<'a> {
    scene: &'a str,
    structure: &'a str,
    scheme: &'a str,
    settings: &'a str,
    machine: &'a str,
    processors: Option<u32>,
    metric: &'static str,
    unit: &'static str,
    a: Option<f64>,
    b: Option<f64>,
    ratio: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    verdict: String,
}

impl fmt::Display for Verdict {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Verdict::Better => "better",
            Verdict::Worse => "worse",
            Verdict::CannotTell => "cannot tell",
            Verdict::Mixed => "mixed",
        })
    }
}

impl Comparison {
    /// For reading: a table for each machine, scene and choice of common settings, then what all say together.
    pub fn text(&self) -> String {
        let way = if self.metric.better == Better::Lower { "lower" } else { "higher" };
        let mut text = format!("B over A, by {}, {}: {way} is better\n", self.metric.name, self.metric.unit);
        let mut left: Vec<&Pair> = self.pairs.iter().collect();
        while let Some(first) = left.first() {
            let title = title(&first.key);
            let (group, others) = left.into_iter().partition(|pair| self::title(&pair.key) == title);
            left = others;
            text.push_str(&format!("\n{title}\n{}", table(&group)));
        }
        for (run, only) in [("A", &self.only_a), ("B", &self.only_b)] {
            for key in only {
                text.push_str(&format!(
                    "only in {run}: {}, {}, {} processors\n",
                    title(key),
                    name(key),
                    key.processors
                ));
            }
        }
        text.push_str(&format!("\n{}", self.summary()));
        text
    }

    fn summary(&self) -> String {
        let count = |verdict| self.pairs.iter().filter(|pair| pair.verdict == verdict).count();
        let mut text = format!(
            "{} better, {} worse, {} cannot tell; all together {}\n",
            count(Verdict::Better),
            count(Verdict::Worse),
            count(Verdict::CannotTell),
            ratio(&self.ratio),
        );
        let measured = self.pairs.iter().filter(|pair| pair.key.machine == THREADS).count();
        if measured > 0 {
            text.push_str(&format!(
                "The intervals hold all at once with 95 %.\nA verdict needs the whole of one beyond 1 by {} %.\n",
                100.0 * FLOOR
            ));
        }
        if self.ratio.low == 0.0 {
            text.push_str("[-, -]: too few repeats for so many cells; give both runs more with --repeats\n");
        }
        if let [Some(a), Some(b)] = self.lost {
            text.push_str(&format!("Other work took {a:.1} % of a core during A, {b:.1} % during B.\n"));
            if (a - b).abs() > BUSIER && self.metric.name != "frame_time" {
                text.push_str("That makes a difference of its own: only frame_time looks past it.\n");
            }
        }
        text + &format!("verdict: {}", self.verdict)
    }

    /// As a JSON array of lines: a line a cell, last one for all together, whose cell is empty.
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(&self.lines())
            .expect("a line is strings and numbers, which JSON can hold")
    }

    /// The same lines as comma-separated values.
    pub fn csv(&self) -> String {
        let mut csv = String::from(
            "scene,structure,scheme,settings,machine,processors,metric,unit,a,b,ratio,low,high,verdict\n",
        );
        let number = |number: Option<f64>| number.map_or(String::new(), |number| number.to_string());
        for line in self.lines() {
            let fields = [
                quoted(line.scene).into_owned(),
                line.structure.to_owned(),
                line.scheme.to_owned(),
                quoted(line.settings).into_owned(),
                quoted(line.machine).into_owned(),
                line.processors.map_or(String::new(), |processors| processors.to_string()),
                line.metric.to_owned(),
                line.unit.to_owned(),
                number(line.a),
                number(line.b),
                number(line.ratio),
                number(line.low),
                number(line.high),
                line.verdict,
            ];
            csv.push_str(&fields.join(","));
            csv.push('\n');
        }
        csv
    }

    fn lines(&self) -> Vec<Line<'_>> {
        let pairs = self.pairs.iter().map(|pair| Line {
            a: Some(pair.a),
            b: Some(pair.b),
            ..self.line(Some(&pair.key), Some(&pair.ratio), pair.verdict.to_string())
        });
        let only_a = self.only_a.iter().map(|key| self.line(Some(key), None, "only in A".to_owned()));
        let only_b = self.only_b.iter().map(|key| self.line(Some(key), None, "only in B".to_owned()));
        let all = self.line(None, Some(&self.ratio), self.verdict.to_string());
        pairs.chain(only_a).chain(only_b).chain([all]).collect()
    }

    fn line<'a>(&self, key: Option<&'a CellKey>, ratio: Option<&Interval>, verdict: String) -> Line<'a> {
        let word = |word: fn(&CellKey) -> &String| key.map_or("", |key| word(key).as_str());
        // An end nobody knows is 0 or infinite.
        let end = |end: f64| (end.is_finite() && end > 0.0).then_some(end);
        Line {
            scene: word(|key| &key.scene),
            structure: word(|key| &key.structure),
            scheme: word(|key| &key.scheme),
            settings: word(|key| &key.settings),
            machine: word(|key| &key.machine),
            processors: key.map(|key| key.processors),
            metric: self.metric.name,
            unit: self.metric.unit,
            a: None,
            b: None,
            ratio: ratio.map(|ratio| ratio.median),
            low: ratio.and_then(|ratio| end(ratio.low)),
            high: ratio.and_then(|ratio| end(ratio.high)),
            verdict,
        }
    }
}

fn table(pairs: &[&Pair]) -> String {
    let head = ["scheme", "P", "A", "B", "B/A", "95 % interval", "verdict"];
    let mut cells = vec![head.map(str::to_owned).to_vec()];
    for pair in pairs {
        let (median, interval) = (format!("{:.3}", pair.ratio.median), interval(&pair.ratio));
        let processors = pair.key.processors.to_string();
        let verdict = pair.verdict.to_string();
        let (a, b) = (significant(pair.a), significant(pair.b));
        cells.push(vec![name(&pair.key), processors, a, b, median, interval, verdict]);
    }
    align(&cells, 1)
}

/// What stands above the cells of one machine, scene and choice of common settings.
fn title(key: &CellKey) -> String {
    let (common, _) = split(&key.settings, &key.machine);
    let settings = if common.is_empty() { String::new() } else { format!(", {common}") };
    format!("{}, {}{settings}", key.machine, key.scene)
}

/// The scheme with its own settings.
fn name(key: &CellKey) -> String {
    let (_, own) = split(&key.settings, &key.machine);
    let bare = |pair: &str| pair.split_once('.').map_or(pair, |(_, bare)| bare).to_owned();
    let own = own.split(';').filter(|pair| !pair.is_empty()).map(bare);
    std::iter::once(key.scheme.clone()).chain(own).collect::<Vec<_>>().join(" ")
}

fn ratio(ratio: &Interval) -> String {
    format!("{:.3} {}", ratio.median, interval(ratio))
}

fn interval(ratio: &Interval) -> String {
    if ratio.high.is_finite() {
        format!("[{:.3}, {:.3}]", ratio.low, ratio.high)
    } else {
        "[-, -]".to_owned()
    }
}

/// Four digits that count.
fn significant(number: f64) -> String {
    let before = number.abs().log10().floor() as i32 + 1;
    format!("{number:.*}", (4 - before).clamp(0, 9) as usize)
}
