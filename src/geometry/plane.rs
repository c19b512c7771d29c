//! A plane with an outward normal.

use glam::Vec3;

use super::Aabb;

/// How many planes a frustum has; they are kept in the order left, right, near, far, up, down, which
/// is the order plane-coherency goes through them (Paper I sec. 3.2).
pub const PLANE_COUNT: usize = 6;

/// A plane `normal . x + d = 0` of a convex body; its normal points out of the body, so that a point is
/// outside when `normal . x + d > 0` (Paper I sec. 3).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plane {
    /// Unit normal, pointing outward.
    pub normal: Vec3,
    /// Distance term, in metres.
    pub d: f32,
}

impl Plane {
    /// Signed distance of a point, in metres; positive outside.
    #[inline]
    pub fn distance(&self, point: Vec3) -> f32 {
        self.normal.dot(point) + self.d
    }

    /// Signed distances of a box's n-vertex (the corner deepest inside) and p-vertex (the corner
    /// furthest outside), in metres: what the translation step of temporal coherence keeps for each box
    /// (Paper I sec. 3.1, 3.5).
    #[inline]
    pub fn extremes(&self, bounds: &Aabb) -> (f32, f32) {
        let inward = self.normal.cmplt(Vec3::ZERO);
        let n_vertex = Vec3::select(inward, bounds.max, bounds.min);
        let p_vertex = Vec3::select(inward, bounds.min, bounds.max);
        (self.distance(n_vertex), self.distance(p_vertex))
    }
}
