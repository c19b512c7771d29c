//! The oracle of the culling tests: the frustum as the convex body it is, in f64.
//!
//! Paper I sec. 3.1 and Fig. 2 own that plane tests are conservative: a box near an edge of the frustum
//! may pass as intersecting though it is outside. This is the exact answer they are held against: two
//! convex bodies are apart exactly if an axis among their face normals and the cross products of their
//! edges separates them. Slow and plain on purpose.

mod ray;
mod slabs;
mod triangle;
mod triangle_pair;

use glam::{DVec3, Vec3};

pub use ray::{Crossing, nearest_crossing};
pub use triangle_pair::{GridPoint, triangles_meet};

use super::{Aabb, Camera, KDop, Obb, PLANE_COUNT, Sphere, Volume};

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

    /// Whether a volume and the frustum have a point in common. An empty one has none; one with a NaN may
    /// have any, so it counts as having one.
    pub fn intersects<V: Exact>(&self, volume: &V) -> bool {
        volume.is_nan() || !volume.is_empty() && volume.meets(self)
    }

    /// Whether a volume lies wholly in the frustum. An empty one does; one with a NaN does not.
    pub fn contains<V: Exact>(&self, volume: &V) -> bool {
        !volume.is_nan() && (volume.is_empty() || volume.lies_within(self))
    }

    /// Whether a body with these corners meets the frustum: `normals` are its faces', `edges` its edges'.
    fn meets(&self, corners: &[DVec3], normals: [DVec3; 3], edges: [DVec3; 3]) -> bool {
        let own_edges = [
            self.corners[5] - self.corners[4],
            self.corners[6] - self.corners[4],
            self.corners[4],
            self.corners[5],
            self.corners[6],
            self.corners[7],
        ];
        let own_normals = self.planes.iter().map(|(normal, _)| *normal);
        let crosses = edges.iter().flat_map(|axis| own_edges.iter().map(|edge| axis.cross(*edge)));
        // A zero cross product (parallel edges) projects everything to 0 and so separates nothing.
        !normals.into_iter().chain(own_normals).chain(crosses).any(|axis| {
            let (low, high) = project(&self.corners, axis);
            let (box_low, box_high) = project(corners, axis);
            box_low > high || box_high < low
        })
    }

    fn holds(&self, points: &[DVec3]) -> bool {
        self.planes.iter().all(|(normal, d)| points.iter().all(|point| normal.dot(*point) + d <= 0.0))
    }

    /// How far a point is from the frustum, in metres; 0 inside.
    fn distance(&self, point: DVec3) -> f64 {
        if self.holds(&[point]) {
            return 0.0;
        }
        // The corners of each face, in a ring.
        let faces = [[0, 2, 6, 4], [1, 3, 7, 5], [0, 1, 3, 2], [4, 5, 7, 6], [2, 3, 7, 6], [0, 1, 5, 4]];
        let ring = |face: [usize; 4]| face.map(|corner| self.corners[corner]);
        let to_faces = faces.into_iter().zip(&self.planes).filter_map(|(face, (normal, d))| {
            let [a, b, c, e] = ring(face);
            let foot = point - *normal * (normal.dot(point) + d);
            let sides = [(a, b), (b, c), (c, e), (e, a)].map(|(a, b)| (b - a).cross(foot - a).dot(*normal));
            let over = sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0);
            over.then(|| (point - foot).length())
        });
        let to_edges = faces.into_iter().flat_map(|face| {
            let [a, b, c, e] = ring(face);
            [(a, b), (b, c), (c, e), (e, a)].map(|(a, b)| {
                let t = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                (a + (b - a) * t - point).length()
            })
        });
        to_faces.chain(to_edges).fold(f64::INFINITY, f64::min)
    }
}

/// A volume whose place can be told exactly.
pub trait Exact: Volume {
    /// Whether it has a point in common with the frustum; it is neither empty nor NaN.
    fn meets(&self, frustum: &Hexahedron) -> bool;

    /// Whether it lies wholly in the frustum; it is neither empty nor NaN.
    fn lies_within(&self, frustum: &Hexahedron) -> bool;
}

impl Exact for Aabb {
    fn meets(&self, frustum: &Hexahedron) -> bool {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        frustum.meets(&relative(&self.corners(), frustum), axes, axes)
    }

    fn lies_within(&self, frustum: &Hexahedron) -> bool {
        frustum.holds(&relative(&self.corners(), frustum))
    }
}

impl Obb {
    /// Its corners relative to the eye, from what it is made of; [`Volume::corners`] are rounded.
    fn exact_corners(&self, frustum: &Hexahedron) -> [DVec3; 8] {
        let half = self.half().as_dvec3();
        let arms = [0, 1, 2].map(|axis| self.axes()[axis].as_dvec3() * half[axis]);
        let centre = self.centre().as_dvec3() - frustum.eye;
        std::array::from_fn(|i| {
            let arm = |axis: usize| if i >> axis & 1 == 0 { -arms[axis] } else { arms[axis] };
            centre + arm(0) + arm(1) + arm(2)
        })
    }
}

impl Exact for Obb {
    fn meets(&self, frustum: &Hexahedron) -> bool {
        let [x, y, z] = self.axes().map(Vec3::as_dvec3);
        frustum.meets(&self.exact_corners(frustum), [y.cross(z), z.cross(x), x.cross(y)], [x, y, z])
    }

    fn lies_within(&self, frustum: &Hexahedron) -> bool {
        frustum.holds(&self.exact_corners(frustum))
    }
}

impl Exact for Sphere {
    fn meets(&self, frustum: &Hexahedron) -> bool {
        frustum.distance(self.centre.as_dvec3() - frustum.eye) <= f64::from(self.radius)
    }

    fn lies_within(&self, frustum: &Hexahedron) -> bool {
        let centre = self.centre.as_dvec3() - frustum.eye;
        frustum.planes.iter().all(|(normal, d)| normal.dot(centre) + d <= -f64::from(self.radius))
    }
}

impl<const D: usize> Exact for KDop<D> {
    fn meets(&self, frustum: &Hexahedron) -> bool {
        let both = slabs::half_spaces(self, frustum.eye).into_iter().chain(frustum.planes);
        slabs::have_a_point(&both.collect::<Vec<_>>())
    }

    fn lies_within(&self, frustum: &Hexahedron) -> bool {
        frustum.holds(&slabs::vertices(&slabs::half_spaces(self, frustum.eye)))
    }
}

fn relative(corners: &[Vec3; 8], frustum: &Hexahedron) -> [DVec3; 8] {
    corners.map(|corner| corner.as_dvec3() - frustum.eye)
}

fn project(corners: &[DVec3], axis: DVec3) -> (f64, f64) {
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
