//! What moves in a scene: nodes and the camera along curves through key frames, and meshes that change shape (Lext,
//! Assarsson and Möller 2000, Implementation notes; P3-05, P3-06). Times are in seconds.

use glam::{Quat, Vec3};

/// What moves in a scene; nothing by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// When the first frame is.
    pub start: f64,
    /// When the last frame is.
    pub end: f64,
    /// How many frames whoever made it asks for; the first and the last are among them.
    pub frames: u32,
    /// How things move; several nodes may follow one motion.
    pub motions: Vec<Motion>,
    /// Nodes, and the motion that stands for the transform of each.
    pub followers: Vec<(u32, u32)>,
    /// The motion of the camera, which looks along its own -z, +y up.
    pub camera: Option<u32>,
    /// Lights, and the motion that takes each from where it stands in the scene to where it is.
    pub lights: Vec<(u32, u32)>,
    /// Meshes that change shape.
    pub bends: Vec<Bend>,
}

/// A transform that changes with time: first scaled, then turned, then moved. What is absent changes nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion {
    /// What it is called.
    pub name: String,
    /// Moved by, in metres.
    pub translation: Option<Curve<Vec3>>,
    /// Turned by.
    pub rotation: Option<Curve<Quat>>,
    /// Scaled by, along each axis.
    pub scale: Option<Curve<Vec3>>,
    /// From when on it is seen (true) or not; seen before the first.
    pub visibility: Vec<(f64, bool)>,
}

/// A value over time, through key frames in the order of their times. Before its first key that has a meaning of its
/// own, and after the last, it stays.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve<T> {
    /// A Kochanek-Bartels spline (1984); of rotations, its analogue on the sphere. The first and the last key only
    /// shape the curve between the others: at least four.
    Spline(Vec<SplineKey<T>>),
    /// Straight from key to key; rotations turn evenly.
    Linear(Vec<(f64, T)>),
    /// Each key's value until the next.
    Steps(Vec<(f64, T)>),
    /// Cubic between keys with their own slopes.
    Hermite(Vec<HermiteKey<T>>),
}

/// A key frame of a Kochanek-Bartels spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplineKey<T> {
    /// When.
    pub time: f64,
    /// What it is then.
    pub value: T,
    /// How sharply it bends there: 1 is tightest.
    pub tension: f32,
    /// How much its direction breaks there; 0 not at all.
    pub continuity: f32,
    /// Whether it overshoots (1) or undershoots (-1).
    pub bias: f32,
}

/// A key frame with slopes, per second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HermiteKey<T> {
    /// When.
    pub time: f64,
    /// What it is then.
    pub value: T,
    /// Slope with which it is come to.
    pub arriving: T,
    /// Slope with which it is left.
    pub leaving: T,
}

/// A mesh whose vertices move, straight from key to key; before the first key and after the last it stays.
#[derive(Clone, Debug, PartialEq)]
pub struct Bend {
    /// The mesh, by number.
    pub mesh: u32,
    /// Key frames in the order of their times.
    pub keys: Vec<BendKey>,
}

/// A mesh at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct BendKey {
    /// When.
    pub time: f64,
    /// Its vertices, in metres, as many as the mesh has.
    pub positions: Vec<Vec3>,
    /// Its normals, as many as the mesh has; between keys they are brought to unit length.
    pub normals: Vec<Vec3>,
}

impl Animation {
    /// Whether nothing moves.
    pub fn is_still(&self) -> bool {
        self.motions.is_empty() && self.bends.is_empty()
    }
}
