//! From places in a mesh to places before the lens.

use glam::{Affine3A, DAffine3, DMat3, DVec3, Vec3};

use super::super::Camera;
use super::Corner;

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

/// A vertex as far as it can be worked out without the triangle it is of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spot {
    /// Where on the grid of pixels it is, if it `is_inside`.
    pub corner: Corner,
    /// Which planes of the view it is outside.
    pub outside: Outside,
    /// Whether it is inside all planes: a triangle of three such is not changed by clipping.
    pub is_inside: bool,
}

impl Outside {
    /// Whether some plane has all three points outside, so that nothing between them can be seen.
    #[inline]
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
        // Spelt out: a loop over these is not unrolled, and each vertex comes by here.
        let outside = u8::from(x < 0.0)
            | u8::from(x > self.size[0] * depth) << 1
            | u8::from(depth < self.near) << 2
            | u8::from(depth > self.far) << 3
            | u8::from(y < 0.0) << 4
            | u8::from(y > self.size[1] * depth) << 5;
        Seen { x, y, depth, outside: Outside(outside) }
    }

    /// Brings a vertex of the mesh before the lens and, if it needs no clipping, onto the grid of pixels.
    #[inline]
    pub fn spot(&self, vertex: Vec3) -> Spot {
        let seen = self.see(vertex);
        // A NaN is outside no plane and has no margin.
        let is_inside = seen.outside.0 == 0 && self.margins(&seen).iter().all(|margin| *margin >= 0.0);
        let corner = if is_inside { Corner::of(&seen) } else { Corner::default() };
        Spot { corner, outside: seen.outside, is_inside }
    }

    /// The six distances that must not be negative for a point to be drawn: near, far, and the edges of a
    /// guard band around the picture, within which coverage can be worked out in whole numbers.
    pub(super) fn margins(&self, at: &Seen) -> [f64; 6] {
        let guard = f64::from(super::fill::GUARD) * at.depth;
        [at.depth - self.near, self.far - at.depth, at.x + guard, guard - at.x, at.y + guard, guard - at.y]
    }
}
