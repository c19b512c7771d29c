//! From the words of an AFF file to its statements.

use glam::{Affine3A, DMat3, DQuat, DVec3, Vec3};

use super::super::super::{SceneError, View};
use super::faces::Faces;
use super::statement::{Finish, Include, Light, Look, Parsed, Round, Statement};
use super::words::{Fault, Words};
use super::{keys, mesh};

/// Reads a whole file.
///
/// # Errors
/// [`SceneError::Malformed`] naming line and column of the first word that is not right.
pub(super) fn parse(file: &str, stem: &str, bytes: &[u8]) -> Result<Parsed, SceneError> {
    let mut parser = Parser {
        words: Words::new(bytes),
        parsed: Parsed {
            stem: stem.into(),
            statements: Vec::new(),
            patches: Vec::new(),
            warnings: Vec::new(),
        },
        finish: None,
        open: Vec::new(),
        faces: Faces::default(),
    };
    parser.statements().map_err(|Fault(what)| {
        let (line, column) = parser.words.place(what.at);
        SceneError::malformed(file, format!("line {line}, column {column}"), what.found, what.expected)
    })?;
    Ok(parser.parsed)
}

struct Parser<'a> {
    words: Words<'a>,
    parsed: Parsed,
    /// The material that holds; none if that depends on what was included, here or around.
    finish: Option<Finish>,
    /// Where each brace stands that is still open.
    open: Vec<usize>,
    /// The polygons and triangles that the mesh in hand has so far.
    faces: Faces,
}

impl Parser<'_> {
    fn statements(&mut self) -> Result<(), Fault> {
        while let Some(word) = self.words.next() {
            self.statement(word)?;
        }
        self.faces.end(&mut self.parsed);
        match self.open.last() {
            Some(at) => Err(Fault::new(*at, "a `{` that nothing closes", "`}` before the file ends")),
            None => Ok(()),
        }
    }

    fn statement(&mut self, word: &[u8]) -> Result<(), Fault> {
        let words = &mut self.words;
        let statement = match word {
            b"p" | b"pp" | b"tt" | b"ttp" | b"tpa" => return self.face(word),
            b"m" => Statement::Patch(self.parsed.add_patch(mesh::read(words, self.finish)?)),
            b"s" => Statement::Round(Round::Sphere { centre: words.vector()?, radius: words.number()? }),
            b"c" => cone(words)?,
            b"f" | b"fm" => {
                let finish = if word == b"f" { fill(words)? } else { material(words)? };
                self.finish = Some(finish);
                Statement::Finish(Box::new(finish))
            }
            b"i" | b"xs" | b"x" | b"}" => {
                // A mesh ends here: what follows is placed elsewhere, or looks as another file says.
                self.faces.end(&mut self.parsed);
                self.structure(word)?
            }
            b"d" => Statement::Detail(level(words)?),
            b"k" => Statement::Keys(Box::new(keys::read(words, &mut self.parsed.warnings)?)),
            b"a" => frames(words)?,
            b"v" => Statement::View(view(words)?.map(Box::new)),
            b"b" => Statement::Background(words.vector()?),
            b"am" => Statement::Ambient(words.vector()?),
            b"l" => light(words, None)?,
            b"la" => {
                let name = words.name("a light's name")?.to_owned();
                light(words, Some(name))?
            }
            _ => {
                return Err(
                    words.wrong("a statement (v b l la am f fm c s p pp tt ttp tpa m i d xs x k a) or `}`")
                );
            }
        };
        self.parsed.statements.push(statement);
        Ok(())
    }

    /// What makes the structure of a scene.
    fn structure(&mut self, word: &[u8]) -> Result<Statement, Fault> {
        let words = &mut self.words;
        let statement = match word {
            b"i" => {
                let level = level(words)?;
                let name = words.name("a file's name")?.to_owned();
                let place = words.place(words.start);
                // It may set another material.
                self.finish = None;
                return Ok(Statement::Include(Box::new(Include { level, name, place })));
            }
            b"}" => {
                let closed = self.open.pop();
                return closed.map(|_| Statement::Close).ok_or_else(|| words.wrong("no `}`: no `{` is open"));
            }
            b"xs" => Statement::Open(Box::new(transform(words)?)),
            _ => Statement::OpenMoving(words.name("a transform's name")?.to_owned()),
        };
        words.expect("{")?;
        self.open.push(words.start);
        Ok(statement)
    }

    fn face(&mut self, word: &[u8]) -> Result<(), Fault> {
        let mut look = Look { finish: self.finish, texture: None };
        if word == b"tpa" {
            return self.faces.bend(&mut self.words, look, &mut self.parsed);
        }
        if word.starts_with(b"tt") {
            look.texture = Some(self.words.name("a texture's file")?.to_owned());
        }
        let has_normals = word.ends_with(b"p") && word != b"p";
        self.faces.polygon(&mut self.words, look, has_normals, &mut self.parsed)
    }
}

fn level(words: &mut Words<'_>) -> Result<i64, Fault> {
    let level = words.double()?;
    // All that an f64 holds without a fraction, which is more than anybody counts to.
    if level.fract() == 0.0 && level.abs() < 1e15 {
        Ok(level as i64)
    } else {
        Err(words.wrong("a level of detail"))
    }
}

fn cone(words: &mut Words<'_>) -> Result<Statement, Fault> {
    let (base, base_radius) = (words.vector()?, words.number()?);
    let (tip, tip_radius) = (words.vector()?, words.number()?);
    if base_radius.min(tip_radius) < 0.0 && base_radius.max(tip_radius) > 0.0 {
        return Err(words.wrong("two radii of one sign"));
    }
    Ok(Statement::Round(Round::Cone { base, base_radius, tip, tip_radius }))
}

/// NFF's material. Its highlights and mirrored light are white.
fn fill(words: &mut Words<'_>) -> Result<Finish, Fault> {
    let (colour, diffuse, specular) = (words.vector()?, words.number()?, words.number()?);
    Ok(Finish {
        ambient: None,
        diffuse: colour * diffuse,
        specular: Vec3::splat(specular),
        shine: words.number()?,
        transmission: words.number()?,
        index: words.number()?,
    })
}

fn material(words: &mut Words<'_>) -> Result<Finish, Fault> {
    let (ambient, diffuse) = (words.vector()?, words.vector()?);
    Ok(Finish {
        ambient: Some(ambient).filter(|ambient| *ambient != diffuse),
        diffuse,
        specular: words.vector()?,
        shine: words.number()?,
        transmission: words.number()?,
        index: words.number()?,
    })
}

fn light(words: &mut Words<'_>, name: Option<String>) -> Result<Statement, Fault> {
    let position = words.vector()?;
    let colour = if words.is_number_next() { Some(words.vector()?) } else { None };
    Ok(Statement::Light(Box::new(Light { position, colour, name })))
}

fn frames(words: &mut Words<'_>) -> Result<Statement, Fault> {
    let (start, end) = (words.double()?, words.double()?);
    if end < start {
        return Err(words.wrong(format!("an end not before the start, {start}")));
    }
    match words.whole()? {
        0 => Err(words.wrong("at least 1 frame")),
        frames => Ok(Statement::Frames(start, end, frames)),
    }
}

fn view(words: &mut Words<'_>) -> Result<Option<View>, Fault> {
    words.expect("from")?;
    let eye = words.vector()?;
    words.expect("at")?;
    let look = words.vector()?;
    words.expect("up")?;
    let up = words.vector()?;
    words.expect("angle")?;
    let degrees = words.double()?;
    if !(degrees > 0.0 && degrees < 180.0) {
        return Err(words.wrong("an angle above 0 and below 180 degrees"));
    }
    words.expect("hither")?;
    words.double()?;
    words.expect("resolution")?;
    let _ = [words.whole()?, words.whole()?];
    let looks = (look - eye).as_dvec3().cross(up.as_dvec3()) != DVec3::ZERO;
    Ok(looks.then(|| View { eye, look, up, fov_y: degrees.to_radians() as f32 }))
}

/// `T R S`: scaled, turned, moved.
fn transform(words: &mut Words<'_>) -> Result<Affine3A, Fault> {
    let (scale, turn) = (words.doubles()?, rotation(words)?);
    let translation = words.doubles()?;
    let matrix = DMat3::from_quat(turn) * DMat3::from_diagonal(scale);
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis, translation].map(|column| column.as_vec3a());
    let transform = Affine3A::from_cols(columns[0], columns[1], columns[2], columns[3]);
    if transform.is_finite() {
        Ok(transform)
    } else {
        Err(words.wrong("a transform within the range of f32"))
    }
}

/// An axis of any length and an angle in degrees.
pub(super) fn rotation(words: &mut Words<'_>) -> Result<DQuat, Fault> {
    let (axis, degrees) = (words.doubles()?, words.double()?);
    match axis.try_normalize() {
        Some(axis) => {
            let (sine, cosine) = (0.5 * degrees.to_radians()).sin_cos();
            let [x, y, z] = (axis * sine).to_array();
            Ok(DQuat::from_xyzw(x, y, z, cosine))
        }
        None if degrees == 0.0 => Ok(DQuat::IDENTITY),
        None => Err(words.wrong("an angle of 0, or an axis that is not 0, before it")),
    }
}
