//! Where a part stands and how it is turned. Angles in radians, anticlockwise seen from the axis' tip.
//!
//! Sines are taken in f64 and rounded once, so that a generated scene is the same on every machine.

use glam::{Affine3A, Mat3, Vec3};

/// A place, turned about x.
pub(super) fn turned_x(place: Vec3, angle: f64) -> Affine3A {
    let (sin, cos) = rounded(angle);
    let turn = Mat3::from_cols(Vec3::X, Vec3::new(0.0, cos, sin), Vec3::new(0.0, -sin, cos));
    Affine3A::from_mat3_translation(turn, place)
}

/// A place, turned about y.
pub(super) fn turned_y(place: Vec3, angle: f64) -> Affine3A {
    let (sin, cos) = rounded(angle);
    let turn = Mat3::from_cols(Vec3::new(cos, 0.0, -sin), Vec3::Y, Vec3::new(sin, 0.0, cos));
    Affine3A::from_mat3_translation(turn, place)
}

/// A place, turned about z.
pub(super) fn turned_z(place: Vec3, angle: f64) -> Affine3A {
    let (sin, cos) = rounded(angle);
    let turn = Mat3::from_cols(Vec3::new(cos, sin, 0.0), Vec3::new(-sin, cos, 0.0), Vec3::Z);
    Affine3A::from_mat3_translation(turn, place)
}

fn rounded(angle: f64) -> (f32, f32) {
    let (sin, cos) = angle.sin_cos();
    (sin as f32, cos as f32)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn each_turns_one_axis_onto_the_next() {
        let place = Vec3::new(1.0, 2.0, 3.0);
        for (turned, from, to, axis) in [
            (turned_x(place, FRAC_PI_2), Vec3::Y, Vec3::Z, Vec3::X),
            (turned_y(place, FRAC_PI_2), Vec3::Z, Vec3::X, Vec3::Y),
            (turned_z(place, FRAC_PI_2), Vec3::X, Vec3::Y, Vec3::Z),
        ] {
            assert!(turned.transform_vector3(from).distance(to) < 1e-6);
            assert_eq!(turned.transform_vector3(axis), axis);
            assert_eq!(turned.transform_point3(Vec3::ZERO), place);
        }
    }
}
