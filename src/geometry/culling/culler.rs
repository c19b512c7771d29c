//! The test of one frame.

use glam::Vec3;

use super::perspective::Projection;
use super::{ALL, Cached, Head, Memory, Motion, Octant, Side, Space, Steps, Verdict, planes};
use crate::geometry::frustum::KernelPlane;
use crate::geometry::volume::Placed;
use crate::geometry::{Frustum, PLANE_COUNT, Volume};

/// Near and far.
const PAIR: u8 = 1 << 2 | 1 << 3;

/// Bound on the rounding of carrying a distance over, relative to its terms: three sums and the shift's own
/// rounding, half an ulp each.
const CARRY: f32 = 4.0 / 16_777_216.0;

/// The octant test was asked for where it does not hold (Paper I sec. 3.3 and 4, P1-F02).
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the octant test cannot be used with an asymmetric frustum: turn it off")]
pub struct Asymmetric;

/// The test of one frame: a frustum, the steps to take, and what can be worked out for them beforehand.
pub struct Culler<'a, V: Volume> {
    frustum: &'a Frustum,
    steps: Steps,
    fields: [V::Field; PLANE_COUNT],
    eye: V::Eye,
    /// There are but the cached plane and the octant among the steps.
    plain: bool,
    projection: Option<Projection>,
    motion: Option<Motion>,
    /// Distances are kept: there is an epoch to keep them for. One that began with this very frame may end with
    /// it, as each does while the camera turns, and keeping costs more than a test (P1-F05).
    keeps: bool,
}

impl<'a, V: Volume> Culler<'a, V> {
    /// The test of a frustum by these steps. `motion` leads up to this frame; without it, or where too many
    /// frames went by, nothing is carried over from other frames.
    ///
    /// # Errors
    /// [`Asymmetric`].
    pub fn new(frustum: &'a Frustum, steps: Steps, motion: Option<Motion>) -> Result<Self, Asymmetric> {
        if steps.octant != Octant::Off && !frustum.symmetric {
            return Err(Asymmetric);
        }
        let motion = motion.filter(|motion| !motion.is_spent());
        let projection = (steps.space != Space::World).then(|| Projection::new(frustum));
        let keeps = steps.translation && motion.is_some_and(|motion| motion.epoch < motion.frame);
        let common = Steps { cached: steps.cached, octant: steps.octant, ..Steps::BASIC };
        Ok(Self { steps, plain: steps == common, motion, keeps, projection, ..Self::basic(frustum) })
    }

    /// The test by all six planes and nothing else.
    #[inline]
    pub fn basic(frustum: &'a Frustum) -> Self {
        Self {
            frustum,
            steps: Steps::BASIC,
            fields: frustum.kernel.map(|plane| V::field(plane.normal)),
            eye: V::eye(frustum.eye),
            plain: true,
            projection: None,
            motion: None,
            keeps: false,
        }
    }

    /// Tests a volume. `mask` has the bits of planes that something around it is inside of; it counts with
    /// [`Steps::masking`] only.
    #[inline]
    pub fn classify<M: Memory>(&self, volume: &V, memory: &M, mask: u8) -> Verdict {
        // The usual steps have code of their own, without the branches of the others.
        if self.plain { self.go::<M, true>(volume, memory, 0) } else { self.any_steps(volume, memory, mask) }
    }

    #[inline(never)]
    fn any_steps<M: Memory>(&self, volume: &V, memory: &M, mask: u8) -> Verdict {
        self.go::<M, false>(volume, memory, mask)
    }

    #[inline(always)]
    fn go<M: Memory, const PLAIN: bool>(&self, volume: &V, memory: &M, mask: u8) -> Verdict {
        let head = if self.steps.remember() { memory.head() } else { Head::default() };
        if !PLAIN && self.steps.rotation && self.motion.is_some_and(|motion| motion.still_outside(head)) {
            return Verdict { side: Side::Outside(head.plane), tests: 0, inside: 0 };
        }
        if volume.is_empty() {
            let side = if volume.is_nan() { Side::Intersecting } else { Side::Outside(0) };
            return Verdict { side, tests: 0, inside: 0 };
        }
        if let Some(projection) = self.projection.as_ref().filter(|_| !PLAIN) {
            return projection.classify(volume, self.steps.space);
        }
        let inside = if !PLAIN && self.steps.masking { mask & ALL } else { 0 };
        let walk = Walk::<V, M, PLAIN> {
            culler: self,
            placed: volume.placed(&self.eye),
            memory,
            inside,
            tested: inside,
            crossed: NONE,
            tests: 0,
            valid: 0,
        };
        walk.go(volume, head)
    }
}

/// No plane.
const NONE: u8 = PLANE_COUNT as u8;

/// One volume on its way through the planes.
struct Walk<'c, 'a, V: Volume + 'c, M, const PLAIN: bool> {
    culler: &'c Culler<'a, V>,
    placed: V::Placed<'c>,
    memory: &'c M,
    /// The planes it is certainly inside of.
    inside: u8,
    /// The planes that need no test any more.
    tested: u8,
    /// The first plane it may cross, or [`NONE`].
    crossed: u8,
    tests: u32,
    /// The planes whose distances are kept, of this epoch.
    valid: u8,
}

impl<'c, V: Volume, M: Memory, const PLAIN: bool> Walk<'c, '_, V, M, PLAIN> {
    #[inline(always)]
    fn go(mut self, volume: &V, head: Head) -> Verdict {
        let steps = &self.culler.steps;
        let rejected = self.find_rejecting(volume, head);
        let crossed = Some(self.crossed).filter(|crossed| *crossed != NONE);
        let kept = rejected.or(crossed.filter(|_| steps.cached == Cached::Crossed));
        if let Some(motion) = self.culler.motion.as_ref().filter(|_| !PLAIN) {
            let rejected = if rejected.is_some() { motion.frame + 1 } else { 0 };
            let plane = kept.unwrap_or(head.plane);
            let now = Head { plane, valid: self.valid, rejected, epoch: motion.epoch };
            if now != head {
                self.memory.keep(now);
            }
        } else if let Some(plane) =
            kept.filter(|plane| steps.cached != Cached::Nothing && *plane != head.plane)
        {
            self.memory.keep(Head { plane, ..Head::default() });
        }
        let side = match (rejected, crossed) {
            (Some(plane), _) => Side::Outside(plane),
            (None, Some(_)) => Side::Intersecting,
            (None, None) => Side::Inside,
        };
        Verdict { side, tests: self.tests, inside: self.inside }
    }

    /// Goes through the steps until a plane rejects.
    #[inline(always)]
    fn find_rejecting(&mut self, volume: &V, head: Head) -> Option<u8> {
        let steps = &self.culler.steps;
        if !PLAIN && let Some(plane) = self.carry_over(head) {
            return Some(plane);
        }
        if steps.cached != Cached::Nothing && self.test(usize::from(head.plane)) {
            return Some(head.plane);
        }
        let octant = if steps.octant == Octant::Off { None } else { self.octant(volume) };
        let chosen = octant.unwrap_or(ALL);
        if let Some(plane) = self.reject(chosen) {
            return Some(plane);
        }
        if self.crossed == NONE && octant.is_some() {
            match steps.octant {
                Octant::AsPublished => self.inside = ALL,
                // They reject nothing that lies inside three planes around its middle, but one may cross it.
                _ => return self.reject(ALL),
            }
        }
        None
    }

    /// Brings the distances kept in this epoch up to date, the last rejecting plane's first, until one rejects.
    #[inline]
    fn carry_over(&mut self, head: Head) -> Option<u8> {
        let motion = self.culler.motion.as_ref().filter(|motion| motion.epoch == head.epoch)?;
        if !self.culler.keeps {
            return None;
        }
        self.valid = head.valid;
        let first = 1 << head.plane & head.valid;
        for plane in planes(first & !self.tested).chain(planes(head.valid & !first & !self.tested)) {
            let (near, far) = self.memory.distances(plane);
            let shift = motion.shift[plane];
            let slack = |bound: f32| (bound.abs() + shift.abs()) * CARRY;
            if self.note(plane, near - shift > slack(near), far - shift < -slack(far)) {
                return Some(plane as u8);
            }
        }
        None
    }

    /// Tests planes, least first, until one rejects.
    #[inline(always)]
    fn reject(&mut self, among: u8) -> Option<u8> {
        // A pair may be done with both of its planes at once, so `test` asks again.
        planes(among & !self.tested).find(|plane| self.test(*plane)).map(|plane| plane as u8)
    }

    /// Tests a plane, unless that was done; whether it rejects.
    #[inline(always)]
    fn test(&mut self, plane: usize) -> bool {
        if !PLAIN && self.tested >> plane & 1 != 0 {
            return false;
        }
        self.tests += 1;
        if !PLAIN && self.culler.steps.pair && PAIR >> plane & 1 != 0 && self.tested & PAIR == 0 {
            return self.test_pair(plane);
        }
        let at = &self.culler.frustum.kernel[plane];
        let field = self.field(plane, at);
        let near = at.nearest(&self.placed, &field);
        let slack = self.placed.slack();
        // The p-vertex of a volume that is outside is never looked at, unless its distance is to be kept.
        let far = |walk: &Self| at.farthest(&walk.placed, &field);
        if !PLAIN && self.culler.keeps {
            self.keep(plane, near - slack, far(self) + slack);
        }
        let outside = near > slack;
        // The comparison is this way round for NaN's sake.
        let inside = !outside && far(self) <= -slack;
        self.note(plane, outside, inside)
    }

    /// Near and far at once: their normals are opposite, so the least product with one is the greatest with
    /// the other. Whether the one asked for rejects; if the other does, it is left to be found.
    #[inline]
    fn test_pair(&mut self, plane: usize) -> bool {
        let (at, opposite) = (&self.culler.frustum.kernel[plane], &self.culler.frustum.kernel[plane ^ 1]);
        let field = self.field(plane, at);
        let least = self.placed.nearest(at.normal, &field);
        let greatest = self.placed.farthest(at.normal, &field);
        let slack = self.placed.slack();
        let ends = [(least + at.low, greatest + at.high), (opposite.low - greatest, opposite.high - least)];
        if self.culler.keeps {
            for (plane, (near, far)) in [plane, plane ^ 1].into_iter().zip(ends) {
                self.keep(plane, near - slack, far + slack);
            }
        }
        let [(near, far), (other_near, other_far)] = ends;
        if other_near > slack {
            // It is beyond the other, and so not beyond this one; `tested` still lets the other be asked.
            return self.note(plane, false, far <= -slack);
        }
        self.note(plane ^ 1, false, other_far <= -slack);
        self.note(plane, near > slack, far <= -slack)
    }

    #[inline]
    fn field(&self, plane: usize, at: &KernelPlane) -> V::Field {
        if PLAIN || self.culler.steps.fields { self.culler.fields[plane] } else { V::field(at.normal) }
    }

    /// Notes what a plane said; whether it rejects.
    #[inline(always)]
    fn note(&mut self, plane: usize, outside: bool, inside: bool) -> bool {
        self.tested |= 1 << plane;
        if inside {
            self.inside |= 1 << plane;
        } else if !outside && self.crossed == NONE {
            self.crossed = plane as u8;
        }
        outside
    }

    /// Keeps bounds of a plane's distances, as seen from where the epoch began.
    #[inline]
    fn keep(&mut self, plane: usize, near: f32, far: f32) {
        if let Some(motion) = &self.culler.motion {
            let shift = motion.shift[plane];
            let slack = |bound: f32| (bound.abs() + shift.abs()) * CARRY;
            self.memory.keep_distances(plane, (near + shift - slack(near), far + shift + slack(far)));
            self.valid |= 1 << plane;
        }
    }

    /// The three planes of the octant that the volume's middle lies in, as bits; `None` if the volume is too
    /// large (Paper I sec. 3.3), or its middle behind the eye, where "right of the middle" no longer means
    /// "within the left plane".
    #[inline]
    fn octant(&mut self, volume: &V) -> Option<u8> {
        let frustum = self.culler.frustum;
        // Written so that a NaN takes the way of all six planes.
        let fits = V::ROUND || volume.radius() <= frustum.least_distance;
        if !fits {
            return None;
        }
        let centre: Vec3 = volume.centre() - frustum.eye;
        let [right, up, forward] = frustum.axes;
        let depth = forward.dot(centre);
        if depth <= 0.0 {
            return None;
        }
        self.tests += 1;
        // The frustum's middle lies on the line of sight, which goes through the eye: only its depth
        // has to be looked up.
        let pick = |less: bool, plane: u8, other: u8| 1 << if less { plane } else { other };
        Some(
            pick(right.dot(centre) < 0.0, 0, 1)
                | pick(depth < frustum.middle_depth, 2, 3)
                | pick(up.dot(centre) < 0.0, 5, 4),
        )
    }
}
