//! Two levels: a hierarchy for each mesh in its own space, and one over the places where meshes stand.
//!
//! A mesh that stands in a thousand places is held once, and what moves as it is needs no more than a new top. A ray is
//! taken into a mesh's space ([`Place`]) and goes through the mesh's hierarchy there; its `t` stays the same.
//!
//! What is told is what a [`WideBvh`] over all triangles in the world tells, but for rounding: there corners are rounded
//! to f32 in the world, here rays are rounded to f32 in a mesh's space. Where meshes stand untransformed it is the same
//! bit for bit; of triangles of one mesh that share an edge no ray slips between either way, for all of them see the
//! same ray. Where two places are the same, the lowest number is told; where different ones bring triangles to the same
//! place, rounding decides.
//!
//! No hit is lost to the rounding of a ray on its way: it moves the ray, as seen from the world, by no more than 2^-19 of
//! the distances there are, times the place's skew, and the top takes every ray to be as wide as that. A mesh whose
//! place has no way back, or a skew above [`MOST_SKEW`], is held in the world's space as one more mesh.

mod together;

use super::build::{BuildError, Builder, Input};
use super::place::placed_box;
use super::traverse::{Count, Uncounted, in_packets};
use super::{BinaryBvh, BoxBvh, Intersector, Place, RayCounts, WideBvh};
use crate::geometry::hit::{TriangleTest, Watertight};
use crate::geometry::{Aabb, FineRay, Hit, Ray};
use crate::scene::Mesh;
use glam::{Affine3A, Vec3};

/// The greatest skew of a place: rays are as wide as 2^-19 times the greatest there is.
const MOST_SKEW: f64 = 64.0;
/// How far a ray may be off where a mesh's box test sees it, as a share of all distances: the slack of that test, 2^-20,
/// and the rounding of its origin and direction, 2^-24 each.
const ROUNDING: f64 = 1.0 / (1 << 19) as f64;

/// A mesh in a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Which mesh, by number.
    pub mesh: u32,
    /// What its first triangle is called in hits; the others follow.
    pub first: u32,
    /// From the mesh's space to the world's, in metres.
    pub transform: Affine3A,
}

/// Hierarchies over meshes, and one over the places where they stand.
#[derive(Clone, Debug)]
pub struct Instances<T: TriangleTest = Watertight> {
    /// By number of the mesh; of those that stand nowhere, none.
    meshes: Vec<Option<WideBvh<T>>>,
    /// Meshes in places that have no way back, in the world's space.
    fixed: Vec<WideBvh<T>>,
    /// In the order of the top's leaves.
    stand: Vec<Standing>,
    top: BoxBvh,
    /// How far a ray may be off.
    error: f64,
}

/// A mesh where it stands.
#[derive(Clone, Debug)]
struct Standing {
    /// None in the world's own space.
    place: Option<Place>,
    /// Among the meshes, or among the fixed.
    index: u32,
    /// Number of its first triangle.
    first: u32,
}

impl<T: TriangleTest> Instances<T> {
    /// Hierarchies over meshes in their places.
    ///
    /// # Errors
    /// [`BuildError`]: a triangle has no box, its corners being NaN; or the box of a mesh has none where it stands, being
    /// infinite.
    ///
    /// # Panics
    /// If there is no mesh of a placement's number, or a triangle of it has a corner that is none.
    pub fn new(meshes: &[Mesh], places: &[Placement], builder: &mut Builder) -> Result<Self, BuildError> {
        let mut made = Self {
            meshes: Vec::new(),
            fixed: Vec::new(),
            stand: Vec::new(),
            top: BoxBvh::default(),
            error: 0.0,
        };
        made.update(meshes, &[], places, builder)?;
        Ok(made)
    }

    /// Follows what has moved: the places of now, in any order, and the numbers of the meshes whose vertices or triangles
    /// are others than they were. Those have their hierarchies built anew, and so have meshes in places without a way
    /// back; those that stand nowhere lose theirs; the others keep theirs. What is not to be seen has no place.
    ///
    /// # Errors
    /// As [`Instances::new`]; then it is of no use until it has been updated without one.
    ///
    /// # Panics
    /// As [`Instances::new`].
    pub fn update(
        &mut self,
        meshes: &[Mesh],
        changed: &[u32],
        places: &[Placement],
        builder: &mut Builder,
    ) -> Result<(), BuildError> {
        self.meshes.resize_with(meshes.len(), || None);
        changed.iter().for_each(|mesh| self.meshes[*mesh as usize] = None);
        self.fixed.clear();
        let mut stand = Vec::with_capacity(places.len());
        let mut boxes = Vec::with_capacity(places.len());
        let mut used = vec![false; meshes.len()];
        let mut skew: f64 = 1.0;
        for place in places {
            let mesh = &meshes[place.mesh as usize];
            if mesh.triangles.is_empty() {
                continue;
            }
            let (index, way, around) = match Place::new(&place.transform) {
                Some((way, own)) if own <= MOST_SKEW => {
                    skew = skew.max(own);
                    let held = &mut self.meshes[place.mesh as usize];
                    let bvh = match held {
                        Some(bvh) => bvh,
                        None => held.insert(hierarchy(mesh, |corner| corner, builder)?),
                    };
                    used[place.mesh as usize] = true;
                    let boxes = bvh.outline().map(|bounds| placed_box(&bounds, &place.transform));
                    (place.mesh, Some(way), boxes.fold(Aabb::EMPTY, Aabb::union))
                }
                _ => {
                    let in_world = |corner| place.transform.transform_point3(corner);
                    let bvh = hierarchy(mesh, in_world, builder)?;
                    let around = bvh.outline().fold(Aabb::EMPTY, Aabb::union);
                    self.fixed.push(bvh);
                    (self.fixed.len() as u32 - 1, None, around)
                }
            };
            // Of triangles none of which can be hit nothing is left.
            if !around.is_empty() {
                stand.push(Standing { place: way, index, first: place.first });
                boxes.push(around);
            }
        }
        self.meshes.iter_mut().zip(used).filter(|(_, used)| !used).for_each(|(mesh, _)| *mesh = None);
        let mut binary = BinaryBvh::default();
        builder.build(&Input::of(&boxes), &mut binary)?;
        let (top, order) = BoxBvh::new(&binary, &boxes);
        self.stand = order.into_iter().map(|item| stand[item as usize].clone()).collect();
        self.top = top;
        self.error = skew * ROUNDING;
        Ok(())
    }

    /// As [`Instances::update`], but the meshes that are others than they were keep their hierarchies, which take in where
    /// their triangles are now ([`WideBvh::refit`]).
    ///
    /// # Errors
    /// As [`Instances::new`].
    ///
    /// # Panics
    /// As [`Instances::new`], or if a mesh has fewer triangles than it had.
    pub fn refit(
        &mut self,
        meshes: &[Mesh],
        changed: &[u32],
        places: &[Placement],
        builder: &mut Builder,
    ) -> Result<(), BuildError> {
        for number in changed {
            if let Some(Some(bvh)) = self.meshes.get_mut(*number as usize) {
                bvh.refit(&corners_of(&meshes[*number as usize], |corner| corner));
            }
        }
        self.update(meshes, &[], places, builder)
    }

    /// How many nodes and blocks a ray is expected to go through that meets the box around all, as
    /// [`WideBvh::expected_cost`] tells it, places of meshes taken as their boxes in the world.
    pub fn expected_cost(&self) -> f64 {
        let costs: Vec<f64> =
            self.meshes.iter().map(|bvh| bvh.as_ref().map_or(0.0, WideBvh::expected_cost)).collect();
        self.top.expected_cost(|place| match &self.stand[place] {
            Standing { place: Some(_), index, .. } => costs[*index as usize],
            fixed => self.bvh(fixed).expected_cost(),
        })
    }

    /// How many bytes the hierarchies and the places take.
    pub fn bytes(&self) -> usize {
        let meshes = self.meshes.iter().flatten().chain(&self.fixed).map(WideBvh::bytes);
        meshes.sum::<usize>() + self.top.bytes() + size_of_val(&self.stand[..])
    }

    /// How many hierarchies over triangles there are: one for each mesh that stands somewhere, and one for each place
    /// that has no way back.
    pub fn hierarchies(&self) -> usize {
        self.meshes.iter().flatten().count() + self.fixed.len()
    }

    /// What a ray meets first, and what it took to find it, which is added to `counts`: the nodes of both levels.
    pub fn closest_counted(&self, ray: &Ray, counts: &mut RayCounts) -> Option<Hit> {
        let mut below = RayCounts::default();
        let found = self.nearest(ray, counts, |bvh, ray| bvh.closest_counted(ray, &mut below));
        *counts += below;
        found
    }

    fn bvh(&self, standing: &Standing) -> &WideBvh<T> {
        match standing.place {
            Some(_) => self.meshes[standing.index as usize].as_ref().expect("a mesh that stands has one"),
            None => &self.fixed[standing.index as usize],
        }
    }

    fn nearest(
        &self,
        ray: &Ray,
        count: &mut impl Count,
        mut closest: impl FnMut(&WideBvh<T>, &Ray) -> Option<Hit>,
    ) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        self.top.walk_counted(&FineRay::from(ray), self.error, count, |place, far| {
            let standing = &self.stand[place];
            let ray = standing.take_in(&Ray { far, ..*ray });
            standing.offer(&mut nearest, closest(self.bvh(standing), &ray));
            nearest.map_or(far, |hit| hit.t)
        });
        nearest
    }
}

impl Standing {
    /// Takes a hit of its mesh if that is nearer than what is known, or as near and of a lower number.
    #[inline]
    fn offer(&self, nearest: &mut Option<Hit>, found: Option<Hit>) {
        let Some(hit) = found.map(|hit| Hit { item: self.first + hit.item, ..hit }) else { return };
        if nearest.is_none_or(|nearest| hit.t < nearest.t || hit.t == nearest.t && hit.item < nearest.item) {
            *nearest = Some(hit);
        }
    }

    #[inline]
    fn take_in(&self, ray: &Ray) -> Ray {
        match &self.place {
            Some(place) => place.take_in(ray).rounded(),
            None => *ray,
        }
    }
}

impl<T: TriangleTest> Intersector for Instances<T> {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.nearest(ray, &mut Uncounted, |bvh, ray| bvh.closest(ray))
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let mut met = false;
        self.top.walk(&FineRay::from(ray), self.error, |place, far| {
            let standing = &self.stand[place];
            met = self.bvh(standing).occluded(&standing.take_in(ray));
            if met { f32::NEG_INFINITY } else { far }
        });
        met
    }

    fn closest_coherent(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
        in_packets(rays, hits, |rays, hits| self.closest_together(rays, hits), |ray| self.closest(ray));
    }

    fn occluded_coherent(&self, rays: &[Ray], occluded: &mut [bool]) {
        let packet = |rays: &[Ray], occluded: &mut [bool]| self.occluded_together(rays, occluded);
        in_packets(rays, occluded, packet, |ray| self.occluded(ray));
    }
}

/// The corners of a mesh's triangles, each put where it belongs.
fn corners_of(mesh: &Mesh, put: impl Fn(Vec3) -> Vec3) -> Vec<[Vec3; 3]> {
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| put(mesh.positions[vertex as usize]));
    mesh.triangles.iter().map(corners).collect()
}

/// The hierarchy over a mesh's triangles, each corner put where it belongs.
fn hierarchy<T: TriangleTest>(
    mesh: &Mesh,
    put: impl Fn(Vec3) -> Vec3,
    builder: &mut Builder,
) -> Result<WideBvh<T>, BuildError> {
    let triangles = corners_of(mesh, put);
    let boxes: Vec<Aabb> = triangles.iter().map(|corners| Aabb::of_points(*corners)).collect();
    let mut binary = BinaryBvh::default();
    builder.build(&Input { boxes: &boxes, triangles: Some(&triangles) }, &mut binary)?;
    Ok(WideBvh::new(&binary, &triangles))
}

#[cfg(test)]
mod tests;
