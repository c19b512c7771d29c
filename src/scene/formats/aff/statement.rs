//! What the statements of an AFF file say, before they are carried out: a file that is included many times is read
//! once, and what it says depends on where it is included only by the material that holds there.

use std::rc::Rc;

use glam::{Affine3A, Vec2, Vec3};

use super::super::super::{BendKey, Corners, Motion, View};

/// A file as it was read.
pub(super) struct Parsed {
    /// Its name without folder and extension.
    pub(super) stem: Rc<str>,
    pub(super) statements: Vec<Statement>,
    pub(super) patches: Vec<Patch>,
    /// What of it is not as it says.
    pub(super) warnings: Vec<String>,
}

impl Parsed {
    /// A patch's number.
    pub(super) fn add_patch(&mut self, patch: Patch) -> u32 {
        self.patches.push(patch);
        self.patches.len() as u32 - 1
    }
}

/// One statement, or several that make one mesh. What is large is boxed: a file may be made of the small ones alone.
pub(super) enum Statement {
    /// `v`; none if it looks nowhere.
    View(Option<Box<View>>),
    /// `b`
    Background(Vec3),
    /// `am`
    Ambient(Vec3),
    /// `l`, `la`
    Light(Box<Light>),
    /// `d`
    Detail(i64),
    /// `i`
    Include(Box<Include>),
    /// `f`, `fm`
    Finish(Box<Finish>),
    /// `xs`
    Open(Box<Affine3A>),
    /// `x`
    OpenMoving(String),
    /// `}`
    Close,
    /// `m`; `p`, `pp`, `tt`, `ttp` in a row; `tpa` in a row: the patch of a number.
    Patch(u32),
    /// `s`, `c`
    Round(Round),
    /// `k`
    Keys(Box<Motion>),
    /// `a`: first and last time in seconds, frames.
    Frames(f64, f64, u32),
}

/// A light, which may follow the keys of its name.
pub(super) struct Light {
    pub(super) position: Vec3,
    pub(super) colour: Option<Vec3>,
    pub(super) name: Option<String>,
}

/// A file to be read in place.
pub(super) struct Include {
    pub(super) level: i64,
    pub(super) name: String,
    /// Line and column of the name.
    pub(super) place: (u32, u32),
}

/// A material, before it is known whether a texture lies on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Finish {
    pub(super) ambient: Option<Vec3>,
    pub(super) diffuse: Vec3,
    pub(super) specular: Vec3,
    pub(super) shine: f32,
    pub(super) transmission: f32,
    pub(super) index: f32,
}

impl Finish {
    /// Its numbers' bits, to look it up by.
    pub(super) fn key(&self) -> [u32; 13] {
        let mut key = [u32::from(self.ambient.is_some()); 13];
        let colours = [self.ambient.unwrap_or_default(), self.diffuse, self.specular];
        let numbers = colours.iter().flat_map(|colour| colour.to_array());
        let numbers = numbers.chain([self.shine, self.transmission, self.index]);
        key[1..].iter_mut().zip(numbers).for_each(|(bits, number)| *bits = number.to_bits());
        key
    }
}

/// Triangles that become one mesh.
#[derive(Default)]
pub(super) struct Patch {
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) normals: Corners<Vec3>,
    pub(super) coordinates: Corners<Vec2>,
    /// What its triangles look like: at least one.
    pub(super) looks: Vec<Look>,
    /// For each triangle which of them; empty if there is but one.
    pub(super) look_of: Vec<u32>,
    /// If it changes its shape: key frames.
    pub(super) keys: Vec<BendKey>,
}

/// What a triangle looks like.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Look {
    /// Its material; none for that which holds where the file is included.
    pub(super) finish: Option<Finish>,
    /// The file of its texture.
    pub(super) texture: Option<String>,
}

/// A sphere or the side of a cone, where the file says it is. A radius below 0 means that only the inside is seen.
#[derive(Clone, Copy, Debug)]
pub(super) enum Round {
    Sphere { centre: Vec3, radius: f32 },
    Cone { base: Vec3, base_radius: f32, tip: Vec3, tip_radius: f32 },
}
