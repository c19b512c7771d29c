//! glTF 2.0, as text or binary: the node hierarchy and the triangles; nodes that share a mesh go on
//! sharing it. Of a mesh's primitives those made of triangles (lists, strips, fans) become one mesh;
//! points and lines have no surface and are left out. Materials, skins, morphs and animation are not
//! read. Quantised, sparse or compressed vertices are refused.

use std::collections::HashMap;

use glam::{Affine3A, Mat4, Vec3};
use gltf::mesh::Mode;

use super::super::source::Source;
use super::super::{Mesh, Scene, SceneError};
use super::gltf_buffers::Buffers;

/// Reads the default scene of a document, or its first, or, if it declares none, all its nodes.
pub(super) fn load(source: &Source) -> Result<Scene, SceneError> {
    let (file, bytes) = (&source.file, &source.bytes);
    check_header(file, bytes)?;
    let invalid = |error: gltf::Error| {
        let found = error.to_string();
        SceneError::malformed(file, "document", found.trim_end_matches(';'), "a valid glTF 2.0 file")
    };
    let gltf = gltf::Gltf::from_slice_without_validation(bytes).map_err(invalid)?;
    let json = gltf.document.into_json();
    check_positions(file, &json)?;
    let document = gltf::Document::from_json(json).map_err(invalid)?;
    let buffers = Buffers::read(source, &document, gltf.blob)?;
    let mut scene = Scene::new(file);
    for mesh in document.meshes() {
        scene.meshes.push(read_mesh(file, &buffers, &mesh)?);
    }
    add_nodes(file, &document, &mut scene)?;
    Ok(scene)
}

/// Crate `gltf` subtracts from the length in the header of a binary file before looking at it, and
/// reports a cut file without saying by how much.
fn check_header(file: &str, bytes: &[u8]) -> Result<(), SceneError> {
    if !bytes.starts_with(b"glTF") {
        return Ok(());
    }
    let said = bytes.get(8..12).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    match said {
        Some(said) if said >= 20 && said <= bytes.len() => Ok(()),
        Some(said) if said >= 20 => {
            let found = format!("{} bytes", bytes.len());
            Err(SceneError::malformed(file, "header", found, format!("the {said} bytes it declares")))
        }
        _ => Err(SceneError::malformed(file, "header", "no usable length", "12 bytes of GLB header")),
    }
}

/// The validation of crate `gltf` looks up the accessor of each POSITION before it has checked that there
/// is one of that number.
fn check_positions(file: &str, json: &gltf::json::Root) -> Result<(), SceneError> {
    let semantic = gltf::json::validation::Checked::Valid(gltf::Semantic::Positions);
    let count = json.accessors.len();
    for (number, mesh) in json.meshes.iter().enumerate() {
        for accessor in mesh.primitives.iter().filter_map(|primitive| primitive.attributes.get(&semantic)) {
            if accessor.value() >= count {
                let found = format!("POSITION in accessor {}", accessor.value());
                let expected = format!("an accessor below {count}");
                return Err(SceneError::malformed(file, format!("mesh {number}"), found, expected));
            }
        }
    }
    Ok(())
}

fn read_mesh(file: &str, buffers: &Buffers<'_>, mesh: &gltf::Mesh<'_>) -> Result<Mesh, SceneError> {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    // Primitives often share their vertices, one for each material.
    let mut first_of: HashMap<usize, (u32, usize)> = HashMap::new();
    for primitive in mesh.primitives() {
        let place = || {
            format!("mesh {} {:?} primitive {}", mesh.index(), mesh.name().unwrap_or(""), primitive.index())
        };
        if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            continue;
        }
        let accessor = primitive
            .get(&gltf::Semantic::Positions)
            .ok_or_else(|| SceneError::malformed(file, place(), "no POSITION", "one"))?;
        let (first, count) = match first_of.get(&accessor.index()) {
            Some(shared) => *shared,
            None => {
                let vertices = buffers.positions(&accessor)?;
                let placed = (positions.len() as u32, vertices.len());
                positions.extend(vertices.into_iter().map(Vec3::from));
                first_of.insert(accessor.index(), placed);
                placed
            }
        };
        let indices = match primitive.indices() {
            Some(accessor) => buffers.indices(&accessor)?,
            None => (0..count as u32).collect(),
        };
        if let Some(index) = indices.iter().find(|index| **index as usize >= count) {
            let expected = format!("indices below {count}");
            return Err(SceneError::malformed(file, place(), format!("vertex index {index}"), expected));
        }
        if primitive.mode() == Mode::Triangles && indices.len() % 3 != 0 {
            let found = format!("{} indices", indices.len());
            return Err(SceneError::malformed(file, place(), found, "a multiple of three"));
        }
        triangles.extend(assemble(primitive.mode(), &indices).map(|triangle| triangle.map(|i| i + first)));
    }
    Ok(Mesh::new(mesh.name().unwrap_or(""), positions, triangles))
}

/// Triangles of a list, a strip or a fan, all wound the same way (glTF 2.0 sec. 3.7.2.1).
fn assemble(mode: Mode, indices: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let count = match mode {
        Mode::Triangles => indices.len() / 3,
        _ => indices.len().saturating_sub(2),
    };
    (0..count).map(move |i| match mode {
        Mode::TriangleStrip => [indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]],
        Mode::TriangleFan => [indices[i + 1], indices[i + 2], indices[0]],
        _ => [indices[3 * i], indices[3 * i + 1], indices[3 * i + 2]],
    })
}

/// Adds the nodes of the scene that is shown, each after its parent, in the document's order of children.
fn add_nodes(file: &str, document: &gltf::Document, scene: &mut Scene) -> Result<(), SceneError> {
    let roots: Vec<gltf::Node<'_>> = match document.default_scene().or_else(|| document.scenes().next()) {
        Some(shown) => shown.nodes().collect(),
        None => {
            let mut is_child = vec![false; document.nodes().len()];
            for child in document.nodes().flat_map(|node| node.children()) {
                is_child[child.index()] = true;
            }
            document.nodes().filter(|node| !is_child[node.index()]).collect()
        }
    };
    let mut reached = vec![false; document.nodes().len()];
    let mut stack: Vec<_> = roots.into_iter().rev().map(|root| (None, root)).collect();
    while let Some((parent, node)) = stack.pop() {
        let name = node.name().unwrap_or("");
        if std::mem::replace(&mut reached[node.index()], true) {
            let place = format!("node {} {name:?}", node.index());
            let expected = "a tree: one way to each node, no cycle";
            return Err(SceneError::malformed(file, place, "it is reached twice", expected));
        }
        let matrix = Mat4::from_cols_array_2d(&node.transform().matrix());
        let mesh = node.mesh().map(|mesh| mesh.index() as u32);
        let index = scene.add_node(parent, name, Affine3A::from_mat4(matrix), mesh);
        let children: Vec<_> = node.children().collect();
        stack.extend(children.into_iter().rev().map(|child| (Some(index), child)));
    }
    Ok(())
}

#[cfg(test)]
#[path = "gltf_tests.rs"]
mod tests;
