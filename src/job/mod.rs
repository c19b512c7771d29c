//! Jobs: work for a scheme, and the serial oracle each result is held against.

pub mod animate;
pub mod build;
pub mod collide;
pub mod cull;
pub mod cull_boxes;
pub mod draw;
pub mod rays;
pub mod synthetic;
pub mod synthetic_tiles;
pub mod trace;
