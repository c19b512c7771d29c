//! STL: triangles without order, as text or binary. Vertices are welded where they are exactly the same
//! place, -0 and 0 being one: that gives back the mesh that was written, and never joins what a
//! tolerance would have to guess at. Each solid of a text becomes a node; normals and attributes are not
//! read; triangles without area are kept.
//!
//! A file is binary if its size is the one its count of triangles calls for, whatever it begins with:
//! many binary files begin with `solid`, as texts do.

use std::collections::HashMap;

use glam::{Affine3A, Vec3};

use super::super::source::Source;
use super::super::{Mesh, Scene, SceneError};
use super::stl_text;

/// Bytes before the first triangle of a binary file, the last four being the count of triangles.
const HEADER: usize = 84;
/// Bytes of a triangle in a binary file: its normal, three corners and an attribute.
const TRIANGLE: usize = 50;

/// Reads the solids of a file: one becomes one node, several become children of a root.
pub(super) fn load(source: &Source) -> Result<Scene, SceneError> {
    let mut scene = Scene::new("");
    if !is_binary(&source.bytes) && is_text(&source.bytes) {
        let mut solids = stl_text::read(&source.file, &source.bytes)?;
        if let [solid] = solids.as_mut_slice() {
            solid.name = source.stem();
        }
        let root = match solids.len() {
            1 => None,
            _ => Some(scene.add_node(None, source.stem(), Affine3A::IDENTITY, None)),
        };
        for solid in solids {
            add(&mut scene, root, solid.name, solid.corners);
        }
    } else {
        let corners = read_binary(&source.file, &source.bytes)?;
        add(&mut scene, None, source.stem(), corners);
    }
    Ok(scene)
}

/// How many triangles a binary file says it has.
fn said(bytes: &[u8]) -> Option<u32> {
    bytes.get(HEADER - 4..HEADER).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
}

fn is_binary(bytes: &[u8]) -> bool {
    let size = said(bytes).map(|count| HEADER as u64 + u64::from(count) * TRIANGLE as u64);
    size == Some(bytes.len() as u64)
}

fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && !bytes.contains(&0)
}

fn read_binary(file: &str, bytes: &[u8]) -> Result<Vec<Vec3>, SceneError> {
    if !is_binary(bytes) {
        let (place, found) = ("header", format!("{} bytes", bytes.len()));
        let expected = match said(bytes) {
            Some(count) => format!("{HEADER} and {TRIANGLE} for each of {count} triangles, or a text"),
            None => format!("at least {HEADER}, or a text that begins with `solid`"),
        };
        return Err(SceneError::malformed(file, place, found, expected));
    }
    let mut corners = Vec::with_capacity((bytes.len() - HEADER) / TRIANGLE * 3);
    for (number, triangle) in bytes[HEADER..].chunks_exact(TRIANGLE).enumerate() {
        for corner in 1..4 {
            let coordinate = |axis: usize| {
                let b = &triangle[12 * corner + 4 * axis..];
                f32::from_le_bytes([b[0], b[1], b[2], b[3]])
            };
            let position = Vec3::new(coordinate(0), coordinate(1), coordinate(2));
            if !position.is_finite() {
                let place = format!("triangle {number}, corner {corner}");
                return Err(SceneError::malformed(file, place, position.to_string(), "finite coordinates"));
            }
            corners.push(position);
        }
    }
    Ok(corners)
}

/// Adds a node with the triangles of three corners each.
fn add(scene: &mut Scene, parent: Option<u32>, name: String, corners: Vec<Vec3>) {
    let (positions, indices) = weld(&corners);
    let triangles = indices.chunks_exact(3).map(|corner| [corner[0], corner[1], corner[2]]).collect();
    let mesh = scene.add_mesh(Mesh::new(name.clone(), positions, triangles));
    scene.add_node(parent, name, Affine3A::IDENTITY, Some(mesh));
}

/// The different places among these, in the order they come, and for each of these its place's index.
fn weld(corners: &[Vec3]) -> (Vec<Vec3>, Vec<u32>) {
    let (mut positions, mut index_of) = (Vec::new(), HashMap::new());
    let index = |corner: &Vec3| {
        // Adding 0 makes 0 of -0.
        let corner = *corner + Vec3::ZERO;
        *index_of.entry(corner.to_array().map(f32::to_bits)).or_insert_with(|| {
            positions.push(corner);
            positions.len() as u32 - 1
        })
    };
    let indices = corners.iter().map(index).collect();
    (positions, indices)
}

#[cfg(test)]
#[path = "stl_tests.rs"]
mod tests;
