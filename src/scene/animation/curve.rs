//! Values of curves at a time: in 64-bit floats, and never NaN if the scene is valid.

use glam::{DAffine3, DQuat, DVec3, Quat, Vec3};

use super::turn::{self, slerp};
use super::{Curve, HermiteKey, Motion, spline};

/// The key at or before a time, the one after it, and what share of the way between them has passed, below 1. Before
/// the first key and after the last both are that one. Keys that coincide are passed over but for the last of them, so
/// that no way has no length. None without keys.
pub(super) fn between<K>(keys: &[K], when: impl Fn(&K) -> f64, time: f64) -> Option<(usize, usize, f64)> {
    let last = keys.len().checked_sub(1)?;
    let after = keys.partition_point(|key| when(key) <= time);
    if after == 0 || after > last {
        let end = after.min(last);
        return Some((end, end, 0.0));
    }
    let (start, end) = (when(&keys[after - 1]), when(&keys[after]));
    Some((after - 1, after, share(start, time, end)))
}

/// How far from start to end a time between them is.
pub(super) fn share(start: f64, time: f64, end: f64) -> f64 {
    (time - start) / (end - start)
}

impl Curve<Vec3> {
    /// The value at a time in seconds; none of a curve without enough keys.
    pub fn at(&self, time: f64) -> Option<DVec3> {
        match self {
            Self::Spline(keys) => spline::vector(keys, time),
            Self::Linear(keys) => {
                let (a, b, share) = between(keys, |key| key.0, time)?;
                Some(keys[a].1.as_dvec3() * (1.0 - share) + keys[b].1.as_dvec3() * share)
            }
            Self::Steps(keys) => between(keys, |key| key.0, time).map(|(at, ..)| keys[at].1.as_dvec3()),
            Self::Hermite(keys) => hermite(keys, time, |value| value.as_dvec3()),
        }
    }
}

impl Curve<Quat> {
    /// The rotation at a time in seconds, of unit length; none of a curve without enough keys.
    pub fn at(&self, time: f64) -> Option<DQuat> {
        match self {
            Self::Spline(keys) => spline::rotation(keys, time),
            Self::Linear(keys) => {
                let (a, b, share) = between(keys, |key| key.0, time)?;
                let (a, b) = (turn::unit(keys[a].1), turn::unit(keys[b].1));
                // The shorter way round (glTF 2.0 appendix C.3).
                Some(slerp(share, a, turn::near(a, b)))
            }
            Self::Steps(keys) => between(keys, |key| key.0, time).map(|(at, ..)| turn::unit(keys[at].1)),
            Self::Hermite(keys) => hermite(keys, time, |value| {
                let [x, y, z, w] = value.to_array().map(f64::from);
                DQuat::from_xyzw(x, y, z, w)
            })
            .map(turn::normalised),
        }
    }
}

/// The cubic with the values and slopes of the two keys about a time (glTF 2.0 appendix C.5).
fn hermite<T, V>(keys: &[HermiteKey<T>], time: f64, wide: impl Fn(T) -> V) -> Option<V>
where
    T: Copy,
    V: std::ops::Mul<f64, Output = V> + std::ops::Add<Output = V>,
{
    let (a, b, u) = between(keys, |key| key.time, time)?;
    let (a, b) = (keys[a], keys[b]);
    let (square, long) = (u * u, b.time - a.time);
    let over = square * (3.0 - 2.0 * u);
    let leaving = wide(a.leaving) * (long * u * (1.0 - u) * (1.0 - u));
    let arriving = wide(b.arriving) * (long * square * (u - 1.0));
    Some(wide(a.value) * (1.0 - over) + leaving + wide(b.value) * over + arriving)
}

impl Motion {
    /// The transform at a time in seconds.
    pub fn transform(&self, time: f64) -> DAffine3 {
        let scale = self.scale.as_ref().and_then(|curve| curve.at(time)).unwrap_or(DVec3::ONE);
        let turn = self.rotation.as_ref().and_then(|curve| curve.at(time)).unwrap_or(DQuat::IDENTITY);
        DAffine3::from_scale_rotation_translation(scale, turn, self.moved(time))
    }

    /// The translation alone at a time in seconds, in metres.
    pub fn moved(&self, time: f64) -> DVec3 {
        self.translation.as_ref().and_then(|curve| curve.at(time)).unwrap_or(DVec3::ZERO)
    }

    /// Whether what follows it is seen at a time in seconds.
    pub fn is_seen(&self, time: f64) -> bool {
        let passed = self.visibility.partition_point(|(when, _)| *when <= time);
        passed.checked_sub(1).is_none_or(|last| self.visibility[last].1)
    }
}

#[cfg(test)]
#[path = "curve_tests.rs"]
mod tests;
