//! What moves in a scene: nodes and the camera along curves through key frames, and meshes that change shape (Lext,
//! Assarsson and Möller 2000, Implementation notes; P3-05, P3-06). Times are in seconds.

use glam::{Quat, Vec3};

mod bend;
mod curve;
mod pose;
mod spline;
mod turn;
mod validate;

pub use pose::{Bent, Pose};
pub(super) use validate::FURTHEST;

/// What moves in a scene; nothing by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// When the first frame is.
    pub start: f64,
    /// When the last frame is.
    pub end: f64,
    /// How many frames whoever made it asks for, the first and the last among them; 0 if no number.
    pub frames: u32,
    /// How things move; several nodes may follow one motion.
    pub motions: Vec<Motion>,
    /// Nodes, and the motion that stands for the transform of each.
    pub followers: Vec<(u32, u32)>,
    /// The motion of the camera, which looks along its own -z, +y up.
    pub camera: Option<u32>,
    /// Lights, and the motion whose translation takes each from where it stands in the scene to where it is; while
    /// the motion is not seen, the light is out.
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

    /// When each of so many frames is, in seconds: the first at the start, the last at the end, the others evenly in
    /// between; a single one is at the start. Any number of frames will do: with fewer, less stays the same from one
    /// to the next (P3-05).
    pub fn times(&self, frames: u32) -> impl ExactSizeIterator<Item = f64> + use<> {
        let (start, end, last) = (self.start, self.end, frames.saturating_sub(1));
        (0..frames).map(move |frame| match frame {
            0 => start,
            frame if frame == last => end,
            frame => start + (end - start) * (f64::from(frame) / f64::from(last)),
        })
    }

    /// Bytes of key frames in memory.
    pub(in crate::scene) fn bytes(&self) -> usize {
        let of_motion = |motion: &Motion| {
            let vectors = [&motion.translation, &motion.scale].into_iter().flatten().map(Curve::bytes);
            let turns = motion.rotation.iter().map(Curve::bytes);
            vectors.chain(turns).sum::<usize>() + size_of_val(&motion.visibility[..])
        };
        let of_key = |key: &BendKey| 8 + size_of_val(&key.positions[..]) + size_of_val(&key.normals[..]);
        self.motions.iter().map(of_motion).sum::<usize>()
            + self.bends.iter().flat_map(|bend| &bend.keys).map(of_key).sum::<usize>()
    }
}

impl<T> Curve<T> {
    fn bytes(&self) -> usize {
        match self {
            Self::Spline(keys) => size_of_val(&keys[..]),
            Self::Linear(keys) | Self::Steps(keys) => size_of_val(&keys[..]),
            Self::Hermite(keys) => size_of_val(&keys[..]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_lie_evenly_from_start_to_end() {
        let museum = Animation { start: -1.0, end: 5.0, frames: 300, ..Animation::default() };
        let times: Vec<f64> = museum.times(museum.frames).collect();
        assert_eq!((times.len(), times[0], times[299]), (300, -1.0, 5.0));
        // AFF: the step is (end - start) / (frames - 1).
        let worst = (0..300).map(|frame| (times[frame] - (-1.0 + frame as f64 * (6.0 / 299.0))).abs());
        assert!(worst.fold(0.0, f64::max) < 1e-12);
        assert_eq!(museum.times(1).collect::<Vec<_>>(), [-1.0], "one frame is the first");
        assert_eq!(museum.times(2).collect::<Vec<_>>(), [-1.0, 5.0]);
        assert_eq!(museum.times(0).len(), 0);
        let frozen = Animation { start: 3.0, end: 3.0, ..Animation::default() };
        assert!(frozen.times(7).all(|time| time == 3.0));
        let thirds = Animation { start: 0.1, end: 0.7, ..Animation::default() };
        assert!(thirds.times(1000).is_sorted());
    }
}
