//! Kochanek-Bartels splines ("Interpolating Splines with Local Control of Tension, Continuity, and Bias", SIGGRAPH
//! 1984) and their analogue of rotations, as BART's files mean them (P3-05): keys unevenly spaced, ends clamped.
//!
//! A curve runs from its second key to the last but one, and each piece of it is shaped by four keys: those it joins,
//! and one before and behind. With `h` the length of the piece over that of the two pieces about a key, the piece
//! leaves its first key with the slope
//!
//! `h (1-t) ((1+c)(1+b) before + (1-c)(1-b) across)`
//!
//! and comes to its second with
//!
//! `h (1-t) ((1-c)(1+b) across + (1+c)(1-b) behind)`
//!
//! of its own length, where `before`, `across` and `behind` are the ways from key to key.

use glam::{DQuat, DVec3, Quat, Vec3};

use super::SplineKey;
use super::curve::{between, share};
use super::turn::{exp, log, near, slerp, unit};

/// Where on a curve a time is.
enum Place {
    /// On a key, or beyond the ends.
    Key(usize),
    /// On the piece that the key after this one leads to, so far along it.
    Piece(usize, f64),
}

/// None with fewer than four keys.
fn place<T>(keys: &[SplineKey<T>], time: f64) -> Option<Place> {
    let inner = keys.get(1..keys.len().checked_sub(1)?).filter(|inner| inner.len() >= 2)?;
    let (start, end, share) = between(inner, |key| key.time, time)?;
    Some(if start == end { Place::Key(start + 1) } else { Place::Piece(start, share) })
}

/// What the ways about a piece count in the slopes at its ends.
struct Weights {
    before: f64,
    across_from: f64,
    across_to: f64,
    behind: f64,
}

impl Weights {
    /// Of a piece between the middle two of four keys, which do not coincide.
    fn of<T>(keys: &[SplineKey<T>]) -> Self {
        let (from, to) = (&keys[1], &keys[2]);
        let part = |key: &SplineKey<T>| [key.tension, key.continuity, key.bias].map(f64::from);
        // The piece's length over that of two, at each end.
        let leaving = 1.0 - share(keys[0].time, from.time, to.time);
        let arriving = share(from.time, to.time, keys[3].time);
        let ([t, c, b], [u, d, e]) = (part(from), part(to));
        Self {
            before: leaving * (1.0 - t) * (1.0 + c) * (1.0 + b),
            across_from: leaving * (1.0 - t) * (1.0 - c) * (1.0 - b),
            across_to: arriving * (1.0 - u) * (1.0 - d) * (1.0 + e),
            behind: arriving * (1.0 - u) * (1.0 + d) * (1.0 - e),
        }
    }
}

/// The point of a curve at a time.
pub(super) fn vector(keys: &[SplineKey<Vec3>], time: f64) -> Option<DVec3> {
    let (first, u) = match place(keys, time)? {
        Place::Key(key) => return Some(keys[key].value.as_dvec3()),
        Place::Piece(first, u) => (first, u),
    };
    let keys = &keys[first..first + 4];
    let [p0, p1, p2, p3] = [0, 1, 2, 3].map(|key| keys[key].value.as_dvec3());
    let (weights, across) = (Weights::of(keys), p2 - p1);
    let out = (p1 - p0) * weights.before + across * weights.across_from;
    let into = across * weights.across_to + (p3 - p2) * weights.behind;
    let square = across * 3.0 - out * 2.0 - into;
    let cube = across * -2.0 + out + into;
    Some(p1 + (out + (square + cube * u) * u) * u)
}

/// The rotation of a curve at a time.
///
/// A key is taken with the sign that brings it near the one before. The key behind a piece is not: it has the sign it
/// was given, as in the code BART came with, by which its cameras were made. Where that is the far one, as in the
/// robots' camera three times, a piece swings out before its end. BART's slerp stands still between rotations less
/// than 0.001 radians apart; this one does not.
pub(super) fn rotation(keys: &[SplineKey<Quat>], time: f64) -> Option<DQuat> {
    let (first, s) = match place(keys, time)? {
        Place::Key(key) => return Some(unit(keys[key].value)),
        Place::Piece(first, s) => (first, s),
    };
    // Signs run on from the second key; the first keeps its own.
    let [mut q0, mut q1] = [0, 1].map(|key| unit(keys[key].value));
    let mut q2 = near(q1, unit(keys[2].value));
    for key in &keys[3..first + 3] {
        (q0, q1, q2) = (q1, q2, near(q2, unit(key.value)));
    }
    let q3 = unit(keys[first + 3].value);
    let weights = Weights::of(&keys[first..first + 4]);
    let across = log(q1.conjugate() * q2);
    let out = log(q0.conjugate() * q1) * weights.before + across * weights.across_from;
    let into = across * weights.across_to + log(q2.conjugate() * q3) * weights.behind;
    let a = q1 * exp((out - across) * 0.5);
    let b = q2 * exp((across - into) * 0.5);
    Some(slerp(2.0 * s * (1.0 - s), slerp(s, q1, q2), slerp(s, a, b)))
}
