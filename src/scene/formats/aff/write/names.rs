//! Names without blanks, each of its own.

use std::collections::HashSet;
use std::path::Path;

use super::super::super::super::Scene;

/// What things are called in a file.
pub(super) struct Names {
    /// Motions, by number.
    pub(super) motions: Vec<String>,
    /// The files of textures, by number.
    pub(super) textures: Vec<String>,
}

impl Names {
    pub(super) fn of(scene: &Scene, stem: &str) -> Self {
        let mut taken = HashSet::from(["camera".to_owned()]);
        let camera = scene.animation.camera.map(|motion| motion as usize);
        let motions = scene.animation.motions.iter().enumerate().map(|(number, motion)| {
            if camera == Some(number) { "camera".to_owned() } else { new(&plain(&motion.name), &mut taken) }
        });
        let motions = motions.collect();
        let mut taken = HashSet::new();
        let textures = scene.textures.iter().map(|texture| {
            let own = Path::new(&texture.name).file_stem().unwrap_or_default().to_string_lossy();
            new(&format!("{}-{}", plain(stem), plain(&own)), &mut taken) + ".ppm"
        });
        Self { motions, textures: textures.collect() }
    }
}

/// What every system takes for a name and every reader for a word.
fn plain(name: &str) -> String {
    let plain =
        |letter: char| if letter.is_ascii_alphanumeric() || "-_".contains(letter) { letter } else { '_' };
    let name: String = name.chars().map(plain).collect();
    if name.is_empty() { "unnamed".to_owned() } else { name }
}

/// The name, with a number if others have it.
fn new(name: &str, taken: &mut HashSet<String>) -> String {
    let numbered = (2u32..).map(|number| format!("{name}_{number}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    // Of so many names one is free.
    names.find(|name| taken.insert(name.to_lowercase())).unwrap_or_default()
}
