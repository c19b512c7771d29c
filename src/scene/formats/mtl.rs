//! Wavefront MTL: the materials of OBJ files. Read are `newmtl`, `Kd`, `Ks`, `Ns`, `Ni`, `d`, `Tr`, `Tf`, `illum` and
//! `map_Kd`; other lines are passed over.
//!
//! How light is mirrored and let through follows `illum`: 3 and more mirror by `Ks`, 5 and 7 the more the flatter they
//! are looked at, 4, 6 and 7 bend what they let through by `Ni`. How much is let through says `d`, or `Tr`, which is
//! `1 - d`, times the colour `Tf`. Colours are taken as linear.

use std::str::SplitWhitespace;

use glam::Vec3;

use super::super::{Material, SceneError};

/// A material, and the file of the picture laid on it.
#[derive(Debug)]
pub(super) struct Read {
    pub(super) material: Material,
    pub(super) texture: Option<String>,
}

/// What a material's lines say.
struct Lines {
    name: String,
    diffuse: Option<Vec3>,
    specular: Vec3,
    exponent: f32,
    index: f32,
    opaque: f32,
    filter: Vec3,
    model: u32,
    texture: Option<String>,
}

/// Reads all materials of a file.
///
/// # Errors
/// [`SceneError::Malformed`] naming the line.
pub(super) fn read(file: &str, text: &str) -> Result<Vec<Read>, SceneError> {
    let mut materials: Vec<Lines> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        read_line(line.trim(), &mut materials).map_err(|(found, expected)| {
            SceneError::malformed(file, format!("line {}", number + 1), found, expected)
        })?;
    }
    Ok(materials.into_iter().map(Lines::finish).collect())
}

type Fault = (String, &'static str);

fn read_line(line: &str, materials: &mut Vec<Lines>) -> Result<(), Fault> {
    let mut words = line.split_whitespace();
    let Some(key) = words.next() else { return Ok(()) };
    let rest = line[key.len()..].trim();
    if key == "newmtl" {
        materials.push(Lines::new(rest));
        return Ok(());
    }
    let known = ["Kd", "Ks", "Ns", "Ni", "d", "Tr", "Tf", "illum", "map_Kd"];
    if !known.contains(&key) {
        return Ok(());
    }
    let material = materials.last_mut().ok_or_else(|| (format!("`{key}`"), "`newmtl` before it"))?;
    match key {
        "Kd" => material.diffuse = colour(words)?.or(material.diffuse),
        "Ks" => material.specular = colour(words)?.unwrap_or(material.specular),
        "Tf" => material.filter = colour(words)?.unwrap_or(material.filter),
        "Ns" => material.exponent = number(words.next(), 0.0..=1e9)?,
        "Ni" => material.index = number(words.next(), 1e-3..=1e3)?,
        // `d -halo 0.5` fades with the angle, which is not done here.
        "d" => material.opaque = number(words.find(|word| *word != "-halo"), 0.0..=1.0)?,
        "Tr" => material.opaque = 1.0 - number(words.next(), 0.0..=1.0)?,
        "illum" => material.model = number(words.next(), 0.0..=10.0)? as u32,
        _ => material.texture = Some(picture(rest).ok_or(("no file".to_owned(), "a picture's file"))?),
    }
    Ok(())
}

fn number(word: Option<&str>, range: std::ops::RangeInclusive<f32>) -> Result<f32, Fault> {
    let word = word.ok_or_else(|| ("the line ends".to_owned(), "a number"))?;
    let read = word.parse().ok().filter(|number| range.contains(number));
    read.ok_or_else(|| (format!("{word:?}"), "a number that such a value may have"))
}

/// Red, green and blue, or one number for all; none for a spectrum's file or CIE coordinates.
fn colour(words: SplitWhitespace<'_>) -> Result<Option<Vec3>, Fault> {
    let words: Vec<&str> = words.collect();
    if matches!(words.first(), Some(&"spectral" | &"xyz")) {
        return Ok(None);
    }
    let read = |at: usize| number(words.get(at).copied(), -1e9..=1e9);
    Ok(Some(match words.len() {
        1 => Vec3::splat(read(0)?),
        _ => Vec3::new(read(0)?, read(1)?, read(2)?),
    }))
}

/// The file's name after the options of a map, none of which is followed.
fn picture(text: &str) -> Option<String> {
    let after_word = |text: &str| {
        let at = text.find(char::is_whitespace).unwrap_or(text.len());
        (text[..at].to_owned(), text[at..].trim_start().to_owned())
    };
    let mut rest = text.to_owned();
    while rest.starts_with('-') {
        let (option, mut after) = after_word(&rest);
        let (least, most) = match option.as_str() {
            "-o" | "-s" | "-t" => (1, 3),
            "-mm" => (2, 2),
            _ => (1, 1),
        };
        for argument in 0..most {
            let (word, further) = after_word(&after);
            if argument >= least && word.parse::<f32>().is_err() {
                break;
            }
            after = further;
        }
        rest = after;
    }
    // Windows wrote many of these files.
    (!rest.is_empty()).then(|| rest.replace('\\', "/"))
}

impl Lines {
    fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            diffuse: None,
            specular: Vec3::ZERO,
            exponent: 0.0,
            index: 1.0,
            opaque: 1.0,
            filter: Vec3::ONE,
            model: 2,
            texture: None,
        }
    }

    fn finish(self) -> Read {
        let unsaid = if self.texture.is_some() { Vec3::ONE } else { Material::default().diffuse };
        let is_mirror = matches!(self.model, 3..=9);
        let material = Material {
            highlight: if self.model >= 2 { self.specular } else { Vec3::ZERO },
            exponent: self.exponent.round().max(1.0) as u32,
            mirror: if is_mirror { self.specular } else { Vec3::ZERO },
            transmission: self.filter * (1.0 - self.opaque),
            fresnel: matches!(self.model, 5 | 7),
            index: if matches!(self.model, 4 | 6 | 7) { self.index } else { 1.0 },
            ..Material::matt(self.name, self.diffuse.unwrap_or(unsaid) * self.opaque)
        };
        Read { material, texture: self.texture }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_become_materials() {
        let text = "# a library\nnewmtl red paint\n  Kd 0.8 0.1 0.1\nKs .5 .5 .5\nNs 96.4\nKe 0 0 0\n\n\
                    newmtl glass\nKd 1\nd 0.25\nTf 1 .5 1\nNi 1.5\nillum 7\nKs 0.04 0.04 0.04\n\
                    newmtl floor\nmap_Kd -s 2 2 -clamp on -o 1 0 0 tex\\big floor.jpg\nTr 0.5\n";
        let read = read("m.mtl", text).unwrap();
        let [red, glass, floor] = &read[..] else { panic!("{read:?}") };
        assert_eq!((red.material.name.as_str(), red.material.exponent), ("red paint", 96));
        assert_eq!(red.material.diffuse, Vec3::new(0.8, 0.1, 0.1));
        assert_eq!((red.material.highlight, red.material.mirror), (Vec3::splat(0.5), Vec3::ZERO));
        assert_eq!(glass.material.transmission, Vec3::new(0.75, 0.375, 0.75));
        assert!(glass.material.fresnel && glass.material.index == 1.5);
        assert_eq!((glass.material.diffuse, glass.material.mirror), (Vec3::splat(0.25), Vec3::splat(0.04)));
        assert_eq!(floor.texture.as_deref(), Some("tex/big floor.jpg"));
        assert_eq!((floor.material.diffuse, floor.material.index), (Vec3::splat(0.5), 1.0));
    }

    #[test]
    fn faults_are_named_with_their_line() {
        for (text, part) in [
            ("Kd 1 1 1\n", "line 1: `Kd`; expected `newmtl` before it"),
            ("newmtl a\nKd 1 x 1\n", "line 2: \"x\"; expected a number"),
            ("newmtl a\nKd 1 nan 1\n", "line 2: \"nan\""),
            ("newmtl a\nKd 1 1\n", "line 2: the line ends; expected a number"),
            ("newmtl a\nd 2\n", "line 2: \"2\""),
            ("newmtl a\n\nNi 0\n", "line 3: \"0\""),
            ("newmtl a\nmap_Kd -s 1\n", "line 2: no file"),
        ] {
            let error = read("m.mtl", text).unwrap_err().to_string();
            assert!(error.starts_with("m.mtl: ") && error.contains(part), "{error:?} lacks {part:?}");
        }
    }
}
