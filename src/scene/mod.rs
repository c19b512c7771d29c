//! What is modelled: a graph of transforms, meshes, what moves and when, camera paths; from files or generated.
//!
//! Lengths are in metres; y is up in generated scenes. A new file format is one file in `formats/` and
//! one line in its list; a new generator one file in `generate/` and one line in its list.

mod animation;
mod cache;
mod describe;
mod error;
mod formats;
mod generate;
mod graph;
mod movers;
mod names;
mod path;
mod primitive;
mod random;
mod repeat;
mod shading;
mod source;
mod validate;

pub use animation::{Animation, Bend, BendKey, Bent, Curve, HermiteKey, Motion, Pose, SplineKey};
pub use cache::{Cache, Origin};
pub use describe::{Description, describe};
pub use error::SceneError;
pub use formats::{FORMATS, Format, Written, load, to_aff};
pub use generate::{Aisles, GENERATORS, Generator, by_name};
pub use graph::{Mesh, Node, Scene};
pub use movers::Movers;
pub use path::{CameraPath, PATHS, PathKind, Waypoint};
pub use primitive::{Flock, Primitive, Shape};
pub use random::SplitMix64;
pub use shading::{Corners, Material, Materials, PointLight, Shading, Texture, View};
