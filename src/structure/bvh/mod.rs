//! Bounding volume hierarchies for rays: binary ones as their builders make them, and wide ones that rays go through;
//! and hierarchies of hierarchies, over meshes that are placed many times or move as they are.

mod binary;
pub mod build;
mod instances;
mod leaks;
mod place;
pub mod refit;
mod traverse;
mod wide;

pub use binary::{BinaryBvh, BinaryNode, BvhStatistics};
pub use instances::{Instances, Placement};
pub use leaks::{leaks, leaks_together};
pub use place::{Place, placed_box};
pub use traverse::{RayCounts, TriangleList};
pub use wide::{BoxBvh, WideBvh};

use crate::geometry::{Hit, Ray};

/// What answers for rays: a hierarchy, or a list gone through item by item.
///
/// Of hits equally near, the one with the lowest item number is told, so every structure over the same items tells the
/// same, bit for bit.
pub trait Intersector: Sync {
    /// The nearest hit.
    fn closest(&self, ray: &Ray) -> Option<Hit>;

    /// Whether there is any hit.
    fn occluded(&self, ray: &Ray) -> bool;

    /// The nearest hits of rays that start near one another and go much the same way.
    ///
    /// # Panics
    /// If there are not as many `hits` as `rays`.
    fn closest_coherent(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "a place for the hit of each ray");
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest(ray);
        }
    }

    /// Whether there is any hit, of rays as those of [`Intersector::closest_coherent`], or that end near one another as
    /// those towards one light do: the same as [`Intersector::occluded`] tells of each.
    ///
    /// # Panics
    /// If there are not as many `occluded` as `rays`.
    fn occluded_coherent(&self, rays: &[Ray], occluded: &mut [bool]) {
        assert_eq!(rays.len(), occluded.len(), "a place for the answer to each ray");
        for (ray, occluded) in rays.iter().zip(occluded) {
            *occluded = self.occluded(ray);
        }
    }
}
