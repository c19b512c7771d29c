//! What is known of a surface where a ray meets it.

use std::sync::LazyLock;

use glam::{DMat3, DVec3, Vec3};

use crate::geometry::{FineRay, Hit, Ray};
use crate::scene::{Material, Shape};
use crate::structure::bvh::placed_box;

use super::World;
use super::facet::Facet;
use super::flocks::way_in;

/// How far from a surface the rays that leave it start, as a share of the greatest coordinate of the shape: 32 units
/// in the last place of it. What is computed of a shape is wrong by a few of those, wherever it lies and however large
/// it is, so a bound of its own in metres is needed nowhere.
pub(super) const APART: f32 = 1.0 / (1 << 19) as f32;

/// A point of a surface. Normals are of unit length and on the side the triangle is anticlockwise from, or outward.
pub(super) struct Surface<'a> {
    pub(super) point: Vec3,
    /// Of the shape itself.
    pub(super) flat: Vec3,
    /// As interpolated for shading.
    pub(super) smooth: Vec3,
    pub(super) material: &'a Material,
    /// Diffuse colour, with the texture.
    pub(super) diffuse: Vec3,
    /// What it scatters of ambient light, with the texture.
    pub(super) ambient: Vec3,
    /// How far from here rays that leave start, in metres.
    pub(super) apart: f32,
}

static UNKNOWN: LazyLock<Material> = LazyLock::new(Material::default);

impl World {
    pub(super) fn material(&self, number: Option<u32>) -> &Material {
        number.map_or(&UNKNOWN, |number| &self.scene.materials[number as usize])
    }

    /// What is where a ray met a triangle, which a texture tints.
    #[inline(always)]
    pub(super) fn on_triangle(&self, ray: &Ray, hit: &Hit, facet: &Facet, tint: Vec3) -> Surface<'_> {
        let [a, b, c] = facet.corners;
        let (u, v) = (f64::from(hit.u), f64::from(hit.v));
        // From the corners and not along the ray, whose error grows with its length.
        let point = (a * (1.0 - u - v) + b * u + c * v).as_vec3();
        let flat = facet.flat.unwrap_or_else(|| -ray.direction.normalize_or_zero());
        // An unused slot of a reader may be 0, and opposite normals cancel.
        let smooth = facet
            .normals
            .and_then(|[a, b, c]| (a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v).try_normalize());
        let material = self.material(facet.material);
        let (diffuse, ambient) =
            (material.diffuse * tint, material.ambient.unwrap_or(material.diffuse) * tint);
        let smooth = smooth.unwrap_or(flat);
        Surface { point, flat, smooth, material, diffuse, ambient, apart: facet.apart }
    }

    /// What is where a ray met a sphere or cone.
    pub(super) fn on_primitive(&self, ray: &Ray, hit: &Hit) -> Surface<'_> {
        let (primitive, transform) = self.primitive(hit.item);
        let t = hit.t;
        let way = transform.and_then(way_in);
        let own = way.map_or_else(|| FineRay::from(ray), |(place, _)| place.take_in(ray));
        let near = own.origin + own.direction * f64::from(t);
        let (mut point, mut normal) = match primitive.shape {
            Shape::Sphere(sphere) => {
                let centre = sphere.centre.as_dvec3();
                let out = (near - centre).normalize_or_zero();
                // Back onto the surface: along the ray it is as far off as the ray is long.
                (centre + out * f64::from(sphere.radius), unit(out))
            }
            Shape::Cone(cone) => (near, cone.normal(near.as_vec3())),
        };
        let mut bounds = primitive.shape.bounds();
        if let Some(transform) = transform {
            let matrix = transform.matrix3.as_dmat3();
            point = matrix * point + Vec3::from(transform.translation).as_dvec3();
            normal = normal.and_then(|normal| unit(normals(matrix) * normal.as_dvec3()));
            bounds = placed_box(&bounds, transform);
        }
        let mut greatest = bounds.min.abs().max(bounds.max.abs()).max_element();
        if let Shape::Cone(_) = primitive.shape {
            // As far off as the ray is long, in its last place.
            greatest = greatest.max(t * ray.direction.abs().max_element());
        }
        let normal = normal.unwrap_or_else(|| -ray.direction.normalize_or_zero());
        let (material, apart) = (self.material(primitive.material), APART * greatest);
        let (point, diffuse) = (point.as_vec3(), material.diffuse);
        let ambient = material.ambient.unwrap_or(diffuse);
        Surface { point, flat: normal, smooth: normal, material, diffuse, ambient, apart }
    }
}

/// Takes normals along with their surface, but for their length, also where it is mirrored.
fn normals(matrix: DMat3) -> DMat3 {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    let turned = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if x.dot(y.cross(z)) < 0.0 { -turned } else { turned }
}

/// Of unit length; none if it has no direction.
#[inline(always)]
pub(super) fn unit(vector: DVec3) -> Option<Vec3> {
    vector.try_normalize().map(|unit| unit.as_vec3())
}
