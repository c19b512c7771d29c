//! The layout of what a kept scene is seen with: materials, textures, lights, primitives, flocks, the shading of
//! meshes.

use glam::{Vec2, Vec3};

use super::layout::{Reader, put, put_count, put_words};
use crate::geometry::Sphere;
use crate::geometry::hit::Cone;
use crate::scene::{
    Corners, Flock, Material, Materials, PointLight, Primitive, Scene, Shading, Shape, Texture, View,
};

/// Stands for no texture and for no material.
const NONE: u32 = u32::MAX;

/// The parts of a scene after its meshes; `None` if a list is too long for its length.
pub(super) fn put_scene(out: &mut Vec<u8>, scene: &Scene) -> Option<()> {
    put_count(out, scene.materials.len())?;
    for material in &scene.materials {
        put(out, material.name.bytes())?;
        for colour in colours(material) {
            put_floats(out, &colour.to_array());
        }
        put_some(out, material.ambient);
        put_floats(out, &[material.index]);
        let words = [material.texture.unwrap_or(NONE), material.exponent, u32::from(material.fresnel)];
        out.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    }
    put_count(out, scene.textures.len())?;
    for texture in &scene.textures {
        put(out, texture.name.bytes())?;
        out.extend([texture.width, texture.height].iter().flat_map(|word| word.to_le_bytes()));
        put_count(out, texture.pixels.len())?;
        out.extend_from_slice(texture.pixels.as_flattened());
    }
    put_count(out, scene.lights.len())?;
    for light in &scene.lights {
        put_floats(out, &light.position.to_array());
        put_floats(out, &light.colour.to_array());
    }
    put_primitives(out, &scene.primitives)?;
    put_count(out, scene.flocks.len())?;
    for flock in &scene.flocks {
        put(out, flock.name.bytes())?;
        put_primitives(out, &flock.primitives)?;
        put_words(out, &flock.nodes)?;
    }
    out.push(u8::from(scene.view.is_some()));
    if let Some(view) = &scene.view {
        [view.eye, view.look, view.up].iter().for_each(|vector| put_floats(out, &vector.to_array()));
        put_floats(out, &[view.fov_y]);
    }
    put_some(out, scene.background);
    put_some(out, scene.ambient);
    put_count(out, scene.warnings.len())?;
    scene.warnings.iter().try_for_each(|warning| put(out, warning.bytes()))
}

fn put_primitives(out: &mut Vec<u8>, primitives: &[Primitive]) -> Option<()> {
    put_count(out, primitives.len())?;
    for primitive in primitives {
        // A sphere is a cone of one end here, told by what stands for its other radius.
        let (base, base_radius, tip, tip_radius) = match primitive.shape {
            Shape::Sphere(sphere) => (sphere.centre, sphere.radius, Vec3::ZERO, f32::NEG_INFINITY),
            Shape::Cone(cone) => (cone.base, cone.base_radius, cone.tip, cone.tip_radius),
        };
        put_floats(out, &base.to_array());
        put_floats(out, &[base_radius]);
        put_floats(out, &tip.to_array());
        put_floats(out, &[tip_radius]);
        out.extend(primitive.material.unwrap_or(NONE).to_le_bytes());
    }
    Some(())
}

/// The shading of a mesh.
pub(super) fn put_shading(out: &mut Vec<u8>, shading: &Shading) -> Option<()> {
    match &shading.materials {
        Materials::Unknown => put_words(out, &[])?,
        Materials::One(material) => put_words(out, &[*material])?,
        Materials::Each(each) => {
            // Told from one material for all by a word more.
            put_words(out, &[NONE, NONE])?;
            put_words(out, each)?;
        }
    }
    put_corners(out, &shading.normals, |normal| normal.to_array())?;
    put_corners(out, &shading.coordinates, |at| at.to_array())
}

fn put_corners<T: Copy, const N: usize>(
    out: &mut Vec<u8>,
    corners: &Corners<T>,
    numbers: impl Fn(T) -> [f32; N],
) -> Option<()> {
    put_count(out, corners.values.len())?;
    corners.values.iter().for_each(|value| put_floats(out, &numbers(*value)));
    out.push(u8::from(corners.triangles.is_some()));
    put_words(out, corners.triangles.as_deref().unwrap_or_default().as_flattened())
}

/// A colour that may be absent.
fn put_some(out: &mut Vec<u8>, colour: Option<Vec3>) {
    out.push(u8::from(colour.is_some()));
    put_floats(out, &colour.unwrap_or_default().to_array());
}

fn put_floats(out: &mut Vec<u8>, numbers: &[f32]) {
    out.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
}

fn colours(material: &Material) -> [Vec3; 5] {
    [material.diffuse, material.highlight, material.mirror, material.transmission, material.absorption]
}

/// Reads what [`put_scene`] wrote into a scene.
pub(super) fn read_scene(from: &mut Reader<'_>, scene: Scene) -> Option<Scene> {
    Some(Scene {
        materials: from.list(read_material)?,
        textures: from.list(read_texture)?,
        lights: from.list(|from| Some(PointLight { position: from.vector()?, colour: from.vector()? }))?,
        primitives: from.list(read_primitive)?,
        flocks: from.list(read_flock)?,
        view: read_view(from)?,
        background: read_some(from)?,
        ambient: read_some(from)?,
        warnings: from.list(Reader::text)?,
        ..scene
    })
}

fn some(index: u32) -> Option<u32> {
    Some(index).filter(|index| *index != NONE)
}

/// None twice: nothing that can be read, or no colour.
fn read_some(from: &mut Reader<'_>) -> Option<Option<Vec3>> {
    let [has_colour] = from.array()?;
    let colour = from.vector()?;
    Some((has_colour != 0).then_some(colour))
}

fn read_material(from: &mut Reader<'_>) -> Option<Material> {
    Some(Material {
        name: from.text()?,
        diffuse: from.vector()?,
        highlight: from.vector()?,
        mirror: from.vector()?,
        transmission: from.vector()?,
        absorption: from.vector()?,
        ambient: read_some(from)?,
        index: from.number()?,
        texture: some(from.word()?),
        exponent: from.word()?,
        fresnel: from.word()? != 0,
    })
}

fn read_texture(from: &mut Reader<'_>) -> Option<Texture> {
    let (name, width, height) = (from.text()?, from.word()?, from.word()?);
    Some(Texture { name, width, height, pixels: from.arrays()?.to_vec() })
}

/// None twice: nothing that can be read, or no view.
fn read_view(from: &mut Reader<'_>) -> Option<Option<View>> {
    let [has_view] = from.array()?;
    if has_view == 0 {
        return Some(None);
    }
    let (eye, look, up) = (from.vector()?, from.vector()?, from.vector()?);
    Some(Some(View { eye, look, up, fov_y: from.number()? }))
}

fn read_primitive(from: &mut Reader<'_>) -> Option<Primitive> {
    let (base, base_radius, tip, tip_radius) =
        (from.vector()?, from.number()?, from.vector()?, from.number()?);
    let shape = match tip_radius {
        f32::NEG_INFINITY => Shape::Sphere(Sphere { centre: base, radius: base_radius }),
        _ => Shape::Cone(Cone { base, base_radius, tip, tip_radius }),
    };
    Some(Primitive { shape, material: some(from.word()?) })
}

fn read_flock(from: &mut Reader<'_>) -> Option<Flock> {
    Some(Flock { name: from.text()?, primitives: from.list(read_primitive)?, nodes: from.words()? })
}

/// Reads what [`put_shading`] wrote.
pub(super) fn read_shading(from: &mut Reader<'_>) -> Option<Shading> {
    let materials = match from.words()?[..] {
        [] => Materials::Unknown,
        [material] => Materials::One(material),
        _ => Materials::Each(from.words()?),
    };
    Some(Shading {
        materials,
        normals: read_corners(from, |from| from.vector())?,
        coordinates: read_corners(from, |from| Some(Vec2::new(from.number()?, from.number()?)))?,
    })
}

fn read_corners<T>(
    from: &mut Reader<'_>,
    value: impl Fn(&mut Reader<'_>) -> Option<T>,
) -> Option<Corners<T>> {
    let values = from.list(value)?;
    let [has_triangles] = from.array()?;
    let words = from.words()?;
    let (triangles, rest) = words.as_chunks();
    rest.is_empty().then(|| Corners { values, triangles: (has_triangles != 0).then(|| triangles.to_vec()) })
}
