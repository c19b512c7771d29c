//! A large mesh split into leaves that can be culled one by one: Bubenicek 2020, sec. 3 and 4.1.

use std::num::NonZeroUsize;
use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use super::runs::{Divided, Runs};
use crate::geometry::Aabb;
use crate::scene::Mesh;

/// A leaf of a [`Split`]: some neighbouring triangles of the mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// Its triangles, by index into [`Split::triangles`]; never empty.
    pub triangles: Range<u32>,
    /// The smallest box around them, in the space of the mesh, in metres.
    pub bounds: Aabb,
}

/// A mesh's triangles in an order in which each leaf is a range. The vertices stay the mesh's: nothing is
/// copied but indices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Split {
    /// The mesh's triangles by vertex index, leaf by leaf; within a leaf in the mesh's own order, but for
    /// leaves cut at a median.
    pub triangles: Vec<[u32; 3]>,
    /// The leaves, depth-first; together they are all triangles.
    pub leaves: Vec<Leaf>,
    /// How many cuts had to be made at the median, since the midpoint would have cut nothing off or the
    /// depth was used up (see [`Split::new`]).
    pub medians: u32,
    /// Parts on the longest way from the whole mesh to a leaf; 0 for a mesh without triangles.
    pub depth: u32,
}

/// Why a mesh cannot be split.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplitError {
    /// A triangle names a vertex there is not.
    #[error("mesh {mesh:?}, triangle {triangle}: vertices {found:?}; expected indices below {count}")]
    NoVertex {
        /// The mesh's name.
        mesh: String,
        /// The triangle, by index.
        triangle: usize,
        /// The vertices it names.
        found: [u32; 3],
        /// How many there are.
        count: usize,
    },
    /// A vertex has no place.
    #[error("mesh {mesh:?}, vertex {vertex} is {found}; expected finite coordinates")]
    NotFinite {
        /// The mesh's name.
        mesh: String,
        /// The vertex, by index.
        vertex: usize,
        /// Where it is.
        found: Vec3,
    },
    /// More triangles than indices can tell apart.
    #[error("mesh {mesh:?}: {count} triangles; expected at most {}", u32::MAX)]
    TooMany {
        /// The mesh's name.
        mesh: String,
        /// How many there are.
        count: usize,
    },
}

impl Split {
    /// Splits a mesh until no leaf has more than `most` triangles: across the longest axis of a part's
    /// box, in its middle, each triangle going where its centroid lies (Bubenicek sec. 3; BU-Q01).
    ///
    /// That alone would not end where all centroids are the same, and would go down a step a triangle
    /// where each lies far beyond the next (BU-F06). A part of which the middle cuts nothing off is halved
    /// at the median centroid, and so is every part that lies deeper than
    /// `2 log2(triangles / most) + 8`; [`Split::medians`] counts them. Even without such a need leaves
    /// come out smaller than they could be: the thesis has 448 where 288 would do.
    ///
    /// Works on the threads of the current rayon pool; the result is the same whatever their number.
    /// While it works it takes some 5 bytes a triangle more than what it returns; some 160 if the mesh's
    /// triangles follow each other in no order.
    ///
    /// # Errors
    /// [`SplitError`] if a triangle names a vertex that does not exist or is not finite.
    pub fn new(mesh: &Mesh, most: NonZeroUsize) -> Result<Self, SplitError> {
        if u32::try_from(mesh.triangles.len()).is_err() {
            return Err(SplitError::TooMany { mesh: mesh.name.clone(), count: mesh.triangles.len() });
        }
        let is_finite = |places: &[Vec3]| places.iter().all(|place| place.is_finite());
        if !mesh.positions.par_chunks(1 << 14).all(is_finite) {
            return Err(fault(mesh));
        }
        let mut triangles = vec![[0; 3]; mesh.triangles.len()];
        let runs = Runs { vertices: &mesh.positions, triangles: &mesh.triangles };
        let Some(Divided { leaves, medians, depth }) = runs.divide(most.get(), &mut triangles) else {
            return Err(fault(mesh));
        };
        Ok(Self { triangles, leaves: leaves.concat(), medians, depth })
    }
}

/// The first fault of a mesh that has one.
fn fault(mesh: &Mesh) -> SplitError {
    let name = || mesh.name.clone();
    let count = mesh.positions.len();
    let exists = |triangle: &[u32; 3]| triangle.iter().all(|vertex| (*vertex as usize) < count);
    if let Some(triangle) = mesh.triangles.iter().position(|triangle| !exists(triangle)) {
        return SplitError::NoVertex { mesh: name(), triangle, found: mesh.triangles[triangle], count };
    }
    let vertex = mesh.positions.iter().position(|place| !place.is_finite());
    let vertex = vertex.expect("one of the two faults there are");
    SplitError::NotFinite { mesh: name(), vertex, found: mesh.positions[vertex] }
}

#[cfg(test)]
#[path = "split_tests.rs"]
mod tests;
