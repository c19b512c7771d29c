//! What is the same all over a triangle, made once for all who meet it one soon after the other.

use glam::{DVec3, Vec2, Vec3};

use super::World;
use super::surface::{APART, unit};

/// A triangle as shading wants it.
pub(super) struct Facet {
    /// In the world, in metres.
    pub(super) corners: [DVec3; 3],
    /// Of unit length, on the side that the corners are anticlockwise from; none of a triangle that is a line or a point.
    pub(super) flat: Option<Vec3>,
    /// How far from it rays that leave it start, in metres.
    pub(super) apart: f32,
    /// Normals at its corners, in the world; the longest about 1 long.
    pub(super) normals: Option<[Vec3; 3]>,
    /// By number among the scene's.
    pub(super) material: Option<u32>,
    /// Which texture, and where in it the corners are.
    pub(super) texture: Option<(u32, [Vec2; 3])>,
}

/// The facets of a wave.
#[derive(Default)]
pub(super) struct Facets {
    all: Vec<Facet>,
    /// Which items were asked about last, and where their facets are, by the last bits of the items.
    latest: [Option<(u32, u32)>; LATEST],
}

/// Nine hits of ten are of a triangle that is among so many.
const LATEST: usize = 16;

impl Facets {
    pub(super) fn clear(&mut self) {
        self.all.clear();
        self.latest = [None; LATEST];
    }

    /// Where the facet of a triangle is.
    #[inline(always)]
    pub(super) fn find(&mut self, world: &World, item: u32) -> u32 {
        let latest = &mut self.latest[item as usize % LATEST];
        if let Some((of, at)) = *latest
            && of == item
        {
            return at;
        }
        let at = self.all.len() as u32;
        self.all.push(Facet::new(world, item));
        *latest = Some((item, at));
        at
    }

    #[inline(always)]
    pub(super) fn at(&self, at: u32) -> &Facet {
        &self.all[at as usize]
    }
}

impl Facet {
    #[inline(always)]
    fn new(world: &World, item: u32) -> Self {
        let placed = world.placed(item);
        let (triangle, shading) = (placed.triangle, &placed.mesh.shading);
        let vertices = placed.mesh.triangles[triangle];
        let greatest =
            placed.corners.iter().fold(0.0, |most: f32, corner| most.max(corner.abs().max_element()));
        let [a, b, c] = placed.corners.map(|corner| corner.as_dvec3());
        let normals = shading.normals.of(triangle, vertices);
        let material = shading.materials.of(triangle);
        let texture = world.material(material).texture;
        Self {
            corners: [a, b, c],
            flat: unit((b - a).cross(c - a)),
            apart: APART * greatest,
            normals: normals.map(|normals| near_one(normals.map(|normal| *placed.normals * normal))),
            material,
            texture: texture.zip(shading.coordinates.of(triangle, vertices)),
        }
    }
}

/// Times a power of two by which the longest is about 1 long, as far as normal numbers go; if all are 0 they stay so.
#[inline(always)]
fn near_one(normals: [Vec3; 3]) -> [Vec3; 3] {
    let greatest = normals.iter().fold(0.0, |most: f32, normal| most.max(normal.abs().max_element()));
    let exponent = (greatest.to_bits() >> 23).clamp(1, 253);
    normals.map(|normal| normal * f32::from_bits((254 - exponent) << 23))
}
