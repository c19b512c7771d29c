//! Ray tracing: a picture of a scene, shared out in tiles (Parker et al. 1999, sec. 2 and 3.1).
//!
//! 1. A [`World`] numbers what rays can meet: triangles, then spheres and cones.
//! 2. An [`Intersector`](crate::structure::bvh::Intersector) over that list answers for rays: a [`Hierarchy`], of
//!    one level or of two, or [`List`], the slow one.
//! 3. A [`Frame`] is the picture of one camera as independent pieces, tiles of 32 x 4 pixels, for any tile scheme;
//!    each processor writes the pixels of its own tiles into a [`Film`], and counts its rays.
//! 4. The [`Image`] is what the film holds, in linear colours, to be written as a file; a [`Video`] is many of them.
//!
//! The picture is the same bit for bit for every scheme, machine and processor count: a pixel depends on nothing but
//! its own rays, a hit is the same whatever answers for it, and no sum runs over processors.

mod bounce;
mod costs;
mod counts;
mod eye;
mod facet;
mod film;
mod flocks;
mod frame;
mod hierarchy;
mod image;
mod lighting;
mod list;
mod shade;
mod spots;
mod surface;
mod video;
mod waves;
mod world;

pub use costs::{Costed, TileCosts};
pub use counts::Counts;
pub use eye::{Eye, Projection, default_view, light_at, view_within};
pub use film::{Film, MOST_PIXELS};
pub use frame::{Draft, Frame, Tiles};
pub use hierarchy::{Hierarchy, Levels, TriangleKind};
pub use image::Image;
pub use list::List;
pub use shade::{Look, MOST_DEPTH, Tracer};
pub use video::{FrameRate, Video};
pub use world::{Items, World};

#[cfg(test)]
mod level_tests;
#[cfg(test)]
mod recursive;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod wave_tests;
