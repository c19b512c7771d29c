//! The oracle of the culling kernels: the frustum as the convex body it is, in f64.
//!
//! Paper I sec. 3.1 and Fig. 2 own that plane tests are conservative: a box near an edge of the frustum
//! may pass as intersecting though it is outside. This is the exact answer they are held against: two
//! convex bodies are apart exactly if an axis among their face normals and the cross products of their
//! edges separates them. Slow and plain on purpose.

use glam::{DVec3, Vec3};

use super::{Aabb, Camera, PLANE_COUNT};

/// A frustum in f64, with coordinates relative to the eye.
#[derive(Clone, Copy, Debug)]
pub struct Hexahedron {
    pub(super) eye: DVec3,
    /// Bit 0 of the index is right, bit 1 is top, bit 2 is far.
    pub(super) corners: [DVec3; 8],
    /// Outward unit normal and distance term: left, right, near, far, up, down.
    pub(super) planes: [(DVec3, f64); PLANE_COUNT],
}

impl Hexahedron {
    /// The frustum of a camera.
    pub fn new(camera: &Camera) -> Self {
        let [right, up, forward] = [camera.right, camera.up, camera.forward].map(Vec3::as_dvec3);
        let tangents = camera.lens.tangents();
        let corners: [DVec3; 8] = std::array::from_fn(|i| {
            let depth = f64::from(if i & 4 == 0 { camera.near } else { camera.far });
            (forward + right * tangents[i & 1] + up * tangents[2 + (i >> 1 & 1)]) * depth
        });
        let centre = corners.iter().sum::<DVec3>() / 8.0;
        // Three corners of each face; the fourth lies with them since all faces are flat.
        let faces = [[0, 2, 4], [1, 3, 5], [0, 1, 2], [4, 5, 6], [2, 3, 6], [0, 1, 4]];
        let planes = faces.map(|[a, b, c]| {
            // The far corners of a side face measure its slope best, and a side face holds the eye.
            let normal = (corners[b] - corners[a]).cross(corners[c] - corners[a]).normalize();
            let d = -normal.dot(corners[a]);
            if normal.dot(centre) + d > 0.0 { (-normal, -d) } else { (normal, d) }
        });
        Self { eye: camera.eye.as_dvec3(), corners, planes }
    }

    /// Mean of the corners, relative to the eye.
    pub(super) fn centre(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / 8.0
    }

    /// Whether a box and the frustum have a point in common. An empty box has none; a box with a NaN
    /// may have any, so it counts as having one.
    pub fn intersects(&self, bounds: &Aabb) -> bool {
        if bounds.is_nan() {
            return true;
        }
        if bounds.is_empty() {
            return false;
        }
        let corners = self.relative_corners(bounds);
        let box_axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let edges = [
            self.corners[5] - self.corners[4],
            self.corners[6] - self.corners[4],
            self.corners[4],
            self.corners[5],
            self.corners[6],
            self.corners[7],
        ];
        let normals = self.planes.iter().map(|(normal, _)| *normal);
        let crosses = box_axes.iter().flat_map(|axis| edges.iter().map(|edge| axis.cross(*edge)));
        // A zero cross product (parallel edges) projects everything to 0 and so separates nothing.
        !box_axes.into_iter().chain(normals).chain(crosses).any(|axis| {
            let (low, high) = project(&self.corners, axis);
            let (box_low, box_high) = project(&corners, axis);
            box_low > high || box_high < low
        })
    }

    /// Whether a box lies wholly in the frustum. An empty box does; a box with a NaN does not.
    pub fn contains(&self, bounds: &Aabb) -> bool {
        if bounds.is_nan() || bounds.is_empty() {
            return !bounds.is_nan();
        }
        let corners = self.relative_corners(bounds);
        self.planes.iter().all(|(normal, d)| corners.iter().all(|corner| normal.dot(*corner) + d <= 0.0))
    }

    fn relative_corners(&self, bounds: &Aabb) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { bounds.min[axis] } else { bounds.max[axis] };
            DVec3::new(pick(0).into(), pick(1).into(), pick(2).into()) - self.eye
        })
    }
}

fn project(corners: &[DVec3; 8], axis: DVec3) -> (f64, f64) {
    corners
        .iter()
        .map(|corner| corner.dot(axis))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Lens;

    #[test]
    fn known_boxes() {
        let lens = Lens::Symmetric { fov_y: std::f32::consts::FRAC_PI_2, aspect: 1.0 };
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, lens, 1.0, 10.0).unwrap();
        let oracle = Hexahedron::new(&camera);
        let cube = |centre: Vec3, half: f32| Aabb { min: centre - half, max: centre + half };
        assert!(oracle.contains(&cube(Vec3::new(0.0, 0.0, -5.0), 1.0)));
        assert!(oracle.intersects(&cube(Vec3::new(5.0, 0.0, -5.0), 0.1)));
        assert!(!oracle.contains(&cube(Vec3::new(5.0, 0.0, -5.0), 0.1)));
        assert!(!oracle.intersects(&cube(Vec3::new(0.0, 0.0, 1.0), 1.9)));
        // Beyond a far corner: no frustum plane separates it, an edge does (Paper I Fig. 2).
        let slab = Aabb { min: Vec3::new(9.5, -30.0, -30.0), max: Vec3::new(30.0, 30.0, -9.8) };
        assert!(oracle.intersects(&slab));
        let beyond = Aabb { min: Vec3::new(9.95, -30.0, -30.0), max: Vec3::new(30.0, 30.0, -9.96) };
        assert!(oracle.intersects(&beyond));
        let apart = Aabb { min: Vec3::new(9.99, -30.0, -9.98), max: Vec3::new(30.0, 30.0, 30.0) };
        assert!(!oracle.intersects(&apart));
        let everything = cube(Vec3::ZERO, 1e30);
        assert!(oracle.intersects(&everything) && !oracle.contains(&everything));
        assert!(!oracle.intersects(&Aabb::EMPTY) && oracle.contains(&Aabb::EMPTY));
    }
}
