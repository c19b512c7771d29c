//! What is modelled beside meshes: spheres and cones, in the world's own space.

use glam::Vec3;

use crate::geometry::hit::Cone;
use crate::geometry::{Aabb, Sphere};

/// A shape that is no mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A ball's surface.
    Sphere(Sphere),
    /// The side of a cone, a cut-off cone or a cylinder, open at its ends.
    Cone(Cone),
}

/// A sphere or cone in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primitive {
    /// Its shape and place, in metres.
    pub shape: Shape,
    /// What it is made of, by number among the scene's materials; the default one where absent.
    pub material: Option<u32>,
}

impl Shape {
    /// A box around it, in metres.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Sphere(sphere) => {
                Aabb { min: sphere.centre - sphere.radius, max: sphere.centre + sphere.radius }
            }
            Self::Cone(cone) => cone.bounds(),
        }
    }

    /// The same somewhere else, so many metres away.
    pub(super) fn moved(self, by: Vec3) -> Self {
        match self {
            Self::Sphere(sphere) => Self::Sphere(Sphere { centre: sphere.centre + by, ..sphere }),
            Self::Cone(cone) => Self::Cone(Cone { base: cone.base + by, tip: cone.tip + by, ..cone }),
        }
    }

    /// Whether all its numbers are finite and no radius is negative.
    pub(super) fn is_sound(&self) -> bool {
        match self {
            Self::Sphere(sphere) => {
                sphere.centre.is_finite() && (0.0..f32::INFINITY).contains(&sphere.radius)
            }
            Self::Cone(cone) => {
                let radii = [cone.base_radius, cone.tip_radius];
                cone.base.is_finite()
                    && cone.tip.is_finite()
                    && radii.iter().all(|radius| (0.0..f32::INFINITY).contains(radius))
            }
        }
    }
}
