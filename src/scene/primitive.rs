//! What is modelled beside meshes: spheres and cones, in the world's own space or, as flocks, in one of their own.

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

/// A sphere or cone in the world, or in the space of its flock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primitive {
    /// Its shape and place, in metres.
    pub shape: Shape,
    /// What it is made of, by number among the scene's materials; the default one where absent.
    pub material: Option<u32>,
}

/// Spheres and cones in a space of their own, which nodes place in the world as they place meshes: those that stand in
/// many places are held once. Only rays see them. A transform that does not keep lengths alike makes them what it makes
/// of them; one without an inverse makes nothing of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flock {
    /// What it is called; need not be unique.
    pub name: String,
    /// What it is made of.
    pub primitives: Vec<Primitive>,
    /// The nodes that place it, by number, each once.
    pub nodes: Vec<u32>,
}

impl Flock {
    /// A box around it in its own space, in metres; empty if there is nothing in it.
    pub fn bounds(&self) -> Aabb {
        let boxes = self.primitives.iter().map(|primitive| primitive.shape.bounds());
        boxes.fold(Aabb::EMPTY, Aabb::union)
    }
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
