//! File formats, one file each. The list is the table of contents.

use std::path::Path;

use super::{Scene, SceneError};

mod base64;
mod gltf;
mod gltf_buffers;
mod obj;
mod obj_check;

/// A file format that scenes are read from.
pub struct Format {
    /// Extension, in small letters, without the dot.
    pub extension: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    load: fn(&Path) -> Result<Scene, SceneError>,
}

/// All formats.
pub const FORMATS: &[Format] = &[
    Format { extension: "gltf", about: "glTF 2.0, buffers beside or inside", load: gltf::load },
    Format { extension: "glb", about: "glTF 2.0, binary", load: gltf::load },
    Format { extension: "obj", about: "Wavefront OBJ, geometry only", load: obj::load },
];

/// Reads a scene from a file, in the format its extension says, and validates it. The scene is named
/// after the file, without its folder. Lengths are taken as metres.
///
/// # Errors
/// [`SceneError`] if the extension is not known, the file cannot be read, or something in it is not
/// right.
pub fn load(path: impl AsRef<Path>) -> Result<Scene, SceneError> {
    let path = path.as_ref();
    let file = path.display().to_string();
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let Some(format) = FORMATS.iter().find(|format| format.extension == extension) else {
        let known = FORMATS.iter().map(|format| format!(".{}", format.extension)).collect::<Vec<_>>();
        return Err(SceneError::UnknownFormat { file, extension, known: known.join(", ") });
    };
    let mut scene = (format.load)(path)?;
    scene.name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    scene.validate_as(&file)?;
    Ok(scene)
}
