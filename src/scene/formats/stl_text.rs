//! STL as text: `solid NAME`, then `facet normal N N N outer loop vertex X Y Z` three times `endloop
//! endfacet`, then `endsolid`; in small letters or capitals, broken into lines anyhow; several solids one
//! after the other.

use glam::Vec3;

use super::super::SceneError;

/// A solid: three corners for each triangle.
pub(super) struct Solid {
    pub(super) name: String,
    pub(super) corners: Vec<Vec3>,
}

/// Reads all solids.
///
/// # Errors
/// [`SceneError::Malformed`] with the number of the first line that is not right.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<Vec<Solid>, SceneError> {
    let mut words = Words { rest: bytes, line: 1 };
    solids(&mut words).map_err(|(found, expected)| {
        SceneError::malformed(file, format!("line {}", words.line), found, expected)
    })
}

fn solids(words: &mut Words<'_>) -> Result<Vec<Solid>, (String, String)> {
    let mut solids = Vec::new();
    while let Some(word) = words.next() {
        if !is(word, "solid") {
            return Err((shown(word), "solid".to_string()));
        }
        let mut solid = Solid { name: words.rest_of_line(), corners: Vec::new() };
        loop {
            match words.next() {
                Some(word) if is(word, "facet") => facet(words, &mut solid.corners)?,
                Some(word) if is(word, "endsolid") => break,
                other => return Err((other.map_or_else(end, shown), "facet or endsolid".to_string())),
            }
        }
        words.rest_of_line();
        solids.push(solid);
    }
    Ok(solids)
}

fn facet(words: &mut Words<'_>, corners: &mut Vec<Vec3>) -> Result<(), (String, String)> {
    words.expect("normal")?;
    // Normals are not read: some writers put nan where a triangle has none.
    for _ in 0..3 {
        words.next();
    }
    words.expect("outer")?;
    words.expect("loop")?;
    for _ in 0..3 {
        words.expect("vertex")?;
        corners.push(Vec3::new(words.coordinate()?, words.coordinate()?, words.coordinate()?));
    }
    words.expect("endloop")?;
    words.expect("endfacet")
}

/// The words of a text, and the line the last one stood on.
struct Words<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let blank = self.rest.iter().take_while(|byte| byte.is_ascii_whitespace());
        let blank = blank.inspect(|byte| self.line += usize::from(**byte == b'\n')).count();
        let rest = &self.rest[blank..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    fn rest_of_line(&mut self) -> String {
        let end = self.rest.iter().position(|byte| *byte == b'\n').unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        self.rest = rest;
        String::from_utf8_lossy(line).trim().to_string()
    }

    fn expect(&mut self, expected: &str) -> Result<(), (String, String)> {
        match self.next() {
            Some(word) if is(word, expected) => Ok(()),
            other => Err((other.map_or_else(end, shown), expected.to_string())),
        }
    }

    fn coordinate(&mut self) -> Result<f32, (String, String)> {
        let word = self.next();
        let number = word.and_then(|word| std::str::from_utf8(word).ok()?.parse().ok());
        let expected = || (word.map_or_else(end, shown), "a finite number".to_string());
        number.filter(|number: &f32| number.is_finite()).ok_or_else(expected)
    }
}

fn is(word: &[u8], expected: &str) -> bool {
    word.eq_ignore_ascii_case(expected.as_bytes())
}

fn end() -> String {
    "the end of the file".to_string()
}

/// A word for a message.
fn shown(word: &[u8]) -> String {
    format!("{:?}", String::from_utf8_lossy(&word[..word.len().min(40)]))
}
