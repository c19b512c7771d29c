//! Jobs: work for a scheme, and the serial oracle each result is held against.

pub mod build;
pub mod collide;
pub mod cull;
pub mod cull_boxes;
pub mod draw;
pub mod synthetic;
