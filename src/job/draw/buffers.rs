//! Vertices and triangles as a draw call reads them: one after the other.
//!
//! The leaves of a mesh share its vertices, which lie here and there in it. Read from there for each copy of
//! the mesh, most of the time would go into waiting for memory; so each leaf has its vertices copied side
//! by side, as one would upload them to a graphics card.

use glam::Vec3;
use std::ops::Range;

use crate::structure::Split;

/// What the leaves of one mesh draw from.
pub(super) struct Buffers {
    vertices: Vec<Vec3>,
    /// By index into the leaf's own vertices.
    triangles: Vec<[u32; 3]>,
    /// Each leaf's vertices and triangles.
    leaves: Vec<[Range<usize>; 2]>,
}

impl Buffers {
    /// Copies what the leaves of a mesh need; each vertex once a leaf, in the order of first use.
    pub(super) fn new(positions: &[Vec3], split: &Split) -> Self {
        let mut buffers = Self { vertices: Vec::new(), triangles: Vec::new(), leaves: Vec::new() };
        buffers.triangles.reserve(split.triangles.len());
        // The leaf that last used a vertex, and its number there.
        let mut known = vec![(u32::MAX, 0); positions.len()];
        for (leaf, index) in split.leaves.iter().zip(0..) {
            let (first, start) = (buffers.vertices.len(), buffers.triangles.len());
            for triangle in &split.triangles[leaf.triangles.start as usize..leaf.triangles.end as usize] {
                let number = |vertex: u32| {
                    let known = &mut known[vertex as usize];
                    if known.0 != index {
                        *known = (index, (buffers.vertices.len() - first) as u32);
                        buffers.vertices.push(positions[vertex as usize]);
                    }
                    known.1
                };
                buffers.triangles.push(triangle.map(number));
            }
            buffers.leaves.push([first..buffers.vertices.len(), start..buffers.triangles.len()]);
        }
        buffers
    }

    /// A leaf's vertices and its triangles by index into these.
    pub(super) fn of_leaf(&self, leaf: u32) -> (&[Vec3], &[[u32; 3]]) {
        let [vertices, triangles] = self.leaves[leaf as usize].clone();
        (&self.vertices[vertices], &self.triangles[triangles])
    }
}
