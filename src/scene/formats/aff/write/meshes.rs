//! Meshes as `m`, and those that bend as `tpa`.

use std::collections::HashMap;
use std::fmt::Write as _;

use super::super::super::super::{Bend, Mesh, Scene};
use super::Out;

/// Triangles of a mesh that one `m` can hold.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Kind {
    material: Option<u32>,
    has_normals: bool,
    texture: Option<u32>,
}

impl Out {
    /// A mesh with its materials; through its key frames if it bends.
    pub(super) fn mesh(&mut self, scene: &Scene, mesh: &Mesh, bend: Option<&Bend>) {
        for (kind, triangles) in self.kinds(scene, mesh) {
            self.finish(scene, kind.material);
            match bend {
                Some(bend) => {
                    let count = triangles.len();
                    self.finishes.bent_textures += if kind.texture.is_some() { count } else { 0 };
                    triangles.iter().for_each(|triangle| self.bent(mesh, bend, *triangle));
                }
                None => self.still(mesh, kind, &triangles),
            }
        }
    }

    /// The triangles of each kind, the kinds in the order of their first.
    fn kinds(&mut self, scene: &Scene, mesh: &Mesh) -> Vec<(Kind, Vec<usize>)> {
        let mut kinds: Vec<(Kind, Vec<usize>)> = Vec::new();
        let mut known: HashMap<Kind, usize> = HashMap::new();
        let shading = &mesh.shading;
        for (triangle, vertices) in mesh.triangles.iter().enumerate() {
            let material = shading.materials.of(triangle);
            let texture = material.and_then(|material| scene.materials[material as usize].texture);
            let has_coordinates = shading.coordinates.of(triangle, *vertices).is_some();
            self.finishes.bare_coordinates += usize::from(has_coordinates && texture.is_none());
            let kind = Kind {
                material,
                has_normals: shading.normals.of(triangle, *vertices).is_some(),
                texture: texture.filter(|_| has_coordinates),
            };
            let at = *known.entry(kind).or_insert_with(|| {
                kinds.push((kind, Vec::new()));
                kinds.len() - 1
            });
            kinds[at].1.push(triangle);
        }
        kinds
    }

    fn still(&mut self, mesh: &Mesh, kind: Kind, triangles: &[usize]) {
        let shading = &mesh.shading;
        let vertices = |triangle: usize| mesh.triangles[triangle];
        let corners = |corners: Option<&Vec<[u32; 3]>>, triangle: usize| {
            corners.map_or(mesh.triangles[triangle], |list| list[triangle])
        };
        let normals = |triangle| corners(shading.normals.triangles.as_ref(), triangle);
        let coordinates = |triangle| corners(shading.coordinates.triangles.as_ref(), triangle);
        let positions = Used::of(triangles, vertices, mesh.positions.len());
        let _ = writeln!(self.text, "m\nvertices {}", positions.order.len());
        self.values(&positions.order, |index| mesh.positions[index as usize].to_array());
        let by_normal = kind.has_normals.then(|| Used::of(triangles, normals, shading.normals.values.len()));
        if let Some(used) = &by_normal {
            let _ = writeln!(self.text, "normals {}", used.order.len());
            self.values(&used.order, |index| shading.normals.values[index as usize].to_array());
        }
        let by_coordinate = kind.texture.map(|texture| {
            let used = Used::of(triangles, coordinates, shading.coordinates.values.len());
            let file = &self.names.textures[texture as usize];
            let _ = writeln!(self.text, "texturecoords {} {file}", used.order.len());
            self.values(&used.order, |index| shading.coordinates.values[index as usize].to_array());
            used
        });
        let _ = writeln!(self.text, "triangles {}", triangles.len());
        for triangle in triangles {
            let mut corners = positions.renumbered(vertices(*triangle)).to_vec();
            corners.extend(by_normal.iter().flat_map(|used| used.renumbered(normals(*triangle))));
            corners.extend(by_coordinate.iter().flat_map(|used| used.renumbered(coordinates(*triangle))));
            for corner in corners {
                let _ = write!(self.text, "{corner} ");
            }
            self.text.push('\n');
        }
    }

    fn values<const N: usize>(&mut self, order: &[u32], numbers: impl Fn(u32) -> [f32; N]) {
        for index in order {
            self.numbers(&numbers(*index));
            self.text.push('\n');
        }
    }

    /// One triangle of a mesh that bends. Where there are no normals, those of the triangle itself are written.
    fn bent(&mut self, mesh: &Mesh, bend: &Bend, triangle: usize) {
        let vertices = mesh.triangles[triangle];
        let _ = writeln!(self.text, "tpa {}", bend.keys.len());
        for key in &bend.keys {
            let _ = write!(self.text, "{}", key.time);
            let corners = vertices.map(|vertex| key.positions[vertex as usize]);
            let [a, b, c] = corners;
            let flat = [(b - a).as_dvec3().cross((c - a).as_dvec3()).normalize_or_zero().as_vec3(); 3];
            let by_normal = mesh.shading.normals.triangles.as_ref().map_or(vertices, |list| list[triangle]);
            let [a, b, c] = by_normal.map(|normal| key.normals.get(normal as usize).copied());
            let normals = a.zip(b).zip(c).map(|((a, b), c)| [a, b, c]);
            for (corner, normal) in corners.into_iter().zip(normals.unwrap_or(flat)) {
                self.vector(corner);
                self.vector(normal);
            }
            self.text.push('\n');
        }
    }
}

/// Which values some triangles use, and their numbers when no others are there.
struct Used {
    order: Vec<u32>,
    new: HashMap<u32, u32>,
}

impl Used {
    /// All in their order if that is as good: then a mesh of one kind is read back as it was.
    fn of(triangles: &[usize], corners: impl Fn(usize) -> [u32; 3], count: usize) -> Self {
        let mut used: Vec<u32> = triangles.iter().flat_map(|triangle| corners(*triangle)).collect();
        used.sort_unstable();
        used.dedup();
        if used.len() == count {
            return Self { order: used, new: HashMap::new() };
        }
        let new = used.iter().zip(0..).map(|(old, new)| (*old, new)).collect();
        Self { order: used, new }
    }

    fn renumbered(&self, corners: [u32; 3]) -> [u32; 3] {
        corners.map(|corner| if self.new.is_empty() { corner } else { self.new[&corner] })
    }
}
