//! Boxes, planes, cameras, frusta: pure functions, f32 kernels with an f64 oracle beside them.
//!
//! Lengths are in metres, angles in radians, unless a line says otherwise. Nothing here allocates.

mod aabb;
mod box_block;
pub mod box_test;
mod camera;
pub mod contact;
pub mod culling;
mod frustum;
pub mod hit;
pub(crate) mod lanes;
pub mod oracle;
pub mod overlap;
mod plane;
pub mod raster;
mod ray;
mod rigid;
pub mod volume;

pub use aabb::Aabb;
pub use box_block::BoxBlock;
pub(crate) use box_block::around;
pub use box_test::{BoxTest, Kernel};
pub use camera::{Camera, CameraError, Lens};
pub use frustum::Frustum;
pub use lanes::Unit;
pub use overlap::Overlap;
pub use plane::{PLANE_COUNT, Plane};
pub use ray::{FineRay, Hit, Ray};
pub use rigid::Rigid;
pub use volume::{KDop, Movable, Obb, Sphere, Volume};
