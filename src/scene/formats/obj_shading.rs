//! What an OBJ file says about how its faces look: normals, texture coordinates and materials, for each triangle that
//! crate `tobj` makes of the faces, in their order. `tobj` would make a mesh of each material and mix up the corners of
//! faces that have only some of all this; and the graph is not to depend on what surfaces are made of.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use super::super::source::Source;
use super::super::{Corners, Material, Materials, Scene, SceneError, Shading};
use super::{mtl, texture};

/// For each triangle of a file where its shading is.
#[derive(Default)]
pub(super) struct Faces {
    coordinates: Vec<Vec2>,
    normals: Vec<Vec3>,
    triangles: Vec<Triangle>,
    taken: usize,
}

/// Numbers are `u32::MAX` where there is none.
#[derive(Clone, Copy)]
struct Triangle {
    coordinates: [u32; 3],
    normals: [u32; 3],
    material: u32,
}

impl Faces {
    /// Goes through a file that has been checked; adds its materials and textures to the scene, or warnings of those
    /// that cannot be had.
    ///
    /// # Errors
    /// [`SceneError`] for a library of materials that is there and is broken.
    pub(super) fn read(source: &Source, text: &str, scene: &mut Scene) -> Result<Self, SceneError> {
        let mut faces = Self::default();
        let mut library = Library::default();
        let mut material = u32::MAX;
        for line in text.lines() {
            let mut words = line.split_whitespace();
            let numbers = |words: std::str::SplitWhitespace<'_>| {
                let mut numbers = [0.0; 3];
                for (number, word) in numbers.iter_mut().zip(words) {
                    *number = word.parse().unwrap_or(0.0);
                }
                numbers
            };
            match words.next() {
                // Texture coordinates count from below there.
                Some("vt") => faces.coordinates.push({
                    let [u, v, _] = numbers(words);
                    Vec2::new(u, 1.0 - v)
                }),
                Some("vn") => faces.normals.push(Vec3::from(numbers(words))),
                // Both, as `tobj` does.
                Some("f" | "l") => faces.add(words, material),
                Some(key @ "mtllib") => library.open(source, line.trim()[key.len()..].trim(), scene)?,
                Some(key @ "usemtl") => material = library.find(line.trim()[key.len()..].trim(), scene),
                _ => {}
            }
        }
        Ok(faces)
    }

    fn add(&mut self, words: std::str::SplitWhitespace<'_>, material: u32) {
        let corners: Vec<[u32; 2]> = words.map(|corner| self.corner(corner)).collect();
        for pair in corners.windows(2).skip(1) {
            let fan = [corners[0], pair[0], pair[1]];
            let [coordinates, normals] = [0, 1].map(|part| fan.map(|corner| corner[part]));
            self.triangles.push(Triangle { coordinates, normals, material });
        }
    }

    /// Texture coordinate and normal of a corner `v/vt/vn`.
    fn corner(&self, corner: &str) -> [u32; 2] {
        let mut parts = corner.split('/').skip(1);
        [self.coordinates.len(), self.normals.len()].map(|count| {
            let index: i64 = parts.next().and_then(|part| part.parse().ok()).unwrap_or(0);
            match index {
                0 => u32::MAX,
                1.. => index as u32 - 1,
                _ => (count as i64 + index) as u32,
            }
        })
    }

    /// The shading of the next so many triangles; none if there are not as many, or too many altogether.
    pub(super) fn take(&mut self, count: usize) -> Option<Shading> {
        let triangles = self.triangles.get(self.taken..self.taken + count)?;
        self.taken += count;
        Some(Shading {
            materials: Materials::from_each(triangles.iter().map(|triangle| triangle.material).collect()),
            normals: gather(&self.normals, triangles.iter().map(|triangle| triangle.normals)),
            coordinates: gather(&self.coordinates, triangles.iter().map(|triangle| triangle.coordinates)),
        })
    }
}

/// The values that some triangles have, each once.
fn gather<T: Copy>(values: &[T], triangles: impl ExactSizeIterator<Item = [u32; 3]>) -> Corners<T> {
    let (mut number, mut kept) = (HashMap::new(), Vec::new());
    let mut keep = |index: u32| match values.get(index as usize) {
        Some(value) => *number.entry(index).or_insert_with(|| {
            kept.push(*value);
            kept.len() as u32 - 1
        }),
        None => u32::MAX,
    };
    let triangles: Vec<[u32; 3]> = triangles.map(|corners| corners.map(&mut keep)).collect();
    if kept.is_empty() { Corners::default() } else { Corners { values: kept, triangles: Some(triangles) } }
}

/// The materials read so far, by name.
#[derive(Default)]
struct Library {
    /// `u32::MAX` for those that were asked for and are not there.
    materials: HashMap<String, u32>,
    textures: HashMap<String, Option<u32>>,
    /// Whether a file of them is not there: then nobody need be told of each material as well.
    is_lacking: bool,
}

impl Library {
    /// Reads a file of materials: the whole line names one, or its words several.
    fn open(&mut self, source: &Source, names: &str, scene: &mut Scene) -> Result<(), SceneError> {
        let several: Vec<&str> = match source.has(names) {
            true => vec![names],
            false => names.split_whitespace().collect(),
        };
        for name in several {
            if !source.has(name) {
                self.is_lacking = true;
                scene.warnings.push(format!("materials {name:?} are not there: surfaces are grey"));
                continue;
            }
            let file = source.beside(name).display().to_string();
            let bytes = source.neighbour(name);
            let bytes = bytes.map_err(|error| SceneError::Read { file: file.clone(), source: error })?;
            for read in mtl::read(&file, &String::from_utf8_lossy(&bytes))? {
                let texture = read.texture.and_then(|name| self.texture(source, &name, scene));
                let name = read.material.name.clone();
                let number = scene.add_material(Material { texture, ..read.material });
                self.materials.insert(name, number);
            }
        }
        Ok(())
    }

    fn texture(&mut self, source: &Source, name: &str, scene: &mut Scene) -> Option<u32> {
        *self
            .textures
            .entry(name.to_owned())
            .or_insert_with(|| texture::take(scene, texture::read(source, name)))
    }

    fn find(&mut self, name: &str, scene: &mut Scene) -> u32 {
        *self.materials.entry(name.to_owned()).or_insert_with(|| {
            if !self.is_lacking {
                scene.warnings.push(format!("material {name:?} is in no library: its surfaces are grey"));
            }
            u32::MAX
        })
    }
}
