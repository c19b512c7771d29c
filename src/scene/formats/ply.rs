//! Stanford PLY, as text or binary of either byte order: element `vertex` with `x y z`, element `face`
//! with a list `vertex_indices` or `vertex_index`. Polygons become triangle fans; faces of fewer than
//! three corners have no surface and are left out. Normals `nx ny nz` of vertices are kept; all other properties and
//! elements are passed over.
//! A cloud of points is refused.
//!
//! Read by hand, not through crate `ply-rs-bw` 4.0: that takes 2.0 to 2.5 times as long for the 871,414
//! triangles of the dragon, and gives counts and indices that still have to be checked.

use glam::{Affine3A, Vec3};

use super::super::source::Source;
use super::super::{Corners, Mesh, Scene, SceneError};
use super::ply_body::{Binary, Body, Text};
use super::ply_header::{self, Element, Encoding, Fault, Header, Kind, Property};

/// Reads the mesh of a file, which becomes one node.
pub(super) fn load(source: &Source) -> Result<Scene, SceneError> {
    let bytes = &source.bytes;
    let fail =
        |place: String, (found, expected): Fault| SceneError::malformed(&source.file, place, found, expected);
    let header = ply_header::read(bytes).map_err(|(line, fault)| fail(format!("line {line}"), fault))?;
    let plan = Plan::of(&header).map_err(|(line, fault)| fail(format!("line {line}"), fault))?;
    let read = match header.encoding {
        Encoding::Text => plan.read(Text::new(&bytes[header.length..], header.lines)),
        encoding => plan.read(Binary::new(bytes, header.length, encoding)),
    };
    let (positions, triangles, normals) = read.map_err(|(place, fault)| fail(place, fault))?;
    let mut scene = Scene::new("");
    let mut mesh = Mesh::new(source.stem(), positions, triangles);
    mesh.shading.normals = Corners::of_vertices(normals);
    let mesh = scene.add_mesh(mesh);
    scene.add_node(None, source.stem(), Affine3A::IDENTITY, Some(mesh));
    Ok(scene)
}

/// What to look for where.
struct Plan<'a> {
    header: &'a Header,
    /// For each property of `vertex` the axis it gives, if any; 3 and more are those of the normal.
    axes: Vec<Option<usize>>,
    /// Whether vertices have normals.
    has_normals: bool,
    /// How many vertices there are said to be.
    vertices: usize,
    /// Which property of `face` lists its corners.
    corners: usize,
}

/// Vertices, triangles and, if vertices have them, their normals.
type Geometry = (Vec<Vec3>, Vec<[u32; 3]>, Vec<Vec3>);

impl<'a> Plan<'a> {
    fn of(header: &'a Header) -> Result<Self, (usize, Fault)> {
        let element = |name: &str, expected: &str| {
            let found = header.elements.iter().find(|element| element.name == name);
            found.ok_or_else(|| (header.lines, (format!("no element `{name}`"), expected.to_string())))
        };
        let vertex = element("vertex", "vertices")?;
        let face = element("face", "a mesh, not a cloud of points")?;
        let mut axes = vec![None; vertex.properties.len()];
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            match vertex.position(name).map(|at| (at, &vertex.properties[at])) {
                Some((at, Property::Number { .. })) => axes[at] = Some(axis),
                _ => return Err((vertex.line, (format!("no number `{name}`"), "x, y and z".to_string()))),
            }
        }
        let normal = ["nx", "ny", "nz"].map(|name| {
            let at = vertex.position(name)?;
            matches!(vertex.properties[at], Property::Number { .. }).then_some(at)
        });
        let has_normals = normal.iter().all(Option::is_some);
        for (axis, at) in normal.into_iter().enumerate().filter(|_| has_normals) {
            axes[at.expect("all are there")] = Some(3 + axis);
        }
        let corners = face.position("vertex_indices").or_else(|| face.position("vertex_index"));
        match corners.map(|at| (at, &face.properties[at])) {
            Some((corners, Property::List { item, .. })) if item.is_whole() => {
                Ok(Self { header, axes, has_normals, vertices: vertex.count, corners })
            }
            _ => {
                let expected = "a list `vertex_indices` or `vertex_index` of whole numbers";
                Err((face.line, ("no list of corners".to_string(), expected.to_string())))
            }
        }
    }

    /// Reads all elements, in the order of the header.
    fn read(&self, mut body: impl Body) -> Result<Geometry, (String, Fault)> {
        let (mut positions, mut triangles, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        for element in &self.header.elements {
            // So that a count that cannot be true neither takes memory nor time.
            let most = body.left() / element.least(self.header.encoding);
            if element.count > most {
                let found = format!("{} of element `{}`", element.count, element.name);
                let expected = format!("at most the {most} that the rest of the file can hold");
                return Err((format!("line {}", element.line), (found, expected)));
            }
            let read = match element.name.as_str() {
                "vertex" => self.read_vertices(element, &mut body, &mut positions, &mut normals),
                "face" => self.read_faces(element, &mut body, &mut triangles),
                _ => skip(element, &mut body),
            };
            read.map_err(|(item, fault)| (format!("{}, {} {item}", body.place(), element.name), fault))?;
        }
        body.finish().map_err(|fault| (body.place(), fault))?;
        Ok((positions, triangles, normals))
    }

    fn read_vertices(
        &self,
        element: &Element,
        body: &mut impl Body,
        positions: &mut Vec<Vec3>,
        normals: &mut Vec<Vec3>,
    ) -> Result<(), (usize, Fault)> {
        positions.reserve_exact(element.count);
        normals.reserve_exact(if self.has_normals { element.count } else { 0 });
        for number in 0..element.count {
            let at = |fault| (number, fault);
            body.next_item().map_err(at)?;
            let (mut position, mut normal) = ([0.0; 3], [0.0; 3]);
            for (property, axis) in element.properties.iter().zip(&self.axes) {
                match (property, axis) {
                    (Property::Number { kind, .. }, Some(axis @ 0..3)) => {
                        position[*axis] = body.coordinate(*kind).map_err(at)?;
                    }
                    (Property::Number { kind, .. }, Some(axis)) => {
                        normal[*axis - 3] = body.number(*kind).map_err(at)?;
                    }
                    _ => pass(property, body).map_err(at)?,
                }
            }
            positions.push(Vec3::from(position));
            if self.has_normals {
                // Scanners write NaN where they know none.
                let normal = Vec3::from(normal);
                normals.push(if normal.is_finite() { normal } else { Vec3::ZERO });
            }
        }
        Ok(())
    }

    fn read_faces(
        &self,
        element: &Element,
        body: &mut impl Body,
        triangles: &mut Vec<[u32; 3]>,
    ) -> Result<(), (usize, Fault)> {
        triangles.reserve_exact(element.count);
        for number in 0..element.count {
            let at = |fault| (number, fault);
            body.next_item().map_err(at)?;
            for (place, property) in element.properties.iter().enumerate() {
                match property {
                    Property::List { count, item, .. } if place == self.corners => {
                        self.read_fan(*count, *item, body, triangles).map_err(at)?;
                    }
                    _ => pass(property, body).map_err(at)?,
                }
            }
        }
        Ok(())
    }

    /// Reads the corners of a face as a fan about the first.
    fn read_fan(
        &self,
        count: Kind,
        item: Kind,
        body: &mut impl Body,
        triangles: &mut Vec<[u32; 3]>,
    ) -> Result<(), Fault> {
        let count = body.whole(count)?;
        let (mut first, mut last) = (0, 0);
        for place in 0..count {
            let corner = body.whole(item)?;
            if corner as usize >= self.vertices {
                let expected = format!("an index below {}", self.vertices);
                return Err((format!("vertex index {corner}"), expected));
            }
            match place {
                0 => first = corner,
                1 => {}
                _ => triangles.push([first, last, corner]),
            }
            last = corner;
        }
        Ok(())
    }
}

/// Passes over all items of an element.
fn skip(element: &Element, body: &mut impl Body) -> Result<(), (usize, Fault)> {
    for number in 0..element.count {
        let mut item = || {
            body.next_item()?;
            element.properties.iter().try_for_each(|property| pass(property, body))
        };
        item().map_err(|fault| (number, fault))?;
    }
    Ok(())
}

/// Passes over a property.
fn pass(property: &Property, body: &mut impl Body) -> Result<(), Fault> {
    match property {
        Property::Number { kind, .. } => body.skip(*kind, 1),
        Property::List { count, item, .. } => {
            let count = body.whole(*count)?;
            body.skip(*item, count as usize)
        }
    }
}

#[cfg(test)]
#[path = "ply_tests.rs"]
mod tests;
