//! What each processor did: a bar a processor.

use super::plot::short;
use super::{Drawn, LETTER, text};
use crate::report::figure::{ACTIVITIES, Bars, shares};
use std::fmt::Write;

/// From the names of the processors to the end, units; a bar is cut at each.
const WIDTH: i32 = 1240;
/// Room for the names.
const LEFT: i32 = 80;
/// From one bar to the next.
const STEP: i32 = 30;
/// The most bars drawn: beyond, each would be thinner than a line.
const LANES: usize = 64;

/// One path an activity: a bar is as long as its activity, and in each column of units the one that took most of it is
/// drawn.
pub(super) fn draw(bars: &Bars) -> Drawn {
    let lanes = bars.lanes.len().min(LANES);
    let mut out = String::new();
    for (lane, name) in bars.lanes.iter().take(lanes).enumerate() {
        out.push_str(&text(LEFT - 10, 20 + STEP * lane as i32, "e", name));
    }
    out.push_str("<g class=\"d\">");
    let mut paths = vec![String::new(); ACTIVITIES.len()];
    for lane in 0..lanes {
        let columns = columns(bars, lane);
        let mut from = 0;
        while from < columns.len() {
            let run = columns[from..].iter().take_while(|activity| **activity == columns[from]).count();
            if let Some(activity) = columns[from] {
                let y = STEP * lane as i32 + 2;
                let height = STEP - 8;
                let _ = write!(paths[activity], "M{} {y}h{run}v{height}h-{run}z", LEFT + from as i32,);
            }
            from += run;
        }
    }
    let shares = shares(bars);
    for (activity, path) in paths.iter().enumerate().filter(|(_, path)| !path.is_empty()) {
        let (name, colour) = ACTIVITIES[activity];
        let share = 100.0 * shares[activity];
        let _ = write!(
            out,
            "<path class=\"f{colour}\" data-c=\"{activity}\" data-t=\"{name}: {} % of the processors&#39; time\" d=\"{path}\"/>",
            short(share)
        );
    }
    out.push_str("</g>");
    let bottom = STEP * lanes as i32 + LETTER;
    out.push_str(&text(LEFT, bottom, "", "0"));
    out.push_str(&text(LEFT + WIDTH, bottom, "e", &format!("{} µs", short(bars.end))));
    Drawn { size: ((LEFT + WIDTH + 4) as u32, (bottom + 12) as u32), data: String::new(), inside: out }
}

/// What takes most of each column of a lane.
fn columns(bars: &Bars, lane: usize) -> Vec<Option<usize>> {
    let mut time = vec![[0.0_f64; ACTIVITIES.len()]; WIDTH as usize];
    let scale = f64::from(WIDTH) / bars.end;
    for span in bars.spans.iter().filter(|span| span.lane == lane) {
        let (from, to) = (span.from * scale, span.to * scale);
        let last = (to.ceil() as usize).min(time.len());
        for (column, time) in time.iter_mut().enumerate().take(last).skip(from as usize) {
            let (start, end) = (column as f64, column as f64 + 1.0);
            time[span.activity] += (to.min(end) - from.max(start)).max(0.0);
        }
    }
    let most = |times: [f64; ACTIVITIES.len()]| {
        let most = times.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        most.filter(|(_, time)| **time > 0.0).map(|(activity, _)| activity)
    };
    time.into_iter().map(most).collect()
}
