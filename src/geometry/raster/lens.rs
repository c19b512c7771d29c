//! From places in a mesh to places before the lens.

use glam::{Affine3A, DAffine3, DMat3, DVec3, Vec3};

use super::super::Camera;

/// How much narrower the depth range drawn is than the camera's, as a share: what culling has rightly left
/// out, because it lies just beyond the near or far plane, is never drawn for a rounding.
const HAIR: f64 = 1e-5;

/// A camera before a grid of pixels, and one placed mesh: brings a vertex of the mesh before the lens.
#[derive(Clone, Copy, Debug)]
pub struct Eye {
    to_lens: DAffine3,
    near: f64,
    far: f64,
    size: [f64; 2],
}

/// A vertex before the lens. Divided by `depth`, `x` and `y` are pixels from the upper left corner of the
/// picture; depth is metres along the line of sight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// To the right.
    pub x: f64,
    /// Downward.
    pub y: f64,
    /// Forward.
    pub depth: f64,
    /// Which planes of the view it is outside.
    pub outside: Outside,
}

/// The planes of the view that a point is outside, as bits: left, right, near, far, up, down.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outside(pub(super) u8);

impl Outside {
    /// Whether some plane has all three points outside, so that nothing between them can be seen.
    pub fn shared(self, other: Self, third: Self) -> bool {
        self.0 & other.0 & third.0 != 0
    }
}

impl Eye {
    /// A camera before a picture of `width` x `height` pixels, and a mesh placed by `world`. Worked out in
    /// f64, so that far from the origin nothing is lost but what the mesh's own coordinates have lost.
    pub fn new(camera: &Camera, [width, height]: [u32; 2], world: &Affine3A) -> Self {
        let [left, right, bottom, top] = camera.lens.tangents();
        let size = [width, height].map(f64::from);
        let axes = DMat3::from_cols(camera.right.as_dvec3(), camera.up.as_dvec3(), camera.forward.as_dvec3());
        let view = DAffine3::from_mat3(axes.transpose()) * DAffine3::from_translation(-camera.eye.as_dvec3());
        // The pixels per metre one metre before the eye, and where the line of sight meets the picture.
        let scale = [size[0] / (right - left), size[1] / (top - bottom)];
        let lens = DMat3::from_cols(
            DVec3::new(scale[0], 0.0, 0.0),
            DVec3::new(0.0, -scale[1], 0.0),
            DVec3::new(-left * scale[0], top * scale[1], 1.0),
        );
        let world = DAffine3 { matrix3: world.matrix3.as_dmat3(), translation: world.translation.as_dvec3() };
        Self {
            to_lens: DAffine3::from_mat3(lens) * view * world,
            near: f64::from(camera.near) * (1.0 + HAIR),
            far: f64::from(camera.far) * (1.0 - HAIR),
            size,
        }
    }

    /// Brings a vertex of the mesh before the lens.
    #[inline]
    pub fn see(&self, vertex: Vec3) -> Seen {
        let DVec3 { x, y, z: depth } = self.to_lens.transform_point3(vertex.as_dvec3());
        let sides = [
            x < 0.0,
            x > self.size[0] * depth,
            depth < self.near,
            depth > self.far,
            y < 0.0,
            y > self.size[1] * depth,
        ];
        let bits = sides.iter().zip(0..).map(|(side, bit)| u8::from(*side) << bit);
        Seen { x, y, depth, outside: Outside(bits.fold(0, |all, bit| all | bit)) }
    }

    /// The six distances that must not be negative for a point to be drawn: near, far, and the edges of a
    /// guard band around the picture, within which coverage can be worked out in whole numbers.
    pub(super) fn margins(&self, at: &Seen) -> [f64; 6] {
        let guard = f64::from(super::fill::GUARD) * at.depth;
        [at.depth - self.near, self.far - at.depth, at.x + guard, guard - at.x, at.y + guard, guard - at.y]
    }
}
