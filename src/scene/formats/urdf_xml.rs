//! The XML of a URDF file: elements, attributes and numbers, with the line of what is not right.

use glam::{Affine3A, DMat3, DVec3};
use roxmltree::{Document, Error, Node};

use super::super::SceneError;

/// An element.
pub(super) type Element<'a> = Node<'a, 'a>;

/// Elements inherit the namespaces of those around them, and the parser keeps a list for each that adds one. What
/// declares more than this is no robot, but a trap for memory.
const MOST_NAMESPACES: usize = 64;

/// A file that has been taken apart.
pub(super) struct Xml<'a> {
    pub(super) file: &'a str,
    document: Document<'a>,
}

impl<'a> Xml<'a> {
    /// Takes a text apart. Document types are refused, and with them all entities of the file's own.
    ///
    /// # Errors
    /// [`SceneError::Malformed`] with the line where it ceases to be XML, the last one where it is cut.
    pub(super) fn parse(file: &'a str, text: &'a str) -> Result<Self, SceneError> {
        let declared = text.matches("xmlns").count();
        if declared > MOST_NAMESPACES {
            let found = format!("{declared} times `xmlns`");
            let expected = format!("at most {MOST_NAMESPACES} namespaces");
            return Err(SceneError::malformed(file, "document", found, expected));
        }
        let document = Document::parse(text).map_err(|error| {
            let line = match &error {
                Error::UnclosedRootNode | Error::UnexpectedEndOfStream | Error::NoRootNode => {
                    text.lines().count().max(1) as u32
                }
                error => error.pos().row,
            };
            let expected = "well-formed XML without a document type";
            SceneError::malformed(file, format!("line {line}"), error.to_string(), expected)
        })?;
        Ok(Self { file, document })
    }

    /// The outermost element, which must have this name.
    pub(super) fn root(&'a self, name: &str) -> Result<Element<'a>, SceneError> {
        let root = self.document.root_element();
        if root.tag_name().name() == name {
            return Ok(root);
        }
        let found = format!("element <{}>", root.tag_name().name());
        Err(self.fail(root, found, format!("<{name}>")))
    }

    /// What is wrong at an element.
    pub(super) fn fail(
        &self,
        at: Element<'_>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> SceneError {
        let line = self.document.text_pos_at(at.range().start).row;
        SceneError::malformed(self.file, format!("line {line}"), found, expected)
    }

    /// The elements of a name directly below one, in order. Those of another namespace than the outermost belong
    /// to some other tool.
    pub(super) fn all(&'a self, above: Element<'a>, name: &'a str) -> impl Iterator<Item = Element<'a>> {
        self.below(above).filter(move |element| element.tag_name().name() == name)
    }

    /// The elements directly below one, in order.
    pub(super) fn below(&'a self, above: Element<'a>) -> impl Iterator<Item = Element<'a>> {
        let own = self.document.root_element().tag_name().namespace();
        let is_own = move |element: &Element<'_>| element.tag_name().namespace() == own;
        above.children().filter(Element::is_element).filter(is_own)
    }

    /// The one element of a name directly below one, if there is any.
    ///
    /// # Errors
    /// [`SceneError::Malformed`] if there are more.
    pub(super) fn any(
        &'a self,
        above: Element<'a>,
        name: &'a str,
    ) -> Result<Option<Element<'a>>, SceneError> {
        let mut all = self.all(above, name);
        let first = all.next();
        match all.next() {
            Some(second) => Err(self.fail(second, format!("a second <{name}>"), "one at most")),
            None => Ok(first),
        }
    }

    /// The one element of a name directly below one.
    pub(super) fn one(&'a self, above: Element<'a>, name: &'a str) -> Result<Element<'a>, SceneError> {
        self.any(above, name)?.ok_or_else(|| {
            let found = format!("<{}> without <{name}>", above.tag_name().name());
            self.fail(above, found, format!("one <{name}> in it"))
        })
    }

    /// An attribute that must be there.
    pub(super) fn attribute(&self, element: Element<'a>, name: &str) -> Result<&'a str, SceneError> {
        element.attribute(name).ok_or_else(|| {
            let found = format!("<{}> without {name:?}", element.tag_name().name());
            self.fail(element, found, format!("{name}=\"...\""))
        })
    }

    /// The numbers of an attribute, if it is there, each finite, also when it is rounded to f32.
    pub(super) fn numbers<const N: usize>(
        &self,
        element: Element<'a>,
        name: &str,
    ) -> Result<Option<[f64; N]>, SceneError> {
        let Some(text) = element.attribute(name) else { return Ok(None) };
        let number = |word: &str| word.parse::<f64>().ok().filter(|number| (*number as f32).is_finite());
        let numbers: Option<Vec<f64>> = text.split_whitespace().map(number).collect();
        match numbers.and_then(|numbers| numbers.try_into().ok()) {
            Some(numbers) => Ok(Some(numbers)),
            None => {
                let expected = format!("{N} finite number{}", if N == 1 { "" } else { "s" });
                Err(self.fail(element, format!("{name}={text:?}"), expected))
            }
        }
    }

    /// Sizes that must be there and cannot be negative, in metres.
    pub(super) fn sizes<const N: usize>(
        &self,
        element: Element<'a>,
        name: &str,
    ) -> Result<[f64; N], SceneError> {
        let text = self.attribute(element, name)?;
        match self.numbers(element, name)? {
            Some(sizes) if sizes.iter().all(|size| *size >= 0.0) => Ok(sizes),
            _ => Err(self.fail(element, format!("{name}={text:?}"), "no negative size")),
        }
    }

    /// Where an element stands by its `origin`: turned by `rpy`, radians about the fixed axes x, y and z in this
    /// order, then moved by `xyz`, metres. What is not said is 0.
    pub(super) fn origin(&'a self, element: Element<'a>) -> Result<Affine3A, SceneError> {
        let Some(origin) = self.any(element, "origin")? else { return Ok(Affine3A::IDENTITY) };
        let [roll, pitch, yaw] = self.numbers(origin, "rpy")?.unwrap_or_default();
        let place = DVec3::from(self.numbers(origin, "xyz")?.unwrap_or_default());
        let turn = DMat3::from_rotation_z(yaw) * DMat3::from_rotation_y(pitch) * DMat3::from_rotation_x(roll);
        Ok(Affine3A::from_mat3_translation(turn.as_mat3(), place.as_vec3()))
    }
}
