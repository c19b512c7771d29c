//! Materials as `fm`.

use glam::Vec3;

use super::super::super::super::{Material, Scene};
use super::Out;

/// Which materials have been written.
#[derive(Default)]
pub(super) struct Finishes {
    /// The one that holds; at first there is none, which no material written later can say.
    holds: Option<Option<u32>>,
    used: Vec<bool>,
    /// Triangles with texture coordinates and no texture.
    pub(super) bare_coordinates: usize,
    /// Triangles that move and have a texture.
    pub(super) bent_textures: usize,
}

impl Out {
    /// Lets a material hold, or that of what has none.
    pub(super) fn finish(&mut self, scene: &Scene, material: Option<u32>) {
        self.finishes.used.resize(scene.materials.len(), false);
        if let Some(number) = material {
            self.finishes.used[number as usize] = true;
        }
        let holds = self.finishes.holds.replace(material);
        if holds == Some(material) || (holds.is_none() && material.is_none()) {
            return;
        }
        let unknown = Material::default();
        let material = material.map_or(&unknown, |number| &scene.materials[number as usize]);
        let ambient = material.ambient.unwrap_or(material.diffuse);
        self.text.push_str("fm");
        [ambient, material.diffuse, material.mirror].into_iter().for_each(|colour| self.vector(colour));
        self.numbers(&[material.exponent as f32, mean(material.transmission), material.index]);
        self.text.push_str(&format!(" # {:?}\n", material.name));
    }

    /// Warns of what AFF cannot say of the materials that were written.
    pub(super) fn tell_finishes(&mut self, scene: &Scene) {
        let used = scene.materials.iter().zip(&self.finishes.used).filter(|(_, used)| **used);
        let used: Vec<&Material> = used.map(|(material, _)| material).collect();
        type Is = fn(&Material) -> bool;
        let kinds: [(Is, &str); 4] = [
            (|m| m.highlight != m.mirror, "highlight otherwise than they mirror: written as they mirror"),
            (|m| m.fresnel, "mirror the more the flatter they are seen: written as seen from above"),
            (|m| m.absorption != Vec3::ZERO, "absorb light inside: left out"),
            (
                |m| m.transmission != Vec3::splat(mean(m.transmission)),
                "colour what they let through: written grey",
            ),
        ];
        for (is, what) in kinds {
            let those: Vec<&str> = used.iter().filter(|m| is(m)).map(|m| m.name.as_str()).collect();
            if let Some(first) = those.first() {
                self.warnings.push(format!("{} materials, {first:?} the first, {what}", those.len()));
            }
        }
        let (bare, bent) = (self.finishes.bare_coordinates, self.finishes.bent_textures);
        if bare > 0 {
            self.warnings.push(format!("{bare} triangles have texture coordinates and no texture: left out"));
        }
        if bent > 0 {
            self.warnings.push(format!("{bent} triangles move and have a texture: written without"));
        }
    }
}

fn mean(colour: Vec3) -> f32 {
    // So that what is grey stays what it is.
    if colour == Vec3::splat(colour.x) { colour.x } else { colour.element_sum() / 3.0 }
}
