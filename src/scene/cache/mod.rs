//! Scenes kept on disk as they are in memory, so that a large file is parsed once only (the binary cache
//! of Bubeníček 2020 sec. 3).
//!
//! Invariant: what comes out of the cache is, bit for bit, what parsing the file would give, or nothing.
//! 1. The kept file is found by the scene's absolute path, and says which files it was made from: name,
//!    size and time of last change of the scene's own, for glTF of its buffers, for AFF of what it includes,
//!    for URDF of its meshes and of all files that were looked for on the way to them, found or not. If one of
//!    them is another now, or is there that was not, it is stale.
//! 2. It ends with a checksum, and begins with the version of its layout and of this program: damaged,
//!    cut and foreign files are passed over, and what was decoded is validated like a parsed scene.
//! 3. It is written under a temporary name and renamed, so nobody sees half of it, and of two
//!    processes that write at once the later one's stays, which says the same.
//! 4. A file changed less than two seconds before is not kept: a second change might leave size and time
//!    as they are.
//!
//! Nothing here can fail a load: where the folder cannot be read or written, the file is parsed. Kept
//! files of scenes that are gone stay until they are deleted by hand, which does no harm at any time.

use std::fmt;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use super::formats;
use super::source::Stamp;
use super::{Scene, SceneError};

mod layout;
mod look;
mod motion;

/// The variable that names a folder for the cache, or switches it off.
const VARIABLE: &str = "APPORTION_CACHE";
/// The word that switches it off.
const OFF: &str = "off";
/// Files smaller than this, with all they refer to, are parsed in a few milliseconds; in bytes.
const WORTH_KEEPING: u64 = 1 << 20;
/// How long a file must have been left alone.
const SETTLED: Duration = Duration::from_secs(2);

/// A folder of kept scenes, or none.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: Option<PathBuf>,
}

/// Where a scene was read from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// Its own file.
    File,
    /// Its own file, and it is now kept in this one.
    Kept(PathBuf),
    /// This file of the cache.
    Cache(PathBuf),
}

impl fmt::Display for Origin {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => write!(out, "the file"),
            Self::Kept(path) => write!(out, "the file; kept in {}", path.display()),
            Self::Cache(path) => write!(out, "the cache, {}", path.display()),
        }
    }
}

impl Cache {
    /// The user's cache: the folder that `APPORTION_CACHE` names, none if it says `off`, and otherwise
    /// `apportion` in the place where the system keeps caches: `XDG_CACHE_HOME` or `~/.cache`, on macOS
    /// `~/Library/Caches`, on Windows `LOCALAPPDATA`.
    pub fn of_user() -> Self {
        let folder = match std::env::var_os(VARIABLE).filter(|value| !value.is_empty()) {
            Some(value) if value == OFF => None,
            Some(value) => Some(PathBuf::from(value)),
            None => system_folder().map(|folder| folder.join("apportion")),
        };
        Self { folder }
    }

    /// A cache in a folder, which is made when something is to be kept in it.
    pub fn in_folder(folder: impl Into<PathBuf>) -> Self {
        Self { folder: Some(folder.into()) }
    }

    /// Reads a scene as [`load`](super::load) does, from the cache if it is there and still right, and
    /// keeps it there if it is large.
    ///
    /// # Errors
    /// As [`load`](super::load).
    pub fn load(&self, path: impl AsRef<Path>) -> Result<(Scene, Origin), SceneError> {
        let path = path.as_ref();
        let kept = self.kept(path);
        if let Some(kept) = &kept
            && let Some(scene) = fetch(kept, path)
        {
            return Ok((scene, Origin::Cache(kept.clone())));
        }
        let (scene, stamps) = formats::read(path)?;
        let origin = match kept.filter(|kept| keep(kept, path, &scene, &stamps).is_some()) {
            Some(kept) => Origin::Kept(kept),
            None => Origin::File,
        };
        Ok((scene, origin))
    }

    /// Where a scene would be kept: under a name a person can tell, and that no other path is likely to
    /// have. If one has, the two take turns.
    fn kept(&self, path: &Path) -> Option<PathBuf> {
        let whole = std::path::absolute(path).ok()?;
        let hash = crc32fast::hash(whole.as_os_str().as_encoded_bytes());
        let name = format!("{}-{hash:08x}.scene", formats::name_of(path));
        self.folder.as_ref().map(|folder| folder.join(name))
    }
}

fn system_folder() -> Option<PathBuf> {
    // Relative paths are to be ignored (XDG Base Directory Specification).
    let place = |name| std::env::var_os(name).map(PathBuf::from).filter(|place| place.is_absolute());
    if cfg!(windows) {
        place("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        place("HOME").map(|home| home.join("Library/Caches"))
    } else {
        place("XDG_CACHE_HOME").or_else(|| place("HOME").map(|home| home.join(".cache")))
    }
}

/// The scene in a kept file, if it is that of `path` as it is now.
fn fetch(kept: &Path, path: &Path) -> Option<Scene> {
    let now = Stamp::of(path).ok()?;
    let bytes = std::fs::read(kept).ok()?;
    let (stamps, mut scene) = layout::decode(&bytes, &std::path::absolute(path).ok()?)?;
    let (own, neighbours) = stamps.split_first()?;
    let unchanged = |stamp: &Stamp| Stamp::of_named(&path.with_file_name(&stamp.name), &stamp.name) == *stamp;
    if *own != now || !neighbours.iter().all(unchanged) {
        return None;
    }
    scene.name = formats::name_of(path);
    scene.validate_as(&path.display().to_string()).ok()?;
    Some(scene)
}

/// Keeps a scene, if it is worth it and can be done.
fn keep(kept: &Path, path: &Path, scene: &Scene, stamps: &[Stamp]) -> Option<()> {
    let settled = |stamp: &Stamp| {
        let age = stamp.modified.and_then(|modified| SystemTime::now().duration_since(modified).ok());
        age.is_some_and(|age| age >= SETTLED)
    };
    let size: u64 = stamps.iter().map(|stamp| stamp.size).sum();
    if size < WORTH_KEEPING || !stamps.iter().all(settled) {
        return None;
    }
    let bytes = layout::encode(&std::path::absolute(path).ok()?, stamps, scene)?;
    let folder = kept.parent()?;
    std::fs::create_dir_all(folder).ok()?;
    let mut file = tempfile::NamedTempFile::new_in(folder).ok()?;
    file.write_all(&bytes).ok()?;
    file.persist(kept).ok()?;
    Some(())
}

#[cfg(test)]
mod tests;
