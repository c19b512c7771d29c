//! Triangles on a grid of pixels: projection, clipping and coverage, just enough to draw a depth buffer.
//!
//! What holds: a pixel whose centre lies in a triangle is visited once, one on an edge that two triangles
//! share belongs to exactly one of them (the top-left rule), and neither the order of triangles nor what
//! else is drawn changes what a triangle covers or how deep it is there. Corners are snapped to 1/256 of a
//! pixel and coverage is worked out in whole numbers, so nothing of this is up to rounding.

mod clip;
mod fill;
mod lens;

pub use clip::Clipped;
pub use fill::{Corner, Coverage};
pub use lens::{Eye, Outside, Seen, Spot};

#[cfg(test)]
mod tests;
