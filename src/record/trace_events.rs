//! Timelines in the Trace Event format (JSON), which Perfetto and `chrome://tracing` open.
//!
//! A cell is a process, a processor is a thread of it, what a processor did is a complete event (`ph` `X`,
//! times in microseconds). Every cell's frame begins at 0, so that cells lie below one another for
//! comparison. `"estimated": true` marks spans whose length was told from tasks nearby.

use super::{RecordError, write_whole};
use serde_json::{Value, json};
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// What the processors of a cell did in one of its frames.
#[derive(Clone, Debug, PartialEq)]
pub struct TracedFrame {
    /// The cell in words: what the viewer calls the process.
    pub cell: String,
    /// The frame, from 0.
    pub frame: u32,
    /// How long it took, ns.
    pub time: f64,
    /// What each processor did, in order.
    pub processors: Vec<Vec<Stretch>>,
    /// Marks for which there was no room: the last part of the frame is missing if there are any.
    pub lost: u64,
}

/// A stretch of time spent on one thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// On what, in a word.
    pub name: &'static str,
    /// From when, ns since the frame began.
    pub start: f64,
    /// Until when, in the same.
    pub end: f64,
    /// Whether its length was told from tasks nearby.
    pub estimated: bool,
}

/// Whether a trace can be written there; leaves nothing behind.
///
/// # Errors
/// There is a folder or a device of that name, or no file can be made beside it.
pub fn check_trace_place(path: &Path) -> Result<(), RecordError> {
    let odd = |what| RecordError::file("write", path)(std::io::Error::new(ErrorKind::InvalidInput, what));
    if path.file_name().is_none() || path.is_dir() {
        return Err(odd("it is a folder"));
    }
    // A trace is renamed into place, which would put a file where a device was.
    if path.exists() && !path.is_file() {
        return Err(odd("it is no ordinary file"));
    }
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".part");
    let part = path.with_file_name(name);
    File::create(&part).and_then(|_| std::fs::remove_file(&part)).map_err(RecordError::file("write", path))
}

/// Writes the frames, whole or not at all; the first cell's process has number 1.
///
/// # Errors
/// The file cannot be written; then the old one, if any, stays as it was.
pub fn write_trace(path: &Path, frames: &[TracedFrame]) -> Result<(), RecordError> {
    write_whole(path, |out| {
        writeln!(out, "{{\"displayTimeUnit\":\"ns\",\"traceEvents\":[")?;
        let mut first = true;
        for (pid, frame) in (1..).zip(frames) {
            for event in heading(pid, frame) {
                write!(out, "{}{event}", separator(&mut first))?;
            }
            for (tid, stretches) in frame.processors.iter().enumerate() {
                for stretch in stretches {
                    write!(out, "{}", separator(&mut first))?;
                    write_stretch(out, pid, tid, stretch)?;
                }
            }
        }
        writeln!(out, "\n]}}")
    })
}

fn separator(first: &mut bool) -> &'static str {
    if std::mem::take(first) { "" } else { ",\n" }
}

/// The events that name a cell and its processors, and mark where its frame begins and ends.
fn heading(pid: usize, frame: &TracedFrame) -> Vec<Value> {
    let name = |what, tid, name: &str| json!({"ph": "M", "name": what, "pid": pid, "tid": tid, "args": {"name": name}});
    let instant = |name: String, at: f64, args: Value| {
        let ts = picoseconds(at) as f64 / 1e6;
        json!({"ph": "i", "s": "p", "name": name, "pid": pid, "tid": 0, "ts": ts, "args": args})
    };
    let mut events = vec![
        name("process_name", 0, &frame.cell),
        json!({"ph": "M", "name": "process_sort_index", "pid": pid, "tid": 0, "args": {"sort_index": pid}}),
    ];
    let threads =
        (0..frame.processors.len()).map(|tid| name("thread_name", tid, &format!("processor {tid}")));
    events.extend(threads);
    let number = frame.frame;
    events.push(instant(format!("frame {number}"), 0.0, json!({"frame": number, "lost_marks": frame.lost})));
    events.push(instant(format!("end of frame {number}"), frame.time, json!({"frame": number})));
    events
}

fn write_stretch(out: &mut dyn Write, pid: usize, tid: usize, stretch: &Stretch) -> std::io::Result<()> {
    // In whole picoseconds, so that what touches still touches.
    let (start, end) = (picoseconds(stretch.start), picoseconds(stretch.end));
    let (name, start, length) = (stretch.name, microseconds(start), microseconds(end - start));
    write!(out, r#"{{"ph":"X","name":"{name}","pid":{pid},"tid":{tid},"ts":{start},"dur":{length}"#)?;
    out.write_all(if stretch.estimated { br#","args":{"estimated":true}}"# } else { b"}" })
}

fn picoseconds(nanoseconds: f64) -> u64 {
    (nanoseconds * 1e3).round() as u64
}

/// Picoseconds as a decimal number of microseconds.
fn microseconds(picoseconds: u64) -> String {
    let text = format!("{}.{:06}", picoseconds / 1_000_000, picoseconds % 1_000_000);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn microseconds_are_exact() {
        for (picoseconds, text) in [(0, "0"), (1, "0.000001"), (1_500_000, "1.5"), (20_000_000, "20")] {
            assert_eq!(microseconds(picoseconds), text);
        }
    }
}
