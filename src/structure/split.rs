//! A large mesh split into leaves that can be culled one by one: Bubenicek 2020, sec. 3 and 4.1.

use std::num::NonZeroUsize;
use std::ops::Range;

use glam::{Vec3, Vec3A};
use rayon::prelude::*;

use super::midpoint::{Items, Place, divide};
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
    /// While it works it takes 12 bytes a triangle and 16 a vertex more than what it returns.
    ///
    /// # Errors
    /// [`SplitError`] if a triangle names a vertex that does not exist or is not finite.
    pub fn new(mesh: &Mesh, most: NonZeroUsize) -> Result<Self, SplitError> {
        let places = check(mesh)?;
        let mut triangles = mesh.triangles.clone();
        let parts = divide(&Triangles { places: &places }, &mut triangles, most.get());
        let leaves = (0..).zip(&parts.nodes).filter(|(index, part)| part.end == index + 1);
        let leaves = leaves.map(|(_, part)| Leaf { triangles: part.start..part.stop, bounds: part.bounds });
        Ok(Self { triangles, leaves: leaves.collect(), medians: parts.medians, depth: parts.depth })
    }
}

/// The vertices, as registers hold them, of a mesh that can be split.
fn check(mesh: &Mesh) -> Result<Vec<Vec3A>, SplitError> {
    let name = || mesh.name.clone();
    if u32::try_from(mesh.triangles.len()).is_err() {
        return Err(SplitError::TooMany { mesh: name(), count: mesh.triangles.len() });
    }
    let count = mesh.positions.len();
    let exists = |triangle: &[u32; 3]| triangle.iter().all(|vertex| (*vertex as usize) < count);
    if let Some(triangle) = mesh.triangles.par_iter().position_first(|triangle| !exists(triangle)) {
        let found = mesh.triangles[triangle];
        return Err(SplitError::NoVertex { mesh: name(), triangle, found, count });
    }
    if let Some(vertex) = mesh.positions.par_iter().position_first(|place| !place.is_finite()) {
        return Err(SplitError::NotFinite { mesh: name(), vertex, found: mesh.positions[vertex] });
    }
    Ok(mesh.positions.par_iter().map(|place| Vec3A::from(*place)).collect())
}

/// Triangles by index.
struct Triangles<'a> {
    places: &'a [Vec3A],
}

impl Items for Triangles<'_> {
    type Item = [u32; 3];

    #[inline]
    fn place(&self, triangle: [u32; 3]) -> Place {
        let [a, b, c] = triangle.map(|vertex| self.places[vertex as usize]);
        Place { low: a.min(b).min(c), high: a.max(b).max(c), middle: (a + b + c) * (1.0 / 3.0) }
    }
}

#[cfg(test)]
#[path = "split_tests.rs"]
mod tests;
