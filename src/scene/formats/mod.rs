//! File formats, one file each. The list is the table of contents.

use std::path::Path;

use super::source::{Source, Stamp, format_of};
use super::{Scene, SceneError};

mod aff;
mod base64;
mod gltf;
mod gltf_bend;
mod gltf_buffers;
mod gltf_look;
mod gltf_motion;
mod mtl;
mod obj;
mod obj_check;
mod obj_shading;
mod ply;
mod ply_body;
mod ply_header;
mod ppm;
mod stl;
mod stl_text;
mod texture;
mod urdf;
mod urdf_shapes;
mod urdf_xml;

pub use aff::{Written, to_aff};

/// A file format that scenes are read from.
pub struct Format {
    /// Extension, in small letters, without the dot.
    pub extension: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    load: fn(&Source) -> Result<Scene, SceneError>,
}

/// All formats. Each may be packed, with `.gz` after its extension. A reader that comes to read something
/// otherwise than before needs a new version of the cache as well (`cache/layout.rs`).
pub const FORMATS: &[Format] = &[
    Format { extension: "gltf", about: "glTF 2.0, buffers and pictures beside or inside", load: gltf::load },
    Format { extension: "glb", about: "glTF 2.0, binary", load: gltf::load },
    Format { extension: "obj", about: "Wavefront OBJ, with its MTL materials and textures", load: obj::load },
    Format { extension: "ply", about: "Stanford PLY, text or binary, with normals", load: ply::load },
    Format { extension: "stl", about: "stereolithography, text or binary, welded", load: stl::load },
    Format {
        extension: "urdf",
        about: "robots: links as their joints place them, with meshes",
        load: urdf::load,
    },
    Format { extension: "aff", about: "animated scenes of BART, with what they include", load: aff::load },
    Format { extension: "nff", about: "neutral file format, as of the SPD", load: aff::load_nff },
];

/// Reads a scene from a file, in the format its extension says, and validates it. The scene is named
/// after the file, without its folder. Lengths are taken as metres.
///
/// # Errors
/// [`SceneError`] if the extension is not known, the file cannot be read, or something in it is not
/// right.
pub fn load(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
    read(path.as_ref()).map(|(scene, _)| scene)
}

/// As [`load`], with the stamps of the files it was read from, the scene's own first.
pub(super) fn read(path: &Path) -> Result<(Scene, Vec<Stamp>), SceneError> {
    let extension = format_of(path);
    let Some(format) = FORMATS.iter().find(|format| format.extension == extension) else {
        let file = path.display().to_string();
        let known = FORMATS.iter().map(|format| format!(".{}", format.extension)).collect::<Vec<_>>();
        return Err(SceneError::UnknownFormat { file, extension, known: known.join(", ") });
    };
    let source = Source::open(path)?;
    let mut scene = (format.load)(&source)?;
    scene.name = name_of(path);
    scene.validate_as(&source.file)?;
    Ok((scene, source.into_stamps()))
}

/// What the scene in a file is called.
pub(super) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
