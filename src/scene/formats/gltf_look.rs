//! The materials and pictures of a glTF file.
//!
//! What is rough or metallic (glTF 2.0, appendix B) is put into the terms there are: metal mirrors and highlights in its
//! base colour and scatters nothing, anything else highlights 4 % of white; the highlight is the smaller the smoother
//! the surface, and only what is nearly smooth is mirrored in. A base colour that is not opaque lets the rest through
//! unbent, if the material says so. Only the base colour's picture is read; it is white where it cannot be.

use std::collections::HashMap;

use glam::Vec3;
use gltf::material::AlphaMode;

use super::super::source::Source;
use super::super::{Material, Scene};
use super::gltf_buffers::{Buffers, unescape};
use super::{base64, texture};

/// Above this roughness a mirror image would be too blurred for one ray to stand for it.
const SMOOTH: f32 = 0.25;
/// What smooth plastic or glass mirrors, seen from straight above.
const PLASTIC: f32 = 0.04;

/// Adds all materials of a document, in its order.
pub(super) fn read(source: &Source, document: &gltf::Document, buffers: &Buffers<'_>, scene: &mut Scene) {
    let mut pictures: HashMap<usize, Option<u32>> = HashMap::new();
    for material in document.materials() {
        let pbr = material.pbr_metallic_roughness();
        let picture = pbr.base_color_texture().map(|info| info.texture().source()).and_then(|image| {
            *pictures.entry(image.index()).or_insert_with(|| picture(source, &image, buffers, scene))
        });
        let [red, green, blue, alpha] = pbr.base_color_factor();
        let opaque = if material.alpha_mode() == AlphaMode::Blend { alpha } else { 1.0 };
        let metallic = pbr.metallic_factor();
        let base = Vec3::new(red, green, blue) * opaque;
        let highlight = Vec3::splat(PLASTIC).lerp(base, metallic);
        let roughness = pbr.roughness_factor();
        // The Phong exponent whose highlight is as wide as that of a Beckmann distribution (Walter et al. 2007).
        let exponent = 2.0 / roughness.max(0.05).powi(4) - 2.0;
        scene.add_material(Material {
            texture: picture,
            highlight,
            exponent: exponent.round().clamp(1.0, 10_000.0) as u32,
            mirror: if roughness <= SMOOTH { highlight } else { Vec3::ZERO },
            transmission: Vec3::splat(1.0 - opaque),
            fresnel: roughness <= SMOOTH,
            ..Material::matt(material.name().unwrap_or(""), base * (1.0 - metallic))
        });
    }
}

/// Reads a picture; a warning if it cannot be had.
fn picture(
    source: &Source,
    image: &gltf::Image<'_>,
    buffers: &Buffers<'_>,
    scene: &mut Scene,
) -> Option<u32> {
    let name = image.name().map_or_else(|| format!("image {}", image.index()), str::to_owned);
    let read = match image.source() {
        gltf::image::Source::View { view, .. } => match buffers.view(&view) {
            Some(bytes) => texture::decode(&name, bytes),
            None => Err(format!("texture {name:?} lies beyond its buffer")),
        },
        gltf::image::Source::Uri { uri, .. } => match uri.strip_prefix("data:") {
            Some(rest) => match rest.split_once(";base64,").and_then(|(_, text)| base64::decode(text)) {
                Some(bytes) => texture::decode(&name, &bytes),
                None => Err(format!("texture {name:?} is a damaged data URI")),
            },
            None => texture::read(source, &unescape(uri)),
        },
    };
    texture::take(scene, read)
}
