//! `rows.jsonl`: the log that survives a kill.
//!
//! 1. A record is one line, given to the system in one `write_all` at the end of a file that nobody else writes: it is
//!    locked as long as the log is open. The system lets go of the lock when a process ends, however it ends.
//! 2. Opening cuts the file back to its last newline: what stands behind it is a torn record.
//! 3. Rows of a cell whose last row, `cell_complete`, is missing are dropped by writing the file anew and renaming it.
//! 4. A write that fails (full disk) is cut off again, so that what was there before stays readable.

use super::{CellKey, RecordError, Row, write_whole};
use std::collections::HashSet;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A lock may outlive its holder by a moment: a process being killed, or a child that has not yet become another program.
const LOOKS: u32 = 20;
const BETWEEN_LOOKS: Duration = Duration::from_millis(10);

/// The log of a run, open for appending.
#[derive(Debug)]
pub struct RowLog {
    file: File,
    /// The file that [`RowLog::open`] replaced, still locked: another process may have opened it before.
    _before: Option<File>,
    path: PathBuf,
    /// Bytes up to the end of the last whole record.
    length: u64,
    finished: HashSet<CellKey>,
}

impl RowLog {
    /// Opens the log, new or old, and returns it with the rows of its finished cells.
    ///
    /// # Errors
    /// Another process has it open; it cannot be opened, read, cut back or rewritten; or a whole line of it is no
    /// record.
    pub fn open(path: &Path) -> Result<(Self, Vec<Row>), RecordError> {
        let (mut file, text) = cut_back(path)?;
        let mut replaced = None;
        let mut rows = parse(path, &text)?;
        let finished: HashSet<CellKey> =
            rows.iter().filter(|row| row.metric == "cell_complete").map(Row::key).collect();
        let before = rows.len();
        rows.retain(|row| finished.contains(&row.key()));
        if rows.len() < before {
            write_whole(path, |out| rows.iter().try_for_each(|row| out.write_all(&line(row))))?;
            replaced = Some(std::mem::replace(&mut file, open_locked(path)?));
        }
        let length = file.seek(SeekFrom::End(0)).map_err(RecordError::file("read", path))?;
        Ok((Self { file, _before: replaced, path: path.to_path_buf(), length, finished }, rows))
    }

    /// Appends one row: one record, one write, one line.
    ///
    /// # Errors
    /// The value is not finite, or the write failed; the log then ends with the row before this one.
    pub fn append(&mut self, row: &Row) -> Result<(), RecordError> {
        if !row.value.is_finite() {
            let (path, metric) = (self.path.clone(), row.metric.clone());
            return Err(RecordError::NotFinite { path, metric, value: row.value });
        }
        let line = line(row);
        if let Err(source) = self.file.write_all(&line) {
            // Best effort: should this fail too, the next opening cuts the torn record off.
            let _ = self.file.set_len(self.length).and_then(|()| self.file.seek(SeekFrom::End(0)));
            return Err(RecordError::File { what: "write", path: self.path.clone(), source });
        }
        self.length += line.len() as u64;
        if row.metric == "cell_complete" {
            self.finished.insert(row.key());
        }
        Ok(())
    }

    /// Whether the cell's last row is in the log.
    pub fn is_finished(&self, key: &CellKey) -> bool {
        self.finished.contains(key)
    }
}

/// Reads the whole rows of a log that someone else may still be writing; touches nothing.
///
/// # Errors
/// The file cannot be read, or a whole line of it is no record.
pub fn read_rows(path: &Path) -> Result<Vec<Row>, RecordError> {
    let bytes = std::fs::read(path).map_err(RecordError::file("read", path))?;
    parse(path, &bytes[..whole_lines(&bytes)])
}

fn line(row: &Row) -> Vec<u8> {
    let mut line = serde_json::to_vec(row).expect("a row is strings and numbers, which JSON can hold");
    line.push(b'\n');
    line
}

/// How many bytes the whole lines take.
fn whole_lines(bytes: &[u8]) -> usize {
    bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1)
}

/// Opens the file for this process alone; makes it where there is none.
fn open_locked(path: &Path) -> Result<File, RecordError> {
    let file = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path)
        .map_err(RecordError::file("open", path))?;
    for _ in 0..LOOKS {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => std::thread::sleep(BETWEEN_LOOKS),
            // A file system without locks is no reason not to measure.
            Ok(()) | Err(TryLockError::Error(_)) => return Ok(file),
        }
    }
    Err(RecordError::InUse { path: path.parent().unwrap_or(path).to_path_buf() })
}

/// Reads the file, cut back to its last newline.
fn cut_back(path: &Path) -> Result<(File, Vec<u8>), RecordError> {
    let mut file = open_locked(path)?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(RecordError::file("read", path))?;
    let whole = whole_lines(&bytes);
    if whole < bytes.len() {
        file.set_len(whole as u64).map_err(RecordError::file("cut back", path))?;
        bytes.truncate(whole);
    }
    Ok((file, bytes))
}

fn parse(path: &Path, bytes: &[u8]) -> Result<Vec<Row>, RecordError> {
    let lines = bytes.split(|&byte| byte == b'\n').enumerate().filter(|(_, line)| !line.is_empty());
    lines
        .map(|(index, line)| {
            serde_json::from_slice(line).map_err(|error| RecordError::Line {
                path: path.to_path_buf(),
                line: index + 1,
                message: error.to_string(),
            })
        })
        .collect()
}
