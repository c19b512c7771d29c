//! How a ray comes to a surface, and which ways light goes on from there.

use glam::Vec3;

use super::shade::power;
use super::surface::Surface;

/// A ray that comes to a surface, both seen from the side it comes from.
pub(super) struct Bounce {
    /// Where it goes, of unit length.
    direction: Vec3,
    pub(super) flat: Vec3,
    pub(super) smooth: Vec3,
    /// Whether it comes from the side of the surface's own normal.
    pub(super) outside: bool,
}

impl Bounce {
    #[inline(always)]
    pub(super) fn new(direction: Vec3, surface: &Surface<'_>) -> Self {
        let outside = direction.dot(surface.flat) <= 0.0;
        let side = |normal: Vec3| if outside { normal } else { -normal };
        let (flat, smooth) = (side(surface.flat), side(surface.smooth));
        // An interpolated normal that points into the shape, or away from who looks at it, tells nothing here.
        let usable = smooth.dot(flat) > 0.0 && smooth.dot(direction) < 0.0;
        Self { direction: direction.normalize(), flat, smooth: if usable { smooth } else { flat }, outside }
    }

    /// Where rays start that leave on this side.
    #[inline(always)]
    pub(super) fn above(&self, surface: &Surface<'_>) -> Vec3 {
        surface.point + self.flat * surface.apart
    }

    /// Where rays start that leave on the other side.
    #[inline(always)]
    pub(super) fn below(&self, surface: &Surface<'_>) -> Vec3 {
        surface.point - self.flat * surface.apart
    }

    /// The mirrored direction; about the flat normal where the other would send it into the shape.
    #[inline(always)]
    pub(super) fn mirrored(&self) -> Vec3 {
        // As long as the direction was, that is 1.
        let about = |normal: Vec3| self.direction - normal * (2.0 * self.direction.dot(normal));
        let mirrored = about(self.smooth);
        if mirrored.dot(self.flat) > 0.0 { mirrored } else { about(self.flat) }
    }

    /// The direction in which light goes on through the surface (Snell); none if it is wholly mirrored inside.
    #[inline(always)]
    pub(super) fn through(&self, surface: &Surface<'_>) -> Option<Vec3> {
        let index = surface.material.index;
        if index == 1.0 {
            return Some(self.direction);
        }
        let ratio = if self.outside { 1.0 / index } else { index };
        let cosine = -self.direction.dot(self.smooth);
        let square = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
        // So that NaN is none, too.
        if square >= 0.0 {
            let bent = self.direction * ratio + self.smooth * (ratio * cosine - square.sqrt());
            return bent.try_normalize();
        }
        None
    }

    /// The share of light that is mirrored.
    #[inline(always)]
    pub(super) fn mirrored_share(&self, surface: &Surface<'_>) -> Vec3 {
        let material = surface.material;
        if !material.fresnel {
            return material.mirror;
        }
        let through = self.through(surface);
        let cosine = match through {
            None => return Vec3::ONE,
            // Schlick's angle is the one in the thinner matter.
            Some(through) if !self.outside && material.index > 1.0 => -through.dot(self.smooth),
            Some(_) => -self.direction.dot(self.smooth),
        };
        material.mirror + (Vec3::ONE - material.mirror) * power((1.0 - cosine).clamp(0.0, 1.0), 5)
    }
}
