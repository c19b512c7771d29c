//! The layout of a kept scene. All numbers have the least significant byte first; a text or a list is
//! preceded by its length.
//!
//! ```text
//! magic, version u32, version of the program
//! path of the scene's file
//! stamps:  name, size u64, seconds u64 and nanoseconds u32 since 1970
//! roots u32
//! nodes:   name, parent u32, mesh u32, children u32, transform 12 f32
//! meshes:  name, positions 3 f32, triangles 3 u32, shading (`look.rs`)
//! materials, textures, lights, primitives, flocks, view, background, ambient light, warnings (`look.rs`)
//! animation (`motion.rs`)
//! checksum u32 (CRC-32 of all before it)
//! ```

use std::path::Path;
use std::time::{Duration, SystemTime};

use glam::{Affine3A, Vec3};

use super::{look, motion};
use crate::scene::source::Stamp;
use crate::scene::{Mesh, Node, Scene};

const MAGIC: &[u8] = b"apportion scene\n";
/// To be raised whenever this layout changes, or a reader comes to read a file otherwise than before.
const VERSION: u32 = 4;
/// Stands for no node and for no mesh.
const NONE: u32 = u32::MAX;

/// The bytes of a kept scene; `None` if a list is too long for its length or a time not to be told.
pub(super) fn encode(path: &Path, stamps: &[Stamp], scene: &Scene) -> Option<Vec<u8>> {
    let mut out = MAGIC.to_vec();
    out.extend(VERSION.to_le_bytes());
    put(&mut out, env!("CARGO_PKG_VERSION").bytes())?;
    put(&mut out, path.as_os_str().as_encoded_bytes().iter().copied())?;
    put_count(&mut out, stamps.len())?;
    for stamp in stamps {
        put(&mut out, stamp.name.bytes())?;
        let since = stamp.modified?.duration_since(SystemTime::UNIX_EPOCH).ok()?;
        out.extend(stamp.size.to_le_bytes());
        out.extend(since.as_secs().to_le_bytes());
        out.extend(since.subsec_nanos().to_le_bytes());
    }
    put_words(&mut out, &scene.roots)?;
    put_count(&mut out, scene.nodes.len())?;
    for node in &scene.nodes {
        put(&mut out, node.name.bytes())?;
        out.extend(node.parent.unwrap_or(NONE).to_le_bytes());
        out.extend(node.mesh.unwrap_or(NONE).to_le_bytes());
        put_words(&mut out, &node.children)?;
        out.extend(node.transform.to_cols_array().iter().flat_map(|number| number.to_le_bytes()));
    }
    put_count(&mut out, scene.meshes.len())?;
    for mesh in &scene.meshes {
        put(&mut out, mesh.name.bytes())?;
        put_count(&mut out, mesh.positions.len())?;
        for position in &mesh.positions {
            out.extend_from_slice(&bytes_of(position.to_array().map(f32::to_le_bytes)));
        }
        put_count(&mut out, mesh.triangles.len())?;
        for triangle in &mesh.triangles {
            out.extend_from_slice(&bytes_of(triangle.map(u32::to_le_bytes)));
        }
        look::put_shading(&mut out, &mesh.shading)?;
    }
    look::put_scene(&mut out, scene)?;
    motion::put_animation(&mut out, &scene.animation)?;
    let checksum = crc32fast::hash(&out);
    out.extend(checksum.to_le_bytes());
    Some(out)
}

pub(super) fn put_count(out: &mut Vec<u8>, count: usize) -> Option<()> {
    out.extend(u32::try_from(count).ok()?.to_le_bytes());
    Some(())
}

pub(super) fn put(out: &mut Vec<u8>, bytes: impl ExactSizeIterator<Item = u8>) -> Option<()> {
    put_count(out, bytes.len())?;
    out.extend(bytes);
    Some(())
}

pub(super) fn put_words(out: &mut Vec<u8>, words: &[u32]) -> Option<()> {
    put_count(out, words.len())?;
    out.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    Some(())
}

fn bytes_of(numbers: [[u8; 4]; 3]) -> [u8; 12] {
    let mut bytes = [0; 12];
    bytes.as_chunks_mut().0.copy_from_slice(&numbers);
    bytes
}

/// The stamps and the scene in these bytes, the scene without a name and not validated; `None` if they
/// are damaged, of another version, or of another path.
pub(super) fn decode(bytes: &[u8], path: &Path) -> Option<(Vec<Stamp>, Scene)> {
    let (bytes, checksum) = bytes.split_last_chunk()?;
    let mut from = Reader { rest: bytes.strip_prefix(MAGIC)? };
    if from.word()? != VERSION || crc32fast::hash(bytes) != u32::from_le_bytes(*checksum) {
        return None;
    }
    let is_own = from.bytes()? == env!("CARGO_PKG_VERSION").as_bytes()
        && from.bytes()? == path.as_os_str().as_encoded_bytes();
    if !is_own {
        return None;
    }
    let stamps = from.list(Reader::stamp)?;
    let roots = from.words()?;
    let nodes = from.list(Reader::node)?;
    let meshes = from.list(Reader::mesh)?;
    let scene = look::read_scene(&mut from, Scene { nodes, meshes, roots, ..Scene::default() })?;
    let scene = Scene { animation: motion::read_animation(&mut from)?, ..scene };
    from.rest.is_empty().then_some((stamps, scene))
}

/// What has not been read yet. Every length is held against it before memory is taken.
pub(super) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// A number of 32 bits, any.
    pub(super) fn number(&mut self) -> Option<f32> {
        self.array().map(f32::from_le_bytes)
    }

    /// A time in seconds: 64 bits, any.
    pub(super) fn time(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }

    /// Three numbers of 32 bits.
    pub(super) fn vector(&mut self) -> Option<Vec3> {
        Some(Vec3::new(self.number()?, self.number()?, self.number()?))
    }

    pub(super) fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (array, rest) = self.rest.split_first_chunk()?;
        self.rest = rest;
        Some(*array)
    }

    pub(super) fn word(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    /// A list of items of `N` bytes.
    pub(super) fn arrays<const N: usize>(&mut self) -> Option<&'a [[u8; N]]> {
        let count = self.word()? as usize;
        let (bytes, rest) = self.rest.split_at_checked(count.checked_mul(N)?)?;
        self.rest = rest;
        Some(bytes.as_chunks().0)
    }

    fn bytes(&mut self) -> Option<&'a [u8]> {
        self.arrays::<1>().map(<[[u8; 1]]>::as_flattened)
    }

    pub(super) fn text(&mut self) -> Option<String> {
        String::from_utf8(self.bytes()?.to_vec()).ok()
    }

    pub(super) fn words(&mut self) -> Option<Vec<u32>> {
        Some(self.arrays()?.iter().map(|word| u32::from_le_bytes(*word)).collect())
    }

    /// A list of items of different sizes, each at least as long as a count.
    pub(super) fn list<T>(&mut self, item: impl Fn(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let count = self.word()? as usize;
        let mut list = Vec::with_capacity(count.min(self.rest.len() / size_of::<u32>()));
        for _ in 0..count {
            list.push(item(self)?);
        }
        Some(list)
    }

    fn stamp(&mut self) -> Option<Stamp> {
        let name = self.text()?;
        let size = self.array().map(u64::from_le_bytes)?;
        let (seconds, nanos) = (self.array().map(u64::from_le_bytes)?, self.word()?);
        let since = Duration::from_secs(seconds).checked_add(Duration::from_nanos(nanos.into()))?;
        Some(Stamp { name, size, modified: Some(SystemTime::UNIX_EPOCH.checked_add(since)?) })
    }

    fn node(&mut self) -> Option<Node> {
        let name = self.text()?;
        let some = |index: u32| Some(index).filter(|index| *index != NONE);
        let (parent, mesh) = (some(self.word()?), some(self.word()?));
        let children = self.words()?;
        let numbers: [u8; 48] = self.array()?;
        let mut transform = [0.0; 12];
        for (number, bytes) in transform.iter_mut().zip(numbers.as_chunks().0) {
            *number = f32::from_le_bytes(*bytes);
        }
        Some(Node { name, parent, children, transform: Affine3A::from_cols_array(&transform), mesh })
    }

    fn mesh(&mut self) -> Option<Mesh> {
        let name = self.text()?;
        let positions = self.arrays()?.iter().map(|bytes| Vec3::from(triple(bytes).map(f32::from_le_bytes)));
        let positions = positions.collect();
        let triangles = self.arrays()?.iter().map(|bytes| triple(bytes).map(u32::from_le_bytes)).collect();
        let shading = look::read_shading(self)?;
        Some(Mesh { shading, ..Mesh::new(name, positions, triangles) })
    }
}

fn triple(bytes: &[u8; 12]) -> [[u8; 4]; 3] {
    let mut numbers = [[0; 4]; 3];
    numbers.copy_from_slice(bytes.as_chunks().0);
    numbers
}
