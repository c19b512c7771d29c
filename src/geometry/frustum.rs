//! View frusta, made once a frame from a camera.

use glam::{DVec3, Vec3};

use super::oracle::Hexahedron;
use super::{Camera, PLANE_COUNT, Plane};

/// One plane as the kernels read it: relative to the eye, with the rounding of its own distance term
/// taken in advance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct KernelPlane {
    pub(super) normal: Vec3,
    /// Distance term less what rounding may have added to it: for claims of "outside".
    pub(super) low: f32,
    /// Distance term plus what rounding may have taken from it: for claims of "inside".
    pub(super) high: f32,
}

/// What a camera sees: a truncated pyramid, brought to world space once a frame (Paper I sec. 3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// The camera it is the view of.
    pub camera: Camera,
    /// The planes in the order left, right, near, far, up, down; unit normals, pointing out.
    pub planes: [Plane; PLANE_COUNT],
    /// The corners, in metres: bit 0 of the index is right, bit 1 is top, bit 2 is far.
    pub corners: [Vec3; 8],
    /// Mean of the corners, in metres: the `c_VF` of the octant test (Paper I sec. 3.3).
    pub centre: Vec3,
    /// Least distance from the centre to a plane, in metres: the `d1` of the octant test, once a frame
    /// (Paper I sec. 3.3). Rounded down, so that `d2 <= d1` is never granted by rounding.
    pub least_distance: f32,
    /// Unit axes that halve the frustum: right, up, forward.
    pub axes: [Vec3; 3],
    /// Whether the lens opens evenly about the line of sight.
    pub symmetric: bool,
    /// Where the eye is, in metres.
    pub eye: Vec3,
    pub(super) kernel: [KernelPlane; PLANE_COUNT],
    /// Depth of the centre before the eye, in metres.
    pub(super) middle_depth: f32,
}

impl Frustum {
    /// The frustum of a camera. Worked out in f64 and rounded once.
    pub fn new(camera: &Camera) -> Self {
        let exact = Hexahedron::new(camera);
        let eye = exact.eye;
        let least = exact
            .planes
            .iter()
            .map(|(normal, d)| -(normal.dot(exact.centre()) + d))
            .fold(f64::INFINITY, f64::min);
        let mut kernel = exact.planes.map(|(normal, d)| KernelPlane::new(normal, d));
        // They are parallel; the kernels that test them as a pair need it to the last bit.
        kernel[3].normal = -kernel[2].normal;
        Self {
            camera: *camera,
            planes: exact
                .planes
                .map(|(normal, d)| Plane { normal: normal.as_vec3(), d: (d - normal.dot(eye)) as f32 }),
            corners: exact.corners.map(|corner| (corner + eye).as_vec3()),
            centre: (exact.centre() + eye).as_vec3(),
            least_distance: (least * (1.0 - 1e-6)) as f32,
            axes: [camera.right, camera.up, camera.forward],
            symmetric: camera.lens.is_symmetric(),
            eye: camera.eye,
            middle_depth: camera.forward.as_dvec3().dot(exact.centre()) as f32,
            kernel,
        }
    }
}

impl KernelPlane {
    fn new(normal: DVec3, d: f64) -> Self {
        let slack = d.abs() * f64::from(super::culling::ROUNDING);
        Self { normal: normal.as_vec3(), low: (d - slack) as f32, high: (d + slack) as f32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Lens;

    fn camera(lens: Lens) -> Camera {
        let (eye, look) = (Vec3::new(3.0, 1.0, -2.0), Vec3::new(7.0, 2.0, 5.0));
        Camera::look_at(eye, look, Vec3::Y, lens, 0.5, 40.0).unwrap()
    }

    #[test]
    fn planes_hold_their_corners_and_face_outward() {
        for lens in [
            Lens::Symmetric { fov_y: 1.0, aspect: 4.0 / 3.0 },
            Lens::OffAxis { left: -0.2, right: 0.9, bottom: -0.8, top: 0.1 },
        ] {
            let frustum = Frustum::new(&camera(lens));
            // Which corners lie on left, right, near, far, up, down, by index bit and value.
            for (plane, (bit, value)) in
                frustum.planes.iter().zip([(0, 0), (0, 1), (2, 0), (2, 1), (1, 1), (1, 0)])
            {
                assert!((plane.normal.length() - 1.0).abs() < 1e-6);
                assert!(plane.distance(frustum.centre) < 0.0);
                for (index, corner) in frustum.corners.iter().enumerate() {
                    let distance = plane.distance(*corner);
                    if index >> bit & 1 == value {
                        assert!(distance.abs() < 1e-4, "corner {index} is {distance} off its plane");
                    } else {
                        assert!(distance < -1e-3);
                    }
                }
            }
        }
    }

    #[test]
    fn least_distance_is_the_least() {
        let frustum = Frustum::new(&camera(Lens::Symmetric { fov_y: 1.0, aspect: 1.0 }));
        let least = frustum.planes.iter().map(|p| -p.distance(frustum.centre)).fold(f32::MAX, f32::min);
        assert!(frustum.symmetric && frustum.least_distance <= least + 1e-4);
        assert!(frustum.least_distance > least * 0.999);
    }
}
