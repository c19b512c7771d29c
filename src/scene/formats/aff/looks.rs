//! Materials and textures of a scene, each once.

use std::collections::HashMap;
use std::rc::Rc;

use glam::Vec3;

use super::super::super::source::Source;
use super::super::super::{Material, Scene};
use super::super::texture;
use super::place::within;
use super::statement::{Finish, Look};

/// Stands for no material.
pub(super) const UNKNOWN: u32 = u32::MAX;

/// What surfaces of the scene look like, by what files say of them.
#[derive(Default)]
pub(super) struct Looks {
    materials: HashMap<(Option<[u32; 13]>, Option<u32>), u32>,
    textures: HashMap<String, Option<u32>>,
}

impl Looks {
    /// The material of a look, by its number in the scene, called after the file that says it: `stem`, or the one
    /// that set what `holds` where that is included.
    pub(super) fn material(
        &mut self,
        look: &Look,
        holds: Option<&(Finish, Rc<str>)>,
        stem: &str,
        source: &Source,
        scene: &mut Scene,
    ) -> u32 {
        let (finish, stem) = match (&look.finish, holds) {
            (None, Some((finish, stem))) => (Some(*finish), &**stem),
            (finish, _) => (*finish, stem),
        };
        let texture = look.texture.as_deref().and_then(|name| self.texture(name, source, scene));
        if finish.is_none() && texture.is_none() {
            return UNKNOWN;
        }
        *self.materials.entry((finish.as_ref().map(Finish::key), texture)).or_insert_with(|| {
            let material = match &finish {
                Some(finish) => finish.material(stem),
                None => Material::matt(stem, Vec3::ONE),
            };
            scene.add_material(Material { texture, ..material })
        })
    }

    fn texture(&mut self, name: &str, source: &Source, scene: &mut Scene) -> Option<u32> {
        if let Some(known) = self.textures.get(name) {
            return *known;
        }
        let read = match within(name) {
            Some(name) => texture::read(source, &name),
            None => Err(format!("texture {name:?} lies outside of the scene's folder: it is not read")),
        };
        let number = texture::take(scene, read);
        self.textures.insert(name.to_owned(), number);
        number
    }
}

impl Finish {
    fn material(&self, name: &str) -> Material {
        Material {
            ambient: self.ambient,
            highlight: self.specular,
            mirror: self.specular,
            exponent: self.shine.round().max(1.0) as u32,
            transmission: Vec3::splat(self.transmission),
            index: if self.index > 0.0 { self.index } else { 1.0 },
            ..Material::matt(name, self.diffuse)
        }
    }
}
