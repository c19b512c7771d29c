//! Wavefront OBJ, through crate `tobj`: objects and groups (`o`, `g`) become child nodes of one root,
//! each with a mesh of its own. Polygons become triangle fans; points and lines are left out.
//! Normals, texture coordinates and materials are read beside it (`obj_shading`); a library of materials or a picture
//! that is not there is a warning.

use std::collections::HashMap;
use std::path::Path;

use glam::{Affine3A, Vec3};

use super::super::source::Source;
use super::super::{Mesh, Scene, SceneError};
use super::{obj_check, obj_shading::Faces};

/// Reads the objects and groups of a file.
pub(super) fn load(source: &Source) -> Result<Scene, SceneError> {
    let file = &source.file;
    let text = source.text()?;
    obj_check::check(file, text)?;
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..tobj::LoadOptions::default()
    };
    let no_materials = |_: &Path| Ok((Vec::new(), HashMap::new()));
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, no_materials)
        .map_err(|error| SceneError::malformed(file, "document", error.to_string(), "a valid OBJ file"))?;
    let mut scene = Scene::new(file);
    let mut faces = Faces::read(source, text, &mut scene)?;
    let root = scene.add_node(None, source.stem(), Affine3A::IDENTITY, None);
    for model in models.into_iter().filter(|model| !model.mesh.indices.is_empty()) {
        let positions = model.mesh.positions.chunks_exact(3).map(Vec3::from_slice).collect();
        let triangles: Vec<_> = model.mesh.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        let shading = faces.take(triangles.len()).ok_or_else(|| {
            let expected = "as many triangles as its faces make";
            SceneError::malformed(
                file,
                "document",
                format!("{} in {:?}", triangles.len(), model.name),
                expected,
            )
        })?;
        let mesh = Mesh { shading, ..Mesh::new(model.name.clone(), positions, triangles) };
        let mesh = scene.add_mesh(mesh);
        scene.add_node(Some(root), model.name, Affine3A::IDENTITY, Some(mesh));
    }
    Ok(scene)
}

#[cfg(test)]
#[path = "obj_tests.rs"]
mod tests;
