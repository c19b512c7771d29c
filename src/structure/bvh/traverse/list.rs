//! Triangles gone through one by one: what every hierarchy is held against.

use super::super::Intersector;
use super::nearest::Nearest;
use crate::geometry::hit::{Aim, Beam, Corners, Scale, TriangleTest, Watertight, meet};
use crate::geometry::{Hit, Ray};
use glam::Vec3;
use std::marker::PhantomData;

/// Triangles without a structure, by whose test `T` rays meet them.
///
/// It tells the same as a [`super::super::WideBvh`] over the same triangles, bit for bit.
#[derive(Clone, Debug)]
pub struct TriangleList<T: TriangleTest = Watertight> {
    scale: Scale,
    triangles: Vec<[Vec3; 3]>,
    test: PhantomData<T>,
}

impl<T: TriangleTest> TriangleList<T> {
    /// The list of these triangles, corners in metres.
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        let scale = Scale::of(triangles.iter().flatten().copied());
        let triangles = triangles.iter().map(|corners| corners.map(|corner| scale.point(corner))).collect();
        Self { scale, triangles, test: PhantomData }
    }
}

struct One<'a>(&'a [Vec3; 3]);

impl Corners<f32> for One<'_> {
    unsafe fn at(&self, corner: usize, axis: usize) -> f32 {
        self.0[corner][axis]
    }
}

impl<T: TriangleTest> Intersector for TriangleList<T> {
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        let aim = Aim::new(ray, self.scale)?;
        let mut nearest = Nearest::none(aim.far);
        // SAFETY: one lane needs no unit.
        let beam = unsafe { Beam::<f32>::one(&aim) };
        for (item, corners) in self.triangles.iter().enumerate() {
            // Also of an infinite corner the test would make NaN, but not of all.
            if !corners.iter().all(|corner| corner.is_finite()) {
                continue;
            }
            // SAFETY: as above.
            let found = unsafe { meet::<f32, T>(&beam, &One(corners)) };
            if let Some(found) = found.filter(|found| found.lanes & 1 == 1 && found.t >= aim.near) {
                nearest.offer(found.t, found.u, found.v, item as u32);
            }
        }
        nearest.hit(|t| aim.own_t(t))
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.closest(ray).is_some()
    }
}
