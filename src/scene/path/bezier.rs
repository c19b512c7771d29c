//! A flight on Bézier curves, as Bubeníček's cameras make over his dragons (2020, sec. 4.1).

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use super::super::SplitMix64;
use super::{CameraPath, PathKind, looking};
use crate::geometry::{Aabb, Camera, CameraError};

/// A flight on Bézier curves past a scene's bounds and through them.
pub(super) const BEZIER: PathKind = PathKind {
    name: "bezier",
    about: "a flight on Bézier curves, from outside through the bounds and out again (Bubeníček 2020)",
    make: |scene, frames, seed| {
        let bounds = scene.bounds();
        let diagonal = bounds.size().length();
        if bounds.is_empty() || !diagonal.is_finite() {
            return CameraPath::default();
        }
        let diagonal = if diagonal > 0.0 { diagonal } else { 1.0 };
        let waypoints = in_and_out(&bounds, diagonal, seed);
        // From the outermost waypoint everything is within two diagonals.
        let cameras = cameras(&waypoints, frames, diagonal * 1e-3, diagonal * 2.0);
        CameraPath { frames: cameras.flatten().collect() }
    },
};

/// Waypoints of a flight made for a scene.
const WAYPOINTS: usize = 9;

/// A place that a camera comes by and where it looks from there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    /// Where the eye is, in metres.
    pub eye: Vec3,
    /// The point looked at, in metres.
    pub look: Vec3,
}

impl CameraPath {
    /// A flight through waypoints on a composite cubic Bézier curve: one piece from each waypoint to the
    /// next, joined with equal tangents (C1), the one at a waypoint being half of the way from its
    /// neighbour before to the one behind. The point looked at follows such a curve of its own. Each
    /// piece takes equally many frames; the first frame is at the first waypoint, the last at the last.
    /// Its top is to the y axis, or to z where it looks along y. 60 degrees up and down, 4:3; near and
    /// far planes are the caller's, in metres. No frames without waypoints.
    ///
    /// # Errors
    /// [`CameraError`] if in some frame the point looked at is the eye, a number is not finite, or not
    /// 0 < near < far.
    pub fn bezier(waypoints: &[Waypoint], frames: usize, near: f32, far: f32) -> Result<Self, CameraError> {
        Ok(Self { frames: cameras(waypoints, frames, near, far).collect::<Result<_, _>>()? })
    }
}

/// The cameras of a flight, frame by frame.
fn cameras(
    waypoints: &[Waypoint],
    frames: usize,
    near: f32,
    far: f32,
) -> impl Iterator<Item = Result<Camera, CameraError>> {
    let eyes: Vec<DVec3> = waypoints.iter().map(|waypoint| waypoint.eye.as_dvec3()).collect();
    let looks: Vec<DVec3> = waypoints.iter().map(|waypoint| waypoint.look.as_dvec3()).collect();
    let pieces = waypoints.len().saturating_sub(1) as f64;
    let last = frames.saturating_sub(1).max(1) as f64;
    let frames = if waypoints.is_empty() { 0 } else { frames };
    (0..frames).map(move |frame| {
        let at = frame as f64 * pieces / last;
        looking(curve(&eyes, at).as_vec3(), curve(&looks, at).as_vec3(), near, far)
    })
}

/// The point on the curve through `points`, of which there is at least one; `at` counts pieces from 0.
fn curve(points: &[DVec3], at: f64) -> DVec3 {
    let Some(last) = points.len().checked_sub(2) else { return points[0] };
    let piece = (at as usize).min(last);
    let (start, end) = (points[piece], points[piece + 1]);
    // Beyond the ends the curve goes on straight.
    let before = if piece > 0 { points[piece - 1] } else { start * 2.0 - end };
    let behind = points.get(piece + 2).copied().unwrap_or(end * 2.0 - start);
    // A cubic Bézier curve leaves its first control point with three times the way to the second.
    let controls = [start, start + (end - before) / 6.0, end - (behind - start) / 6.0, end];
    casteljau(controls, at - piece as f64)
}

/// The point of a cubic Bézier curve at `share` of its way (de Casteljau).
fn casteljau([a, b, c, d]: [DVec3; 4], share: f64) -> DVec3 {
    let [ab, bc, cd] = [a.lerp(b, share), b.lerp(c, share), c.lerp(d, share)];
    ab.lerp(bc, share).lerp(bc.lerp(cd, share), share)
}

/// Waypoints by turns outside a box, with all of it in view, and within; all look to about its middle.
fn in_and_out(bounds: &Aabb, diagonal: f32, seed: u64) -> Vec<Waypoint> {
    let mut random = SplitMix64::new(seed);
    let start = random.between(0.0, TAU);
    let waypoint = |number: usize| {
        // A third of a turn or so from each to the next, so that they lead through the box.
        let angle = start + number as f64 * (TAU / 3.0) + random.between(-0.4, 0.4);
        let rise = random.between(0.1, 0.6);
        let out = DVec3::new(angle.cos(), rise, angle.sin()).normalize().as_vec3();
        let away = if number.is_multiple_of(2) { Vec3::splat(diagonal) } else { bounds.size() * 0.4 };
        let mut share = || random.between(-0.1, 0.1) as f32;
        let aside = Vec3::new(share(), share(), share());
        Waypoint { eye: bounds.centre() + out * away, look: bounds.centre() + aside * bounds.size() }
    };
    (0..WAYPOINTS).map(waypoint).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waypoints() -> Vec<Waypoint> {
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let eyes = [at(0.0, 0.0, 0.0), at(4.0, 1.0, 0.0), at(5.0, 3.0, 7.0), at(-2.0, 0.0, 9.0)];
        eyes.map(|eye| Waypoint { eye, look: at(0.0, -20.0, 4.0) }).to_vec()
    }

    #[test]
    fn curves_pass_their_points_with_one_tangent() {
        let points: Vec<DVec3> = waypoints().iter().map(|waypoint| waypoint.eye.as_dvec3()).collect();
        for (number, point) in points.iter().enumerate() {
            assert!((curve(&points, number as f64) - *point).length() < 1e-12);
        }
        let (step, inner) = (1e-6, 1..points.len() - 1);
        for number in inner {
            let at = number as f64;
            let into = (curve(&points, at) - curve(&points, at - step)) / step;
            let out = (curve(&points, at + step) - curve(&points, at)) / step;
            let half = (points[number + 1] - points[number - 1]) / 2.0;
            assert!((into - out).length() < 1e-4 && (into - half).length() < 1e-4, "{into} then {out}");
        }
    }

    #[test]
    fn casteljau_is_the_bernstein_polynomial() {
        let points = [DVec3::X, DVec3::new(3.0, -1.0, 2.0), DVec3::splat(1e6), DVec3::ZERO];
        for t in (0..=16).map(|t| f64::from(t) / 16.0) {
            let s = 1.0 - t;
            let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
            let sum: DVec3 = points.iter().zip(weights).map(|(point, weight)| *point * weight).sum();
            assert!((casteljau(points, t) - sum).length() < 1e-8);
        }
    }

    #[test]
    fn flights_begin_and_end_at_their_waypoints_and_bad_ones_are_refused() {
        let waypoints = waypoints();
        let path = CameraPath::bezier(&waypoints, 100, 0.1, 50.0).unwrap();
        assert_eq!(path.frames.len(), 100);
        assert_eq!((path.frames[0].eye, path.frames[99].eye), (waypoints[0].eye, waypoints[3].eye));
        assert_eq!(CameraPath::bezier(&waypoints, 1, 0.1, 50.0).unwrap().frames[0].eye, waypoints[0].eye);
        assert_eq!(CameraPath::bezier(&waypoints[..1], 3, 0.1, 50.0).unwrap().frames.len(), 3);
        assert!(CameraPath::bezier(&[], 100, 0.1, 50.0).unwrap().frames.is_empty());
        let here = Waypoint { eye: Vec3::ONE, look: Vec3::ONE };
        assert_eq!(CameraPath::bezier(&[here], 2, 0.1, 50.0), Err(CameraError::NoDirection));
        let lost = Waypoint { eye: Vec3::NAN, look: Vec3::ONE };
        assert_eq!(CameraPath::bezier(&[here, lost], 2, 0.1, 50.0), Err(CameraError::NotFinite));
        let shut = CameraPath::bezier(&waypoints, 2, 1.0, 1.0);
        assert!(matches!(shut, Err(CameraError::Depth { .. })));
    }
}
