//! What light makes of a scene's surfaces: materials, textures, point lights, and the normals and texture
//! coordinates of meshes. Colours are linear, red, green and blue, 1 being white; only the pixels of textures are
//! coded as sRGB.

use glam::{Vec2, Vec3};

use super::Scene;

/// What a surface does with light (Parker et al. 1999, sec. 3.1; PK-08). A term that is black is not evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// What it is called; need not be unique.
    pub name: String,
    /// Share scattered evenly; times the texture's colour, if there is one.
    pub diffuse: Vec3,
    /// Share scattered of light from everywhere, times the texture's colour; that of `diffuse` where absent.
    pub ambient: Option<Vec3>,
    /// By number among the scene's textures.
    pub texture: Option<u32>,
    /// Share of a light seen in the highlight's middle.
    pub highlight: Vec3,
    /// Exponent of the highlight: a whole number, at least 1; the greater the smaller it is.
    pub exponent: u32,
    /// Share mirrored, seen from straight above.
    pub mirror: Vec3,
    /// Share let through of what is not mirrored.
    pub transmission: Vec3,
    /// Whether more is mirrored the flatter it is looked at, all of it at last: Schlick's approximation.
    pub fresnel: bool,
    /// How much slower light is inside than outside; 1 does not bend it.
    pub index: f32,
    /// How fast light fades inside, a metre: of intensity I is left `I exp(-absorption * metres)`.
    pub absorption: Vec3,
}

impl Default for Material {
    /// A light matt grey.
    fn default() -> Self {
        Self::matt("", Vec3::splat(0.7))
    }
}

impl Material {
    /// A surface that scatters evenly.
    pub fn matt(name: impl Into<String>, diffuse: Vec3) -> Self {
        Self {
            name: name.into(),
            diffuse,
            ambient: None,
            texture: None,
            highlight: Vec3::ZERO,
            exponent: 1,
            mirror: Vec3::ZERO,
            transmission: Vec3::ZERO,
            fresnel: false,
            index: 1.0,
            absorption: Vec3::ZERO,
        }
    }

    /// Metal: mirrors and highlights in its own colour, whatever the angle.
    pub fn metal(name: impl Into<String>, colour: Vec3, exponent: u32) -> Self {
        Self { highlight: colour, mirror: colour, exponent, ..Self::matt(name, Vec3::ZERO) }
    }

    /// Glass and the like, of a refractive index: what is not mirrored goes through.
    pub fn dielectric(name: impl Into<String>, index: f32) -> Self {
        Self {
            transmission: Vec3::ONE,
            highlight: Vec3::splat(0.5),
            exponent: 200,
            ..Self::polished(name, Vec3::ZERO, index)
        }
    }

    /// A coat of a refractive index over an even colour: wood, marble.
    pub fn polished(name: impl Into<String>, diffuse: Vec3, index: f32) -> Self {
        let straight = (index - 1.0) / (index + 1.0);
        let mirror = Vec3::splat(straight * straight);
        Self { mirror, fresnel: true, index, ..Self::matt(name, diffuse) }
    }
}

/// A picture to lay on a surface. Texture coordinate (0, 0) is its upper left corner, (1, 1) its lower right one;
/// beyond, it repeats.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// What it is called: the name of its file.
    pub name: String,
    /// Pixels across, at least 1.
    pub width: u32,
    /// Pixels down, at least 1.
    pub height: u32,
    /// Red, green and blue, coded as sRGB, row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

/// A light without size, which shines evenly whatever the distance (Whitted 1980).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointLight {
    /// Where it is, in metres.
    pub position: Vec3,
    /// Its colour; 1 makes a white matt surface that faces it white.
    pub colour: Vec3,
}

/// Where a scene wants to be looked at from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the eye is, in metres.
    pub eye: Vec3,
    /// The point looked at, in metres.
    pub look: Vec3,
    /// To the top of the picture.
    pub up: Vec3,
    /// Full vertical angle, in radians.
    pub fov_y: f32,
}

/// Which material each triangle of a mesh has, by number among the scene's materials.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Materials {
    /// None that is known: the default one.
    #[default]
    Unknown,
    /// All the same.
    One(u32),
    /// One for each triangle; `u32::MAX` where none is known.
    Each(Vec<u32>),
}

impl Materials {
    /// That of a triangle.
    pub fn of(&self, triangle: usize) -> Option<u32> {
        match self {
            Self::Unknown => None,
            Self::One(material) => Some(*material),
            Self::Each(each) => each.get(triangle).copied().filter(|material| *material != u32::MAX),
        }
    }

    /// The same materials, by numbers that are greater by so much.
    fn renumber(&mut self, by: u32) {
        match self {
            Self::Unknown => {}
            Self::One(material) => *material += by,
            Self::Each(each) => {
                each.iter_mut().filter(|material| **material != u32::MAX).for_each(|m| *m += by)
            }
        }
    }

    /// As short as they can be said.
    pub(super) fn from_each(each: Vec<u32>) -> Self {
        match each.first() {
            Some(first) if each.iter().all(|material| material == first) => match *first {
                u32::MAX => Self::Unknown,
                material => Self::One(material),
            },
            Some(_) => Self::Each(each),
            None => Self::Unknown,
        }
    }

    /// The greatest number among them.
    pub(super) fn greatest(&self) -> Option<u32> {
        match self {
            Self::Unknown => None,
            Self::One(material) => Some(*material),
            Self::Each(each) => each.iter().copied().filter(|material| *material != u32::MAX).max(),
        }
    }
}

/// Values at the corners of a mesh's triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Corners<T> {
    /// The values.
    pub values: Vec<T>,
    /// For each triangle which values its corners have, `u32::MAX` for none; where absent, each vertex has the
    /// value of its own number.
    pub triangles: Option<Vec<[u32; 3]>>,
}

impl<T> Default for Corners<T> {
    fn default() -> Self {
        Self { values: Vec::new(), triangles: None }
    }
}

impl<T: Copy> Corners<T> {
    /// One value for each vertex.
    pub fn of_vertices(values: Vec<T>) -> Self {
        Self { values, triangles: None }
    }

    /// The values at the corners of a triangle, by its number and its vertices; none if a corner has none.
    pub fn of(&self, triangle: usize, vertices: [u32; 3]) -> Option<[T; 3]> {
        if self.values.is_empty() {
            return None;
        }
        let [a, b, c] = match &self.triangles {
            Some(triangles) => *triangles.get(triangle)?,
            None => vertices,
        };
        let value = |index: u32| self.values.get(index as usize).copied();
        Some([value(a)?, value(b)?, value(c)?])
    }
}

/// What a mesh has beside its shape, to be seen with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shading {
    /// What its triangles are made of.
    pub materials: Materials,
    /// Normals, of any length but 0, on the side that the triangles are anticlockwise from; none where a surface is
    /// not curved.
    pub normals: Corners<Vec3>,
    /// Texture coordinates.
    pub coordinates: Corners<Vec2>,
}

impl Scene {
    /// Takes over the materials, textures and warnings of another scene, whose meshes know them by their new numbers
    /// from then on.
    pub(super) fn take_look(&mut self, other: &mut Self) {
        let (materials, textures) = (self.materials.len() as u32, self.textures.len() as u32);
        for texture in other.materials.iter_mut().filter_map(|material| material.texture.as_mut()) {
            *texture += textures;
        }
        other.meshes.iter_mut().for_each(|mesh| mesh.shading.materials.renumber(materials));
        self.materials.append(&mut other.materials);
        self.textures.append(&mut other.textures);
        self.warnings.append(&mut other.warnings);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;

    #[test]
    fn what_is_taken_over_is_renumbered() {
        let part = |colour: f32| {
            let mut scene = Scene::new("part");
            scene.textures.push(Texture {
                name: "t".into(),
                width: 1,
                height: 1,
                pixels: vec![[colour as u8; 3]],
            });
            scene.add_material(Material { texture: Some(0), ..Material::matt("m", Vec3::splat(colour)) });
            let mut mesh = Mesh::new("m", vec![Vec3::ZERO; 3], vec![[0; 3]; 2]);
            mesh.shading.materials = Materials::from_each(vec![u32::MAX, 0]);
            scene.add_mesh(mesh);
            scene
        };
        let (mut whole, mut other) = (part(0.0), part(1.0));
        whole.take_look(&mut other);
        whole.meshes.append(&mut other.meshes);
        whole.validate().unwrap();
        let shading = &whole.meshes[1].shading;
        assert_eq!([shading.materials.of(0), shading.materials.of(1)], [None, Some(1)]);
        assert_eq!(whole.materials[1].texture, Some(1));
        assert_eq!((whole.materials[1].diffuse, whole.textures[1].pixels[0]), (Vec3::ONE, [1; 3]));
    }
}
