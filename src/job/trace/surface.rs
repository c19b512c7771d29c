//! What is known of a surface where a ray meets it.

use std::sync::LazyLock;

use glam::{Affine3A, DMat3, DVec3, Vec2, Vec3};

use crate::geometry::{FineRay, Hit, Ray};
use crate::scene::{Material, Primitive, Shape, Texture};
use crate::structure::bvh::placed_box;

use super::World;
use super::flocks::way_in;

/// How far from a surface the rays that leave it start, as a share of the greatest coordinate of the shape: 32 units
/// in the last place of it. What is computed of a shape is wrong by a few of those, wherever it lies and however large
/// it is, so a bound of its own in metres is needed nowhere.
const APART: f32 = 1.0 / (1 << 19) as f32;

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
    fn material(&self, number: Option<u32>) -> &Material {
        number.map_or(&UNKNOWN, |number| &self.scene.materials[number as usize])
    }

    /// What is where a ray met an item.
    pub(super) fn surface(&self, ray: &Ray, hit: &Hit) -> Surface<'_> {
        if (hit.item as usize) < self.triangles() {
            return self.on_triangle(ray, hit);
        }
        let (primitive, transform) = self.primitive(hit.item);
        self.on_primitive(ray, hit.t, primitive, transform)
    }

    fn on_triangle(&self, ray: &Ray, hit: &Hit) -> Surface<'_> {
        let placed = self.placed(hit.item);
        let corners = placed.corners;
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        let (u, v) = (f64::from(hit.u), f64::from(hit.v));
        // From the corners and not along the ray, whose error grows with its length.
        let point = (a * (1.0 - u - v) + b * u + c * v).as_vec3();
        let facing = || -ray.direction.normalize_or_zero();
        let flat = unit((b - a).cross(c - a)).unwrap_or_else(facing);
        let vertices = placed.mesh.triangles[placed.triangle];
        let shading = &placed.mesh.shading;
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let smooth = shading.normals.of(placed.triangle, vertices).and_then(|normals| {
            let normal = normals.iter().zip(weights).fold(Vec3::ZERO, |sum, (n, w)| sum + *n * w);
            // An unused slot of a reader may be 0, and opposite normals cancel.
            unit((placed.normals * normal).as_dvec3())
        });
        let material = self.material(shading.materials.of(placed.triangle));
        let texture = material.texture.map(|texture| &self.scene.textures[texture as usize]);
        let coordinates = shading.coordinates.of(placed.triangle, vertices);
        let colour = texture
            .zip(coordinates)
            .map(|(texture, [a, b, c])| sample(texture, a * weights[0] + b * weights[1] + c * weights[2]));
        let greatest = corners.iter().fold(0.0, |most: f32, corner| most.max(corner.abs().max_element()));
        let colour = colour.unwrap_or(Vec3::ONE);
        let (diffuse, ambient) =
            (material.diffuse * colour, material.ambient.unwrap_or(material.diffuse) * colour);
        let (smooth, apart) = (smooth.unwrap_or(flat), APART * greatest);
        Surface { point, flat, smooth, material, diffuse, ambient, apart }
    }

    /// On a sphere or cone, in the world or in a space that `transform` takes to it.
    fn on_primitive(
        &self,
        ray: &Ray,
        t: f32,
        primitive: &Primitive,
        transform: Option<&Affine3A>,
    ) -> Surface<'_> {
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
fn unit(vector: DVec3) -> Option<Vec3> {
    vector.try_normalize().map(|unit| unit.as_vec3())
}

/// Linear colours of the 256 codes of sRGB (IEC 61966-2-1).
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|code| {
        let coded = code as f64 / 255.0;
        let linear = if coded <= 0.04045 { coded / 12.92 } else { ((coded + 0.055) / 1.055).powf(2.4) };
        linear as f32
    })
});

/// The colour of a texture, between the four pixels about a place.
pub(super) fn sample(texture: &Texture, at: Vec2) -> Vec3 {
    let size = Vec2::new(texture.width as f32, texture.height as f32);
    // Pixels count from their middles.
    let place = (at - at.floor()) * size - 0.5;
    let low = place.floor();
    let share = place - low;
    let wrapped = |at: f32, count: u32| (at as i64).rem_euclid(i64::from(count)) as usize;
    let pixel = |x: f32, y: f32| {
        let (x, y) = (wrapped(low.x + x, texture.width), wrapped(low.y + y, texture.height));
        let [r, g, b] = texture.pixels[y * texture.width as usize + x].map(|code| LINEAR[code as usize]);
        Vec3::new(r, g, b)
    };
    let upper = pixel(0.0, 0.0) * (1.0 - share.x) + pixel(1.0, 0.0) * share.x;
    let lower = pixel(0.0, 1.0) * (1.0 - share.x) + pixel(1.0, 1.0) * share.x;
    upper * (1.0 - share.y) + lower * share.y
}
