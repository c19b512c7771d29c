//! The bytes of a file, unpacked if it ends in `.gz`, and when they were of that date.

use std::cell::RefCell;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use flate2::bufread::MultiGzDecoder;

use super::SceneError;

/// A packed file may hold this many times its own size, and [`ALWAYS`]: text of meshes packs 3 to 15
/// times, and what packs better than this is nothing a scene is made of, but a trap for memory.
const MOST_TIMES: u64 = 64;
/// What even the smallest packed file may hold, in bytes.
const ALWAYS: u64 = 16 << 20;

/// A file read whole, and the files read for its sake.
pub(super) struct Source {
    /// Where it lies, without `.gz`.
    path: PathBuf,
    /// What messages call it.
    pub(super) file: String,
    /// What is in it, unpacked.
    pub(super) bytes: Vec<u8>,
    /// It, as it was found, then its neighbours.
    stamps: RefCell<Vec<Stamp>>,
}

/// What a file was when it was read: enough to tell whether it has been changed since.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stamp {
    /// Its name, without folder; of a neighbour the way to it from the folder of the scene's own file.
    pub(super) name: String,
    /// Its size, in bytes.
    pub(super) size: u64,
    /// When it was last changed; none where the system does not say.
    pub(super) modified: Option<SystemTime>,
}

impl Stamp {
    /// The file as it is now.
    pub(super) fn of(path: &Path) -> io::Result<Self> {
        let found = std::fs::metadata(path)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { name, size: found.len(), modified: found.modified().ok() })
    }

    /// The file as it is now, under the name it was asked for by; one that is not there is empty and as old as
    /// can be told, so that it is noticed when it comes.
    pub(super) fn of_named(path: &Path, name: &str) -> Self {
        match Self::of(path) {
            Ok(found) => Self { name: name.to_string(), ..found },
            Err(_) => Self { name: name.to_string(), size: 0, modified: Some(SystemTime::UNIX_EPOCH) },
        }
    }
}

impl Source {
    /// Reads a whole file, and unpacks it if it is called `.gz`.
    ///
    /// # Errors
    /// [`SceneError`] if it cannot be read, or is packed and damaged or unreasonably large.
    pub(super) fn open(path: &Path) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        // The stamp first: what is changed while it is read is then newer than its stamp.
        let read = Stamp::of(path).and_then(|stamp| Ok((stamp, std::fs::read(path)?)));
        let (stamp, bytes) = read.map_err(|source| SceneError::Read { file: file.clone(), source })?;
        let (path, bytes) = match is_packed(path) {
            true => (path.with_extension(""), unpack(&file, &bytes)?),
            false => (path.to_path_buf(), bytes),
        };
        Ok(Self { path, file, bytes, stamps: RefCell::new(vec![stamp]) })
    }

    /// The whole of it as text, without a byte order mark.
    ///
    /// # Errors
    /// [`SceneError::Malformed`] naming the line that is not UTF-8.
    pub(super) fn text(&self) -> Result<&str, SceneError> {
        let text = std::str::from_utf8(&self.bytes).map_err(|error| {
            let valid = &self.bytes[..error.valid_up_to()];
            let line = valid.iter().filter(|byte| **byte == b'\n').count() + 1;
            let (found, expected) = ("a byte that is not UTF-8", "text in UTF-8");
            SceneError::malformed(&self.file, format!("line {line}"), found, expected)
        })?;
        Ok(text.trim_start_matches('\u{feff}'))
    }

    /// Reads a file that lies beside it.
    pub(super) fn neighbour(&self, name: &str) -> io::Result<Vec<u8>> {
        let path = self.beside(name);
        let stamp = Stamp { name: name.to_string(), ..Stamp::of(&path)? };
        let bytes = std::fs::read(path)?;
        self.note(stamp);
        Ok(bytes)
    }

    /// Where a file is whose way is told from this one's folder.
    pub(super) fn beside(&self, name: &str) -> PathBuf {
        self.path.with_file_name(name)
    }

    /// Whether there is a file beside it. What is read next may hang on that, so either is kept in mind.
    pub(super) fn has(&self, name: &str) -> bool {
        let path = self.beside(name);
        self.note(Stamp::of_named(&path, name));
        path.exists()
    }

    /// Keeps in mind that the scene depends on a file; the first stamp of each counts.
    pub(super) fn note(&self, stamp: Stamp) {
        let mut stamps = self.stamps.borrow_mut();
        if stamps[1..].iter().all(|noted| noted.name != stamp.name) {
            stamps.push(stamp);
        }
    }

    /// Its name without folder and extensions.
    pub(super) fn stem(&self) -> String {
        self.path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The stamps of all files read so far, its own first.
    pub(super) fn into_stamps(self) -> Vec<Stamp> {
        self.stamps.into_inner()
    }
}

/// Whether a file's name says that it is packed.
fn is_packed(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"))
}

/// The extension that names a file's format, in small letters: the one before `.gz` if it is packed.
pub(super) fn format_of(path: &Path) -> String {
    let inner = if is_packed(path) { path.with_extension("") } else { path.to_path_buf() };
    inner.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

fn unpack(file: &str, packed: &[u8]) -> Result<Vec<u8>, SceneError> {
    let most = packed.len() as u64 * MOST_TIMES + ALWAYS;
    let mut decoder = MultiGzDecoder::new(packed);
    let mut bytes = Vec::new();
    let read = decoder.by_ref().take(most + 1).read_to_end(&mut bytes);
    let place = || format!("byte {} of the packed data", packed.len() - decoder.get_ref().len());
    if let Err(error) = read {
        return Err(SceneError::malformed(file, place(), error.to_string(), "a whole gzip file"));
    }
    if bytes.len() as u64 > most {
        let expected = format!("at most {most}, {MOST_TIMES} times its own size and {ALWAYS} more");
        return Err(SceneError::malformed(file, place(), format!("over {most} bytes unpacked"), expected));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn what_was_packed_comes_out_whole_also_in_several_members() {
        let text: Vec<u8> = (0..100_000u32).flat_map(|n| n.wrapping_mul(n).to_le_bytes()).collect();
        assert_eq!(unpack("f", &packed(&text)).unwrap(), text);
        let (front, back) = text.split_at(777);
        assert_eq!(unpack("f", &[packed(front), packed(back)].concat()).unwrap(), text);
    }

    #[test]
    fn cut_damaged_and_bloated_files_are_refused() {
        let good = packed(b"the quick brown fox");
        for end in 0..good.len() {
            let message = unpack("model.ply.gz", &good[..end]).unwrap_err().to_string();
            assert!(message.starts_with("model.ply.gz: byte "), "{message}");
        }
        let mut bad = good.clone();
        *bad.last_mut().unwrap() ^= 1;
        assert!(unpack("f", &bad).is_err(), "its length is checked");
        let bomb = packed(&vec![0; 40 << 20]);
        assert!(bomb.len() < 60_000);
        let message = unpack("f", &bomb).unwrap_err().to_string();
        assert!(message.contains("bytes unpacked; expected at most"), "{message}");
    }

    #[test]
    fn the_format_is_named_before_gz() {
        for (name, format) in [("a.PLY", "ply"), ("a.b.ply.GZ", "ply"), ("a.gz", ""), ("a", ""), (".gz", "")]
        {
            assert_eq!(format_of(Path::new(name)), format, "{name}");
        }
    }
}
