//! Cameras: where a frustum stands and how wide it opens.

use glam::{DVec3, Vec3};
use thiserror::Error;

/// How wide a camera opens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Opens evenly about the line of sight.
    Symmetric {
        /// Full vertical angle, in radians, between 0 and pi.
        fov_y: f32,
        /// Width over height of the picture.
        aspect: f32,
    },
    /// Opens unevenly, as walls of a CAVE and head-tracked screens do. The octant test refuses it
    /// (Paper I sec. 3.3). Each number is a tangent: the edge's offset from the line of sight, in
    /// metres, one metre in front of the eye; left and bottom are usually negative.
    OffAxis {
        /// Left edge.
        left: f32,
        /// Right edge, greater than `left`.
        right: f32,
        /// Bottom edge.
        bottom: f32,
        /// Top edge, greater than `bottom`.
        top: f32,
    },
}

/// A perspective camera. Axes are of unit length and at right angles; `right x up = -forward`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is, in metres.
    pub eye: Vec3,
    /// To the right of the picture.
    pub right: Vec3,
    /// To the top of the picture.
    pub up: Vec3,
    /// Along the line of sight.
    pub forward: Vec3,
    /// How wide the camera opens.
    pub lens: Lens,
    /// Distance of the near plane, in metres, above 0.
    pub near: f32,
    /// Distance of the far plane, in metres, above `near`.
    pub far: f32,
}

/// Why a camera cannot be made.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum CameraError {
    /// A number is NaN or infinite.
    #[error("a camera value is not finite; expected finite numbers")]
    NotFinite,
    /// The point looked at is the eye.
    #[error("the point looked at is the eye; expected two different points")]
    NoDirection,
    /// The up direction is zero or along the line of sight.
    #[error("the up direction is zero or along the line of sight; expected a direction across it")]
    NoUp,
    /// The lens opens to nothing, or to a half-space or more.
    #[error(
        "the lens does not open; expected 0 < fov_y < 180 degrees, aspect > 0, left < right, bottom < top"
    )]
    Lens,
    /// The depth range is empty.
    #[error("near {near}, far {far}; expected 0 < near < far")]
    Depth {
        /// Distance asked for the near plane, in metres.
        near: f32,
        /// Distance asked for the far plane, in metres.
        far: f32,
    },
}

impl Camera {
    /// A camera at `eye` looking at `look`, both in metres.
    ///
    /// # Errors
    /// [`CameraError`] if a value is not finite, the two points are the same, `up` is zero or along the
    /// line of sight, the lens does not open, or not 0 < near < far.
    pub fn look_at(
        eye: Vec3,
        look: Vec3,
        up: Vec3,
        lens: Lens,
        near: f32,
        far: f32,
    ) -> Result<Self, CameraError> {
        if !(eye.is_finite() && look.is_finite() && up.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        lens.check()?;
        if !(near.is_finite() && far.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        if !(near > 0.0 && near < far) {
            return Err(CameraError::Depth { near, far });
        }
        // In f64, so that far from the origin the axes lose no more than the eye itself has lost.
        let forward = (look.as_dvec3() - eye.as_dvec3()).try_normalize().ok_or(CameraError::NoDirection)?;
        let up = up.as_dvec3().try_normalize().ok_or(CameraError::NoUp)?;
        let across = forward.cross(up);
        // Below this the two directions agree to within what their f32 coordinates can tell apart.
        if across.length() < 1e-6 {
            return Err(CameraError::NoUp);
        }
        let right = across.normalize();
        let up: DVec3 = right.cross(forward);
        Ok(Self {
            eye,
            right: right.as_vec3(),
            up: up.as_vec3(),
            forward: forward.as_vec3(),
            lens,
            near,
            far,
        })
    }
}

impl Lens {
    fn check(&self) -> Result<(), CameraError> {
        let opens = match *self {
            Self::Symmetric { fov_y, aspect } => {
                fov_y > 0.0 && fov_y < std::f32::consts::PI && aspect > 0.0 && aspect.is_finite()
            }
            Self::OffAxis { left, right, bottom, top } => {
                [left, right, bottom, top].iter().all(|t| t.is_finite()) && left < right && bottom < top
            }
        };
        if opens { Ok(()) } else { Err(CameraError::Lens) }
    }

    /// The four edges as tangents: left, right, bottom, top.
    pub fn tangents(&self) -> [f64; 4] {
        match *self {
            Self::Symmetric { fov_y, aspect } => {
                let top = (f64::from(fov_y) * 0.5).tan();
                let right = top * f64::from(aspect);
                [-right, right, -top, top]
            }
            Self::OffAxis { left, right, bottom, top } => [left, right, bottom, top].map(f64::from),
        }
    }

    /// Whether left mirrors right and bottom mirrors top, which the octant test needs.
    pub fn is_symmetric(&self) -> bool {
        let [left, right, bottom, top] = self.tangents();
        left == -right && bottom == -top
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LENS: Lens = Lens::Symmetric { fov_y: 1.0, aspect: 1.5 };

    #[test]
    fn axes_are_orthonormal() {
        let camera = Camera::look_at(
            Vec3::new(1e6, 2.0, 3.0),
            Vec3::new(1e6 + 4.0, 1.0, 9.0),
            Vec3::Y,
            LENS,
            0.1,
            10.0,
        );
        let camera = camera.unwrap();
        assert!(camera.right.dot(camera.up).abs() < 1e-6 && camera.right.dot(camera.forward).abs() < 1e-6);
        assert!((camera.right.cross(camera.up) + camera.forward).length() < 1e-6);
    }

    #[test]
    fn degenerate_cameras_are_refused() {
        let make = |look, up, lens, near, far| Camera::look_at(Vec3::ZERO, look, up, lens, near, far);
        assert_eq!(make(Vec3::ZERO, Vec3::Y, LENS, 0.1, 1.0), Err(CameraError::NoDirection));
        assert_eq!(make(Vec3::Y, Vec3::Y, LENS, 0.1, 1.0), Err(CameraError::NoUp));
        assert_eq!(make(Vec3::X, Vec3::ZERO, LENS, 0.1, 1.0), Err(CameraError::NoUp));
        assert_eq!(make(Vec3::NAN, Vec3::Y, LENS, 0.1, 1.0), Err(CameraError::NotFinite));
        assert!(matches!(make(Vec3::X, Vec3::Y, LENS, 1.0, 1.0), Err(CameraError::Depth { .. })));
        let shut = Lens::OffAxis { left: 1.0, right: 1.0, bottom: 0.0, top: 1.0 };
        assert_eq!(make(Vec3::X, Vec3::Y, shut, 0.1, 1.0), Err(CameraError::Lens));
        let wide = Lens::Symmetric { fov_y: 3.2, aspect: 1.0 };
        assert_eq!(make(Vec3::X, Vec3::Y, wide, 0.1, 1.0), Err(CameraError::Lens));
    }
}
