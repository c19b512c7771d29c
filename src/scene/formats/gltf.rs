//! glTF 2.0, as text or binary: the node hierarchy and the triangles; nodes that share a mesh go on
//! sharing it. Of a mesh's primitives those made of triangles (lists, strips, fans) become one mesh;
//! points and lines have no surface and are left out. Normals, the first texture coordinates and
//! materials are read, how nodes move (`gltf_motion.rs`) and meshes bend (`gltf_bend.rs`). Quantised, sparse or compressed
//! vertices are refused.

use std::collections::HashMap;

use glam::{Affine3A, Mat4, Vec2, Vec3};
use gltf::mesh::Mode;

use super::super::source::Source;
use super::super::{Corners, Materials, Mesh, Scene, SceneError, Shading};
use super::gltf_bend::{self, Block};
use super::gltf_buffers::Buffers;
use super::{gltf_look, gltf_motion};

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
    gltf_look::read(source, &document, &buffers, &mut scene);
    let mut blocks = Vec::new();
    for mesh in document.meshes() {
        let (mesh, of_mesh) = read_mesh(file, &buffers, &mesh, &mut scene.warnings)?;
        scene.meshes.push(mesh);
        blocks.push(of_mesh);
    }
    let placed = add_nodes(file, &document, &mut scene)?;
    gltf_motion::read(&document, &buffers, &placed, &mut scene);
    gltf_bend::read(&document, &buffers, &placed, &blocks, &mut scene);
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

/// Reads a mesh; tells which vertices came with which of its primitives.
fn read_mesh(
    file: &str,
    buffers: &Buffers<'_>,
    mesh: &gltf::Mesh<'_>,
    warnings: &mut Vec<String>,
) -> Result<(Mesh, Vec<Block>), SceneError> {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let (mut normals, mut coordinates, mut materials) = (Vec::new(), Vec::new(), Vec::new());
    let mut blocks = Vec::new();
    // Primitives often share their vertices, one for each material.
    let mut first_of: HashMap<[Option<usize>; 3], (u32, usize)> = HashMap::new();
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
        let (normal, coordinate) =
            (primitive.get(&gltf::Semantic::Normals), primitive.get(&gltf::Semantic::TexCoords(0)));
        let key = [
            Some(accessor.index()),
            normal.as_ref().map(gltf::Accessor::index),
            coordinate.as_ref().map(gltf::Accessor::index),
        ];
        let (first, count) = match first_of.get(&key) {
            Some(shared) => *shared,
            None => {
                let vertices = buffers.positions(&accessor)?;
                let placed = (positions.len() as u32, vertices.len());
                positions.extend(vertices.into_iter().map(Vec3::from));
                let read = normal.map(|normal| buffers.positions(&normal));
                extend(&mut normals, read, positions.len(), placed.1, warnings);
                let read = coordinate.map(|coordinate| buffers.coordinates(&coordinate));
                extend(&mut coordinates, read, positions.len(), placed.1, warnings);
                let first = positions.len() - placed.1;
                blocks.push(Block { primitive: primitive.index(), first, count: placed.1 });
                first_of.insert(key, placed);
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
        let material = primitive.material().index().map_or(u32::MAX, |material| material as u32);
        materials.resize(triangles.len(), material);
    }
    let corners = |values: Vec<[f32; 3]>| Corners::of_vertices(values.into_iter().map(Vec3::from).collect());
    let shading = Shading {
        materials: Materials::from_each(materials),
        normals: corners(normals),
        coordinates: Corners::of_vertices(coordinates.into_iter().map(Vec2::from).collect()),
    };
    Ok((Mesh { shading, ..Mesh::new(mesh.name().unwrap_or(""), positions, triangles) }, blocks))
}

/// Adds what shading knows of the last `count` of `vertices` vertices: 0 for those of which nothing is known, and none at
/// all as long as nothing is known of any. What cannot be read is a warning: the shape is whole without it.
fn extend<const N: usize>(
    values: &mut Vec<[f32; N]>,
    read: Option<Result<Vec<[f32; N]>, SceneError>>,
    vertices: usize,
    count: usize,
    warnings: &mut Vec<String>,
) {
    match read {
        Some(Ok(read)) if read.len() == count => {
            values.resize(vertices - count, [0.0; N]);
            let is_sound = |value: &[f32; N]| value.iter().all(|number| number.is_finite());
            values.extend(read.into_iter().map(|value| if is_sound(&value) { value } else { [0.0; N] }));
        }
        Some(Ok(read)) => {
            warnings.push(format!("{} normals or texture coordinates for {count} vertices", read.len()))
        }
        Some(Err(error)) => warnings.push(error.to_string()),
        None => {}
    }
    if !values.is_empty() {
        values.resize(vertices, [0.0; N]);
    }
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

/// Adds the nodes of the scene that is shown, each after its parent, in the document's order of children; tells which
/// one each of the document's became.
fn add_nodes(
    file: &str,
    document: &gltf::Document,
    scene: &mut Scene,
) -> Result<Vec<Option<u32>>, SceneError> {
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
    let mut placed = vec![None; document.nodes().len()];
    let mut stack: Vec<_> = roots.into_iter().rev().map(|root| (None, root)).collect();
    while let Some((parent, node)) = stack.pop() {
        let name = node.name().unwrap_or("");
        if placed[node.index()].is_some() {
            let place = format!("node {} {name:?}", node.index());
            let expected = "a tree: one way to each node, no cycle";
            return Err(SceneError::malformed(file, place, "it is reached twice", expected));
        }
        let matrix = Mat4::from_cols_array_2d(&node.transform().matrix());
        let mesh = node.mesh().map(|mesh| mesh.index() as u32);
        let index = scene.add_node(parent, name, Affine3A::from_mat4(matrix), mesh);
        placed[node.index()] = Some(index);
        let children: Vec<_> = node.children().collect();
        stack.extend(children.into_iter().rev().map(|child| (Some(index), child)));
    }
    Ok(placed)
}

#[cfg(test)]
#[path = "gltf_tests.rs"]
mod tests;
