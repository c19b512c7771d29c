//! The bytes behind a glTF file, and numbers read out of them with every bound checked: the reader of
//! crate `gltf` trusts counts and strides, and a damaged file would make it panic.

use std::cell::Cell;

use gltf::accessor::{DataType, Dimensions};

use super::super::SceneError;
use super::super::source::Source;
use super::base64;

/// The buffers of a document, by index.
pub(super) struct Buffers<'a> {
    file: &'a str,
    data: Vec<Vec<u8>>,
    /// Bytes that may still be taken out of them.
    left: Cell<usize>,
}

/// How often over, on average, the bytes of a document may be taken out of it. Accessors may share
/// buffers, and without a bound a small file could ask for any amount of memory.
const MOST_TIMES: usize = 64;

impl<'a> Buffers<'a> {
    /// Collects the buffers: the binary chunk, files beside the document, data URIs.
    pub(super) fn read(
        source: &'a Source,
        document: &gltf::Document,
        mut blob: Option<Vec<u8>>,
    ) -> Result<Self, SceneError> {
        let file = &source.file;
        let mut data = Vec::new();
        for buffer in document.buffers() {
            let fail = |found: &str, expected: &str| {
                SceneError::malformed(file, format!("buffer {}", buffer.index()), found, expected)
            };
            let bytes = match buffer.source() {
                gltf::buffer::Source::Bin => {
                    blob.take().ok_or_else(|| fail("no binary chunk", "a GLB file with a BIN chunk"))?
                }
                gltf::buffer::Source::Uri(uri) => match uri.strip_prefix("data:") {
                    Some(rest) => rest
                        .split_once(";base64,")
                        .and_then(|(_, text)| base64::decode(text))
                        .ok_or_else(|| fail("a damaged data URI", "data:...;base64,..."))?,
                    None if uri.contains("://") => {
                        return Err(fail(&format!("the address {uri:?}"), "a file beside the document"));
                    }
                    None => source.neighbour(&unescape(uri)).map_err(|error| {
                        let found = format!("file {uri:?}, which cannot be read ({error})");
                        fail(&found, "a file beside the document")
                    })?,
                },
            };
            if bytes.len() < buffer.length() {
                let expected = format!("{} bytes", buffer.length());
                return Err(fail(&format!("only {} bytes", bytes.len()), &expected));
            }
            data.push(bytes);
        }
        let all = data.iter().map(Vec::len).sum::<usize>() + source.bytes.len();
        Ok(Self { file, data, left: Cell::new(all.saturating_mul(MOST_TIMES)) })
    }

    /// The bytes of a view; none if it lies beyond its buffer.
    pub(super) fn view(&self, view: &gltf::buffer::View<'_>) -> Option<&[u8]> {
        let end = view.offset().checked_add(view.length())?;
        self.data[view.buffer().index()].get(view.offset()..end)
    }

    /// The items of an accessor, each handed to `item` as its bytes.
    fn items<T>(
        &self,
        accessor: &gltf::Accessor<'_>,
        item: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, SceneError> {
        let fail = |found: &str, expected: &str| {
            SceneError::malformed(self.file, format!("accessor {}", accessor.index()), found, expected)
        };
        if accessor.sparse().is_some() {
            return Err(fail("sparse values", "values in full"));
        }
        let view = accessor.view().ok_or_else(|| fail("no buffer view", "one"))?;
        let bytes =
            self.view(&view).ok_or_else(|| fail("a buffer view past the end of its buffer", "one within"))?;
        let (size, count) = (accessor.size(), accessor.count());
        let stride = view.stride().unwrap_or(size);
        let needed = count.checked_sub(1).map_or(Some(0), |last| {
            last.checked_mul(stride)?.checked_add(size)?.checked_add(accessor.offset())
        });
        if stride < size || needed.is_none_or(|needed| needed > bytes.len()) {
            let found = format!("{count} items at a stride of {stride} bytes from {}", accessor.offset());
            return Err(fail(&found, &format!("no more than the view's {} bytes", bytes.len())));
        }
        let left = self.left.get().checked_sub(count.saturating_mul(size)).ok_or_else(|| {
            fail("accessors that overlap too much", &format!("each byte taken {MOST_TIMES} times at most"))
        })?;
        self.left.set(left);
        let start = |i: usize| accessor.offset() + i * stride;
        Ok((0..count).map(|i| item(&bytes[start(i)..start(i) + size])).collect())
    }

    /// Texture coordinates: floats, or shares of the greatest number of 8 or 16 bits.
    pub(super) fn coordinates(&self, accessor: &gltf::Accessor<'_>) -> Result<Vec<[f32; 2]>, SceneError> {
        let short = |b: &[u8], i: usize| f32::from(u16::from_le_bytes([b[i], b[i + 1]])) / 65_535.0;
        let number = |b: &[u8], i: usize| f32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]]);
        match (accessor.data_type(), accessor.dimensions()) {
            (DataType::F32, Dimensions::Vec2) => self.items(accessor, |b| [number(b, 0), number(b, 4)]),
            (DataType::U16, Dimensions::Vec2) => self.items(accessor, |b| [short(b, 0), short(b, 2)]),
            (DataType::U8, Dimensions::Vec2) => {
                self.items(accessor, |b| [f32::from(b[0]) / 255.0, f32::from(b[1]) / 255.0])
            }
            _ => Err(self.wrong_kind(accessor, "texture coordinates of two floats or shares")),
        }
    }

    /// Three floats an item: vertex positions, or normals.
    pub(super) fn positions(&self, accessor: &gltf::Accessor<'_>) -> Result<Vec<[f32; 3]>, SceneError> {
        let kind = (accessor.data_type(), accessor.dimensions());
        if kind != (DataType::F32, Dimensions::Vec3) {
            return Err(self.wrong_kind(accessor, "positions of three 32-bit floats"));
        }
        let number = |b: &[u8], i: usize| f32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]]);
        self.items(accessor, |b| [number(b, 0), number(b, 4), number(b, 8)])
    }

    /// One float an item: times of key frames, weights.
    pub(super) fn numbers(&self, accessor: &gltf::Accessor<'_>) -> Result<Vec<f32>, SceneError> {
        if (accessor.data_type(), accessor.dimensions()) != (DataType::F32, Dimensions::Scalar) {
            return Err(self.wrong_kind(accessor, "32-bit floats"));
        }
        self.items(accessor, |b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
    }

    /// Matrices, column by column.
    pub(super) fn matrices(&self, accessor: &gltf::Accessor<'_>) -> Result<Vec<[f32; 16]>, SceneError> {
        if (accessor.data_type(), accessor.dimensions()) != (DataType::F32, Dimensions::Mat4) {
            return Err(self.wrong_kind(accessor, "matrices of 16 floats"));
        }
        let number = |b: &[u8], i: usize| f32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]]);
        self.items(accessor, |b| std::array::from_fn(|i| number(b, 4 * i)))
    }

    /// The joints that a vertex follows, by number in its skin.
    pub(super) fn joints(&self, accessor: &gltf::Accessor<'_>) -> Result<Vec<[u16; 4]>, SceneError> {
        match (accessor.data_type(), accessor.dimensions()) {
            (DataType::U8, Dimensions::Vec4) => {
                self.items(accessor, |b| std::array::from_fn(|i| u16::from(b[i])))
            }
            (DataType::U16, Dimensions::Vec4) => self
                .items(accessor, |b| std::array::from_fn(|i| u16::from_le_bytes([b[2 * i], b[2 * i + 1]]))),
            _ => Err(self.wrong_kind(accessor, "four joints of 8 or 16 bits")),
        }
    }

    /// Quaternions x, y, z, w, or four weights: floats, or shares of the greatest number of 8 or 16 bits.
    pub(super) fn fours(&self, accessor: &gltf::Accessor<'_>) -> Result<Vec<[f32; 4]>, SceneError> {
        if accessor.dimensions() != Dimensions::Vec4 {
            return Err(self.wrong_kind(accessor, "four numbers"));
        }
        let four = |part: &dyn Fn(usize) -> f32| [0, 1, 2, 3].map(part);
        let number = |b: &[u8], i: usize| f32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]]);
        match accessor.data_type() {
            DataType::F32 => self.items(accessor, |b| four(&|i| number(b, 4 * i))),
            DataType::I8 => self.items(accessor, |b| four(&|i| (f32::from(b[i] as i8) / 127.0).max(-1.0))),
            DataType::U8 => self.items(accessor, |b| four(&|i| f32::from(b[i]) / 255.0)),
            DataType::I16 => self.items(accessor, |b| {
                four(&|i| (f32::from(i16::from_le_bytes([b[2 * i], b[2 * i + 1]])) / 32_767.0).max(-1.0))
            }),
            DataType::U16 => self.items(accessor, |b| {
                four(&|i| f32::from(u16::from_le_bytes([b[2 * i], b[2 * i + 1]])) / 65_535.0)
            }),
            DataType::U32 => Err(self.wrong_kind(accessor, "four floats or shares of 8 or 16 bits")),
        }
    }

    /// Checks that there are as many values as key frames ask for.
    pub(super) fn check_keys(
        &self,
        accessor: &gltf::Accessor<'_>,
        kind: gltf::animation::Interpolation,
        times: &[f32],
        values: usize,
    ) -> Result<(), SceneError> {
        let each = if kind == gltf::animation::Interpolation::CubicSpline { 3 } else { 1 };
        if times.len().checked_mul(each) == Some(values) {
            return Ok(());
        }
        let (place, found) = (format!("accessor {}", accessor.index()), format!("{values} values"));
        Err(SceneError::malformed(
            self.file,
            place,
            found,
            format!("{each} for each of {} times", times.len()),
        ))
    }

    /// Vertex indices, of any width.
    pub(super) fn indices(&self, accessor: &gltf::Accessor<'_>) -> Result<Vec<u32>, SceneError> {
        match (accessor.data_type(), accessor.dimensions()) {
            (DataType::U8, Dimensions::Scalar) => self.items(accessor, |b| u32::from(b[0])),
            (DataType::U16, Dimensions::Scalar) => {
                self.items(accessor, |b| u32::from(u16::from_le_bytes([b[0], b[1]])))
            }
            (DataType::U32, Dimensions::Scalar) => {
                self.items(accessor, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            }
            _ => Err(self.wrong_kind(accessor, "indices of 8, 16 or 32 bits")),
        }
    }

    fn wrong_kind(&self, accessor: &gltf::Accessor<'_>, expected: &str) -> SceneError {
        let found = format!("{:?} of {:?}", accessor.dimensions(), accessor.data_type());
        SceneError::malformed(self.file, format!("accessor {}", accessor.index()), found, expected)
    }
}

/// Undoes the percent escapes of an address.
pub(super) fn unescape(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let code = tail.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()).filter(|_| *first == b'%') {
            Some(byte) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            None => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
