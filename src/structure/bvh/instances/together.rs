//! Rays that go much the same way, together through both levels: through the top as one, and from place to place on
//! into the meshes' spaces, where those that are still under way go on together or one by one, as a mesh finds best.
//!
//! Each is taken into a space as it is when it goes alone, and the top passes over no box that one of them meets alone,
//! so the answers are the same bit for bit.

use super::super::traverse::RAYS;
use super::{Instances, Intersector};
use crate::geometry::hit::TriangleTest;
use crate::geometry::{Hit, Ray};

/// Into how many places a packet may go before its rays go on by themselves: all of them go into each, where one by one
/// few would.
const MOST: usize = 4;

/// No ray.
const NONE: Ray = Ray { origin: glam::Vec3::ZERO, direction: glam::Vec3::ZERO, near: 0.0, far: 0.0 };

impl<T: TriangleTest> Instances<T> {
    /// What rays of a packet meet first, and whether it stayed together; none if they do not go the same way.
    pub(super) fn closest_together(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> Option<bool> {
        hits.fill(None);
        let stayed = self.walk_together(rays, |place, under_way, fars| {
            let standing = &self.stand[place];
            let (mut own, mut found) = ([NONE; RAYS], [None; RAYS]);
            let (own, found) = (&mut own[..under_way.len()], &mut found[..under_way.len()]);
            for (own, ray) in own.iter_mut().zip(under_way) {
                *own = standing.take_in(&Ray { far: fars[*ray], ..rays[*ray] });
            }
            self.bvh(standing).closest_coherent(own, found);
            for (ray, found) in under_way.iter().zip(found) {
                standing.offer(&mut hits[*ray], *found);
                fars[*ray] = hits[*ray].map_or(fars[*ray], |hit| hit.t);
            }
        })?;
        if !stayed {
            for (hit, ray) in hits.iter_mut().zip(rays) {
                // Nothing further than what it has by now is looked for.
                let far = hit.map_or(ray.far, |hit| hit.t);
                *hit = self.closest(&Ray { far, ..*ray }).or(*hit);
            }
        }
        Some(stayed)
    }

    /// Which rays of a packet meet anything, as [`Instances::closest_together`].
    pub(super) fn occluded_together(&self, rays: &[Ray], occluded: &mut [bool]) -> Option<bool> {
        occluded.fill(false);
        let stayed = self.walk_together(rays, |place, under_way, fars| {
            let standing = &self.stand[place];
            let (mut own, mut found) = ([NONE; RAYS], [false; RAYS]);
            let (own, found) = (&mut own[..under_way.len()], &mut found[..under_way.len()]);
            for (own, ray) in own.iter_mut().zip(under_way) {
                *own = standing.take_in(&rays[*ray]);
            }
            self.bvh(standing).occluded_coherent(own, found);
            for (ray, found) in under_way.iter().zip(found) {
                if *found {
                    (occluded[*ray], fars[*ray]) = (true, f32::NEG_INFINITY);
                }
            }
        })?;
        if !stayed {
            let under_way = occluded.iter_mut().zip(rays).filter(|(occluded, _)| !**occluded);
            under_way.for_each(|(occluded, ray)| *occluded = self.occluded(ray));
        }
        Some(stayed)
    }

    /// Goes through the places that rays may end in: tells each, which rays are still under way, and how far each reaches,
    /// which is shortened. Tells whether it came to the end; none if the rays do not go the same way.
    fn walk_together(
        &self,
        rays: &[Ray],
        mut place: impl FnMut(usize, &[usize], &mut [f32]),
    ) -> Option<bool> {
        let mut fars = [0.0; RAYS];
        fars.iter_mut().zip(rays).for_each(|(far, ray)| *far = ray.far);
        let fars = &mut fars[..rays.len()];
        let mut places = 0;
        let go_together = self.top.walk_together(rays, fars, self.error, |at, fars| {
            places += 1;
            if places > MOST {
                return false;
            }
            let mut under_way = [0; RAYS];
            let mut count = 0;
            for ray in (0..rays.len()).filter(|ray| fars[*ray] >= rays[*ray].near) {
                under_way[count] = ray;
                count += 1;
            }
            place(at, &under_way[..count], fars);
            true
        });
        go_together.then_some(places <= MOST)
    }
}
