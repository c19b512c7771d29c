//! What the camera did since the last frames: what rotation and translation coherency go by (Paper I
//! sec. 3.5).
//!
//! **Translation.** While the axes, the lens and the depth range stay the same, bit for bit, only the eye
//! moves: an epoch. A distance kept in an epoch is kept as seen from where it began, so one number a plane
//! and frame, the epoch's shift, brings every volume's distances up to date. The paper adds each frame's
//! change to what it kept; its sums drift (finding P1-F07). Here nothing is summed: a distance is measured
//! once an epoch and shifted once. Its error grows with the way from the epoch's beginning, so an epoch
//! ends when that way is longer than the far plane is away, and all is tested exactly again.
//!
//! **Rotation.** While the eye, the lens and the depth range stay the same and the camera turns one way
//! about one of its own axes, a volume outside the plane that trails stays outside the frustum until the
//! plane opposite has come round to it: for an angle of 180 degrees less that between the two. The volume
//! may leave that plane's half-space meanwhile (finding P1-F08), so the turn counts from the frame that
//! really tested it. Near and far do not move at all when the camera rolls. Turns about other axes, such
//! as a level turn of a tilted camera, do not count (P1-F06), nor does anything after a change of lens.

use glam::{DVec3, Vec3};

use super::{ALL, Head};
use crate::geometry::{Camera, Frustum, PLANE_COUNT};

/// How far before its limit a turn begins anew, in radians.
const MARGIN: f64 = 1e-3;

/// The planes by their place in the order left, right, near, far, up, down.
const LEFT: u8 = 0;
const RIGHT: u8 = 1;
const NEAR: u8 = 2;
const FAR: u8 = 3;
const UP: u8 = 4;
const DOWN: u8 = 5;

/// The camera's way up to a frame.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    camera: Camera,
    pub(super) frame: u32,
    pub(super) epoch: u32,
    /// Where the eye was when the epoch began.
    from: Vec3,
    /// What is to be taken off the distances to each plane as the epoch has it, in metres.
    pub(super) shift: [f32; PLANE_COUNT],
    turn: Turn,
}

/// A turn about one axis.
#[derive(Clone, Copy, Debug)]
struct Turn {
    /// The frame it began with.
    since: u32,
    /// The planes that trail, as bits; all of them as long as the camera stands still.
    trailing: u8,
    /// How far it has gone, in radians.
    angle: f64,
}

impl Motion {
    /// The first frame.
    pub fn start(frustum: &Frustum) -> Self {
        let turn = Turn { since: 0, trailing: ALL, angle: 0.0 };
        let shift = [0.0; PLANE_COUNT];
        Self { camera: frustum.camera, frame: 0, epoch: 0, from: frustum.eye, shift, turn }
    }

    /// The next frame.
    #[must_use]
    pub fn next(&self, frustum: &Frustum) -> Self {
        let (before, camera) = (&self.camera, &frustum.camera);
        let frame = (self.frame + 1).min(Head::FRAMES);
        let mut now = Self { camera: *camera, frame, ..*self };
        let opening = |camera: &Camera| (camera.lens, camera.near, camera.far);
        let axes = |camera: &Camera| [camera.right, camera.up, camera.forward];
        let another = opening(before) != opening(camera);
        let way = |from: Vec3| camera.eye.as_dvec3() - from.as_dvec3();
        if another || axes(before) != axes(camera) || way(self.from).length() > f64::from(camera.far) {
            (now.epoch, now.from) = (frame, camera.eye);
        }
        now.shift = frustum.kernel.map(|plane| plane.normal.as_dvec3().dot(way(now.from)) as f32);
        now.turn = match another {
            true => Turn { since: frame, trailing: ALL, angle: 0.0 },
            false => self.turn.next(before, camera, frame),
        };
        now
    }

    /// Whether there are no more frame numbers to tell frames apart by: nothing is carried over then.
    #[inline]
    pub(super) fn is_spent(&self) -> bool {
        self.frame == Head::FRAMES
    }

    /// Whether a volume that was last seen outside a plane in a frame is still outside the frustum.
    #[inline]
    pub(super) fn still_outside(&self, head: Head) -> bool {
        // `rejected` is one more than the frame.
        (self.turn.since + 1..=self.frame + 1).contains(&head.rejected)
            && self.turn.trailing >> head.plane & 1 != 0
    }
}

impl Turn {
    fn next(self, before: &Camera, camera: &Camera, frame: u32) -> Self {
        let anew = Turn { since: frame, trailing: ALL, angle: 0.0 };
        if before.eye != camera.eye {
            return anew;
        }
        if before == camera {
            return self;
        }
        let Some((trailing, angle, opening)) = step(before, camera) else { return anew };
        // A turn that begins here may begin with all that was seen while the camera stood still.
        let goes_on = self.trailing == ALL || self.trailing == trailing;
        let angle = if goes_on { self.angle + angle } else { angle };
        let limit = opening.map_or(f64::INFINITY, |opening| std::f64::consts::PI - opening - MARGIN);
        if angle >= limit {
            return anew;
        }
        // What was seen in the frame before this one was seen before this step of the turn.
        Turn { since: if goes_on { self.since } else { frame - 1 }, trailing, angle }
    }
}

/// One step of a turn: the planes that trail, the angle in radians, and the angle between the trailing
/// plane and its opposite, where the turn brings that one round.
fn step(before: &Camera, camera: &Camera) -> Option<(u8, f64, Option<f64>)> {
    if before.forward == camera.forward {
        // A roll: near and far stay where they are.
        return Some((1 << NEAR | 1 << FAR, 0.0, None));
    }
    let same = |a: Vec3, b: Vec3| {
        let (a, b) = (a.as_dvec3(), b.as_dvec3());
        a.cross(b) == DVec3::ZERO && a.dot(b) > 0.0
    };
    let [left, right, bottom, top] = before.lens.tangents();
    // The tangents across the axis, the one that trails when the turn is positive first, and its planes.
    let (axis, across, tangents, planes): (_, fn(&Camera) -> Vec3, _, _) = if same(before.up, camera.up) {
        (before.up, |camera| camera.right, [left, right], [LEFT, RIGHT])
    } else if same(before.right, camera.right) {
        (before.right, |camera| camera.up, [bottom, top], [DOWN, UP])
    } else {
        return None;
    };
    // Both planes hold the axis exactly: their edges, seen along it, say how far they turned.
    let axis = axis.as_dvec3().normalize();
    let flat = |v: DVec3| (v - axis * axis.dot(v)).normalize();
    let forward = |camera: &Camera| camera.forward.as_dvec3();
    let edge = |camera: &Camera, tangent| flat(forward(camera) + across(camera).as_dvec3() * tangent);
    let positive = flat(forward(before)).cross(flat(across(before).as_dvec3()));
    let turns = tangents.map(|tangent| {
        let (from, to) = (edge(before, tangent), edge(camera, tangent));
        from.cross(to).dot(positive).atan2(from.dot(to))
    });
    let opening = edge(camera, tangents[0]).angle_between(edge(camera, tangents[1]));
    let (least, most) = (turns[0].abs().min(turns[1].abs()), turns[0].abs().max(turns[1].abs()));
    // Steps too small to tell their way, or so large that they might have gone round, begin anew.
    (least > 1e-6 && most < 1.0 && (turns[0] > 0.0) == (turns[1] > 0.0)).then(|| {
        let trailing = if turns[0] > 0.0 { planes[0] } else { planes[1] };
        (1 << trailing, most, Some(opening))
    })
}
