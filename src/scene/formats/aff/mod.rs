//! AFF, the animated file format of BART (Lext, Assarsson and Möller 2000, Implementation notes; P3-06), and the
//! neutral file format NFF 3.9 (Haines 1987), of which it is a superset: words set apart by blanks, `#` and `%` begin
//! comments.
//!
//! | statement | what becomes of it |
//! |---|---|
//! | `v` | the scene's view; `hither` and `resolution` are read and left |
//! | `b`, `am` | its background and ambient light; where absent black and, in AFF, white |
//! | `l`, `la` | point lights, in the world's space wherever they stand; a named one follows the keys of its name |
//! | `f`, `fm` | the material of what follows, also beyond the file's end |
//! | `m` | a mesh, which all places share that a file is included in, if its material is the same there |
//! | `p`, `pp`, `tt`, `ttp` | triangles, concave polygons too; those that follow on one another are one mesh |
//! | `tpa` | a mesh that bends; those that follow on one another with the same times and looks are one |
//! | `s`, `c` | primitives; meshes where what is around moves, or is scaled unevenly |
//! | `i`, `d` | a file in the scene's own folder is read in place if its level of detail is not above that of `d` |
//! | `xs`, `x` | nodes; the one of `x` follows the keys of its name, and stands still if there are none |
//! | `k`, `a` | motions, and the time from the first to the last frame; the keys of `camera` move it |
//!
//! A material's `Ks` or specular colour is both its highlights' and its mirror's, `Shine` the exponent rounded, `T` the
//! share let through, unbent where the refractive index is 0. A texture is multiplied with the diffuse colour; its
//! coordinates are the scene's own. Faces are seen from both sides, also where a radius below 0 asks for the inside
//! alone. NFF leaves the brightness of lights that have no colour open: there they have `1 / sqrt(count)`.

use super::super::source::Source;
use super::super::{Scene, SceneError};

mod faces;
mod keys;
mod looks;
mod mesh;
mod parse;
mod place;
mod polygon;
mod round;
mod statement;
mod words;
mod write;

pub use write::{Written, to_aff};

/// Reads an AFF file and what it includes.
pub(super) fn load(source: &Source) -> Result<Scene, SceneError> {
    place::place(source, place::Dialect { ambient: Some(glam::Vec3::ONE), dims_lights: false })
}

/// Reads an NFF file.
pub(super) fn load_nff(source: &Source) -> Result<Scene, SceneError> {
    place::place(source, place::Dialect { ambient: None, dims_lights: true })
}

#[cfg(test)]
mod fuzz;
#[cfg(test)]
mod tests;
