//! Files that are there whole or not at all: written beside their place, then renamed into it.

use super::RecordError;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Writes a file so that a reader sees the old one or the new one, never half of it.
///
/// # Errors
/// The temporary file `<name>.part` beside it cannot be written or renamed; it is removed again.
pub fn write_whole(
    path: &Path,
    body: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), RecordError> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".part");
    let part = path.with_file_name(name);
    let written = File::create(&part).and_then(|file| {
        let mut out = BufWriter::new(file);
        body(&mut out)?;
        // Without the sync a crash of the machine could leave the new name on an empty file.
        out.into_inner().map_err(|full| full.into_error())?.sync_all()?;
        std::fs::rename(&part, path)
    });
    written.map_err(|source| {
        // Best effort: the error that matters is the one being returned.
        let _ = std::fs::remove_file(&part);
        RecordError::File { what: "write", path: path.to_path_buf(), source }
    })
}
