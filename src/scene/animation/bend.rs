//! Shapes of bending meshes at a time.

use glam::Vec3;

use super::curve::between;
use super::{Bend, Bent};
use crate::geometry::Aabb;

impl Bend {
    /// The mesh's vertices and normals at a time in seconds, into memory that is used again.
    pub(super) fn shape(&self, time: f64, bent: &mut Bent) {
        bent.mesh = self.mesh;
        bent.positions.clear();
        bent.normals.clear();
        if let Some((a, b, share)) = between(&self.keys, |key| key.time, time) {
            let (a, b) = (&self.keys[a], &self.keys[b]);
            let mix = |(a, b): (&Vec3, &Vec3)| a.as_dvec3() * (1.0 - share) + b.as_dvec3() * share;
            bent.positions.extend(a.positions.iter().zip(&b.positions).map(|pair| mix(pair).as_vec3()));
            bent.normals.extend(a.normals.iter().zip(&b.normals).map(|(from, to)| {
                // Opposite normals cancel halfway: the one behind is kept then.
                let mixed = mix((from, to)).try_normalize().or_else(|| from.as_dvec3().try_normalize());
                mixed.unwrap_or_default().as_vec3()
            }));
        }
        bent.bounds = Aabb::of_points(bent.positions.iter().copied());
    }
}
