use std::f64::consts::{FRAC_PI_2, PI};

use glam::DMat3;

use super::super::SplineKey;
use super::*;

fn key<T>(time: f64, value: T, shape: [f32; 3]) -> SplineKey<T> {
    let [tension, continuity, bias] = shape;
    SplineKey { time, value, tension, continuity, bias }
}

/// Unevenly spaced, with every parameter in use.
fn path() -> Vec<SplineKey<Vec3>> {
    vec![
        key(-1.0, Vec3::new(0.0, 1.0, 2.0), [0.0; 3]),
        key(0.0, Vec3::new(3.0, 1.0, -2.0), [0.25, 0.5, -0.5]),
        key(2.5, Vec3::new(4.0, 5.0, 0.5), [-0.5, 0.0, 0.75]),
        key(3.0, Vec3::new(-1.0, 5.5, 8.0), [0.0, -0.25, 0.0]),
        key(4.0, Vec3::new(-2.0, 0.0, 8.5), [1.0, 0.0, 0.0]),
        key(7.0, Vec3::new(0.0, 0.0, 0.0), [0.0; 3]),
    ]
}

fn about(axis: Vec3, degrees: f32) -> Quat {
    Quat::from_axis_angle(axis.normalize(), degrees.to_radians())
}

/// The slopes at a key by the definition of Kochanek and Bartels for evenly spaced keys, then each brought to the
/// length of its own piece; the curve by Hermite's basis.
fn textbook(keys: &[SplineKey<Vec3>], time: f64) -> DVec3 {
    let last = keys.len() - 2;
    let time = time.clamp(keys[1].time, keys[last].time);
    let at = (1..last).rev().find(|at| keys[*at].time <= time).unwrap();
    let slopes = |at: usize| {
        let [t, c, b] = [keys[at].tension, keys[at].continuity, keys[at].bias].map(f64::from);
        let [p, q, r] = [at - 1, at, at + 1].map(|at| keys[at].value.as_dvec3());
        let [before, after] = [at - 1, at].map(|at| keys[at + 1].time - keys[at].time);
        let into = (q - p) * (0.5 * (1.0 - t) * (1.0 - c) * (1.0 + b))
            + (r - q) * (0.5 * (1.0 - t) * (1.0 + c) * (1.0 - b));
        let out = (q - p) * (0.5 * (1.0 - t) * (1.0 + c) * (1.0 + b))
            + (r - q) * (0.5 * (1.0 - t) * (1.0 - c) * (1.0 - b));
        (into * (2.0 * before / (before + after)), out * (2.0 * after / (before + after)))
    };
    let u = (time - keys[at].time) / (keys[at + 1].time - keys[at].time);
    let (a, b) = (keys[at].value.as_dvec3(), keys[at + 1].value.as_dvec3());
    let (out, into) = (slopes(at).1, slopes(at + 1).0);
    a * (2.0 * u.powi(3) - 3.0 * u * u + 1.0)
        + out * (u.powi(3) - 2.0 * u * u + u)
        + b * (3.0 * u * u - 2.0 * u.powi(3))
        + into * (u.powi(3) - u * u)
}

#[test]
fn splines_agree_with_the_textbook_and_are_clamped_at_their_ends() {
    let (keys, curve) = (path(), Curve::Spline(path()));
    for step in -20..=80 {
        let time = f64::from(step) * 0.1 + 0.013;
        let (found, expected) = (curve.at(time).unwrap(), textbook(&keys, time));
        assert!(found.distance(expected) < 1e-12, "{time}: {found} {expected}");
    }
    for inner in &keys[1..5] {
        assert_eq!(curve.at(inner.time), Some(inner.value.as_dvec3()));
    }
    for early in [f64::NEG_INFINITY, -1e300, -1.0, 0.0, f64::NAN] {
        assert_eq!(curve.at(early), Some(keys[1].value.as_dvec3()), "{early}");
    }
    for late in [4.0, 7.0, 1e300, f64::INFINITY] {
        assert_eq!(curve.at(late), Some(keys[4].value.as_dvec3()), "{late}");
    }
    assert_eq!(Curve::Spline(path()[..3].to_vec()).at(0.0), None, "three keys are no spline");
}

#[test]
fn a_catmull_rom_piece_has_its_known_middle() {
    // Evenly spaced and without parameters it is Catmull and Rom's: the middle is (-a + 9 b + 9 c - d) / 16.
    let values = [Vec3::new(1.0, 2.0, 0.0), Vec3::new(2.0, -1.0, 4.0), Vec3::new(5.0, 0.0, 8.0), Vec3::ZERO];
    let keys = (0..4).map(|at| key(f64::from(at), values[at as usize], [0.0; 3])).collect();
    let [a, b, c, d] = values.map(|value| value.as_dvec3());
    let middle = Curve::Spline(keys).at(1.5).unwrap();
    assert!(middle.distance((b * 9.0 + c * 9.0 - a - d) / 16.0) < 1e-14);
}

#[test]
fn where_continuity_is_0_speed_has_no_jump() {
    let mut keys = path();
    keys.iter_mut().for_each(|key| key.continuity = 0.0);
    let curve = Curve::Spline(keys.clone());
    let slope = |from: f64, to: f64| (curve.at(to).unwrap() - curve.at(from).unwrap()) / (to - from);
    let step = 1e-6;
    for inner in &keys[2..4] {
        let (into, out) = (slope(inner.time - step, inner.time), slope(inner.time, inner.time + step));
        assert!(into.distance(out) < 1e-3 * out.length().max(1.0), "{into} {out}");
    }
    // And where it is not, there is one: the test above can fail.
    keys[2].continuity = 0.5;
    let broken = Curve::Spline(keys.clone());
    let slope = |from: f64, to: f64| (broken.at(to).unwrap() - broken.at(from).unwrap()) / (to - from);
    let at = keys[2].time;
    assert!(slope(at - step, at).distance(slope(at, at + step)) > 0.5);
}

#[test]
fn coinciding_keys_give_numbers_and_the_last_of_them_counts() {
    // The robots' cameras have two keys at 0; wheels of the toy car jump between two in the middle.
    let times = [0.0, 0.0, 1.0, 1.0, 2.0, 2.0];
    let values: Vec<Vec3> = (0..6).map(|at| Vec3::splat(at as f32)).collect();
    let keys = times.iter().zip(&values).map(|(time, value)| key(*time, *value, [0.0; 3]));
    let curve = Curve::Spline(keys.collect());
    for (time, expected) in [(-1.0, 1.0), (0.0, 1.0), (1.0, 3.0), (2.0, 4.0), (3.0, 4.0)] {
        assert_eq!(curve.at(time), Some(DVec3::splat(expected)), "{time}");
    }
    assert!((0..200).all(|step| curve.at(f64::from(step) * 0.01).unwrap().is_finite()));
    let frozen = Curve::Spline((0..5).map(|at| key(1.0, values[at], [0.0; 3])).collect());
    for time in [0.0, 1.0, 2.0] {
        assert!(frozen.at(time).unwrap().is_finite());
    }
}

#[test]
fn lines_steps_and_hermite_curves_do_what_they_are_called() {
    let keys = vec![(1.0, Vec3::X), (3.0, Vec3::new(5.0, 4.0, 0.0)), (4.0, Vec3::ZERO)];
    let (line, steps) = (Curve::Linear(keys.clone()), Curve::Steps(keys));
    assert_eq!(line.at(1.5), Some(DVec3::new(2.0, 1.0, 0.0)));
    assert_eq!([line.at(0.0), line.at(9.0)], [Some(DVec3::X), Some(DVec3::ZERO)]);
    assert_eq!([steps.at(0.0), steps.at(2.999)], [Some(DVec3::X); 2]);
    assert_eq!(steps.at(3.0), Some(DVec3::new(5.0, 4.0, 0.0)));
    // x(t) = t^3 and its slope 3 t^2 are a cubic's own, whatever the spacing.
    let cubic = |time: f64| HermiteKey {
        time,
        value: Vec3::splat(time.powi(3) as f32),
        arriving: Vec3::splat(3.0 * (time * time) as f32),
        leaving: Vec3::splat(3.0 * (time * time) as f32),
    };
    let hermite = Curve::Hermite([-1.0, 0.5, 3.0].map(cubic).to_vec());
    for time in [-1.0, -0.25, 0.5, 1.75, 2.9, 3.0] {
        assert!((hermite.at(time).unwrap() - DVec3::splat(time * time * time)).length() < 1e-6, "{time}");
    }
    assert_eq!(Curve::<Vec3>::Linear(Vec::new()).at(0.0), None);
    assert_eq!(Curve::Linear(vec![(2.0, Vec3::Y)]).at(7.0), Some(DVec3::Y), "one key stays");
}

#[test]
fn rotations_take_the_shorter_way_evenly() {
    let curve = |to: f32| Curve::Linear(vec![(0.0, Quat::IDENTITY), (1.0, about(Vec3::Y, to))]);
    let angle = |turn: DQuat| 2.0 * turn.y.atan2(turn.w);
    for (to, expected) in
        [(90.0, 22.5), (170.0, 42.5), (200.0, -40.0), (-90.0, -22.5), (270.0, -22.5), (360.0, 0.0)]
    {
        let found = angle(curve(to).at(0.25).unwrap()).to_degrees();
        let off = (found - expected).rem_euclid(360.0);
        assert!(off.min(360.0 - off) < 1e-4, "{to}: {found}");
    }
    // Opposite quaternions are one rotation.
    let still = Curve::Linear(vec![(0.0, about(Vec3::X, 50.0)), (1.0, -about(Vec3::X, 50.0))]);
    let turned = still.at(0.6).unwrap() * DVec3::Y;
    assert!(turned.distance((about(Vec3::X, 50.0) * Vec3::Y).as_dvec3()) < 1e-6);
}

/// About one axis the spline of rotations is that of angles but for squad's own shape: at the keys and in their slopes
/// the same. A turn of more than 180 degrees in all, piece by piece.
#[test]
fn a_spline_about_one_axis_passes_its_angles_at_their_speed() {
    let angles = [0.0, 40.0, 150.0, 260.0, 380.0, 420.0];
    let times = [0.0, 1.0, 2.0, 4.0, 5.0, 8.0];
    let turns = (0..6).map(|at| key(times[at], about(Vec3::Z, angles[at]), [0.0, 0.0, 0.0]));
    // Signs as the angles give them, which is as a file would have them.
    let turns: Vec<_> = turns
        .zip(angles)
        .map(|(turn, angle)| SplineKey {
            value: Quat::from_xyzw(
                0.0,
                0.0,
                (angle.to_radians() / 2.0).sin(),
                (angle.to_radians() / 2.0).cos(),
            ),
            ..turn
        })
        .collect();
    let lines: Vec<_> =
        (0..6).map(|at| key(times[at], Vec3::X * angles[at].to_radians(), [0.0, 0.0, 0.0])).collect();
    let (turns, lines) = (Curve::Spline(turns), Curve::Spline(lines));
    let angle = |time: f64| {
        let turn = turns.at(time).unwrap();
        2.0 * turn.z.atan2(turn.w)
    };
    let near = |a: f64, b: f64| (a - b + PI).rem_euclid(2.0 * PI) - PI;
    let step = 1e-6;
    for time in [1.0, 2.0, 4.0, 5.0] {
        assert!(near(angle(time), lines.at(time).unwrap().x).abs() < 1e-6, "{time}");
    }
    for time in [2.0, 4.0] {
        let slope = (lines.at(time + step).unwrap() - lines.at(time).unwrap()).x / step;
        let [into, out] = [-step, step].map(|step| near(angle(time + step), angle(time)) / step);
        assert!((into - out).abs() < 1e-4, "{time}: {into} then {out}");
        assert!((out - slope).abs() < 1e-4, "{time}: {out} for {slope}");
    }
}

/// Squad by de Casteljau's two steps written in rotation matrices, whose interpolation is by axis and angle: another
/// arithmetic altogether.
#[test]
fn rotations_agree_with_squad_in_matrices() {
    let turn = |axis: [f32; 3], degrees: f32| about(Vec3::from(axis), degrees);
    let values = [
        turn([1.0, 0.2, 0.0], 20.0),
        turn([0.3, 1.0, -0.4], 75.0),
        turn([-0.2, 0.5, 1.0], 110.0),
        turn([0.0, 1.0, 1.0], 60.0),
    ];
    let times = [0.0, 1.0, 3.0, 3.5];
    let shapes = [[0.0; 3], [0.2, 0.3, -0.4], [-0.5, 0.1, 0.6], [0.0; 3]];
    let keys: Vec<_> = (0..4).map(|at| key(times[at], values[at], shapes[at])).collect();
    let matrices = values.map(|value| {
        let [x, y, z, w] = value.to_array().map(f64::from);
        DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize())
    });
    // The rotation vector of a matrix, from its trace and its skew part.
    let vector = |m: DMat3| {
        let angle = ((m.x_axis.x + m.y_axis.y + m.z_axis.z - 1.0) / 2.0).clamp(-1.0, 1.0).acos();
        let skew = DVec3::new(m.y_axis.z - m.z_axis.y, m.z_axis.x - m.x_axis.z, m.x_axis.y - m.y_axis.x);
        skew.normalize_or_zero() * angle
    };
    let matrix = |v: DVec3| match v.length() {
        0.0 => DMat3::IDENTITY,
        angle => DMat3::from_axis_angle(v / angle, angle),
    };
    let mix = |share: f64, a: DMat3, b: DMat3| a * matrix(vector(a.transpose() * b) * share);
    let ways: Vec<DVec3> = (0..3).map(|at| vector(matrices[at].transpose() * matrices[at + 1])).collect();
    let parts = |at: usize| shapes[at].map(f64::from);
    let ([t, c, b], [u, d, e]) = (parts(1), parts(2));
    let (h, g) = (2.0 * 2.0 / 3.0 / 2.0, 2.0 * 2.0 / 2.5 / 2.0);
    let out = (ways[0] * (1.0 + c) * (1.0 + b) + ways[1] * (1.0 - c) * (1.0 - b)) * ((1.0 - t) * h);
    let into = (ways[1] * (1.0 - d) * (1.0 + e) + ways[2] * (1.0 + d) * (1.0 - e)) * ((1.0 - u) * g);
    let a = matrices[1] * matrix((out - ways[1]) * 0.5);
    let b = matrices[2] * matrix((ways[1] - into) * 0.5);
    let curve = Curve::Spline(keys);
    for share in [0.0, 0.1, 0.37, 0.5, 0.8, 0.99, 1.0] {
        let expected =
            mix(2.0 * share * (1.0 - share), mix(share, matrices[1], matrices[2]), mix(share, a, b));
        let found = DMat3::from_quat(curve.at(1.0 + 2.0 * share).unwrap());
        assert!(found.abs_diff_eq(expected, 1e-7), "{share}: {found} {expected}");
    }
}

#[test]
fn signs_of_keys_do_what_they_do_in_barts_own_code() {
    let keys: Vec<_> = (0..7)
        .map(|at| key(f64::from(at), about(Vec3::new(1.0, at as f32, 0.5), 30.0 * at as f32), [0.0; 3]))
        .collect();
    let plain = Curve::Spline(keys.clone());
    let turned = |signs: &[usize]| {
        let mut keys = keys.clone();
        signs.iter().for_each(|at| keys[*at].value = -keys[*at].value);
        Curve::Spline(keys)
    };
    let apart = |a: &Curve<Quat>, b: &Curve<Quat>, time: f64| {
        let (a, b) = (a.at(time).unwrap(), b.at(time).unwrap());
        (a.dot(b).abs().min(1.0)).acos()
    };
    let (all, one, second) = (turned(&[0, 1, 2, 3, 4, 5, 6]), turned(&[4]), turned(&[2]));
    for step in 0..60 {
        let time = f64::from(step) * 0.1 + 0.05;
        assert!(apart(&plain, &all, time) < 1e-6, "all signs changed, none against another");
        assert!(
            apart(&plain, &second, time) < 1e-6,
            "no piece lies before key 1, where key 2 would be behind"
        );
        // Key 4 is seen with its own sign from the piece that ends at key 3 alone.
        let swings = (2.0..3.0).contains(&time);
        assert_eq!(apart(&plain, &one, time) > 1e-6, swings, "{time}");
    }
    assert!(apart(&plain, &one, 2.6) > 0.01, "the piece before swings");
    for at in 1..6 {
        assert!(apart(&plain, &one, f64::from(at)) < 1e-6, "keys are passed all the same");
    }
}

#[test]
fn opposite_turned_and_still_keys_give_rotations() {
    let x = Quat::from_xyzw(1.0, 0.0, 0.0, 0.0);
    let tiny = Quat::from_xyzw(1e-20, 0.0, 0.0, 1e-20);
    for values in [
        [Quat::IDENTITY; 4],
        [Quat::IDENTITY, -Quat::IDENTITY, Quat::IDENTITY, -Quat::IDENTITY],
        [Quat::IDENTITY, x, Quat::IDENTITY, x],
        [x, Quat::from_xyzw(0.0, 1.0, 0.0, 0.0), Quat::from_xyzw(0.0, 0.0, 1.0, 0.0), Quat::IDENTITY],
        [tiny, x, tiny, about(Vec3::X, 1e-4)],
        [Quat::from_xyzw(0.0, 0.0, 0.0, 3e38), x * 1e38, Quat::IDENTITY, Quat::IDENTITY],
    ] {
        for shape in [[0.0; 3], [-1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [f32::MAX, f32::MIN, 1e20]] {
            let keys: Vec<_> =
                (0..4).map(|at| key(f64::from(at as u8), values[at as usize], shape)).collect();
            let hermite =
                values.map(|value| HermiteKey { time: 0.0, value, arriving: value, leaving: value });
            let hermite = (0..4).map(|at| HermiteKey { time: at as f64, ..hermite[at] }).collect();
            for curve in [Curve::Spline(keys.clone()), Curve::Hermite(hermite)] {
                for step in 0..=40 {
                    let turn = curve.at(f64::from(step) * 0.1 - 0.5).unwrap();
                    assert!((turn.length() - 1.0).abs() < 1e-9, "{values:?} {shape:?}: {turn}");
                }
            }
        }
    }
}

#[test]
fn a_transform_scales_then_turns_then_moves() {
    let motion = Motion {
        translation: Some(Curve::Steps(vec![(0.0, Vec3::new(10.0, 0.0, 0.0))])),
        rotation: Some(Curve::Steps(vec![(0.0, Quat::from_rotation_z(FRAC_PI_2 as f32))])),
        scale: Some(Curve::Steps(vec![(0.0, Vec3::new(2.0, 1.0, 1.0))])),
        ..Motion::default()
    };
    // (1, 1, 0) is scaled to (2, 1, 0), turned to (-1, 2, 0), moved to (9, 2, 0).
    let moved = motion.transform(5.0).transform_point3(DVec3::new(1.0, 1.0, 0.0));
    assert!(moved.distance(DVec3::new(9.0, 2.0, 0.0)) < 1e-6, "{moved}");
    assert_eq!(Motion::default().transform(5.0), DAffine3::IDENTITY);
}

#[test]
fn things_are_seen_until_a_key_says_otherwise() {
    let motion = Motion {
        visibility: vec![(1.0, false), (2.0, true), (2.0, false), (3.0, true)],
        ..Motion::default()
    };
    let seen = [0.0, 1.0, 1.9, 2.0, 2.9, 3.0, 1e9, f64::NAN].map(|time| motion.is_seen(time));
    assert_eq!(seen, [true, false, false, false, false, true, true, true]);
    assert!(Motion::default().is_seen(0.0));
}
