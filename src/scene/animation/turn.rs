//! Arithmetic of unit quaternions, in 64-bit floats.

use glam::{DQuat, DVec3, Quat};

/// Below this, angles are taken as their sines.
const TINY: f64 = 1e-9;

/// A rotation as a unit quaternion; none at all where there is none to be had.
pub(super) fn unit(rotation: Quat) -> DQuat {
    let [x, y, z, w] = rotation.to_array().map(f64::from);
    normalised(DQuat::from_xyzw(x, y, z, w))
}

/// The same of unit length; the identity for one that has no length or no finite one.
pub(super) fn normalised(rotation: DQuat) -> DQuat {
    let largest = rotation.to_array().into_iter().fold(0.0, |most: f64, part| most.max(part.abs()));
    // First to a size whose square neither vanishes nor overflows.
    let scaled = rotation * largest.recip();
    let unit = scaled * scaled.length().recip();
    if unit.is_finite() { unit } else { DQuat::IDENTITY }
}

/// Half the angle of a unit quaternion about its axis, as a vector along it.
pub(super) fn log(rotation: DQuat) -> DVec3 {
    let axis = DVec3::new(rotation.x, rotation.y, rotation.z);
    let sine = axis.length();
    // About half a turn's double there is no axis to be told, and about no turn the vector is the logarithm itself.
    if sine < TINY { axis } else { axis * (sine.atan2(rotation.w) / sine) }
}

/// The unit quaternion whose logarithm this is.
pub(super) fn exp(half: DVec3) -> DQuat {
    let angle = half.length();
    let along = if angle < TINY { half } else { half * (angle.sin() / angle) };
    normalised(DQuat::from_xyzw(along.x, along.y, along.z, angle.cos()))
}

/// Evenly from one unit quaternion to another, whichever way that is (Shoemake 1985); the first where they are
/// opposite and there is no one way.
pub(super) fn slerp(share: f64, from: DQuat, to: DQuat) -> DQuat {
    // Exact also where the cosine is 1 to the last place.
    let angle = 2.0 * (from - to).length().atan2((from + to).length());
    let sine = angle.sin();
    if angle < TINY {
        return normalised(from * (1.0 - share) + to * share);
    }
    if sine < TINY {
        return from;
    }
    let (a, b) = (((1.0 - share) * angle).sin() / sine, (share * angle).sin() / sine);
    normalised(from * a + to * b)
}

/// A rotation with the sign that brings it near another.
pub(super) fn near(to: DQuat, rotation: DQuat) -> DQuat {
    if to.dot(rotation) < 0.0 { -rotation } else { rotation }
}
